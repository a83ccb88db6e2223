/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements timing.paths: delays from inputs to outputs of a circuit with
   drawn and printed transistors (thesis 3.3.3, 5.3.1), by event simulation with
   cells from timing.characterize. */
#include "../parameters.h"
#include "gradients.h"

#include <eda/drawing.h>
#include <glib.h>
#include <math.h>
#include <opcflow/table.h>

/* ---- work ---- */

static int write_files(paths *p, opc_error *error) {
  for (size_t s = 0; s < p->states; s++) {
    g_autofree char *name =
        g_strdup_printf("%s.%s.sdf", p->graph.name, p->state[s].name);
    const char *path = p->host->output_path(p->host, name, error);
    if (!path || write_sdf(p, &p->state[s], path, error)) return error->code;
  }
  if (p->verilog) {
    const char *path = p->host->output_path(p->host, p->verilog, error);
    if (!path || write_verilog(p, path, error)) return error->code;
  }
  return p->events ? events_report(p, error) : OPC_OK;
}

static int paths_simulate(paths *p, opc_error *error) {
  delays d = {0};
  const char *path = NULL;
  int code = delays_find(p, &d, error);
  if (!code) code = delays_report(p, &d, error);
  if (!code && p->states > 1) {
    path = p->host->output_path(p->host, p->picture, error);
    code = path ? draw_histogram(p, &d, path, error) : error->code;
  }
  delays_clear(&d, p->states);
  return code;
}

static int paths_run(void *self, void **outputs, opc_error *error) {
  paths *p = self;
  eda_delays *sensed = NULL;
  p->states = 0;
  if (!p->top) p->top = p->circuit ? p->circuit->name : NULL;
  int code = p->top ? graph_read(&p->graph, &p->pool, p->timing, p->file,
                                 p->top, error)
                    : opc_fail(error, OPC_INVALID, "top",
                               "'top' is missing: without 'circuit', name the "
                               "subcircuit of the netlist");
  if (!code) code = states_find(p, error);
  for (size_t s = 0; s < p->states && !code; s++)
    state_tables(&p->graph, p->at, &p->state[s]);
  if (!code) log_extrapolated(p->host, &p->graph, p->state, p->at.slew);
  if (!code) patterns_count(p);
  if (!code) code = paths_simulate(p, error);
  if (!code) code = write_files(p, error);
  if (!code && p->spice) code = compare_with_spice(p, error);
  if (!code) code = delays_differentiate(p, &sensed, error);
  outputs[0] = sensed;
  for (size_t s = 0; s < p->states; s++) state_clear(&p->state[s]);
  eda_pool_clear(&p->pool);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(paths, timing, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "timing",
                  .summary = "timing tables of the circuit's cells"),
    OPC_PARAMETER(paths, file, .type = OPC_FILE, .flags = OPC_REQUIRED,
                  .summary = "SPICE or CDL netlist of cell instances"),
    OPC_PARAMETER(
        paths, top, .type = OPC_TEXT,
        .summary = "subcircuit to analyse (default: the name of `circuit`)"),
    OPC_PARAMETER(
        paths, circuit, .type = OPC_INPUT, .choices = "circuit",
        .summary = "matched gates of the transistors, for printed sizes"),
    OPC_PARAMETER(paths, mask, .type = OPC_INPUT, .choices = "mask",
                  .summary = "corrected mask with printed image"),
    OPC_PARAMETER(paths, label, .type = OPC_TEXT, .preset = "printed",
                  .summary = "name of the mask in tables"),
    OPC_PARAMETER(
        paths, prints, .type = OPC_MAP,
        .summary = "further sets of sizes: tables gates.csv of runs with the "
                   "same layout, { dpb: runs/dpb/gates.csv }"),
    OPC_PARAMETER(paths, experiment, .type = OPC_INPUT, .choices = "experiment",
                  .summary = "runs of the same layout by several methods"),
    OPC_PARAMETER(paths, transitions, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "22000",
                  .min = 1, .max = 10000000,
                  .summary = "largest number of input transitions; if there "
                             "are more, a random sample"),
    OPC_PARAMETER(paths, seed, .type = OPC_INT, .flags = OPC_AT_LEAST,
                  .preset = "1", .min = 0, .summary = "seed of random samples"),
    OPC_PARAMETER(paths, changes, .type = OPC_CHOICE,
                  .choices = "single|several", .preset = "several",
                  .summary = "single: one input changes at a time; several: "
                             "all inputs may change"),
    OPC_PARAMETER(paths, delays, .type = OPC_CHOICE, .choices = "slews|arcs",
                  .preset = "slews",
                  .summary = "delay model: by slew and load of each event, or "
                             "one delay per arc, as in the SDF files"),
    TIMING_CONDITIONS(paths),
    OPC_PARAMETER(paths, picture, .type = OPC_OUTPUT, .preset = "histogram.png",
                  .summary = "histogram of the deviations, .png, .svg or .pdf"),
    OPC_PARAMETER(paths, verilog, .type = OPC_OUTPUT,
                  .summary = "Verilog file of the circuit, with a test bench "
                             "if 'events' is above 0"),
    OPC_PARAMETER(paths, events, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0", .min = 0,
                  .max = 100000,
                  .summary = "number of transitions whose output events at "
                             "drawn sizes are listed in a table"),
    OPC_PARAMETER(paths, spice, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0", .min = 0,
                  .max = 100000,
                  .summary = "number of transitions at which ngspice also "
                             "simulates the whole circuit"),
    TIMING_MODELS(paths, 0, "file with the model cards, for 'spice'"),
    TIMING_TIME_LIMIT(paths),
};

