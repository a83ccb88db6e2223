/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements devices.fit_gamma: fits the weights of extractor.gamma (thesis eq.
   3.2) to transistors with known currents, from TCAD or measurement. */
#include <eda/file.h>
#include <eda/memory.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit.h"

enum { EDGE_TERM, POINTS };
enum { FITS = 2 * EDA_CURRENTS };

/* ---- state ---- */

typedef struct fitter {
  const opc_host *host;
  const char *reference_file, *devices, *table; /* parameters */
  int form;                                     /* EDGE_TERM, POINTS */
  opc_reals edges;
  double from, to;
  eda_curves curves;
  reference reference;
  sample sample[FITS];
  fitted fitted[FITS];
} fitter;

static const char *const types[2] = {"n", "p"};
static const char *const currents[EDA_CURRENTS] = {"ion", "ioff"};

/* ---- work ---- */

static int fit_all(fitter *f, opc_error *error) {
  int code = OPC_OK;
  for (int k = 0; k < FITS && !code; k++) {
    sample *s = &f->sample[k];
    sample_init(s, &f->reference, k / EDA_CURRENTS, k % EDA_CURRENTS);
    if (!s->count) continue;
    code = f->form == EDGE_TERM ? fit_edge(s, &f->fitted[k], error)
                                : fit_table(s, f->edges.values, f->edges.count,
                                            &f->fitted[k], error);
  }
  return code;
}

/* Write the table for extractor.gamma. The table contains only one width; its
   value has no effect. */
static int write_table(const fitter *f, opc_error *error) {
  const char *path = f->host->output_path(f->host, f->table, error);
  if (!path) return error->code;
  FILE *file = fopen(path, "w");
  if (file) fputs("type,current,width (nm),edge (nm),gamma\n", file);
  for (int k = 0; k < FITS && file; k++)
    for (size_t i = 0; i < f->fitted[k].points; i++)
      fprintf(file, "%s,%s,1000,%.10g,%.10g\n", types[k / EDA_CURRENTS],
              currents[k % EDA_CURRENTS], f->fitted[k].edge[i],
              f->fitted[k].gamma[i]);
  return eda_file_close(file, path, "table", error);
}

static int residual_table(const fitter *f, opc_error *error) {
  typedef struct row {
    const char *type, *current;
    double width, plain, fitted;
  } row;
  size_t n = 0, at = 0;
  for (int k = 0; k < FITS; k++) n += f->sample[k].count;
  row *rows = eda_alloc(n, sizeof *rows);
  for (int k = 0; k < FITS; k++)
    for (size_t i = 0; i < f->sample[k].count; i++) {
      const sample *s = &f->sample[k];
      rows[at++] =
          (row){types[s->type], currents[s->current], s->transistor[i]->width,
                fit_residual(s, i, NULL), fit_residual(s, i, &f->fitted[k])};
    }
  const opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, &rows->type},
      {"current", NULL, OPC_TEXT, 0, &rows->current},
      {"width", "nm", OPC_REAL, 1, &rows->width},
      {"plain", "%", OPC_REAL, 4, &rows->plain},
      {"gamma", "%", OPC_REAL, 4, &rows->fitted},
  };
  int code = opc_put_rows(f->host, "gamma_residuals", 0, n, sizeof *rows,
                          OPC_ARRAY(columns), error);
  free(rows);
  return code;
}

static int summary_table(const fitter *f, opc_error *error) {
  typedef struct row {
    const char *type, *current;
    int64_t count;
    double amplitude, decay, plain, fitted;
  } row;
  row rows[FITS];
  double worst[EDA_CURRENTS] = {0};
  size_t n = 0;
  for (int k = 0; k < FITS; k++) {
    const sample *s = &f->sample[k];
    if (!s->count) continue;
    row r = {.type = types[s->type],
             .current = currents[s->current],
             .count = (int64_t)s->count,
             .amplitude = f->fitted[k].amplitude,
             .decay = f->fitted[k].decay};
    for (size_t i = 0; i < s->count; i++) {
      r.plain = fmax(r.plain, fabs(fit_residual(s, i, NULL)));
      r.fitted = fmax(r.fitted, fabs(fit_residual(s, i, &f->fitted[k])));
    }
    worst[s->current] = fmax(worst[s->current], r.fitted);
    rows[n++] = r;
  }
  const opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, &rows->type},
      {"current", NULL, OPC_TEXT, 0, &rows->current},
      {"transistors", NULL, OPC_INT, 0, &rows->count},
      {"edge", NULL, OPC_REAL, 5, &rows->amplitude},
      {"decay", "nm", OPC_REAL, 3, &rows->decay},
      {"plain_max", "%", OPC_REAL, 3, &rows->plain},
      {"gamma_max", "%", OPC_REAL, 3, &rows->fitted},
  };
  const opc_metric_value values[] = {{"ion_max", worst[EDA_ION]},
                                     {"ioff_max", worst[EDA_IOFF]}};
  int code = opc_put_rows(f->host, "gamma", OPC_TABLE_PRINT, n, sizeof *rows,
                          OPC_ARRAY(columns), error);
  return code ? code : opc_put_metrics(f->host, OPC_ARRAY(values), error);
}

