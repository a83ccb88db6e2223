/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements timing.characterize: simulates the cells of a netlist with
   ngspice. The results are delays and slews of all arcs, and derivatives with
   respect to the printed sizes of each transistor. */
#include "characterize.h"
#include "../parameters.h"

#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

/* ---- work: selection of cells ---- */

/* Return 1 if a subcircuit consists of transistors only. A subcircuit with
   instances of other subcircuits is a circuit, not a cell. */
static int is_cell(const eda_subcircuit *c) {
  for (size_t i = 0; i < c->elements; i++)
    if (!c->element[i].is_transistor) return 0;
  return c->elements > 0;
}

static int is_wanted(const study *s, eda_netlist *n, uint32_t number,
                     int64_t top) {
  const eda_subcircuit *c = &n->subcircuit[number];
  if (!is_cell(c)) return 0;
  if (s->cells && !eda_in_list(s->cells, c->name)) return 0;
  if (top < 0) return 1;
  const eda_subcircuit *t = &n->subcircuit[top];
  for (size_t i = 0; i < t->elements; i++)
    if (!t->element[i].is_transistor && t->element[i].child == number) return 1;
  return 0;
}

static int build_cells(study *s, eda_netlist *n, opc_error *error) {
  int64_t top = -1;
  if (s->top) {
    top = eda_netlist_find(n, s->top);
    if (top < 0 || eda_netlist_prepare(n, (uint32_t)top)) return error->code;
  }
  s->timing = eda_timing_new(n->subcircuits);
  s->timing->count = 0;
  s->circuit = eda_pool_alloc(&s->pool, n->subcircuits, sizeof *s->circuit);
  s->timing->supply = s->supply;
  s->timing->temperature = s->temperature;
  s->timing->low = s->edges.values[0] / 100;
  s->timing->high = s->edges.values[1] / 100;
  for (uint32_t i = 0; i < n->subcircuits; i++) {
    if (!is_wanted(s, n, i, top)) continue;
    size_t k = s->timing->count++;
    if (cell_build(s, n, i, &s->timing->cell[k], &s->circuit[k], error))
      return error->code;
  }
  for (size_t i = 0; i < s->timing->count; i++)
    if (!s->timing->cell[i].trouble) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "file",
                  "'%.300s' has no cell that can be characterised%s", s->file,
                  s->top || s->cells ? " among those selected by 'cells'" : "");
}

static int read_cells(study *s, opc_error *error) {
  eda_netlist n = {.error = error,
                   .scale = s->scale,
                   .n_models = s->n_models,
                   .p_models = s->p_models};
  int code = eda_netlist_read(&n, s->file);
  if (!code) code = build_cells(s, &n, error);
  eda_netlist_clear(&n);
  return code;
}

/* ---- work: simulating ---- */

static int find_figures(study *s, eda_timing_cell *c, int *kept,
                        opc_error *error) {
  char *key = keep_key(s, c, error);
  if (!key) return error->code;
  *kept = keep_load(s, key, c->figure, c->figures);
  int code = *kept ? OPC_OK : cell_measure(s, c, error);
  if (!code && !*kept) keep_save(s, key, c->figure, c->figures);
  if (!code) code = pairs_find(s, c, key, error);
  /* The cell consists of circuit.times identical circuits in parallel, of which
     one was simulated. */
  const size_t pins = c->inputs * 2 * EDA_CAPS,
               all = pins * (1 + c->bundles * (size_t)EDA_SIZES),
               by_pattern = (c->inputs << c->inputs) * EDA_CAPS;
  for (size_t i = 0; i < all && !code; i++)
    c->capacitance[i] *= circuit_of(s, c)->times;
  for (size_t i = 0; i < by_pattern && !code; i++)
    c->pin_capacitance[i] *= circuit_of(s, c)->times;
  free(key);
  return code;
}

