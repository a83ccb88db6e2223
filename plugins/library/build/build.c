/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `library.build`: corrects each cell of a sheet alone
   (thesis 4.2.1) and stores the results for later runs. */
#include <math.h>
#include <opcflow/table.h>
#include <string.h>

#include <correct/cut.h>
#include <correct/entry.h>
#include <correct/library.h>
#include <correct/loop.h>
#include <correct/settings.h>
#include <correct/start.h>
#include <correct/units.h>

/* ---- state ---- */

typedef struct build {
  const opc_host *host;
  const eda_layout *sheet;
  const eda_gates *gates;
  correct_settings with;
} build;

/* Row of the table of cells. */
typedef struct line {
  char *cell;
  const char *state; /* "kept", "corrected" */
  int64_t transistors, simulations;
  double ion_mean, ion_max; /* |Ion deviation|, % */
} line;

typedef struct builder {
  const build *b;
  library *out;
  const opc_results *results;
  GArray *lines; /* array of `line` */
  size_t corrected, simulations;
  opc_error *error;
} builder;

/* ---- one cell ---- */

static char *key_of(const builder *r, const char *geometry,
                    const char *settings, const eda_gates *cell) {
  g_autofree char *cut = correct_cut_sum(cell);
  g_autofree char *all = g_strdup_printf("%s %s %s %a", geometry, settings, cut,
                                         r->b->gates->grid);
  return g_compute_checksum_for_string(G_CHECKSUM_SHA256, all, -1);
}

/* Simulate the mask with the fast model, without the difference of the models.
   Set seen[i] to ln(Ion of this simulation / ion[i]); `ion`: Ion of the
   accurate model. Later steps use seen[i] to replace accurate simulations by
   fast simulations. */
static int look_cheaply(loop *l, const double *ion, double *seen,
                        opc_error *error) {
  for (size_t k = 0; k < l->gates->layers; k++)
    eda_field_clear(&l->printer.difference[k]);
  correct_trial_copy(&l->next, &l->now);
  int code = correct_loop_print(l, 1, error);
  for (size_t i = 0; i < l->gates->count && !code; i++) {
    int prints = !eda_print_failed(l->measured.flags[i]);
    double ratio = l->measured.performance.ion[i] / ion[i];
    seen[i] = prints && ratio > 0 && isfinite(ratio) ? log(ratio) : 0;
  }
  return code;
}

static GVariant *cell_pack(const builder *r, const cut_out *cell, loop *l) {
  GVariant *data = NULL;
  eda_measurement end;
  eda_moved *moved = correct_moved_of(l);
  if (!moved) {
    opc_fail(r->error, OPC_INVALID, "synthesizer",
             "'%s' displaces fragments of edges or adds scatter bars, expected "
             "a synthesizer that only changes lengths and widths of "
             "transistors",
             r->b->with.synthesizer->id);
    return NULL;
  }
  size_t n = l->gates->count;
  eda_measurement_init(&end, n);
  eda_performance_copy(&end.performance, &l->measured.performance);
  memcpy(end.flags, l->measured.flags, n * sizeof *end.flags);
  if (!look_cheaply(l, end.performance.ion, moved->seen, r->error))
    data = g_variant_ref_sink(correct_entry_pack(
        cell, &l->design, &end.performance, end.flags, moved));
  eda_measurement_clear(&end);
  eda_moved_free(moved);
  return data;
}

/* Set mean and largest |Ion deviation| of the cell's own transistors. */
static void sum_up(const entry *e, line *result) {
  for (size_t i = 0; i < e->gates; i++) {
    double off = fabs(eda_deviation(e->after.ion[i], e->design[i]));
    result->ion_max = fmax(result->ion_max, off);
    result->ion_mean += off / (double)e->gates;
  }
}

/* Correct a cell as the step `correct` does, and store the result. Returns NULL
   and *r->error on failure. */
static entry *correct_cell(builder *r, const cut_out *cell, const char *key,
                           line *result) {
  const build *b = r->b;
  g_autoptr(GVariant) data = NULL;
  loop l;
  correct_loop_init(&l, b->host, cell->gates, &b->with);
  l.printer.drawn = NULL; /* all cells share one resist calibration */
  if (!correct_loop_run(&l, r->error)) data = cell_pack(r, cell, &l);
  result->simulations = (int64_t)l.printer.simulations;
  result->simulations += (int64_t)l.printer.fine_simulations;
  result->state = "corrected";
  r->corrected++;
  r->simulations += (size_t)result->simulations;
  correct_loop_clear(&l);
  if (!data) return NULL;
  r->results->keep(b->host, key, g_variant_get_data(data),
                   g_variant_get_size(data));
  return correct_entry_unpack(data);
}

/* Return the stored cell of a key; NULL: none. */
static entry *find_kept(const builder *r, const char *key) {
  size_t size = 0;
  void *bytes = r->results->find(r->b->host, key, &size);
  if (!bytes) return NULL;
  g_autoptr(GVariant) data = g_variant_ref_sink(
      g_variant_new_from_data(ENTRY_TYPE, bytes, size, FALSE, free, bytes));
  return g_variant_is_normal_form(data) ? correct_entry_unpack(data) : NULL;
}

