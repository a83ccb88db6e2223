/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the verb `opcflow library list|show|check|prune`: contents of a
   library of corrected cells. */
#include <eda/print.h>
#include <math.h>
#include <opcflow/command.h>
#include <opcflow/table.h>
#include <string.h>

#include <correct/entry.h>
#include <correct/shelf.h>

/* ---- state ---- */

typedef struct verb {
  const opc_host *host;
  const char *database, *settings;
  int superseded;
} verb;

typedef struct line {
  char *cell, *method, *process, *settings, *made, *state;
  int64_t transistors, simulations, bytes;
  double ion_mean, ion_max, seconds;
} line;

/* State of one traversal of all rows. */
typedef struct pass {
  const verb *v;
  const char *const *pattern; /* NULL-terminated; empty: all cells */
  GArray *lines;              /* line */
  GHashTable *keys;           /* keys of rows to remove */
  char *cell, *newest;        /* cell and geometry of the last row */
  size_t damaged;
} pass;

static void clear_line(gpointer item) {
  line *l = item;
  char *const texts[] = {l->cell,     l->method, l->process,
                         l->settings, l->made,   l->state};
  for (size_t i = 0; i < G_N_ELEMENTS(texts); i++) g_free(texts[i]);
}

/* ---- all cells ---- */

static gboolean is_wanted(const pass *p, const shelf_row *row) {
  const char *s = p->v->settings;
  if (s && strncmp(row->settings, s, strlen(s)) != 0) return FALSE;
  if (!*p->pattern) return TRUE;
  for (const char *const *one = p->pattern; *one; one++)
    if (g_pattern_match_simple(*one, row->cell)) return TRUE;
  return FALSE;
}

/* Return an abbreviated hash, long enough to be distinct. */
static char *short_sum(const char *sum) { return g_strndup(sum, 10); }

static int take_row(void *self, const shelf_row *row, GVariant *data,
                    opc_error *error) {
  pass *p = self;
  (void)error;
  if (!is_wanted(p, row)) return OPC_OK;
  g_autoptr(entry) e = data ? correct_entry_unpack(data) : NULL;
  g_autoptr(GDateTime) made = g_date_time_new_from_unix_utc(row->made);
  p->damaged += !e;
  const line l = {.cell = g_strdup(row->cell),
                  .method = g_strdup(row->method),
                  .process = short_sum(row->process),
                  .settings = short_sum(row->settings),
                  .made = made ? g_date_time_format_iso8601(made) : NULL,
                  .state = g_strdup(e ? "sound" : "damaged"),
                  .transistors = row->transistors,
                  .simulations = row->simulations,
                  .bytes = row->bytes,
                  .ion_mean = row->ion_mean,
                  .ion_max = row->ion_max,
                  .seconds = row->seconds};
  g_array_append_val(p->lines, l);
  if (!e) g_hash_table_add(p->keys, g_strdup(row->key));
  return OPC_OK;
}

static int library_list(const pass *p, opc_error *error) {
  const line none = {0}, *l = (const line *)(const void *)p->lines->data;
  size_t n = p->lines->len;
  if (!n) l = &none;
  const opc_column columns[] = {
      {"cell", NULL, OPC_TEXT, 0, &l->cell},
      {"transistors", NULL, OPC_INT, 0, &l->transistors},
      {"method", NULL, OPC_TEXT, 0, &l->method},
      {"process", NULL, OPC_TEXT, 0, &l->process},
      {"settings", NULL, OPC_TEXT, 0, &l->settings},
      {"ion_mean", "%", OPC_REAL, 3, &l->ion_mean},
      {"ion_max", "%", OPC_REAL, 3, &l->ion_max},
      {"simulations", NULL, OPC_INT, 0, &l->simulations},
      {"cpu", "s", OPC_REAL, 2, &l->seconds},
      {"bytes", NULL, OPC_INT, 0, &l->bytes},
      {"made", NULL, OPC_TEXT, 0, &l->made},
      {"state", NULL, OPC_TEXT, 0, &l->state}};
  return opc_put_rows(p->v->host, "cells", OPC_TABLE_PRINT, n, sizeof *l,
                      columns, G_N_ELEMENTS(columns), error);
}

