/* SPDX-License-Identifier: BSD-3-Clause */
/* devices.fit_gamma: the weights of extract.gamma (thesis eq. 3.2) from
   transistors whose currents are known, of TCAD or measured. */
#include <gsl/gsl_errno.h>
#include <math.h>
#include <opcflow/step.h>
#include <stdio.h>
#include <stdlib.h>

#include "fit.h"

enum { REFERENCE, DEVICES, FORM, EDGES, TABLE, PARAMETERS };
enum { EDGE_TERM, POINTS };
enum { KINDS = 2 * CURRENTS };   /* of fits */

/* ---- state ---- */

typedef struct fitter {
  const opc_host *host;
  const opc_value *values;
} fitter;

/* All fits of a run. */
typedef struct fits {
  curves curves;
  reference reference;
  sample sample[KINDS];
  fitted fitted[KINDS];
} fits;

static const char *const types[2] = {"n", "p"};
static const char *const currents[CURRENTS] = {"ion", "ioff"};

/* ---- work ---- */

static int fit_all(const fitter *f, fits *all, opc_error *error) {
  const opc_value *v = f->values, *edges = &v[EDGES];
  int code = OPC_OK;
  for (int k = 0; k < KINDS && !code; k++) {
    sample *s = &all->sample[k];
    code = sample_make(f->host, &all->reference, k / CURRENTS, k % CURRENTS, s,
                       error);
    if (code || !s->count) continue;
    code = v[FORM].integer == EDGE_TERM
               ? fit_edge(f->host, s, &all->fitted[k], error)
               : fit_table(f->host, s, edges->reals, edges->count,
                           &all->fitted[k], error);
  }
  return code;
}

/* The table that extract.gamma reads. The width says nothing: there is one. */
static int write_table(const fitter *f, const fits *all, opc_error *error) {
  const char *path =
      f->host->output_path(f->host, f->values[TABLE].text, error);
  if (!path) return error->code;
  FILE *file = fopen(path, "w");
  int good = file != NULL;
  if (good) good = fprintf(file, "type,current,width (nm),edge (nm),gamma\n") > 0;
  for (int k = 0; k < KINDS && good; k++)
    for (size_t i = 0; i < all->fitted[k].points && good; i++)
      good = fprintf(file, "%s,%s,1000,%.10g,%.10g\n", types[k / CURRENTS],
                     currents[k % CURRENTS], all->fitted[k].edge[i],
                     all->fitted[k].gamma[i]) > 0;
  if (file && fclose(file)) good = 0;
  if (good) return OPC_OK;
  return f->host->fail(f->host, error, OPC_IO, "table",
                       "'%s' could not be written", path);
}

static int residual_table(const fitter *f, const fits *all, opc_error *error) {
  size_t n = 0, row = 0;
  for (int k = 0; k < KINDS; k++) n += all->sample[k].count;
  const char **type = calloc(2 * n + 1, sizeof *type), **current = type + n;
  double *figure = calloc(3 * n + 1, sizeof *figure);
  int code = OPC_OK;
  if (!type || !figure)
    code = f->host->fail(f->host, error, OPC_FAILED, NULL, "out of memory");
  for (int k = 0; k < KINDS && !code; k++)
    for (size_t i = 0; i < all->sample[k].count; i++, row++) {
      const sample *s = &all->sample[k];
      type[row] = types[s->type];
      current[row] = currents[s->current];
      figure[row] = s->transistor[i]->width;
      figure[n + row] = fit_residual(s, i, NULL);
      figure[2 * n + row] = fit_residual(s, i, &all->fitted[k]);
    }
  const opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, type},
      {"current", NULL, OPC_TEXT, 0, current},
      {"width", "nm", OPC_REAL, 1, figure},
      {"plain", "%", OPC_REAL, 4, figure + n},
      {"gamma", "%", OPC_REAL, 4, figure + 2 * n},
  };
  if (!code)
    code = f->host->table(f->host, "gamma_residuals", 0, n, columns,
                          sizeof columns / sizeof *columns, error);
  free(type);
  free(figure);
  return code;
}

