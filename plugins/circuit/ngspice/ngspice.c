/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements circuit.ngspice: simulates a circuit with drawn and printed
   transistors for delays and slopes (thesis 2.3.2, 3.3.2), leakage, and static
   noise margins of memory cells (thesis 2.3.4). */
#include <eda/drawing.h>
#include <eda/models.h>
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"

/* Values of the parameter 'measure'. */
enum { AUTO, DELAYS, LEAKAGE, SNM, CELL };

/* ---- work: sets of sizes ---- */

/* Return the distinct model names of all devices, separated by blanks. */
static char *names_of_models(const bench *b) {
  GString *all = g_string_new(NULL);
  for (size_t i = 0; i < b->circuit->count; i++) {
    const eda_device *d = &b->circuit->device[i];
    const char *name = b->model[d->type] ? b->model[d->type] : d->model;
    if (eda_in_list(all->str, name)) continue;
    g_string_append_printf(all, "%s%s", all->len ? " " : "", name);
  }
  return g_string_free(all, FALSE);
}

/* Check that the library has all models, either all as subcircuits or all as
   cards. */
static int check_names(bench *b, const eda_models *l, const char *names,
                       opc_error *error) {
  g_auto(GStrv) name = g_strsplit(names, " ", -1);
  for (size_t i = 0; name[i]; i++) {
    int kind = eda_models_kind(l, name[i]);
    if (i && (kind == EDA_MODEL_SUBCIRCUIT) != b->subcircuits) kind = 0;
    b->subcircuits = kind == EDA_MODEL_SUBCIRCUIT;
    if (!kind)
      return opc_fail(
          error, OPC_INVALID, "library",
          "'%s' has no model '%s', or the model is of another kind than the "
          "others; set 'nmos' and 'pmos' to the names of the models",
          b->library, name[i]);
  }
  return OPC_OK;
}

/* Replace models missing in the library by those given in 'stand_ins'. */
static int put_stand_ins(bench *b, const eda_models *l, opc_error *error) {
  g_auto(GStrv) pair = g_strsplit(b->stand_ins, " ", -1);
  const size_t count = b->circuit->count;
  eda_device *device = eda_pool_alloc(&b->pool, count, sizeof *device);
  for (size_t i = 0; i < count; i++) device[i] = b->circuit->device[i];
  for (char **p = pair; *p; p += 2) {
    size_t n = 0;
    if (!p[1])
      return opc_fail(error, OPC_INVALID, "stand_ins",
                      "'%s' has no substitute model", *p);
    const char *name = eda_pool_text(&b->pool, p[1], strlen(p[1]));
    for (size_t i = 0; i < count && !eda_models_kind(l, *p); i++) {
      if (!device[i].model || !eda_same_name(device[i].model, *p)) continue;
      device[i].model = name;
      n++;
    }
    if (n)
      b->host->log(b->host, OPC_LOG_INFO,
                   "model '%s' replaces '%s' in %zu transistors", p[1], *p, n);
  }
  b->own = *b->circuit;
  b->own.device = device;
  b->circuit = &b->own;
  return OPC_OK;
}

/* Read the models that the sizes of the circuit need from a foundry's library.
   Printed sizes differ from drawn sizes by less than `around` and may be
   shorter than the shortest bin. */
static int read_library(bench *b, opc_error *error) {
  const double around = 0.3;
  const eda_gates *g = b->circuit->gates;
  eda_sizes sizes = {{INFINITY, 0}, {INFINITY, 0}};
  for (size_t i = 0; i < g->count; i++) {
    sizes.length[0] = fmin(sizes.length[0], (1 - around) * g->length[i]);
    sizes.length[1] = fmax(sizes.length[1], (1 + around) * g->length[i]);
    sizes.width[0] = fmin(sizes.width[0], (1 - around) * g->width[i]);
    sizes.width[1] = fmax(sizes.width[1], (1 + around) * g->width[i]);
  }
  eda_models *l = eda_models_read(b->library, b->corner, b->osdi, error);
  if (!l) return error->code;
  int code = b->stand_ins ? put_stand_ins(b, l, error) : OPC_OK;
  g_autofree char *all = names_of_models(b);
  if (!code) code = check_names(b, l, all, error);
  b->unit = eda_models_unit(l);
  if (!code) b->statements = eda_models_cut(l, all, &sizes, 1);
  eda_models_free(l);
  return code;
}