/* ---- one cell ---- */

typedef struct gate {
  const char *cell, *type;
  int64_t number;
  double l, w, ion; /* nm, nm, % */
  int64_t mask_l, mask_w, jog, end_low, end_high, parts;
} gate;

static int show_row(void *self, const shelf_row *row, GVariant *data,
                    opc_error *error) {
  const pass *p = self;
  g_autoptr(entry) e = data ? correct_entry_unpack(data) : NULL;
  if (!is_wanted(p, row)) return OPC_OK;
  if (!e)
    return opc_fail(error, OPC_IO, NULL, "cell '%s' is damaged", row->cell);
  g_autofree gate *gates = g_new0(gate, e->gates + 1);
  const eda_moved *m = e->moved;
  for (size_t i = 0; i < e->gates; i++) {
    gates[i] = (gate){.cell = row->cell,
                      .type = e->type[i] == EDA_PMOS ? "p" : "n",
                      .number = (int64_t)i + 1,
                      .l = e->length[i],
                      .w = e->width[i],
                      .ion = eda_deviation(e->after.ion[i], e->design[i]),
                      .mask_l = m->l[i],
                      .mask_w = m->w[i],
                      .jog = m->jog[i],
                      .end_low = m->end[2 * i],
                      .end_high = m->end[2 * i + 1]};
    const eda_part *part = m->part + EDA_PARTS * i;
    while (gates[i].parts < EDA_PARTS &&
           part[gates[i].parts].from < part[gates[i].parts].to)
      gates[i].parts++;
  }
  const opc_column columns[] = {
      {"cell", NULL, OPC_TEXT, 0, &gates->cell},
      {"number", NULL, OPC_INT, 0, &gates->number},
      {"type", NULL, OPC_TEXT, 0, &gates->type},
      {"l", "nm", OPC_REAL, 1, &gates->l},
      {"w", "nm", OPC_REAL, 1, &gates->w},
      {"ion", "%", OPC_REAL, 3, &gates->ion},
      {"mask_l", "steps", OPC_INT, 0, &gates->mask_l},
      {"mask_w", "steps", OPC_INT, 0, &gates->mask_w},
      {"jog", "steps", OPC_INT, 0, &gates->jog},
      {"end_low", "steps", OPC_INT, 0, &gates->end_low},
      {"end_high", "steps", OPC_INT, 0, &gates->end_high},
      {"parts", NULL, OPC_INT, 0, &gates->parts}};
  g_autofree char *sum = short_sum(row->key);
  g_autofree char *name = g_strdup_printf("%s_%s", row->cell, sum);
  return opc_put_rows(p->v->host, name, OPC_TABLE_PRINT, e->gates,
                      sizeof *gates, columns, G_N_ELEMENTS(columns), error);
}

/* ---- order ---- */

static int check_all(const pass *p, shelf *s, opc_error *error) {
  int code = shelf_check(s, error);
  if (code) return code;
  if (p->damaged)
    return opc_fail(error, OPC_IO, NULL,
                    "%zu of %u cells are damaged: remove them by 'opcflow "
                    "library prune', the next run corrects them again",
                    p->damaged, p->lines->len);
  p->v->host->log(p->v->host, OPC_LOG_INFO, "%u cells are valid",
                  p->lines->len);
  return OPC_OK;
}

/* Mark superseded rows. Rows are sorted by cell, then by time: all but the last
   row of a cell and method are superseded. */