static int cells_simulate(study *s, size_t *kept, opc_error *error) {
  eda_timing *t = s->timing;
  double arcs = 0, done = 0;
  for (size_t i = 0; i < t->count; i++) arcs += (double)t->cell[i].arcs;
  for (size_t i = 0; i < t->count; i++) {
    eda_timing_cell *c = &t->cell[i];
    int was_kept = 0;
    if (c->trouble) {
      s->host->log(s->host, OPC_LOG_WARNING, "cell '%s' has no arcs: %s",
                   c->name, c->trouble);
      continue;
    }
    if (find_figures(s, c, &was_kept, error)) return error->code;
    *kept += (size_t)was_kept;
    done += (double)c->arcs;
    const opc_progress p = {done, arcs, (double)NAN, NULL};
    s->host->progress(s->host, &p);
  }
  return OPC_OK;
}

/* ---- work: reports ---- */

typedef struct row {
  const char *cell, *trouble;
  int64_t inputs, outputs, transistors, arcs;
  double capacitance, delay, slew;
} row;

/* Return the row of a cell: means over all arcs at the middle of the grid. */
static row row_of(const eda_timing_cell *c) {
  row r = {.cell = c->name,
           .trouble = c->trouble ? c->trouble : "",
           .inputs = (int64_t)c->inputs,
           .outputs = (int64_t)c->outputs,
           .transistors = (int64_t)c->devices,
           .arcs = (int64_t)c->arcs};
  size_t at = c->slews / 2 * c->loads + c->loads / 2;
  for (size_t i = 0; i < c->arcs; i++) {
    r.delay += c->arc[i].delay[at] * 1e12 / (double)c->arcs;
    r.slew += c->arc[i].slew[at] * 1e12 / (double)c->arcs;
  }
  for (size_t i = 0; i < 2 * c->inputs && !c->trouble; i++)
    r.capacitance += c->capacitance[i * EDA_CAPS + EDA_CAP_DELAY] * 1e15 / 2 /
                     (double)c->inputs;
  return r;
}

static int cells_report(const study *s, opc_error *error) {
  const eda_timing *t = s->timing;
  row *r = eda_alloc(t->count, sizeof *r);
  for (size_t i = 0; i < t->count; i++) r[i] = row_of(&t->cell[i]);
  const opc_column columns[] = {
      {"cell", NULL, OPC_TEXT, 0, &r->cell},
      {"inputs", NULL, OPC_INT, 0, &r->inputs},
      {"outputs", NULL, OPC_INT, 0, &r->outputs},
      {"transistors", NULL, OPC_INT, 0, &r->transistors},
      {"arcs", NULL, OPC_INT, 0, &r->arcs},
      {"capacitance", "fF", OPC_REAL, 3, &r->capacitance},
      {"delay", "ps", OPC_REAL, 3, &r->delay},
      {"slew", "ps", OPC_REAL, 3, &r->slew},
      {"trouble", NULL, OPC_TEXT, 0, &r->trouble},
  };
  int code = opc_put_rows(s->host, "cells", 0, t->count, sizeof *r,
                          OPC_ARRAY(columns), error);
  free(r);
  return code;
}

static int study_report(study *s, size_t kept, opc_error *error) {
  verdict v = {0};
  size_t arcs = 0, good = 0;
  for (size_t i = 0; i < s->timing->count; i++) {
    arcs += s->timing->cell[i].arcs;
    good += !s->timing->cell[i].trouble;
  }
  if (s->checks && cells_check(s, &v, error)) return error->code;
#define WHERE(is, name) ((is) ? (name) : NULL)
  const opc_metric_value values[] = {
      {"cells", (double)good},
      {"arcs", (double)arcs},
      {"kept", (double)kept},
      {"simulated", (double)s->simulated},
      {WHERE(v.points, "delay_error"), v.delay_rms},
      {WHERE(v.points, "delay_error_max"), v.delay_max},
      {WHERE(v.points, "slew_error"), v.slew_rms},
      {WHERE(v.points, "slew_error_max"), v.slew_max},
      {WHERE(v.points, "change_error"), v.change_rms}};
#undef WHERE
  int code = opc_put_metrics(s->host, OPC_ARRAY(values), error);
  if (!code) code = cells_report(s, error);
  const char *path =
      code ? NULL : s->host->output_path(s->host, s->liberty, error);
  if (!path) return error->code;
  return liberty_write(s, path, error);
}

