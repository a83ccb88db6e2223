/* SPDX-License-Identifier: BSD-3-Clause */
/* litho.hopkins: scalar partially coherent imaging by Hopkins' transmission
   cross coefficient, T(f1, f2) (H. H. Hopkins, Proc. R. Soc. A 217, 1953), for
   a circular source in focus.

   T depends on |f1|, |f2| and the angle between them only. So its
   eigenfunctions are R(|f|) exp(i m angle), found for each order m from a small
   symmetric matrix over the radius; they serve fields of every size. */
#include "disks.h"

#include <opcflow/litho.h>

#include <gsl/gsl_integration.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum {
  INNER = 8,        /* radial nodes where the whole source passes the pupil */
  OUTER = 56,       /* and from there to where none of it does */
  NODES = INNER + OUTER,
  ANGLES = 192,     /* of the integral over half a turn */
  ORDERS = 32,      /* angular orders that are looked at */
  TABLE = 2048      /* intervals of a radial function's table */
};

/* A coherent system: the orders +m and -m of one radial function, or two
   radial functions of order 0 in real and imaginary part. Both halves have
   the same square since the mask is real. */
typedef struct coherent {
  int order;
  float *re, *im;    /* TABLE + 2 values each; im may be NULL */
  double weight;
} coherent;

typedef struct hopkins {
  const opc_host *host;
  double wavelength, na, sigma;   /* nm, 1, 1 */
  size_t wanted;
  double cutoff;                  /* NA / wavelength */
  double node[NODES], weight[NODES];   /* radius, in units of the cutoff */
  coherent *systems;
  double *weights;
  size_t count;
  double captured;                /* of the trace of T */
} hopkins;

/* ---- work: kernels ---- */

/* Gauss-Legendre nodes on [0, 1 - sigma], where T does not change, and on
   [1 - sigma, 1 + sigma]. */
static int place_nodes(hopkins *h) {
  gsl_integration_glfixed_table *inner =
      gsl_integration_glfixed_table_alloc(INNER);
  gsl_integration_glfixed_table *outer =
      gsl_integration_glfixed_table_alloc(OUTER);
  int ok = inner && outer;
  for (size_t i = 0; ok && i < INNER; i++)
    gsl_integration_glfixed_point(0, 1 - h->sigma, i, &h->node[i],
                                  &h->weight[i], inner);
  for (size_t i = 0; ok && i < OUTER; i++)
    gsl_integration_glfixed_point(1 - h->sigma, 1 + h->sigma, i,
                                  &h->node[INNER + i], &h->weight[INNER + i],
                                  outer);
  gsl_integration_glfixed_table_free(inner);
  gsl_integration_glfixed_table_free(outer);
  return ok;
}

typedef struct expansion {
  const hopkins *h;
  double cosine[ANGLES][ORDERS];   /* cos(m angle) */
  double *matrix;                  /* [ORDERS][NODES][NODES] */
} expansion;

static double angle_of(int a) { return M_PI * (a + 0.5) / ANGLES; }

/* Row i of all matrices: sqrt(w_i r_i) T_m(r_i, r_j) sqrt(w_j r_j), T_m the
   Fourier coefficients of T over the angle. */
static void expand_row(void *data, size_t i) {
  const expansion *e = data;
  const hopkins *h = e->h;
  for (size_t j = 0; j <= i; j++) {
    double sum[ORDERS] = {0};
    for (int a = 0; a < ANGLES; a++) {
      double t =
          opc_common_area(h->sigma, h->node[i], h->node[j], angle_of(a));
      if (t <= 0) continue;
      for (int m = 0; m < ORDERS; m++) sum[m] += t * e->cosine[a][m];
    }
    double scale = sqrt(h->weight[i] * h->node[i] * h->weight[j] * h->node[j]) /
                   (ANGLES * M_PI * h->sigma * h->sigma);
    for (int m = 0; m < ORDERS; m++) {
      double *a = e->matrix + (size_t)m * NODES * NODES;
      a[i * NODES + j] = a[j * NODES + i] = sum[m] * scale;
    }
  }
}