/* Replace the names of the netlist by names that the simulator accepts. */
static void make_plain(bench *b) {
  const eda_circuit *c = b->circuit;
  b->plain = *c;
  b->plain.net = eda_pool_alloc(&b->pool, c->nets, sizeof *b->plain.net);
  for (size_t i = 0; i < c->nets; i++) {
    char name[24];
    int n = snprintf(name, sizeof name, "n%zu", i);
    b->plain.net[i] = eda_pool_text(&b->pool, name, (size_t)n);
  }
}

/* Refuse chips that cannot be simulated. Inputs are not known to .check. */
static int check_chips(const bench *b, opc_error *error) {
  const char *why = NULL;
  if (!b->chips) return OPC_OK;
  if (b->measure != CELL)
    why = "'chips' requires 'measure: cell'";
  else if (b->sizes == SIZES_LENGTH)
    why = "'chips' requires 'sizes: both', because chips have printed L and W";
  else if (!b->mask)
    why = "'mask' is missing, required by 'chips'";
  else if (b->chips->gates != b->mask->gates)
    why = "the chips and the mask belong to different gates";
  else if (!b->chips->count)
    why = "there are no chips: set 'tables' of the step that samples them";
  return why ? opc_fail(error, OPC_INVALID, "chips", "%s", why) : OPC_OK;
}

/* Find the sets of sizes present. Transistors that do not print are an error
   for the corrected mask, but not for the mask before correction. */
static int find_states(bench *b, opc_error *error) {
  static const int kinds[] = {SIZE_TIMED, SIZE_OFF};
  if (b->mask && eda_mask_flat(b->mask, &b->mask, error)) return error->code;
  if (b->mask && b->mask->gates != b->circuit->gates)
    return opc_fail(error, OPC_INVALID, "mask",
                    "the mask and the circuit belong to different gates");
  if (check_chips(b, error)) return error->code;
  b->printed = b->mask;
  if (b->sizes == SIZES_LENGTH && sizes_by_length(b, error)) return error->code;
  for (int state = 0; state < EDA_STATES; state++) {
    b->has[state] = state == EDA_DRAWN || b->mask;
    for (int k = 0; k < 2 && b->has[state]; k++) {
      char *text = bench_netlist(b, &b->plain, state, kinds[k], error);
      int code = text ? OPC_OK : error->code;
      free(text);
      if (bench_forgive(b, state, code, error)) return code;
    }
  }
  return OPC_OK;
}

static int circuit_prepare(bench *b, opc_error *error) {
  b->low = b->edges.values[0] / 100;
  b->high = b->edges.values[1] / 100;
  /* DLC of library models cannot be changed. */
  if (b->library) b->dlc = 0;
  if (b->library ? read_library(b, error)
                 : eda_cards_read(&b->pool, b->models, b->model, b->dlc,
                                  b->cards, b->card, error))
    return error->code;
  make_plain(b);
  int code = bench_ports(b, error);
  return code ? code : find_states(b, error);
}

static const char *picture_path(const bench *b, opc_error *error) {
  return b->host->output_path(b->host, b->picture, error);
}

/* ---- work: logic ---- */

static int finish_delays(bench *b, const machine *m, const patterns *p,
                         const logic *l, opc_error *error) {
  delays d;
  if (delays_find(b, m, p, l, &d, error) || delays_report(b, p, &d, error))
    return error->code;
  const char *path = picture_path(b, error);
  return path ? draw_delays(b, p, &d, path, error) : error->code;
}