static int characterize_run(void *self, void **outputs, opc_error *error) {
  study *s = self;
  size_t kept = 0;
  s->simulated = 0;
  int code = eda_cards_read(&s->pool, s->models, s->model, s->dlc, s->cards,
                            s->card, error);
  if (!code) code = read_cells(s, error);
  if (!code) code = cells_simulate(s, &kept, error);
  if (!code) code = study_report(s, kept, error);
  if (code)
    eda_timing_free(s->timing);
  else
    outputs[0] = s->timing;
  s->timing = NULL;
  eda_pool_clear(&s->pool);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(study, file, .type = OPC_FILE, .flags = OPC_REQUIRED,
                  .summary = "SPICE or CDL netlist with the cells"),
    OPC_PARAMETER(study, top, .type = OPC_TEXT,
                  .summary = "circuit whose cells are simulated (default: all "
                             "cells of the file)"),
    OPC_PARAMETER(
        study, cells, .type = OPC_TEXT,
        .summary = "names of cells, separated by blanks (default: all)"),
    OPC_PARAMETER(
        study, scale, .type = OPC_REAL, .preset = "1",
        .flags = OPC_ABOVE | OPC_AT_MOST, .min = 0, .max = 1e6,
        .summary = "factor by which the sizes in the netlist are multiplied"),
    TIMING_MODELS(study, OPC_REQUIRED, "file with the model cards"),
    OPC_PARAMETER(study, n_models, .type = OPC_TEXT,
                  .summary = "model names of n-transistors in the netlist that "
                             "do not indicate the type"),
    OPC_PARAMETER(study, p_models, .type = OPC_TEXT,
                  .summary = "model names of p-transistors in the netlist that "
                             "do not indicate the type"),
    OPC_PARAMETER_NAMED("supplies", study, supplies, .type = OPC_TEXT,
                        .preset = "VDD VDD! VCC VPWR VPB",
                        .summary = "names of supplies"),
    OPC_PARAMETER_NAMED("grounds", study, grounds, .type = OPC_TEXT,
                        .preset = "VSS VSS! GND GND! 0 VGND VNB",
                        .summary = "names of grounds"),
    OPC_PARAMETER(
        study, dlc, .type = OPC_BOOL, .preset = "true",
        .summary =
            "use a separate length for the gate capacitance (thesis eq. 3.11)"),
    EDA_CONDITIONS(study),
    OPC_PARAMETER(
        study, slews, .type = OPC_REALS, .unit = "s",
        .preset = "[2 ps, 5 ps, 10 ps, 22 ps, 70 ps]",
        .summary = "input slews, measured between the levels `edges`"),
    OPC_PARAMETER(
        study, loads, .type = OPC_REALS, .unit = "F",
        .preset = "[0.3 fF, 1.2 fF, 3 fF, 7 fF, 16 fF]",
        .summary = "output loads for each um of channel width at the output"),
    OPC_PARAMETER(study, edges, .type = OPC_REALS, .unit = "%",
                  .preset = "[30 %, 70 %]",
                  .summary = "voltage levels between which slews are measured"),
    OPC_PARAMETER(
        study, checks, .type = OPC_INT, .flags = OPC_AT_LEAST | OPC_AT_MOST,
        .preset = "0", .min = 0, .max = 10000,
        .summary = "number of random points at which the tables are compared "
                   "with simulations, with all sizes varied"),
    OPC_PARAMETER(study, seed, .type = OPC_INT, .flags = OPC_AT_LEAST,
                  .preset = "1", .min = 0, .summary = "seed of random samples"),
    OPC_PARAMETER(study, liberty, .type = OPC_OUTPUT, .preset = "cells.lib",
                  .summary = "Liberty file of the drawn cells"),
    OPC_PARAMETER_NAMED("line_edges.sigma", study, rough.sigma,
                        .type = OPC_REAL, .flags = OPC_AT_LEAST | OPC_AT_MOST,
                        .unit = "nm", .preset = "0 nm", .min = 0, .max = 100,
                        .summary = "standard deviation of a line edge of poly; "
                                   "above 0, the Liberty file has standard "
                                   "deviations (LVF)"),
    OPC_PARAMETER_NAMED("line_edges.length", study, rough.length,
                        .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "nm",
                        .preset = "25 nm", .min = 0,
                        .summary = "correlation length of a line edge"),
    OPC_PARAMETER_NAMED("line_edges.hurst", study, rough.hurst,
                        .type = OPC_REAL, .flags = OPC_ABOVE | OPC_AT_MOST,
                        .preset = "0.5", .min = 0, .max = 1,
                        .summary = "Hurst exponent of a line edge"),
    TIMING_TIME_LIMIT(study),
};