static const opc_metric metrics[] = {
    FIGURE("cells", NULL, "number of cell instances"),
    FIGURE("transitions", NULL, "number of input transitions"),
    FIGURE("delays", NULL, "number of output transitions"),
    FIGURE("delay", "ps", "mean delay as drawn"),
    FIGURE("delay_max", "ps", "largest delay as drawn"),
    FIGURE("delay_min", "ps", "smallest delay as drawn"),
    FIGURE("static", "ps", "latest arrival of static analysis as drawn"),
    FIGURE("others", NULL,
           "delays that are not compared, because the latest path at printed "
           "sizes has other nets"),
    COST("mean", "%",
         "mean of the absolute deviations of delays (thesis eq. 3.15)"),
    COST("stdv", "%", "standard deviation of the deviations of delays"),
    FIGURE("lowest", "%", "lowest deviation"),
    FIGURE("highest", "%", "highest deviation"),
    FIGURE("longest", "%", "deviation of the largest delay"),
    FIGURE("shortest", "%", "deviation of the smallest delay"),
    FIGURE("static_deviation", "%", "deviation of the static latest arrival"),
    FIGURE("spice_delays", NULL, "number of delays simulated by ngspice"),
    FIGURE("critical_paths", NULL, "number of paths in the output"),
    FIGURE("critical_coverage", "%",
           "random circuits whose longest path is in the output"),
    COST("spice_error", "%",
         "root mean square error of delays as drawn against ngspice"),
    COST("spice_error_max", "%",
         "largest |error| of delays as drawn against ngspice"),
    COST("spice_deviation", "%",
         "mean error of the deviations against ngspice, in points"),
    COST("spice_deviation_max", "%",
         "largest |error| of the deviations against ngspice, in points"),
};

static int paths_check(void *self, opc_error *error) {
  const paths *p = self;
  if (p->spice && !p->models[0])
    return opc_fail(error, OPC_INVALID, "models",
                    "'models' is missing, required by 'spice'");
  return eda_paper_check(p->picture, "picture", error);
}

/* ---- entry ---- */

/* Results of the step are not stored, because the netlist may include other
   files and ngspice is another program. */
static const opc_port outputs[] = {EDA_PORT_DELAYS("delays")};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = paths_run,
                                   .flags = OPC_STEP_OUTSIDE};
OPC_PLUGIN(paths, .id = "timing.paths", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "path delays of a circuit as drawn and as printed",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = paths_check, OPC_FUNCTIONS(functions));
