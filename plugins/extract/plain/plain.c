/* SPDX-License-Identifier: BSD-3-Clause */
/* extract.plain: a printed gate as slices in parallel, each with the current of
   a wide transistor of its length (thesis eq. 2.1 to 2.4, after Poppe et al.,
   "From poly line to transistor", SPIE 6156, 2006). */
#include <opcflow/extract.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_interp.h>
#include <math.h>
#include <stdlib.h>

/* ---- state ---- */

enum { ION, IOFF, CURRENTS };
enum { GAUSS, EQUAL };

typedef struct plain {
  const opc_host *host;
  const char *path;
  size_t slices;
  double *place, *width;
  opc_devices *devices;
  double *logarithm[2][CURRENTS];     /* of the currents, [type][current] */
  gsl_interp *curve[2][CURRENTS];     /* of these, against length */
} plain;

/* ---- work ---- */

/* Steffen's interpolation: cubic, and monotone where the table is. */
static int prepare(void *self, opc_error *error) {
  plain *p = self;
  if (p->devices) return OPC_OK;
  gsl_set_error_handler_off();   /* its default aborts */
  opc_devices *d = p->host->devices->load(p->host, p->path, error);
  if (!d) return error->code;
  p->devices = d;
  if (d->count < gsl_interp_type_min_size(gsl_interp_steffen))
    return p->host->fail(p->host, error, OPC_INVALID, "devices",
                         "'%s' has %zu lengths, at least %u are needed",
                         p->path, d->count,
                         gsl_interp_type_min_size(gsl_interp_steffen));
  for (int type = 0; type < 2; type++)
    for (int c = 0; c < CURRENTS; c++) {
      const double *current = c == ION ? d->ion[type] : d->ioff[type];
      double *y = malloc(d->count * sizeof *y);
      gsl_interp *curve = gsl_interp_alloc(gsl_interp_steffen, d->count);
      p->logarithm[type][c] = y;
      p->curve[type][c] = curve;
      if (!y || !curve)
        return p->host->fail(p->host, error, OPC_FAILED, NULL, "out of memory");
      for (size_t i = 0; i < d->count; i++) {
        if (i && !(current[i] < current[i - 1]))
          return p->host->fail(
              p->host, error, OPC_INVALID, "devices",
              "'%s': a current does not fall from %g to %g nm, so that it "
              "tells no length",
              p->path, d->length[i - 1], d->length[i]);
        y[i] = log(current[i]);
      }
      gsl_interp_init(curve, d->length, y, d->count);
    }
  return OPC_OK;
}

/* log of the current per width of a wide transistor; beyond the table, that of
   its end. */
static double curve_at(const plain *p, int type, int c, double length) {
  const opc_devices *d = p->devices;
  length = fmin(fmax(length, d->length[0]), d->length[d->count - 1]);
  return gsl_interp_eval(p->curve[type][c], d->length, p->logarithm[type][c],
                         length, NULL);
}

/* The length whose current per width has that logarithm; the curves fall. */
static double length_of(const plain *p, int type, int c, double logarithm) {
  const opc_devices *d = p->devices;
  const double *y = p->logarithm[type][c];
  size_t low = 0, high = d->count - 1;
  if (!(logarithm < y[0])) return d->length[0];
  if (!(logarithm > y[high])) return d->length[high];
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (y[middle] > logarithm) low = middle;
    else high = middle;
  }
  double a = d->length[low], b = d->length[high];
  double fa = y[low] - logarithm, fb = y[high] - logarithm;
  double x = a;
  /* Regula falsi, Illinois variant. */
  for (int i = 0; i < 60; i++) {
    x = (a * fb - b * fa) / (fb - fa);
    double f = curve_at(p, type, c, x) - logarithm;
    if (fabs(f) < 1e-13) break;
    if ((f > 0) == (fb > 0)) fa /= 2;
    else a = b, fa = fb;
    b = x;
    fb = f;
  }
  return x;
}

static size_t slicing(const void *self, const double **place,
                      const double **width) {
  const plain *p = self;
  *place = p->place;
  *width = p->width;
  return p->slices;
}

static int extract(const void *self, const opc_slices *in,
                   opc_performance *out, opc_error *error) {
  const plain *p = self;
  (void)error;
  for (size_t i = 0; i < in->count; i++) {
    double current[CURRENTS] = {0}, width = 0, area = 0;
    int type = in->type[i];
    for (size_t s = i * in->slices; s < (i + 1) * in->slices; s++) {
      double w = in->width[s], length = in->length[s];
      for (int c = 0; c < CURRENTS; c++)
        current[c] += w * exp(curve_at(p, type, c, length));
      width += w;
      area += w * length;
    }
    out->ion[i] = current[ION];
    out->ioff[i] = current[IOFF];
    out->weq[i] = width;
    out->area[i] = area;
    out->leq_ion[i] =
        width > 0 ? length_of(p, type, ION, log(current[ION] / width)) : 0;
    out->leq_ioff[i] =
        width > 0 ? length_of(p, type, IOFF, log(current[IOFF] / width)) : 0;
  }
  return OPC_OK;
}

/* ---- parameters ---- */

enum { DEVICES, SLICES, RULE, PARAMETERS };

static const opc_parameter parameters[PARAMETERS] = {
    [DEVICES] = {.name = "devices", .type = OPC_FILE, .flags = OPC_REQUIRED,
                 .summary = "device table: currents against length"},
    [SLICES] = {.name = "slices", .type = OPC_INT,
                .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "12",
                .min = 1, .max = 10000,
                .summary = "slices across the width of a gate"},
    [RULE] = {.name = "rule", .type = OPC_CHOICE, .preset = "gauss",
              .choices = "gauss|equal",
              .summary = "slices at Gauss-Legendre nodes or of equal width"},
};

static void destroy(void *self) {
  plain *p = self;
  for (int type = 0; type < 2; type++)
    for (int c = 0; c < CURRENTS; c++) {
      if (p->curve[type][c]) gsl_interp_free(p->curve[type][c]);
      free(p->logarithm[type][c]);
    }
  if (p->devices) p->host->devices->release(p->devices);
  free(p->place);
  free(p->width);
  free(p);
}

static int place_slices(plain *p, int64_t rule) {
  if (rule == EQUAL) {
    for (size_t i = 0; i < p->slices; i++) {
      p->place[i] = ((double)i + 0.5) / (double)p->slices;
      p->width[i] = 1 / (double)p->slices;
    }
    return 1;
  }
  gsl_integration_glfixed_table *t =
      gsl_integration_glfixed_table_alloc(p->slices);
  if (!t) return 0;
  for (size_t i = 0; i < p->slices; i++)
    gsl_integration_glfixed_point(0, 1, i, &p->place[i], &p->width[i], t);
  gsl_integration_glfixed_table_free(t);
  return 1;
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  plain *p = calloc(1, sizeof *p);
  if (!p) goto memory;
  p->host = host;
  p->path = values[DEVICES].text;
  p->slices = (size_t)values[SLICES].integer;
  p->place = calloc(p->slices, sizeof *p->place);
  p->width = calloc(p->slices, sizeof *p->width);
  if (!p->place || !p->width || !place_slices(p, values[RULE].integer))
    goto memory;
  return p;
memory:
  host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  if (p) destroy(p);
  return NULL;
}

/* ---- entry ---- */

static const opc_extract operations = {.size = sizeof operations,
                                       .prepare = prepare,
                                       .slicing = slicing,
                                       .extract = extract};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "extract.plain",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "plain gate slicing: slices in parallel, each of its length",
      .kind = OPC_KIND_EXTRACT,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