static int fit_gamma_run(void *self, void **outputs, opc_error *error) {
  fitter *f = self;
  (void)outputs;
  gsl_set_error_handler_off(); /* the default handler aborts */
  int code = eda_curves_read(&f->curves, f->devices, error);
  if (!code && f->curves.devices->narrow)
    code = opc_fail(error, OPC_INVALID, "devices",
                    "'%s' has several widths and therefore already includes "
                    "the effect of the edges",
                    f->devices);
  if (!code)
    code = reference_read(f->reference_file, &f->curves, f->from, f->to,
                          &f->reference, error);
  if (!code && !f->reference.count)
    code = opc_fail(error, OPC_INVALID, "length.from",
                    "'%s' has no transistor with a mean length of %g to %g nm",
                    f->reference_file, f->from, f->to);
  if (!code) code = fit_all(f, error);
  if (!code) code = write_table(f, error);
  if (!code) code = summary_table(f, error);
  return code ? code : residual_table(f, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED(
        "reference", fitter, reference_file, .type = OPC_FILE,
        .flags = OPC_REQUIRED,
        .summary =
            "transistors with their currents: a CSV file, or a device table "
            "(.yaml) whose widths and lengths are rectangles"),
    OPC_PARAMETER(fitter, devices, .type = OPC_FILE, .flags = OPC_REQUIRED,
                  .summary = "device table that extractor.gamma will use"),
    OPC_PARAMETER(fitter, form, .type = OPC_CHOICE, .preset = "edge",
                  .choices = "edge|table",
                  .summary = "edge: gamma = 1 + a exp(-d / decay); table: "
                             "gamma at the distances `edges`"),
    OPC_PARAMETER(
        fitter, edges, .type = OPC_REALS, .unit = "nm",
        .preset = "[0 nm, 20 nm]",
        .summary = "distances from the active edge, for the form 'table'"),
    OPC_PARAMETER_NAMED("length.from", fitter, from, .type = OPC_REAL,
                        .unit = "nm", .flags = OPC_AT_LEAST, .preset = "0 nm",
                        .min = 0,
                        .summary = "smallest mean length of the transistors"),
    OPC_PARAMETER_NAMED("length.to", fitter, to, .type = OPC_REAL, .unit = "nm",
                        .flags = OPC_AT_LEAST, .preset = "1000000 nm", .min = 0,
                        .summary = "largest mean length of the transistors"),
    OPC_PARAMETER(fitter, table, .type = OPC_OUTPUT, .preset = "gamma.csv",
                  .summary = "table of weights for extractor.gamma"),
};

static const opc_metric metrics[] = {
    {"ion_max", "%", OPC_LOWER, 0.01, "largest |error| of Ion after the fit"},
    {"ioff_max", "%", OPC_LOWER, 0.01, "largest |error| of Ioff after the fit"},
};

static int fit_gamma_check(void *self, opc_error *error) {
  opc_reals e = ((fitter *)self)->edges;
  int good = e.count > 0;
  for (size_t i = 0; i < e.count; i++)
    good &= e.values[i] >= 0 && (i == 0 || e.values[i] > e.values[i - 1]);
  if (good) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "edges",
                  "distances must increase and must not be negative");
}

static void fit_gamma_clear(void *self) {
  fitter *f = self;
  for (int k = 0; k < FITS; k++) {
    sample_clear(&f->sample[k]);
    fitted_clear(&f->fitted[k]);
  }
  reference_clear(&f->reference);
  eda_curves_clear(&f->curves);
}

/* ---- entry ---- */

static const opc_step functions = {.run = fit_gamma_run};

OPC_PLUGIN(fitter, .id = "devices.fit_gamma", .kind = "step",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "fit the weights of gate slices to known currents",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = fit_gamma_check, .clear = fit_gamma_clear,
           OPC_FUNCTIONS(functions));