static int run_logic(bench *b, opc_error *error) {
  patterns p;
  logic l;
  if (patterns_make(b, &p, error)) return error->code;
  if (p.sampled)
    b->host->log(b->host, OPC_LOG_INFO,
                 "%zu random transitions of the inputs are simulated, not all",
                 p.transitions);
  if (logic_find(b, &p, &l, error)) return error->code;
  if (b->measure != DELAYS && leakage_report(b, &p, &l, error))
    return error->code;
  return b->measure == LEAKAGE ? OPC_OK : finish_delays(b, NULL, &p, &l, error);
}

/* Simulate a circuit that keeps a state on net `net`. */
static int run_states(bench *b, const char *net, opc_error *error) {
  machine m;
  patterns p;
  logic l;
  if (b->measure == LEAKAGE || b->several)
    return opc_fail(error, OPC_INVALID, "circuit",
                    "'%s' is sequential: net '%s' is on a loop; %s",
                    b->circuit->name, net,
                    b->several ? "set one changing input at a time"
                               : "leakage requires a combinational circuit");
  if (bench_drives(b, error) || states_find(b, &m, &p, &l, error))
    return error->code;
  return finish_delays(b, &m, &p, &l, error);
}

/* ---- work: memory ---- */

/* Discard all cells except the cell with the requested storage node. */
static int pick_cell(const bench *b, cell *cells, size_t *count,
                     opc_error *error) {
  if (!b->cell) return OPC_OK;
  for (size_t i = 0; i < *count; i++)
    if (eda_same_name(b->circuit->net[cells[i].q], b->cell) ||
        eda_same_name(b->circuit->net[cells[i].qb], b->cell)) {
      cells[0] = cells[i];
      *count = 1;
      return OPC_OK;
    }
  return opc_fail(error, OPC_INVALID, "cell",
                  "'%s' is not a storage node of '%s'", b->cell,
                  b->circuit->name);
}

/* Simulate cells that hold, are read and are written. The picture has the
   margins of cells that are read. */
static int run_cells(bench *b, const cell *cells, size_t count,
                     opc_error *error) {
  margins m[2] = {{{NULL}}};
  accesses a = {{NULL}};
  if (cells_measure(b, cells, count, m, &a, error) ||
      accesses_report(b, cells, count, m, &a, error))
    return error->code;
  const char *path = picture_path(b, error);
  if (!path || draw_margins(b, cells, count, &m[1], path, error))
    return error->code;
  return b->chips ? chips_find(b, cells, count, m, &a, error) : OPC_OK;
}

static int run_margins(bench *b, cell *cells, size_t count, opc_error *error) {
  margins m = {{NULL}};
  if (!count)
    return opc_fail(error, OPC_INVALID, "circuit",
                    "'%s' has no cross-coupled inverters", b->circuit->name);
  if (pick_cell(b, cells, &count, error)) return error->code;
  if (b->measure == CELL) return run_cells(b, cells, count, error);
  if (margins_find(b, cells, count, &m, error) ||
      margins_report(b, cells, count, &m, error))
    return error->code;
  const char *path = picture_path(b, error);
  return path ? draw_margins(b, cells, count, &m, path, error) : error->code;
}

/* ---- work ---- */

/* Return 1 for a memory: a circuit of cells whose bit lines are ports. */
static int is_memory(const cell *cells, size_t count) {
  size_t n = 0;
  for (size_t i = 0; i < count; i++)
    n += cells[i].accesses > 0 && cells[i].on_ports;
  return count && n == count;
}

static int circuit_run(void *self, void **outputs, opc_error *error) {
  bench *b = self;
  cell *cells;
  size_t count;
  (void)outputs;
  if (circuit_prepare(b, error) || cells_find(b, &cells, &count, error))
    return error->code;
  if (b->measure >= SNM || (b->measure == AUTO && is_memory(cells, count)))
    return run_margins(b, cells, count, error);
  int64_t loop = feedback_find(b);
  return loop < 0 ? run_logic(b, error)
                  : run_states(b, b->circuit->net[loop], error);
}