/* The value at r of the polynomial through f at the nodes of r's interval
   (barycentric Lagrange, Berrut and Trefethen 2004). */
static double interpolate(const hopkins *h, const double *f, double r) {
  int first = r < 1 - h->sigma ? 0 : INNER;
  int n = first ? OUTER : INNER;
  double above = 0, below = 0;
  double a = first ? 1 - h->sigma : 0, b = first ? 1 + h->sigma : 1 - h->sigma;
  for (int k = 0; k < n; k++) {
    double x = h->node[first + k], w = h->weight[first + k];
    if (r == x) return f[first + k];
    double c = (k % 2 ? -1 : 1) * sqrt(w * (x - a) * (b - x)) / (r - x);
    above += c * f[first + k];
    below += c;
  }
  return above / below;
}

/* The radial function of an eigenvector, as a table from 0 to 1 + sigma. */
static float *tabulate(const hopkins *h, const double *vector, double scale) {
  double f[NODES];
  for (int i = 0; i < NODES; i++)
    f[i] = scale * vector[i] / sqrt(h->weight[i] * h->node[i]);
  float *table = malloc((TABLE + 2) * sizeof *table);
  for (int i = 0; table && i < TABLE + 2; i++)
    table[i] = (float)interpolate(
        h, f, fmin((1 + h->sigma) * i / TABLE, 1 + h->sigma));
  return table;
}

typedef struct candidate {
  double value;      /* eigenvalue */
  int order, index;
} candidate;

static int by_value(const void *a, const void *b) {
  double x = ((const candidate *)a)->value, y = ((const candidate *)b)->value;
  return (x < y) - (x > y);
}

/* Take the strongest eigenfunctions until `wanted` systems are full. vectors:
   [order][index][node]. */
static int choose(hopkins *h, candidate *c, size_t n, const double *vectors) {
  qsort(c, n, sizeof *c, by_value);
  double trace = 0, kept = 0;
  for (size_t i = 0; i < n; i++)
    trace += (c[i].order ? 2 : 1) * fmax(c[i].value, 0);
  coherent *open = NULL;   /* of order 0, with room for another one */
  for (size_t i = 0; i < n && c[i].value > 1e-9 * c[0].value; i++) {
    if (h->count == h->wanted && (c[i].order || !open)) break;
    const double *v =
        vectors + ((size_t)c[i].order * NODES + (size_t)c[i].index) * NODES;
    float *table = tabulate(h, v, c[i].order ? 1 : sqrt(c[i].value));
    if (!table) return 0;
    kept += (c[i].order ? 2 : 1) * c[i].value;
    if (!c[i].order && open) {
      open->im = table;
      open = NULL;
      continue;
    }
    coherent *s = &h->systems[h->count];
    *s = (coherent){.order = c[i].order, .re = table,
                    .weight = c[i].order ? 2 * c[i].value : 1};
    if (!c[i].order) open = s;
    h->weights[h->count++] = s->weight;
  }
  h->captured = kept / trace;
  return 1;
}

static int prepare(void *self, opc_error *error) {
  hopkins *h = self;
  if (h->count) return OPC_OK;
  const size_t n = (size_t)ORDERS * NODES;
  expansion e = {.h = h, .matrix = malloc(n * NODES * sizeof(double))};
  candidate *c = malloc(n * sizeof *c);
  int code = OPC_OK;
  h->systems = calloc(h->wanted, sizeof *h->systems);
  h->weights = calloc(h->wanted, sizeof *h->weights);
  if (!e.matrix || !c || !h->systems || !h->weights || !place_nodes(h)) {
    code = h->host->fail(h->host, error, OPC_FAILED, NULL, "out of memory");
    goto done;
  }
  for (int a = 0; a < ANGLES; a++)
    for (int m = 0; m < ORDERS; m++) e.cosine[a][m] = cos(m * angle_of(a));
  h->host->parallel(h->host, NODES, expand_row, &e);
  for (int m = 0; m < ORDERS; m++) {
    double value[NODES];
    double *a = e.matrix + (size_t)m * NODES * NODES;
    if (LAPACKE_dsyev(LAPACK_COL_MAJOR, 'V', 'U', NODES, a, NODES, value)) {
      code = h->host->fail(h->host, error, OPC_FAILED, NULL,
                           "no eigenvalues of angular order %d", m);
      goto done;
    }
    for (int i = 0; i < NODES; i++)
      c[m * NODES + i] = (candidate){value[i], m, i};
  }
  if (!choose(h, c, n, e.matrix))
    code = h->host->fail(h->host, error, OPC_FAILED, NULL, "out of memory");
done:
  free(e.matrix);
  free(c);
  return code;
}

