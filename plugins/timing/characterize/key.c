/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes the key of a circuit, a hash of all data that determine its values
   except this plugin. Loads and saves the values in the store of the host. */
#include <glib.h>
#include <inttypes.h>
#include <opcflow/results.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "characterize.h"

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
    /* The parsed card also covers files that it includes. Cards are parsed only
       if `dlc` is set. */
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

/* Cells that consist of different numbers of the same circuit in parallel have
   the same key, independent of the names and the order of transistors. The
   colour of a part encodes the connections of the part. */
char *keep_key(const study *s, const eda_timing_cell *c, opc_error *error) {
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  const circuit *r = circuit_of(s, c);
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

/* ---- results ---- */

int keep_load(const study *s, const char *key, double *figure, size_t figures) {
  const opc_results *results = opc_get_results(s->host);
  size_t size = 0, wanted = figures * sizeof *figure;
  void *kept = results ? results->find(s->host, key, &size) : NULL;
  int good = kept && size == wanted;
  if (good) memcpy(figure, kept, wanted);
  free(kept);
  return good;
}

void keep_save(const study *s, const char *key, const double *figure,
               size_t figures) {
  const opc_results *results = opc_get_results(s->host);
  if (results) results->keep(s->host, key, figure, figures * sizeof *figure);
}
