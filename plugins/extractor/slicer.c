/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the sum over slices of a gate (thesis eq. 2.2 and 3.2). */
#include "slicer.h"

#include <eda/memory.h>
#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "edges.h"

enum { CONTOUR, GAUSS, EQUAL };

/* Extrapolated part of a current, divided by the current, above which a gate is
   marked: the effect of 1/3 nm of length. Within a few nm, the error of Ion is
   a tenth of the extrapolated part (docs/reference/devices.md), so an unmarked
   gate has an error below 0.1 % of Ion. */
static const double notable[EDA_CURRENTS] = {
    [EDA_ION] = 0.01, [EDA_IOFF] = 0.1};

/* ---- work ---- */

int slicer_prepare(void *self, opc_error *error) {
  slicer *s = self;
  return eda_curves_read(&s->curves, s->path, error);
}

int slicer_range(const void *self, int type, double *shortest,
                 double *longest) {
  const slicer *s = self;
  (void)type;
  *shortest = eda_curves_shortest(&s->curves);
  *longest = eda_curves_longest(&s->curves);
  return 1;
}

double slicer_modelled(const void *self, int type, const char *flavour) {
  const slicer *s = self;
  const eda_curves *curves = eda_curves_of(&s->curves, flavour);
  return curves ? eda_curves_modelled(curves, type) : 0;
}

size_t slicer_slicing(const void *self, const double **place,
                      const double **width) {
  const slicer *s = self;
  *place = s->place;
  *width = s->width;
  return (size_t)s->slices;
}

void slicer_slice(const void *self, const eda_printed_gate *gate, double *place,
                  double *width) {
  const slicer *s = self;
  size_t n = (size_t)s->slices;
  const eda_curves *curves = eda_curves_of(&s->curves, gate->flavour);
  if (!curves)
    curves = &s->curves; /* slicer_extract reports a missing table as
                            an error */
  if (s->contour && contour_slice(s->contour, curves, s->reach, s->weight, s,
                                  gate, n, place, width))
    return;
  memcpy(place, s->place, n * sizeof *place);
  memcpy(width, s->width, n * sizeof *width);
}

static int length_within(const eda_curves *table, double length) {
  return length >= eda_curves_shortest(table) &&
         length <= eda_curves_longest(table);
}

/* Return the extrapolated part of a current per width: |difference| from the
   current at the end of the table; 0 for lengths within the table. */
static double current_extrapolated(const eda_curves *table, int type, int c,
                                   double length, double current) {
  if (length_within(table, length)) return 0;
  double low = eda_curves_shortest(table), high = eda_curves_longest(table);
  double end = eda_curves_at(table, type, c, length < low ? low : high);
  return fabs(current - exp(end));
}

/* Slices of a gate. */
typedef struct strips {
  const slicer *slicer;
  const eda_curves *curves; /* curves of the gate's flavour */
  int type;
  size_t count;
  const double *width, *length, *edge; /* one value per slice */
  double sum, area;                    /* sum of the widths, nm; area of the
                                          gate, nm^2 */
  edges edges;
} strips;

/* Return the factor that scales the mean of the edge shares to 1. */
static double edges_scale(const strips *g, int c) {
  double sum = 0;
  for (size_t k = 0; k < g->count; k++)
    sum += g->width[k] * edges_share(&g->edges, c, g->edge[k]);
  return g->sum / sum;
}

/* Return the current of slice k per width. `part`: result of edges_scale;
   `wide`: current per width of a wide transistor of equal length. */
static double current_at(const strips *g, int c, size_t k, double part,
                         double wide) {
  if (g->edges.width.is_wide) return wide;
  double narrow = exp(eda_curves_narrow_at(g->curves, g->type, c, g->length[k],
                                           &g->edges.width));
  return wide + (narrow - wide) * part * edges_share(&g->edges, c, g->edge[k]);
}

/* Compute one current of a gate, and its equivalent length: the length of a
   rectangle of equal width, current and weights (eq. 2.2 and 3.2). Return 1 if
   the extrapolated part exceeds `notable`. */