static void circuit_clear(void *self) {
  bench *b = self;
  free(b->statements);
  eda_pool_clear(&b->pool);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(bench, circuit, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "circuit",
                  .summary = "netlist matched with gates"),
    OPC_PARAMETER(bench, mask, .type = OPC_INPUT, .choices = "mask",
                  .summary = "corrected mask with printed image"),
    OPC_PARAMETER(bench, chips, .type = OPC_INPUT, .choices = "samples",
                  .summary = "sampled chips of the mask, for distributions of "
                             "the figures of `measure: cell`"),
    OPC_PARAMETER_NAMED(
        "models", bench, models[0], .type = OPC_FILE,
        .summary = "file with the model cards; required without `library`"),
    OPC_PARAMETER_NAMED(
        "pmos_models", bench, models[1], .type = OPC_FILE,
        .summary =
            "file with the model card of the p-transistor, if different"),
    OPC_PARAMETER(
        bench, library, .type = OPC_FILE,
        .summary =
            "model library of a foundry: subcircuits or cards, in sections and "
            "bins; the outermost bins are extended to the printed sizes"),
    OPC_PARAMETER(
        bench, corner, .type = OPC_TEXT,
        .summary =
            "section of the library (default: the models outside of sections)"),
    OPC_PARAMETER(bench, osdi, .type = OPC_FILE,
                  .summary = "shared object of the compiled models that the "
                             "library uses (OSDI)"),
    OPC_PARAMETER_NAMED("nmos", bench, model[EDA_NMOS], .type = OPC_TEXT,
                        .summary =
                            "model name of n-transistors (default: nmos; with "
                            "`library`: the name in the netlist)"),
    OPC_PARAMETER_NAMED("pmos", bench, model[EDA_PMOS], .type = OPC_TEXT,
                        .summary =
                            "model name of p-transistors (default: pmos; with "
                            "`library`: the name in the netlist)"),
    OPC_PARAMETER(
        bench, stand_ins, .type = OPC_TEXT,
        .summary =
            "pairs of model names, separated by blanks: a name in the netlist "
            "that `library` may lack, and the name of the replacement"),
    OPC_PARAMETER(bench, dlc, .type = OPC_BOOL, .preset = "true",
                  .summary = "use the gate capacitance of the printed area, by "
                             "DLC (thesis eq. 3.11)"),
    OPC_PARAMETER(bench, sizes, .type = OPC_CHOICE, .choices = "both|length",
                  .preset = "both",
                  .summary = "printed L and W; or drawn W, and the L at which "
                             "this W has the printed Ion (thesis 2.3.3)"),
    OPC_PARAMETER(bench, devices, .type = OPC_FILE,
                  .summary = "device table used by the correction; required "
                             "for 'sizes: length'"),
    EDA_CONDITIONS(bench),
    OPC_PARAMETER(bench, load, .type = OPC_REAL, .unit = "F",
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "4 fF",
                  .min = 0, .max = 1e-6,
                  .summary = "capacitance at each output"),
    OPC_PARAMETER(bench, slew, .type = OPC_REAL, .unit = "s",
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "20 ps",
                  .min = 1e-14, .max = 1e-3,
                  .summary = "duration of an input ramp from 0 to 100 %"),
    OPC_PARAMETER(
        bench, edges, .type = OPC_REALS, .unit = "%", .preset = "[10 %, 90 %]",
        .summary =
            "voltage levels between which rise and fall times are measured"),
    OPC_PARAMETER(bench, measure, .type = OPC_CHOICE,
                  .choices = "auto|delays|leakage|snm|cell", .preset = "auto",
                  .summary = "quantities to measure; auto: noise margins of "
                             "memories, delays and leakage of other circuits; "
                             "cell: noise margins of cells that hold and that "
                             "are read, write margin, read current and leakage "
                             "of memories"),
    OPC_PARAMETER_NAMED(
        "inputs", bench, inputs_list, .type = OPC_TEXT,
        .summary = "names of the input ports, separated by blanks (default: "
                   "ports connected only to gates)"),
    OPC_PARAMETER_NAMED("transitions", bench, several, .type = OPC_CHOICE,
                        .choices = "single|several", .preset = "single",
                        .summary = "single: one input changes at a time; "
                                   "several: also several inputs at once"),
    OPC_PARAMETER(bench, most, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "1024",
                  .min = 1, .max = 100000,
                  .summary = "largest number of transitions; if there are "
                             "more, a random sample"),
    OPC_PARAMETER(bench, seed, .type = OPC_INT, .flags = OPC_AT_LEAST,
                  .preset = "1", .min = 0, .summary = "seed of random samples"),
    OPC_PARAMETER(
        bench, cell, .type = OPC_TEXT,
        .summary =
            "storage node of the memory cell to simulate (default: all cells)"),
    OPC_PARAMETER_NAMED(
        "access", bench, reads, .type = OPC_CHOICE, .choices = "hold|read",
        .preset = "hold",
        .summary = "state of the access transistors of memory cells for the "
                   "noise margins: off (hold) or conducting (read); bit lines "
                   "are at the supply"),
    OPC_PARAMETER(
        bench, picture, .type = OPC_OUTPUT, .preset = "circuit.png",
        .summary =
            "picture of the waveforms or butterfly curves, .png, .svg or .pdf"),
    OPC_PARAMETER_NAMED(
        "time_limit", bench, limit, .type = OPC_REAL, .unit = "s",
        .former = "limit", .flags = OPC_ABOVE | OPC_AT_MOST | OPC_NO_EFFECT,
        .preset = "300 s", .min = 0, .max = 86400,
        .summary = "Longest time of one process of the simulator"),
};

