/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `library.build`: corrects each cell of a sheet alone
   (thesis 4.2.1) and stores the cells in a database for later runs. */
#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <string.h>
#include <time.h>

#include <correct/cut.h>
#include <correct/entry.h>
#include <correct/library.h>
#include <correct/loop.h>
#include <correct/settings.h>
#include <correct/shelf.h>
#include <correct/start.h>
#include <correct/units.h>

/* ---- state ---- */

typedef struct build {
  const opc_host *host;
  const eda_layout *sheet;
  const eda_gates *gates;
  const char *database;
  correct_settings with;
} build;

typedef struct line {
  char *cell;
  const char *state; /* "kept", "corrected" */
  int64_t transistors, simulations;
  double ion_mean, ion_max; /* |Ion deviation|, % */
} line;

typedef struct builder {
  const build *b;
  shelf *shelf;
  library *out;
  char *process;
  GArray *lines; /* line */
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

static double cpu_seconds(void) {
  struct timespec t;
  (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Simulate the mask with the fast model without corrections by an accurate one.
   The ratios to the accurate figures allow later steps to use fast
   simulations. */
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
             "%s moves fragments of edges or adds scatter bars: a library "
             "requires a synthesizer that moves the edges of transistors",
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

/* Return mean and largest |Ion deviation| of a cell's own transistors. */
static void sum_up(GVariant *data, double *mean, double *max) {
  g_autoptr(entry) e = correct_entry_unpack(data);
  *mean = *max = 0;
  for (size_t i = 0; e && i < e->gates; i++) {
    double off = fabs(eda_deviation(e->after.ion[i], e->design[i]));
    *max = fmax(*max, off);
    *mean += off / (double)e->gates;
  }
}

static int cell_keep(builder *r, const cut_out *cell, loop *l, shelf_row *row,
                     line *result) {
  g_autoptr(GVariant) data = cell_pack(r, cell, l);
  if (!data) return r->error->code;
  sum_up(data, &row->ion_mean, &row->ion_max);
  row->simulations = l->printer.simulations + l->printer.fine_simulations;
  result->simulations = row->simulations;
  result->ion_mean = row->ion_mean;
  result->ion_max = row->ion_max;
  result->state = "corrected";
  r->corrected++;
  r->simulations += (size_t)row->simulations;
  return shelf_put(r->shelf, row, data, r->error);
}

/* Correct a cell as the step `correct` does, and store the result. */
static int correct_cell(builder *r, const cut_out *cell, shelf_row *row,
                        line *result) {
  const build *b = r->b;
  double before = cpu_seconds();
  loop l;
  correct_loop_init(&l, b->host, cell->gates, &b->with);
  l.printer.drawn = NULL; /* all cells share one resist calibration */
  int code = correct_loop_run(&l, r->error);
  row->seconds = cpu_seconds() - before;
  if (!code) code = cell_keep(r, cell, &l, row, result);
  correct_loop_clear(&l);
  return code;
}

/* Take a cell from the database, or correct it. */
static int take_cell(builder *r, const cut_out *cell, shelf_row *row,
                     line *result) {
  gboolean damaged;
  GVariant *data;
  int code =
      shelf_get(r->shelf, row->key, ENTRY_TYPE, &data, &damaged, r->error);
  if (code) return code;
  if (damaged)
    r->b->host->log(r->b->host, OPC_LOG_WARNING,
                    "cell '%s' is damaged in '%s' and is corrected again",
                    row->cell, r->out->database);
  g_autoptr(entry) e = data ? correct_entry_unpack(data) : NULL;
  if (e) sum_up(data, &result->ion_mean, &result->ion_max);
  if (data) g_variant_unref(data);
  return e ? OPC_OK : correct_cell(r, cell, row, result);
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
  c.key = c.geometry ? key_of(r, c.geometry, settings, cell.gates) : NULL;
  g_array_append_val(r->out->cells, c);
  shelf_row row = {.key = c.key,
                   .cell = c.name,
                   .geometry = c.geometry,
                   .process = r->process,
                   .settings = settings,
                   .method = b->with.synthesizer->id,
                   .made = g_get_real_time() / G_USEC_PER_SEC,
                   .transistors = result.transistors};
  code = c.key ? take_cell(r, &cell, &row, &result) : r->error->code;
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
  const char *settings =
      opc_get_results(b->host)->identity(b->host, NULL, r->error);
  int32_t top = eda_layout_top(b->sheet, r->error);
  int code = settings && top >= 0
                 ? correct_library_take_models(b->host, r->out->model, r->error)
                 : r->error->code;
  if (code) return code;
  g_autofree char *models = g_strjoin(" ", r->out->model[0], r->out->model[1],
                                      r->out->model[2], NULL);
  r->process = g_compute_checksum_for_string(G_CHECKSUM_SHA256, models, -1);
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
  g_autofree char *path = b->database ? g_strdup(b->database) : shelf_place();
  builder r = {.b = b, .error = error};
  outputs[0] = r.out = correct_library_new(path, b->gates->grid);
  r.shelf = shelf_open(path, TRUE, error);
  if (!r.shelf) return error->code;
  r.lines = g_array_new(FALSE, TRUE, sizeof(line));
  int code = build_all(&r);
  g_array_free(r.lines, TRUE);
  g_free(r.process);
  shelf_close(r.shelf);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(build, sheet, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "layout",
                  .summary = "Layout made by library.sheet"),
    OPC_PARAMETER(build, gates, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "gates", .summary = "Transistors of the sheet"),
    OPC_PARAMETER(build, database, .type = OPC_TEXT, .flags = OPC_NO_EFFECT,
                  .summary =
                      "Database of the cells, created if missing (default: "
                      "opcflow/library.sqlite in the user's data folder)"),
    CORRECT_PRINT_SLOTS(build),
    CORRECT_MOVE_SLOTS(build),
    CORRECT_MAX_ITERATIONS(build, "Largest number of iterations for a cell"),
    CORRECT_MARGIN(build),
    CORRECT_FINE(build),
    CORRECT_GUARD(build),
    CORRECT_ION_LIMIT(build,
                      "Largest allowed |Ion deviation|: the guard accepts any "
                      "transistor within the limit"),
};

static const opc_metric metrics[] = {
    {"cells", NULL, OPC_NEUTRAL, 0, "cells with transistors"},
    {"corrected", NULL, OPC_NEUTRAL, 0, "cells corrected in this run"},
    {"kept", NULL, OPC_NEUTRAL, 0, "cells taken from the database"},
    {"ion_mean", "%", OPC_LOWER, 0.01,
     "mean of |Ion deviation| of all transistors, each cell alone"},
    {"ion_max", "%", OPC_LOWER, 0.01, "largest |Ion deviation|"},
    {"simulations", NULL, OPC_LOWER, 0, "litho simulations of this run"},
};

static int build_check(void *self, opc_error *error) {
  build *b = self;
  return correct_settings_check(&b->with, b->host, error);
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {LIBRARY_PORT("library")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = build_run,
                                   .flags = OPC_STEP_OUTSIDE};

OPC_PLUGIN(build, .id = "library.build", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "correct each cell alone and store it in a database",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = build_check, OPC_FUNCTIONS(functions));