static int extract_current(const strips *g, int c, double *current,
                           double *leq) {
  const slicer *s = g->slicer;
  double sum = 0, weight = 0, guess = 0;
  double part = g->edges.width.is_wide ? 1 : edges_scale(g, c);
  for (size_t k = 0; k < g->count; k++) {
    double w = g->width[k];
    if (s->weight) w *= s->weight(s, g->type, c, g->edge[k], g->sum);
    double one = exp(eda_curves_at(g->curves, g->type, c, g->length[k]));
    sum += w * current_at(g, c, k, part, one);
    weight += w;
    guess += w * current_extrapolated(g->curves, g->type, c, g->length[k], one);
  }
  *current = sum;
  *leq = 0;
  if (g->sum > 0)
    *leq = eda_curves_narrow_length(g->curves, g->type, c, log(sum / weight),
                                    &g->edges.width, g->area / g->sum);
  return guess > notable[c] * sum || !length_within(g->curves, *leq);
}

static int extract_gate(const slicer *s, const eda_slices *in, size_t i,
                        eda_performance *out, opc_error *error) {
  size_t first = i * in->slices;
  const char *flavour = in->flavour ? in->flavour[i] : NULL;
  strips g = {.slicer = s,
              .curves = eda_curves_of(&s->curves, flavour),
              .type = in->type[i],
              .count = in->slices,
              .width = in->width + first,
              .length = in->length + first,
              .edge = in->edge + first};
  if (!g.curves)
    return opc_fail(error, OPC_INVALID, "devices",
                    "'%s' has no table of flavour '%.100s', required by "
                    "transistors of the layout",
                    s->path, flavour);
  for (size_t k = 0; k < g.count; k++) {
    g.sum += g.width[k];
    g.area += g.width[k] * g.length[k];
  }
  g.edges = edges_of(g.curves, g.type, g.sum, s->reach);
  uint8_t outside = eda_curves_narrowest(g.curves) > g.sum;
  outside |= extract_current(&g, EDA_ION, &out->ion[i], &out->leq_ion[i]);
  outside |= extract_current(&g, EDA_IOFF, &out->ioff[i], &out->leq_ioff[i]);
  out->weq[i] = g.sum;
  out->area[i] = g.area;
  if (out->outside) out->outside[i] = outside;
  return OPC_OK;
}

int slicer_extract(const void *self, const eda_slices *in, eda_performance *out,
                   opc_error *error) {
  int code = OPC_OK;
  for (size_t i = 0; i < in->count && !code; i++)
    code = extract_gate(self, in, i, out, error);
  return code;
}

/* ---- parameters ---- */

static void place_slices(slicer *s) {
  size_t n = (size_t)s->slices;
  if (s->rule == EQUAL) {
    for (size_t i = 0; i < n; i++) {
      s->place[i] = ((double)i + 0.5) / (double)n;
      s->width[i] = 1 / (double)n;
    }
    return;
  }
  gsl_integration_glfixed_table *t = gsl_integration_glfixed_table_alloc(n);
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    gsl_integration_glfixed_point(0, 1, i, &s->place[i], &s->width[i], t);
    sum += s->width[i];
  }
  /* GSL's weights are accurate only to 1e-11 for some n, so normalise their
     sum. */
  for (size_t i = 0; i < n; i++) s->width[i] /= sum;
  gsl_integration_glfixed_table_free(t);
}

int slicer_check(void *self, opc_error *error) {
  slicer *s = self;
  if (s->rule == CONTOUR &&
      (s->slices < CONTOUR_LEAST || s->slices > CONTOUR_MOST))
    return opc_fail(error, OPC_INVALID, "slices",
                    "the rule 'contour' requires %d to %d slices, found %d",
                    CONTOUR_LEAST, CONTOUR_MOST, (int)s->slices);
  s->place = eda_alloc((size_t)s->slices, sizeof *s->place);
  s->width = eda_alloc((size_t)s->slices, sizeof *s->width);
  if (s->rule == CONTOUR) s->contour = contour_new();
  place_slices(s);
  return OPC_OK;
}

void slicer_clear(void *self) {
  slicer *s = self;
  eda_curves_clear(&s->curves);
  contour_free(s->contour);
  free(s->place);
  free(s->width);
}