static int add_cell(builder *r, int32_t top, size_t i, const char *settings) {
  const build *b = r->b;
  cut_out cell;
  int code = correct_cut_cell(b->gates, b->sheet, top, i, &cell, r->error);
  if (code || !cell.gates) return code;
  library_cell c = {
      .name = g_strdup(cell.gates->name),
      .geometry = correct_units_sum(b->sheet, cell.cell, r->error)};
  line result = {.cell = c.name, .state = "kept"};
  for (size_t k = 0; k < cell.gates->count; k++)
    result.transistors += cell.own[k];
  g_autofree char *key =
      c.geometry ? key_of(r, c.geometry, settings, cell.gates) : NULL;
  if (key) c.entry = find_kept(r, key);
  if (key && !c.entry) c.entry = correct_cell(r, &cell, key, &result);
  if (c.entry) sum_up(c.entry, &result);
  code = c.entry ? OPC_OK : r->error->code;
  g_array_append_val(r->out->cells, c);
  g_array_append_val(r->lines, result);
  correct_cut_clear(&cell);
  return code;
}

/* ---- run ---- */

static int build_report(const builder *r) {
  const opc_host *host = r->b->host;
  const line *first = (const line *)(const void *)r->lines->data;
  size_t n = r->lines->len;
  const line none = {0};
  if (!n) first = &none;
  double mean = 0, max = 0, transistors = 0;
  for (size_t i = 0; i < n; i++) {
    mean += first[i].ion_mean * (double)first[i].transistors;
    transistors += (double)first[i].transistors;
    max = fmax(max, first[i].ion_max);
  }
  const opc_column columns[] = {
      {"cell", NULL, OPC_TEXT, 0, &first->cell},
      {"state", NULL, OPC_TEXT, 0, &first->state},
      {"transistors", NULL, OPC_INT, 0, &first->transistors},
      {"ion_mean", "%", OPC_REAL, 3, &first->ion_mean},
      {"ion_max", "%", OPC_REAL, 3, &first->ion_max},
      {"simulations", NULL, OPC_INT, 0, &first->simulations}};
  const opc_metric_value values[] = {
      {"cells", (double)n},
      {"corrected", (double)r->corrected},
      {"kept", (double)(n - r->corrected)},
      {"ion_mean", transistors > 0 ? mean / transistors : 0},
      {"ion_max", max},
      {"simulations", (double)r->simulations}};
  int code = opc_put_rows(host, "cells", 0, n, sizeof *first, columns,
                          G_N_ELEMENTS(columns), r->error);
  return code ? code : opc_put_metrics(host, OPC_ARRAY(values), r->error);
}

static int build_all(builder *r) {
  const build *b = r->b;
  const char *settings = r->results->identity(b->host, NULL, r->error);
  int32_t top = eda_layout_top(b->sheet, r->error);
  int code = settings && top >= 0
                 ? correct_library_take_models(b->host, r->out->model, r->error)
                 : r->error->code;
  if (code) return code;
  size_t n = eda_layout_instances(b->sheet, top);
  for (size_t i = 0; i < n && !code; i++) {
    const opc_progress at = {
        .done = (double)i, .total = (double)n, .worst = NAN};
    b->host->progress(b->host, &at);
    if (opc_cancelled(b->host->context))
      return opc_fail(r->error, OPC_CANCELLED, NULL, "stopped");
    code = add_cell(r, top, i, settings);
  }
  if (!code && !r->lines->len)
    code = opc_fail(r->error, OPC_INVALID, "gates",
                    "no cell of the sheet has a transistor");
  return code ? code : build_report(r);
}

static int build_run(void *self, void **outputs, opc_error *error) {
  const build *b = self;
  builder r = {.b = b, .results = opc_get_results(b->host), .error = error};
  outputs[0] = r.out = correct_library_new(b->gates->grid);
  r.lines = g_array_new(FALSE, TRUE, sizeof(line));
  int code = build_all(&r);
  g_array_free(r.lines, TRUE);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(build, sheet, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "layout",
                  .summary = "Layout made by library.sheet"),
    OPC_PARAMETER(build, gates, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "gates", .summary = "Transistors of the sheet"),
    CORRECT_PRINT_SLOTS(build),
    CORRECT_MOVE_SLOTS(build),
    CORRECT_MAX_ITERATIONS(build, "Largest number of iterations for a cell"),
    CORRECT_MARGIN(build),
    CORRECT_FINE(build),
    CORRECT_GUARD(build),
    CORRECT_ION_LIMIT(
        build,
        "Largest allowed |Ion deviation|; the guard reverts a transistor above "
        "the limit if its deviation is smaller with the drawn mask"),
};

static const opc_metric metrics[] = {
    {"cells", NULL, OPC_NEUTRAL, 0, "cells with transistors"},
    {"corrected", NULL, OPC_NEUTRAL, 0, "cells corrected in this run"},
    {"kept", NULL, OPC_NEUTRAL, 0, "cells stored by earlier runs"},
    {"ion_mean", "%", OPC_LOWER, 0.01,
     "mean |Ion deviation| of all transistors, in simulations of single cells"},
    {"ion_max", "%", OPC_LOWER, 0.01, "largest |Ion deviation|"},
    {"simulations", NULL, OPC_LOWER, 0, "litho simulations of this run"},
};

static int build_check(void *self, opc_error *error) {
  build *b = self;
  return correct_settings_check(&b->with, b->host, error);
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {LIBRARY_PORT("library")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = build_run};

OPC_PLUGIN(build, .id = "library.build", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "correct each cell alone and store the results",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = build_check, OPC_FUNCTIONS(functions));