static int mark_superseded(void *self, const shelf_row *row, GVariant *data,
                           opc_error *error) {
  pass *p = self;
  (void)data, (void)error;
  if (!is_wanted(p, row)) return OPC_OK;
  g_autofree char *name = g_strdup_printf("%s %s", row->cell, row->method);
  if (p->cell && !strcmp(p->cell, name))
    g_hash_table_add(p->keys, g_strdup(p->newest));
  g_free(p->cell);
  g_free(p->newest);
  p->cell = g_strdup(name);
  p->newest = g_strdup(row->key);
  return OPC_OK;
}

static int mark_chosen(void *self, const shelf_row *row, GVariant *data,
                       opc_error *error) {
  const pass *p = self;
  (void)data, (void)error;
  if (is_wanted(p, row)) g_hash_table_add(p->keys, g_strdup(row->key));
  return OPC_OK;
}

/* Remove damaged rows, rows selected by name, and superseded rows if
   requested. */
static int library_prune(pass *p, shelf *s, opc_error *error) {
  int code = OPC_OK;
  if (p->v->superseded)
    code = shelf_each(s, NULL, mark_superseded, p, error);
  else if (*p->pattern || p->v->settings)
    code = shelf_each(s, NULL, mark_chosen, p, error);
  if (!code) code = shelf_remove(s, p->keys, error);
  if (!code)
    p->v->host->log(p->v->host, OPC_LOG_INFO, "%u cells removed",
                    g_hash_table_size(p->keys));
  return code;
}

/* ---- the verb ---- */

static int library_work(pass *p, shelf *s, const char *what, opc_error *error) {
  if (!strcmp(what, "show"))
    return shelf_each(s, ENTRY_TYPE, show_row, p, error);
  int code = shelf_each(s, ENTRY_TYPE, take_row, p, error);
  if (code) return code;
  if (!strcmp(what, "check")) return check_all(p, s, error);
  return strcmp(what, "prune") ? library_list(p, error)
                               : library_prune(p, s, error);
}

static int library_run(void *self, size_t n, const char *const *arguments,
                       opc_error *error) {
  static const char *const verbs[] = {"list", "show", "check", "prune", NULL};
  const verb *v = self;
  if (!n || !g_strv_contains(verbs, arguments[0]))
    return opc_fail(error, OPC_INVALID, NULL,
                    "expected an action: list, show, check or prune");
  if (!strcmp(arguments[0], "show") && n < 2)
    return opc_fail(error, OPC_INVALID, NULL, "name the cells to show");
  g_autofree char *path = v->database ? g_strdup(v->database) : shelf_place();
  g_autoptr(shelf) s = shelf_open(path, FALSE, error);
  if (!s) return error->code;
  g_autofree const char **pattern = g_new0(const char *, n + 1);
  for (size_t i = 1; i < n; i++) pattern[i - 1] = arguments[i];
  pass p = {
      .v = v,
      .pattern = pattern,
      .lines = g_array_new(FALSE, TRUE, sizeof(line)),
      .keys = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL)};
  g_array_set_clear_func(p.lines, clear_line);
  int code = library_work(&p, s, arguments[0], error);
  g_array_free(p.lines, TRUE);
  g_hash_table_destroy(p.keys);
  g_free(p.cell);
  g_free(p.newest);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(verb, database, .type = OPC_TEXT,
                  .summary = "the library; opcflow/library.sqlite in the "
                             "user's data folder"),
    OPC_PARAMETER(verb, settings, .type = OPC_TEXT,
                  .summary = "only cells of settings whose sum begins so"),
    OPC_PARAMETER(verb, superseded, .type = OPC_BOOL, .preset = "false",
                  .summary = "prune: all but the newest entry of each cell and "
                             "method"),
};

/* ---- entry ---- */

static const opc_command functions = {
    .arguments = "list|show|check|prune [CELL ...]", .run = library_run};

OPC_PLUGIN(verb, .id = "command.library", .kind = "command",
           .version = OPC_VERSION, .licence = "BSD-3-Clause",
           .summary = "content of a library of corrected cells",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