/* ---- work: images ---- */

static double band(const void *self) {
  const hopkins *h = self;
  return (1 + h->sigma) * h->cutoff;
}

static float look_up(const float *table, float place) {
  int i = (int)place;
  float t = place - (float)i;
  return table[i] + t * (table[i + 1] - table[i]);
}

static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  const hopkins *h = self;
  const coherent *c = &h->systems[s];
  double scale = TABLE / band(h);
  for (size_t i = 0; i < n; i++) {
    double r = sqrt(fx[i] * fx[i] + fy * fy);
    float place = (float)fmin(r * scale, TABLE);
    float re = look_up(c->re, place), im = 0;
    if (c->im) im = look_up(c->im, place);
    if (c->order) {
      /* times exp(i order angle), by repeated multiplication */
      float zx = r > 0 ? (float)(fx[i] / r) : 0, zy = r > 0 ? (float)(fy / r) : 0;
      for (int m = 0; m < c->order; m++) {
        float x = re * zx - im * zy;
        im = re * zy + im * zx;
        re = x;
      }
    }
    out[2 * i] = re;
    out[2 * i + 1] = im;
  }
}

static int image(const void *self, int layer, const opc_spectrum *mask,
                 opc_field *out, opc_error *error) {
  const hopkins *h = self;
  (void)layer;   /* all are exposed alike */
  opc_systems systems = {.size = sizeof systems,
                         .count = h->count,
                         .weight = h->weights,
                         .band = band(h),
                         .intensity_band = 2 * h->cutoff,
                         .transfer = transfer,
                         .self = h};
  return h->host->imaging->coherent_sum(h->host, mask, &systems, 0, out, error);
}

/* ---- parameters ---- */

enum { WAVELENGTH, NA, SIGMA, KERNELS, PARAMETERS };

static const opc_parameter parameters[PARAMETERS] = {
    [WAVELENGTH] = {.name = "wavelength", .type = OPC_REAL,
                    .flags = OPC_ABOVE, .unit = "nm", .preset = "193 nm",
                    .summary = "wavelength of the light"},
    [NA] = {.name = "na", .type = OPC_REAL, .flags = OPC_ABOVE | OPC_BELOW,
            .preset = "0.75", .min = 0, .max = 1,
            .summary = "numerical aperture, in air"},
    [SIGMA] = {.name = "sigma", .type = OPC_REAL,
               .flags = OPC_AT_LEAST | OPC_BELOW, .preset = "0.75",
               .min = 0.05, .max = 1,
               .summary = "radius of the circular source over that of the pupil"},
    [KERNELS] = {.name = "kernels", .type = OPC_INT,
                 .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "24", .min = 1,
                 .max = 600,
                 .summary = "coherent systems, one Fourier transform each"},
};

static void destroy(void *self) {
  hopkins *h = self;
  for (size_t i = 0; i < h->count; i++) {
    free(h->systems[i].re);
    free(h->systems[i].im);
  }
  free(h->systems);
  free(h->weights);
  free(h);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  hopkins *h = calloc(1, sizeof *h);
  if (!h) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  h->host = host;
  h->wavelength = values[WAVELENGTH].real;
  h->na = values[NA].real;
  h->sigma = values[SIGMA].real;
  h->wanted = (size_t)values[KERNELS].integer;
  h->cutoff = h->na / h->wavelength;
  return h;
}

/* ---- entry ---- */

static const opc_litho operations = {.size = sizeof operations,
                                     .prepare = prepare,
                                     .band = band,
                                     .image = image};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "litho.hopkins",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "partially coherent imaging by Hopkins kernels, circular source",
      .kind = OPC_KIND_LITHO,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