#define FIGURE(id, of, text) \
  { .name = (id), .unit = (of), .better = OPC_NEUTRAL, .summary = (text) }
#define CHANGE(id, text)                                              \
  {.name = (id "_worst"),                                             \
   .unit = "%",                                                       \
   .better = OPC_LOWER,                                               \
   .summary = ("largest deviation of " text)},                        \
  {                                                                   \
    .name = (id "_worst_before"), .unit = "%", .better = OPC_NEUTRAL, \
    .summary = ("before correction, largest deviation of " text)      \
  }

#define CELL_FIGURE(id, of, better_when, text)                    \
  {.name = (id),                                                  \
   .unit = (of),                                                  \
   .better = (better_when),                                       \
   .summary = ("mean " text ", printed; without a mask, drawn")}, \
      {.name = (id "_mean"),                                      \
       .unit = "%",                                               \
       .better = OPC_NEUTRAL,                                     \
       .summary = ("mean deviation of the " text)},               \
      CHANGE(id, "the " text)

static const opc_metric metrics[] = {
    FIGURE("transitions", NULL, "input transitions that change an output"),
    {"unmeasured", NULL, OPC_LOWER, 0,
     "outputs that did not reach the final level, as drawn or corrected"},
    FIGURE("tr", "ps", "mean rise time as drawn"),
    FIGURE("tf", "ps", "mean fall time as drawn"),
    FIGURE("tplh", "ps", "mean delay of rising outputs as drawn"),
    FIGURE("tphl", "ps", "mean delay of falling outputs as drawn"),
    FIGURE("tp", "ps", "mean delay as drawn"),
    CHANGE("tr", "rise times (thesis eq. 3.9)"),
    CHANGE("tf", "fall times (thesis eq. 3.10)"),
    CHANGE("tplh", "delays of rising outputs"),
    CHANGE("tphl", "delays of falling outputs"),
    CHANGE("tp", "delays (thesis eq. 3.8)"),
    FIGURE("leakage", "A", "mean supply current at rest as drawn"),
    FIGURE("leakage_most", "A", "largest supply current at rest as drawn"),
    FIGURE("power", "W", "mean static power as drawn"),
    FIGURE("leakage_mean", "%", "mean deviation of the leakage"),
    FIGURE("leakage_mean_before", "%",
           "mean deviation of the leakage before correction"),
    CHANGE("leakage", "the leakage"),
    FIGURE("cells", NULL, "memory cells"),
    FIGURE("snm_left", "mV", "smallest left noise margin as drawn"),
    FIGURE("snm_right", "mV", "smallest right noise margin as drawn"),
    CHANGE("snm_left", "left noise margins"),
    CHANGE("snm_right", "right noise margins"),
    CELL_FIGURE("hold_margin", "mV", OPC_HIGHER,
                "noise margin of holding cells"),
    CELL_FIGURE("read_margin", "mV", OPC_HIGHER,
                "noise margin of cells that are read"),
    CELL_FIGURE("write_margin", "mV", OPC_HIGHER,
                "bit line voltage that writes a cell"),
    CELL_FIGURE("read_current", "uA", OPC_HIGHER, "read current of a cell"),
    CELL_FIGURE("cell_leakage", "pA", OPC_LOWER, "leakage of a cell"),
    {"hold_margin_sigma", "mV", OPC_LOWER, 0.01,
     "standard deviation over chips of the noise margin of holding cells"},
    {"read_margin_sigma", "mV", OPC_LOWER, 0.01,
     "standard deviation over chips of the noise margin of cells that are "
     "read"},
    {"write_margin_sigma", "mV", OPC_LOWER, 0.01,
     "standard deviation over chips of the write margin"},
    {"read_current_sigma", "uA", OPC_LOWER, 0.01,
     "standard deviation over chips of the read current"},
    {"failed_cells", NULL, OPC_LOWER, 0,
     "cells of chips that do not hold, or lose their value when they are read"},
};

