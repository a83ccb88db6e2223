/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements devices.check: compares an extractor with simulated transistors of
   several widths, for rectangles and for printed gates (thesis figure 2.3). */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include "reference.h"

/* ---- state ---- */

typedef struct check {
  const opc_host *host;
  const char *path; /* parameters */
  const opc_module *extractor;
  const eda_mask *mask;
  double from, to;
  eda_curves curves;
  reference reference;
} check;

enum { TYPES = 2 };

/* Sums of |error|, %, of one set of transistors: [EDA_CURRENTS] of the
   currents, then of the deviations from the drawn transistor. */
typedef struct errors {
  const char *set, *type;
  int64_t count;
  double mean[2 * EDA_CURRENTS], max[2 * EDA_CURRENTS];
} errors;

static void errors_add(errors *e, int k, double error) {
  e->mean[k] += fabs(error);
  e->max[k] = fmax(e->max[k], fabs(error));
}

static const double *current_of(const eda_performance *p, int current) {
  return current == EDA_ION ? p->ion : p->ioff;
}

/* ---- rectangles ---- */

/* Return 1 if a length of the table is within the bounds. */
static int length_used(const check *c, size_t i) {
  double l = c->curves.devices->length[i];
  return l >= c->from && l <= c->to;
}

static double width_of(const eda_devices *d, size_t k) {
  return k < d->narrow ? d->narrow_width[k] : d->width;
}

/* Return gates: for each width and length of the reference, a rectangular
   n-transistor and p-transistor. The caller frees the gates. */
static eda_gates *rectangles_new(const check *c) {
  const eda_devices *d = c->curves.devices;
  size_t lengths = 0, at = 0;
  for (size_t i = 0; i < d->count; i++) lengths += (size_t)length_used(c, i);
  eda_gates *g = eda_gates_new(2, TYPES * (d->narrow + 1) * lengths);
  g->grid = 1;
  for (int type = 0; type < TYPES; type++)
    for (size_t k = 0; k <= d->narrow; k++)
      for (size_t i = 0; i < d->count; i++) {
        if (!length_used(c, i)) continue;
        g->type[at] = (uint8_t)type;
        g->length[at] = d->length[i];
        g->width[at] = width_of(d, k);
        g->extension[2 * at] = g->extension[2 * at + 1] = 100;
        g->box[at] = (eda_box){0, 0, 1, 1};
        g->axis[at++] = EDA_X;
      }
  return g;
}

static int put_rectangles(const check *c, const eda_gates *g,
                          const eda_performance *found,
                          const eda_performance *known, errors *sums,
                          opc_error *error) {
  typedef struct row {
    const char *type;
    double width, length, current[EDA_CURRENTS], off[EDA_CURRENTS];
  } row;
  row *rows = eda_alloc(g->count, sizeof *rows);
  for (size_t i = 0; i < g->count; i++) {
    row *r = &rows[i];
    *r = (row){g->type[i] ? "p" : "n", g->width[i], g->length[i], {0}, {0}};
    sums[g->type[i]].count++;
    for (int k = 0; k < EDA_CURRENTS; k++) {
      r->current[k] = current_of(known, k)[i];
      r->off[k] = eda_deviation(current_of(found, k)[i], r->current[k]);
      errors_add(&sums[g->type[i]], k, r->off[k]);
    }
  }
  const opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, &rows->type},
      {"width", "nm", OPC_REAL, 1, &rows->width},
      {"length", "nm", OPC_REAL, 2, &rows->length},
      {"ion", "A", OPC_REAL, -6, &rows->current[EDA_ION]},
      {"ioff", "A", OPC_REAL, -6, &rows->current[EDA_IOFF]},
      {"ion_error", "%", OPC_REAL, 4, &rows->off[EDA_ION]},
      {"ioff_error", "%", OPC_REAL, 4, &rows->off[EDA_IOFF]},
  };
  int code = opc_put_rows(c->host, "rectangles", 0, g->count, sizeof *rows,
                          OPC_ARRAY(columns), error);
  free(rows);
  return code;
}

