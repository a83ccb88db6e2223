/* SPDX-License-Identifier: BSD-3-Clause */
/* Cells that were simulated before: a file each, named by a hash of all that
   its figures depend on. */
#include <errno.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "characterize.h"

/* To be raised when figures change for the same circuit. */
#define FORMAT "opcflow-timing 2"

/* ---- the key ---- */

static void hash_text(GChecksum *sum, const char *text) {
  g_checksum_update(sum, (const guchar *)text, (gssize)strlen(text) + 1);
}

static void hash_number(GChecksum *sum, double value) {
  char text[40];
  snprintf(text, sizeof text, "%.17g", value);
  hash_text(sum, text);
}

static void hash_numbers(GChecksum *sum, const double *value, size_t n) {
  hash_number(sum, (double)n);
  for (size_t i = 0; i < n; i++) hash_number(sum, value[i]);
}

static int hash_cards(GChecksum *sum, const study *s, opc_error *error) {
  for (int i = 0; i < 2; i++) {
    g_autofree char *text = NULL;
    g_autoptr(GError) fault = NULL;
    gsize n;
    hash_text(sum, s->model[i]);
    /* What the file includes is in the card; without DLC there is none. */
    for (size_t k = 0; s->dlc && k < s->card[i].count; k++) {
      hash_text(sum, s->card[i].key[k]);
      hash_text(sum, s->card[i].value[k]);
    }
    if (!s->cards[i]) continue;
    if (!g_file_get_contents(s->cards[i], &text, &n, &fault))
      return opc_fail(error, OPC_IO, "models", "%s", fault->message);
    g_checksum_update(sum, (const guchar *)text, (gssize)n);
  }
  return OPC_OK;
}

static void hash_colour(GChecksum *sum, uint64_t colour) {
  char text[24];
  snprintf(text, sizeof text, "%016" PRIx64, colour);
  hash_text(sum, text);
}

/* Cells of the same circuit side by side, whatever their names and the order of
   their transistors, have one key: a part's colour says where it is. */
char *keep_key(const study *s, const eda_timing_cell *c, opc_error *error) {
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  const circuit *r = circuit_of(s, c);
  hash_text(sum, FORMAT);
  hash_number(sum, s->dlc);
  hash_number(sum, s->supply);
  hash_number(sum, s->temperature);
  hash_numbers(sum, s->edges.values, s->edges.count);
  hash_numbers(sum, s->slews.values, s->slews.count);
  hash_numbers(sum, s->loads.values, s->loads.count);
  hash_number(sum, (double)c->inputs);
  hash_number(sum, (double)c->outputs);
  for (size_t i = 0; i < r->parts; i++) {
    const part *p = &r->part[i];
    const double n[] = {p->type, p->length, p->width, p->count};
    hash_numbers(sum, n, sizeof n / sizeof *n);
    hash_colour(sum, p->colour);
  }
  if (hash_cards(sum, s, error)) return NULL;
  return g_strndup(g_checksum_get_string(sum), 32);
}

/* ---- files ---- */

static char *path_of(const study *s, const char *key) {
  const char *store = g_getenv("OPCFLOW_STORE");
  if (s->kept && !strcmp(s->kept, "none")) return NULL;
  if (s->kept) return g_build_filename(s->kept, key, NULL);
  if (store) return g_build_filename(store, "timing", key, NULL);
  return g_build_filename(g_get_user_cache_dir(), "opcflow", "timing", key,
                          NULL);
}

int keep_load(const study *s, const char *cell, const char *key, double *figure,
              size_t figures) {
  g_autofree char *path = path_of(s, key), *text = NULL;
  if (!path || !g_file_get_contents(path, &text, NULL, NULL)) return 0;
  g_autofree char *head = g_strdup_printf(FORMAT " %s %zu\n", key, figures);
  int good = g_str_has_prefix(text, head);
  char *at = text + (good ? strlen(head) : 0);
  for (size_t i = 0; good && i < figures; i++) {
    char *end;
    figure[i] = g_ascii_strtod(at, &end);
    good = end > at && *end == '\n' && isfinite(figure[i]);
    at = end + 1;
  }
  if (good && !strcmp(at, "end\n")) return 1;
  s->host->log(s->host, OPC_LOG_WARNING,
               "'%s' is damaged; cell '%s' is simulated again", path, cell);
  memset(figure, 0, figures * sizeof *figure);
  return 0;
}

/* A cell that cannot be kept is no fault: it is simulated again next time. */
void keep_save(const study *s, const char *cell, const char *key,
               const double *figure, size_t figures) {
  g_autofree char *path = path_of(s, key);
  g_autoptr(GError) fault = NULL;
  if (!path) return;
  g_autofree char *folder = g_path_get_dirname(path);
  g_autoptr(GString) text = g_string_new(NULL);
  g_string_printf(text, FORMAT " %s %zu\n", key, figures);
  for (size_t i = 0; i < figures; i++)
    g_string_append_printf(text, "%.17g\n", figure[i]);
  g_string_append(text, "end\n");
  g_mkdir_with_parents(folder, 0700);
  /* Written beside it and renamed: whoever reads it meanwhile has all. */
  if (!g_file_set_contents(path, text->str, (gssize)text->len, &fault))
    s->host->log(s->host, OPC_LOG_WARNING, "cell '%s' is not kept: %s", cell,
                 fault->message);
}
