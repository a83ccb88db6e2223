/* SPDX-License-Identifier: BSD-3-Clause */
/* devices.fit_gamma: the weights of extractor.gamma (thesis eq. 3.2) from
   transistors whose currents are known, of TCAD or measured. */
#include <eda/memory.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <opcflow/step.h>
#include <stdio.h>
#include <stdlib.h>

#include "fit.h"

enum { EDGE_TERM, POINTS };
enum { FITS = 2 * EDA_CURRENTS };

/* ---- state ---- */

typedef struct fitter {
  const opc_host *host;
  const char *reference_file, *devices, *table; /* parameters */
  int form;                                     /* EDGE_TERM, POINTS */
  opc_reals edges;
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

/* The table that extractor.gamma reads. The width says nothing: there is one.
 */
static int write_table(const fitter *f, opc_error *error) {
  const char *path = f->host->output_path(f->host, f->table, error);
  if (!path) return error->code;
  FILE *file = fopen(path, "w");
  int good = file != NULL;
  if (good)
    good = fprintf(file, "type,current,width (nm),edge (nm),gamma\n") > 0;
  for (int k = 0; k < FITS && good; k++)
    for (size_t i = 0; i < f->fitted[k].points && good; i++)
      good = fprintf(file, "%s,%s,1000,%.10g,%.10g\n", types[k / EDA_CURRENTS],
                     currents[k % EDA_CURRENTS], f->fitted[k].edge[i],
                     f->fitted[k].gamma[i]) > 0;
  if (file && fclose(file)) good = 0;
  if (good) return OPC_OK;
  return opc_fail(error, OPC_IO, "table", "'%s' could not be written", path);
}

static int residual_table(const fitter *f, opc_error *error) {
  size_t n = 0, row = 0;
  for (int k = 0; k < FITS; k++) n += f->sample[k].count;
  const char **type = eda_alloc(2 * n, sizeof *type), **current = type + n;
  double *figure = eda_alloc(3 * n, sizeof *figure);
  for (int k = 0; k < FITS; k++)
    for (size_t i = 0; i < f->sample[k].count; i++, row++) {
      const sample *s = &f->sample[k];
      type[row] = types[s->type];
      current[row] = currents[s->current];
      figure[row] = s->transistor[i]->width;
      figure[n + row] = fit_residual(s, i, NULL);
      figure[2 * n + row] = fit_residual(s, i, &f->fitted[k]);
    }
  const opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, type},
      {"current", NULL, OPC_TEXT, 0, current},
      {"width", "nm", OPC_REAL, 1, figure},
      {"plain", "%", OPC_REAL, 4, figure + n},
      {"gamma", "%", OPC_REAL, 4, figure + 2 * n},
  };
  int code = f->host->table(f->host, "gamma_residuals", 0, n, columns,
                            sizeof columns / sizeof *columns, error);
  free(type);
  free(figure);
  return code;
}

static int summary_table(const fitter *f, opc_error *error) {
  enum { AMPLITUDE, DECAY, PLAIN, FITTED, FIGURES };
  const char *type[FITS], *current[FITS];
  double figure[FIGURES][FITS], worst[EDA_CURRENTS] = {0};
  int64_t count[FITS];
  size_t rows = 0;
  for (int k = 0; k < FITS; k++) {
    const sample *s = &f->sample[k];
    if (!s->count) continue;
    double plain = 0, fit = 0;
    for (size_t i = 0; i < s->count; i++) {
      plain = fmax(plain, fabs(fit_residual(s, i, NULL)));
      fit = fmax(fit, fabs(fit_residual(s, i, &f->fitted[k])));
    }
    type[rows] = types[s->type];
    current[rows] = currents[s->current];
    count[rows] = (int64_t)s->count;
    figure[AMPLITUDE][rows] = f->fitted[k].amplitude;
    figure[DECAY][rows] = f->fitted[k].decay;
    figure[PLAIN][rows] = plain;
    figure[FITTED][rows++] = fit;
    worst[s->current] = fmax(worst[s->current], fit);
  }
  const opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, type},
      {"current", NULL, OPC_TEXT, 0, current},
      {"transistors", NULL, OPC_INT, 0, count},
      {"edge", NULL, OPC_REAL, 5, figure[AMPLITUDE]},
      {"decay", "nm", OPC_REAL, 3, figure[DECAY]},
      {"plain_max", "%", OPC_REAL, 3, figure[PLAIN]},
      {"gamma_max", "%", OPC_REAL, 3, figure[FITTED]},
  };
  int code = f->host->table(f->host, "gamma", OPC_TABLE_PRINT, rows, columns,
                            sizeof columns / sizeof *columns, error);
  if (!code) code = f->host->metric(f->host, "ion_max", worst[EDA_ION], error);
  if (!code)
    code = f->host->metric(f->host, "ioff_max", worst[EDA_IOFF], error);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  fitter *f = self;
  (void)outputs;
  gsl_set_error_handler_off(); /* its default aborts */
  int code = eda_curves_read(&f->curves, f->devices, error);
  if (!code)
    code = reference_read(f->reference_file, &f->curves, &f->reference, error);
  if (!code) code = fit_all(f, error);
  if (!code) code = write_table(f, error);
  if (!code) code = summary_table(f, error);
  return code ? code : residual_table(f, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    {.name = "reference",
     .type = OPC_FILE,
     .flags = OPC_REQUIRED,
     .summary = "transistors with their currents: a CSV file",
     OPC_FIELD(fitter, reference_file)},
    {.name = "devices",
     .type = OPC_FILE,
     .flags = OPC_REQUIRED,
     .summary = "device table that extractor.gamma will use",
     OPC_FIELD(fitter, devices)},
    {.name = "form",
     .type = OPC_CHOICE,
     .preset = "edge",
     .choices = "edge|table",
     .summary = "gamma = 1 + a exp(-d / decay), or free at `edges`",
     OPC_FIELD(fitter, form)},
    {.name = "edges",
     .type = OPC_REALS,
     .unit = "nm",
     .preset = "[0 nm, 10 nm, 20 nm, 40 nm, 80 nm]",
     .summary = "distances from the active edge of the form 'table'",
     OPC_FIELD(fitter, edges)},
    {.name = "table",
     .type = OPC_OUTPUT,
     .preset = "gamma.csv",
     .summary = "the weights, for extractor.gamma",
     OPC_FIELD(fitter, table)},
};

static const opc_metric metrics[] = {
    {.name = "ion_max",
     .unit = "%",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "largest |error| of Ion after the fit"},
    {.name = "ioff_max",
     .unit = "%",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "largest |error| of Ioff after the fit"},
};

static int check(void *self, opc_error *error) {
  opc_reals e = ((fitter *)self)->edges;
  int good = e.count > 0;
  for (size_t i = 0; i < e.count; i++)
    good &= e.values[i] >= 0 && (i == 0 || e.values[i] > e.values[i - 1]);
  if (good) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "edges",
                  "distances rise, and none is below 0");
}

static void clear(void *self) {
  fitter *f = self;
  for (int k = 0; k < FITS; k++) {
    sample_clear(&f->sample[k]);
    fitted_clear(&f->fitted[k]);
  }
  reference_clear(&f->reference);
  eda_curves_clear(&f->curves);
}

/* ---- entry ---- */

static const opc_step functions = {.run = run};

OPC_PLUGIN(fitter, .id = "devices.fit_gamma", .kind = "step",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "fit the weights of gate slices to known currents",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = check,
           .clear = clear, OPC_FUNCTIONS(functions));