static int check_rectangles(check *c, const opc_module *by, errors *sums,
                            opc_error *error) {
  eda_gates *g = rectangles_new(c);
  eda_performance found, known;
  eda_performance_init(&found, g->count);
  eda_performance_init(&known, g->count);
  int code = g->count ? OPC_OK
                      : opc_fail(error, OPC_INVALID, "length.from",
                                 "'%s' has no length from %g to %g nm", c->path,
                                 c->from, c->to);
  if (!code)
    code = eda_measure_drawn(c->host->context, g, c->extractor, &found, error);
  if (!code) code = eda_measure_drawn(c->host->context, g, by, &known, error);
  if (!code) code = put_rectangles(c, g, &found, &known, sums, error);
  eda_performance_clear(&found);
  eda_performance_clear(&known);
  eda_gates_free(g);
  return code;
}

/* ---- printed gates ---- */

/* A printed layout as measured by one extractor. */
typedef struct measured {
  eda_performance drawn;
  eda_measurement printed;
} measured;

static int measured_init(measured *m, const check *c, const opc_module *by,
                         opc_error *error) {
  const eda_gates *g = c->mask->gates;
  eda_performance_init(&m->drawn, g->count);
  eda_measurement_init(&m->printed, g->count);
  int code = eda_measure_drawn(c->host->context, g, by, &m->drawn, error);
  if (code) return code;
  return eda_measure(c->host->context, g, c->mask->print, by, &m->printed,
                     error);
}

static void measured_clear(measured *m) {
  eda_performance_clear(&m->drawn);
  eda_measurement_clear(&m->printed);
}

static double printed_current(const measured *m, int current, size_t i) {
  return current_of(&m->printed.performance, current)[i];
}

static double printed_deviation(const measured *m, int current, size_t i) {
  return eda_deviation(printed_current(m, current, i),
                       current_of(&m->drawn, current)[i]);
}

static int put_printed(const check *c, const measured *found,
                       const measured *known, errors *sums, opc_error *error) {
  typedef struct row {
    const char *owner, *type;
    int64_t number;
    double width, off[EDA_CURRENTS], deviation[EDA_CURRENTS],
        reference[EDA_CURRENTS];
  } row;
  const eda_gates *g = c->mask->gates;
  row *rows = eda_alloc(g->count, sizeof *rows);
  size_t n = 0;
  for (size_t i = 0; i < g->count; i++) {
    if (eda_print_failed(found->printed.flags[i])) continue;
    errors *sum = &sums[g->type[i]];
    row *r = &rows[n++];
    *r = (row){.owner = eda_gates_owner(g, i),
               .type = g->type[i] ? "p" : "n",
               .number = g->number[i],
               .width = g->width[i]};
    sum->count++;
    for (int k = 0; k < EDA_CURRENTS; k++) {
      r->off[k] = eda_deviation(printed_current(found, k, i),
                                printed_current(known, k, i));
      r->deviation[k] = printed_deviation(found, k, i);
      r->reference[k] = printed_deviation(known, k, i);
      errors_add(sum, k, r->off[k]);
      errors_add(sum, EDA_CURRENTS + k, r->deviation[k] - r->reference[k]);
    }
  }
  const opc_column columns[] = {
      {"owner", NULL, OPC_TEXT, 0, &rows->owner},
      {"number", NULL, OPC_INT, 0, &rows->number},
      {"type", NULL, OPC_TEXT, 0, &rows->type},
      {"width", "nm", OPC_REAL, 1, &rows->width},
      {"ion_error", "%", OPC_REAL, 4, &rows->off[EDA_ION]},
      {"ioff_error", "%", OPC_REAL, 4, &rows->off[EDA_IOFF]},
      {"ion_deviation", "%", OPC_REAL, 4, &rows->deviation[EDA_ION]},
      {"ion_reference", "%", OPC_REAL, 4, &rows->reference[EDA_ION]},
      {"ioff_deviation", "%", OPC_REAL, 4, &rows->deviation[EDA_IOFF]},
      {"ioff_reference", "%", OPC_REAL, 4, &rows->reference[EDA_IOFF]},
  };
  int code = opc_put_rows(c->host, "printed", 0, n, sizeof *rows,
                          OPC_ARRAY(columns), error);
  free(rows);
  return code;
}

static int check_printed(const check *c, const opc_module *by, errors *sums,
                         opc_error *error) {
  measured found = {0}, known = {0};
  int code = measured_init(&found, c, c->extractor, error);
  if (!code) code = measured_init(&known, c, by, error);
  if (!code) code = put_printed(c, &found, &known, sums, error);
  measured_clear(&found);
  measured_clear(&known);
  return code;
}

/* ---- result ---- */

