/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the printed sizes of each instance's transistors from a mask, from the
   table gates.csv of a run, or from each run of an experiment. */
#include <eda/runs.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "paths.h"

/* Printed sizes of the gates, nm; area nm^2. */
typedef struct printed {
  double *leq, *weq, *area; /* 0 or NAN if the gate does not print */
} printed;

static const char *gate_where(const eda_gates *g, size_t i) {
  return *g->instance[i] ? g->instance[i] : g->cell[i];
}

/* ---- from the gates to the instances ---- */

/* Compute the ln of the ratios of printed to drawn sizes of a device. Its
   length is the mean of the logarithms of its fingers' lengths, weighted by
   width; its width is the sum of the widths. */
static int change_of(const paths *p, const eda_device *d, const printed *q,
                     double change[EDA_SIZES], opc_error *error) {
  const eda_gates *g = p->circuit->gates;
  double drawn = 0, width = 0, l = 0, c = 0;
  for (uint32_t k = 0; k < d->fingers; k++) {
    uint32_t f = d->finger[k];
    double mean = q->area[f] / q->weq[f];
    if (!(q->leq[f] > 0 && q->weq[f] > 0 && mean > 0))
      return opc_fail(error, OPC_FAILED, NULL,
                      "netlist device '%.100s' has no size: the gate "
                      "'%.200s:%u' does not print",
                      d->name, gate_where(g, f), g->number[f]);
    drawn += g->width[f];
    width += q->weq[f];
    l += q->weq[f] * log(q->leq[f] / d->length);
    c += q->weq[f] * log(mean / d->length);
  }
  change[EDA_SIZE_L] = l / width;
  change[EDA_SIZE_W] = log(width / drawn);
  change[EDA_SIZE_C] = c / width;
  return OPC_OK;
}

static void state_allocate(paths *p, state *s) {
  const graph *g = &p->graph;
  s->change = eda_pool_alloc(&p->pool, g->instances, sizeof *s->change);
  for (size_t i = 0; i < g->nodes; i++) {
    double **c = &s->change[g->node[i].instance];
    if (!*c)
      *c = eda_pool_alloc(&p->pool, g->node[i].cell->bundles * EDA_SIZES,
                          sizeof **c);
  }
}

static int sizes_apply(paths *p, state *s, const printed *q, opc_error *error) {
  place *places = graph_places(&p->graph, p->circuit, error);
  if (!places) return error->code;
  state_allocate(p, s);
  int code = OPC_OK;
  for (size_t i = 0; i < p->circuit->count && !code; i++) {
    const eda_timing_device *t = places[i].device;
    double change[EDA_SIZES] = {0};
    code = change_of(p, &p->circuit->device[i], q, change, error);
    for (size_t k = 0; k < EDA_SIZES; k++)
      s->change[places[i].instance][t->bundle * EDA_SIZES + k] +=
          t->share * change[k];
  }
  free(places);
  return code;
}

/* ---- from a mask ---- */

static int from_mask(paths *p, state *s, opc_error *error) {
  if (eda_mask_flat(p->mask, &p->mask, error)) return error->code;
  const eda_performance *after = &p->mask->after;
  const printed q = {after->leq_ion, after->weq, after->area};
  if (p->mask->gates != p->circuit->gates)
    return opc_fail(error, OPC_INVALID, "mask",
                    "the mask and the circuit belong to different gates");
  return sizes_apply(p, s, &q, error);
}

/* ---- from a table ---- */

/* Columns read from gates.csv. */
enum { GATE, LEQ, WEQ, AREA, COLUMNS };
static const char *const names[COLUMNS] = {"transistor", "leq_ion", "weq",
                                           "area_after"};

static int find_columns(eda_table *t, const char *path, size_t at[COLUMNS],
                        const double *value[COLUMNS], opc_error *error) {
  for (int k = 0; k < COLUMNS; k++) {
    int found = eda_table_find(t, names[k]);
    if (found < 0)
      return opc_fail(error, OPC_INVALID, "prints",
                      "'%.300s' has no column '%s', expected a table of gates",
                      path, names[k]);
    at[k] = (size_t)found;
    value[k] = k == GATE ? NULL : eda_table_numbers(t, at[k]);
    if (k != GATE && !value[k])
      return eda_table_fail(t, 0, at[k], "no column of numbers:", error);
  }
  return OPC_OK;
}