static const opc_metric metrics[] = {
    FIGURE("cells", NULL, "cells with arcs"),
    FIGURE("arcs", NULL, "input transitions that change an output"),
    FIGURE("kept", NULL, "cells reused from earlier simulations"),
    FIGURE("simulated", NULL, "number of simulated transitions"),
    COST("delay_error", "%",
         "root mean square error of delays from the tables at random points"),
    COST("delay_error_max", "%", "largest |error| of delays at random points"),
    COST("slew_error", "%",
         "root mean square error of slews from the tables at random points"),
    COST("slew_error_max", "%", "largest |error| of slews at random points"),
    COST("change_error", "%",
         "root mean square error of the changes of delays by printed sizes, in "
         "points"),
};

static int check_grid(const opc_reals *r, const char *name, double least,
                      opc_error *error) {
  int good = r->count >= 3 && r->count <= EDA_TIMING_GRID;
  for (size_t i = 0; good && i < r->count; i++)
    good = r->values[i] > (i ? r->values[i - 1] : least) && r->values[i] < 1e-3;
  if (good) return OPC_OK;
  return opc_fail(error, OPC_INVALID, name,
                  "'%s' must be 3 to %d increasing values above %g", name,
                  EDA_TIMING_GRID, least);
}

static int characterize_check(void *self, opc_error *error) {
  static const char *const names[] = {[EDA_NMOS] = "nmos", [EDA_PMOS] = "pmos"};
  const study *s = self;
  const double *edge = s->edges.values;
  for (int type = 0; type < 2; type++)
    if (!eda_spice_is_name(s->model[type]))
      return opc_fail(error, OPC_INVALID, names[type],
                      "'%s' is not the name of a model", s->model[type]);
  if (s->edges.count != 2 || !(edge[0] > 0) || !(edge[0] < 50) ||
      !(edge[1] > 50) || !(edge[1] < 95))
    return opc_fail(error, OPC_INVALID, "edges",
                    "'edges' must be two thresholds between 0 and 95 %%, one "
                    "below and one above 50 %%");
  if (check_grid(&s->slews, "slews", 1e-14, error)) return error->code;
  return check_grid(&s->loads, "loads", 0, error);
}

/* ---- entry ---- */

static const opc_port ports[] = {EDA_PORT_TIMING("timing")};
/* Results of the step are not stored, because netlists may include other files
   and ngspice is another program. */
static const opc_step functions = {OPC_OUTPUTS(ports), .run = characterize_run,
                                   .flags = OPC_STEP_OUTSIDE};
OPC_PLUGIN(study, .id = "timing.characterize", .kind = "step",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "delays and slews of cells by ngspice",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = characterize_check, OPC_FUNCTIONS(functions));