/* Write the means and largest values of all sets that are not empty. */
static int put_errors(const check *c, errors *sums, size_t sets,
                      opc_error *error) {
  double worst[EDA_CURRENTS] = {0};
  size_t n = 0;
  for (size_t s = 0; s < sets; s++) {
    errors e = sums[s];
    if (!e.count) continue;
    for (int k = 0; k < 2 * EDA_CURRENTS; k++) {
      e.mean[k] /= (double)e.count;
      if (s < TYPES && k >= EDA_CURRENTS) e.mean[k] = e.max[k] = (double)NAN;
      if (s < TYPES && k < EDA_CURRENTS) worst[k] = fmax(worst[k], e.max[k]);
    }
    sums[n++] = e;
  }
  const opc_column columns[] = {
      {"set", NULL, OPC_TEXT, 0, &sums->set},
      {"type", NULL, OPC_TEXT, 0, &sums->type},
      {"transistors", NULL, OPC_INT, 0, &sums->count},
      {"ion_mean", "%", OPC_REAL, 4, &sums->mean[0]},
      {"ion_max", "%", OPC_REAL, 4, &sums->max[0]},
      {"ioff_mean", "%", OPC_REAL, 4, &sums->mean[1]},
      {"ioff_max", "%", OPC_REAL, 4, &sums->max[1]},
      {"ion_change_mean", "%", OPC_REAL, 4, &sums->mean[2]},
      {"ion_change_max", "%", OPC_REAL, 4, &sums->max[2]},
      {"ioff_change_mean", "%", OPC_REAL, 4, &sums->mean[3]},
      {"ioff_change_max", "%", OPC_REAL, 4, &sums->max[3]},
  };
  const opc_metric_value values[] = {{"ion_max", worst[EDA_ION]},
                                     {"ioff_max", worst[EDA_IOFF]}};
  int code = opc_put_rows(c->host, "check", OPC_TABLE_PRINT, n, sizeof *sums,
                          OPC_ARRAY(columns), error);
  return code ? code : opc_put_metrics(c->host, OPC_ARRAY(values), error);
}

static int check_run(void *self, void **outputs, opc_error *error) {
  check *c = self;
  (void)outputs;
  errors sums[2 * TYPES] = {{.set = "rectangles", .type = "n"},
                            {.set = "rectangles", .type = "p"},
                            {.set = "printed", .type = "n"},
                            {.set = "printed", .type = "p"}};
  int code = eda_curves_read(&c->curves, c->path, error);
  if (!code && !c->curves.devices->narrow)
    code = opc_fail(error, OPC_INVALID, "devices",
                    "'%s' has one width, expected several", c->path);
  if (!code)
    code = eda_extractor_prepare(c->host->context, c->extractor, error);
  reference_init(&c->reference, &c->curves);
  const opc_module known = reference_module(&c->reference);
  if (!code) code = check_rectangles(c, &known, sums, error);
  if (!code && c->mask) code = check_printed(c, &known, sums + TYPES, error);
  return code ? code : put_errors(c, sums, 2 * TYPES, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(check, extractor, .type = OPC_SLOT, .choices = "extractor",
                  .flags = OPC_REQUIRED, .summary = "extractor to compare"),
    OPC_PARAMETER_NAMED("devices", check, path, .type = OPC_FILE,
                        .flags = OPC_REQUIRED,
                        .summary = "reference: device table of several widths"),
    OPC_PARAMETER_NAMED("length.from", check, from, .type = OPC_REAL,
                        .unit = "nm", .flags = OPC_AT_LEAST, .preset = "0 nm",
                        .min = 0, .summary = "shortest rectangle"),
    OPC_PARAMETER_NAMED("length.to", check, to, .type = OPC_REAL, .unit = "nm",
                        .flags = OPC_AT_LEAST, .preset = "1000000 nm", .min = 0,
                        .summary = "longest rectangle"),
    OPC_PARAMETER(check, mask, .type = OPC_INPUT, .choices = "mask",
                  .summary = "mask whose printed gates are also compared"),
};

static const opc_metric metrics[] = {
    {"ion_max", "%", OPC_LOWER, 0.01, "largest |error| of Ion of a rectangle"},
    {"ioff_max", "%", OPC_LOWER, 0.01,
     "largest |error| of Ioff of a rectangle"},
};

static void check_clear(void *self) {
  eda_curves_clear(&((check *)self)->curves);
}

/* ---- entry ---- */

static const opc_step functions = {.run = check_run};

OPC_PLUGIN(check, .id = "devices.check", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "compare an extractor with transistors of several widths",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .clear = check_clear, OPC_FUNCTIONS(functions));