static int circuit_check(void *self, opc_error *error) {
  static const char *const names[] = {[EDA_NMOS] = "nmos", [EDA_PMOS] = "pmos"};
  bench *b = self;
  const double *edge = b->edges.values;
  if (!b->library == !b->models[0])
    return opc_fail(error, OPC_INVALID, b->library ? "library" : "models",
                    "set either 'models' or 'library'");
  for (int type = 0; type < 2; type++)
    if (!b->model[type] && !b->library) b->model[type] = names[type];
  for (int type = 0; type < 2; type++)
    if (b->model[type] && !eda_spice_is_name(b->model[type]))
      return opc_fail(error, OPC_INVALID, names[type],
                      "'%s' is not the name of a model", b->model[type]);
  if (b->sizes == SIZES_LENGTH && !b->devices)
    return opc_fail(
        error, OPC_INVALID, "devices",
        "'devices' is missing: 'sizes: length' requires a device table");
  if (b->edges.count != 2 || !(edge[0] > 0) || !(edge[0] < 50) ||
      !(edge[1] > 50) || !(edge[1] < 100))
    return opc_fail(error, OPC_INVALID, "edges",
                    "'edges' must be two thresholds between 0 and 100 %%, one "
                    "below and one above 50 %%");
  if (b->corner && !eda_spice_is_name(b->corner))
    return opc_fail(error, OPC_INVALID, "corner",
                    "'%s' is not the name of a section", b->corner);
  if (b->osdi && !b->library)
    return opc_fail(error, OPC_INVALID, "osdi", "'%s' requires 'library'",
                    b->osdi);
  return eda_paper_check(b->picture, "picture", error);
}

/* ---- entry ---- */

/* Results are not stored, because models may include other files and the
   simulator is another program. */
static const opc_step functions = {.run = circuit_run,
                                   .flags = OPC_STEP_OUTSIDE};
OPC_PLUGIN(bench, .id = "circuit.ngspice", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary =
               "delays, leakage and noise margins of a circuit with printed "
               "transistors",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = circuit_check, .clear = circuit_clear,
           OPC_FUNCTIONS(functions));