/* Read the rows of a table. Gates without a row count as not printed, which is
   an error only for gates of the circuit. */
static int take_rows(const paths *p, eda_table *t, const char *path,
                     GHashTable *gates, printed *q, opc_error *error) {
  const eda_gates *g = p->circuit->gates;
  size_t at[COLUMNS];
  const double *value[COLUMNS];
  if (find_columns(t, path, at, value, error)) return error->code;
  for (size_t r = 0; r < eda_table_rows(t); r++) {
    gpointer gate = g_hash_table_lookup(gates, eda_table_text(t, r, at[GATE]));
    if (!gate)
      return eda_table_fail(t, r, at[GATE],
                            "not a transistor of this circuit:", error);
    size_t i = GPOINTER_TO_SIZE(gate) - 1;
    q->leq[i] = value[LEQ][r];
    q->weq[i] = value[WEQ][r];
    q->area[i] = g->length[i] * g->width[i] * (1 + value[AREA][r] / 100);
  }
  return OPC_OK;
}

static int from_table(paths *p, state *s, const char *path, opc_error *error) {
  const eda_gates *g = p->circuit->gates;
  eda_table *t = eda_table_read(path, error);
  if (!t) return error->code;
  g_autoptr(GHashTable) gates =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  printed q = {eda_pool_alloc(&p->pool, g->count, sizeof(double)),
               eda_pool_alloc(&p->pool, g->count, sizeof(double)),
               eda_pool_alloc(&p->pool, g->count, sizeof(double))};
  for (size_t i = 0; i < g->count; i++)
    g_hash_table_insert(
        gates, g_strdup_printf("%s:%u", gate_where(g, i), g->number[i]),
        GSIZE_TO_POINTER(i + 1));
  int code = take_rows(p, t, path, gates, &q, error);
  eda_table_free(t);
  return code ? code : sizes_apply(p, s, &q, error);
}

/* ---- from an experiment ---- */

/* Return the path of a run's verification table if present, else of its
   correction table (caller frees). */
static char *table_of(const char *folder) {
  char *judged = g_build_filename(folder, "verify.gates.csv", NULL);
  if (g_file_test(judged, G_FILE_TEST_EXISTS)) return judged;
  g_free(judged);
  return g_build_filename(folder, "gates.csv", NULL);
}

static int from_experiment(paths *p, opc_error *error) {
  const eda_experiment *e = p->experiment;
  if (e->n_cases != 1)
    return opc_fail(
        error, OPC_INVALID, "experiment",
        "the experiment has %zu cases, expected one, the layout of 'circuit'",
        e->n_cases);
  for (size_t m = 0; m < e->n_methods; m++) {
    if (!e->folders[m]) {
      p->host->log(p->host, OPC_LOG_WARNING,
                   "'%s' is omitted, because the run failed", e->methods[m]);
      continue;
    }
    g_autofree char *path = table_of(e->folders[m]);
    state *s = &p->state[p->states++];
    s->name = eda_pool_text(&p->pool, e->methods[m], strlen(e->methods[m]));
    if (from_table(p, s, path, error)) return error->code;
  }
  return OPC_OK;
}

/* ---- all ---- */

int states_find(paths *p, opc_error *error) {
  size_t most =
      2 + p->prints.count + (p->experiment ? p->experiment->n_methods : 0);
  p->state = eda_pool_alloc(&p->pool, most, sizeof *p->state);
  p->state[0].name = "drawn";
  p->states = 1;
  if ((p->mask || p->prints.count || p->experiment) && !p->circuit)
    return opc_fail(error, OPC_INVALID, "circuit",
                    "'circuit' is missing, required for printed sizes");
  if (p->spice && !p->circuit)
    return opc_fail(error, OPC_INVALID, "circuit",
                    "'circuit' is missing, required by 'spice'");
  if (p->mask) {
    state *s = &p->state[p->states++];
    s->name = p->label;
    if (from_mask(p, s, error)) return error->code;
  }
  if (p->experiment && from_experiment(p, error)) return error->code;
  for (size_t i = 0; i < p->prints.count; i++) {
    state *s = &p->state[p->states++];
    s->name = p->prints.pairs[i].key;
    if (from_table(p, s, p->prints.pairs[i].value, error)) return error->code;
  }
  return OPC_OK;
}