static int summary_table(const fitter *f, const fits *all, opc_error *error) {
  enum { AMPLITUDE, DECAY, PLAIN, FITTED, FIGURES };
  const char *type[KINDS], *current[KINDS];
  double figure[FIGURES][KINDS], worst[CURRENTS] = {0};
  int64_t count[KINDS];
  size_t rows = 0;
  for (int k = 0; k < KINDS; k++) {
    const sample *s = &all->sample[k];
    if (!s->count) continue;
    double plain = 0, fit = 0;
    for (size_t i = 0; i < s->count; i++) {
      plain = fmax(plain, fabs(fit_residual(s, i, NULL)));
      fit = fmax(fit, fabs(fit_residual(s, i, &all->fitted[k])));
    }
    type[rows] = types[s->type];
    current[rows] = currents[s->current];
    count[rows] = (int64_t)s->count;
    figure[AMPLITUDE][rows] = all->fitted[k].amplitude;
    figure[DECAY][rows] = all->fitted[k].decay;
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
  if (!code) code = f->host->metric(f->host, "ion_max", worst[ION], error);
  if (!code) code = f->host->metric(f->host, "ioff_max", worst[IOFF], error);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const fitter *f = self;
  const opc_value *v = f->values;
  (void)outputs;
  fits *all = calloc(1, sizeof *all);
  if (!all)
    return f->host->fail(f->host, error, OPC_FAILED, NULL, "out of memory");
  gsl_set_error_handler_off();   /* its default aborts */
  int code = curves_load(&all->curves, f->host, v[DEVICES].text, error);
  if (!code)
    code = reference_read(f->host, v[REFERENCE].text, &all->curves,
                          &all->reference, error);
  if (!code) code = fit_all(f, all, error);
  if (!code) code = write_table(f, all, error);
  if (!code) code = summary_table(f, all, error);
  if (!code) code = residual_table(f, all, error);
  for (int k = 0; k < KINDS; k++) {
    sample_clear(&all->sample[k]);
    fitted_clear(&all->fitted[k]);
  }
  reference_clear(&all->reference);
  curves_clear(&all->curves, f->host);
  free(all);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [REFERENCE] = {.name = "reference", .type = OPC_FILE, .flags = OPC_REQUIRED,
                   .summary = "transistors with their currents: a CSV file"},
    [DEVICES] = {.name = "devices", .type = OPC_FILE, .flags = OPC_REQUIRED,
                 .summary = "device table that extract.gamma will use"},
    [FORM] = {.name = "form", .type = OPC_CHOICE, .preset = "edge",
              .choices = "edge|table",
              .summary = "gamma = 1 + a exp(-d / decay), or free at `edges`"},
    [EDGES] = {.name = "edges", .type = OPC_REALS, .unit = "nm",
               .preset = "[0 nm, 10 nm, 20 nm, 40 nm, 80 nm]",
               .summary = "distances from the active edge of the form 'table'"},
    [TABLE] = {.name = "table", .type = OPC_OUTPUT, .preset = "gamma.csv",
               .summary = "the weights, for extract.gamma"},
};

static const opc_metric metrics[] = {
    {.name = "ion_max", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "largest |error| of Ion after the fit"},
    {.name = "ioff_max", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "largest |error| of Ioff after the fit"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  const opc_value *edges = &values[EDGES];
  int good = edges->count > 0;
  for (size_t i = 0; i < edges->count; i++)
    good &= edges->reals[i] >= 0 &&
            (i == 0 || edges->reals[i] > edges->reals[i - 1]);
  if (!good) {
    host->fail(host, error, OPC_INVALID, "edges",
               "distances rise, and none is below 0");
    return NULL;
  }
  fitter *f = malloc(sizeof *f);
  if (!f) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  *f = (fitter){host, values};
  return f;
}

static void destroy(void *self) { free(self); }

/* ---- entry ---- */

static const opc_step operations = {.size = sizeof operations, .run = run};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "devices.fit_gamma",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "fit the weights of gate slices to known currents",
      .kind = OPC_KIND_STEP,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      OPC_METRICS(metrics),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
