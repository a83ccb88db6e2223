/* SPDX-License-Identifier: BSD-3-Clause */
/* Sums up the slices of a gate, after thesis eq. 2.2 and 3.2. */
#include "slicer.h"

#include <eda/memory.h>
#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CONTOUR, GAUSS, EQUAL };

/* A gate is marked if more than this part of a current rests on how the device
   table goes on beyond its ends: what a third of a nm does to it. Within a few
   nm the change of Ion there is right to a tenth (docs/devices.md), so that
   less is an error of 0.1 % in Ion. */
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
  if (s->contour && contour_slice(s->contour, &s->curves, s->weight, s, gate, n,
                                  place, width))
    return;
  memcpy(place, s->place, n * sizeof *place);
  memcpy(width, s->width, n * sizeof *width);
}

static int within(const eda_curves *table, double length) {
  return length >= eda_curves_shortest(table) &&
         length <= eda_curves_longest(table);
}

/* How much of a current per width the table does not have: what going on beyond
   its end adds to that of the end, or takes from it. */
static double guessed(const eda_curves *table, int type, int c, double length,
                      double current) {
  if (within(table, length)) return 0;
  double low = eda_curves_shortest(table), high = eda_curves_longest(table);
  double end = eda_curves_at(table, type, c, length < low ? low : high);
  return fabs(current - exp(end));
}

/* The sums of eq. 2.2 and 3.2. An equivalent length is that of the rectangle of
   the same width and current whose slices have the same weights. */
static void extract_gate(const slicer *s, const eda_slices *in, size_t i,
                         eda_performance *out) {
  double current[EDA_CURRENTS] = {0}, weight[EDA_CURRENTS] = {0};
  double width = 0, area = 0, leq[EDA_CURRENTS] = {0};
  uint8_t outside = 0;
  size_t first = i * in->slices, last = first + in->slices;
  int type = in->type[i];
  for (size_t k = first; k < last; k++) {
    width += in->width[k];
    area += in->width[k] * in->length[k];
  }
  for (int c = 0; c < EDA_CURRENTS; c++) {
    double guess = 0;
    for (size_t k = first; k < last; k++) {
      double w = in->width[k];
      if (s->weight) w *= s->weight(s, type, c, in->edge[k], width);
      double one = exp(eda_curves_at(&s->curves, type, c, in->length[k]));
      current[c] += w * one;
      weight[c] += w;
      guess += w * guessed(&s->curves, type, c, in->length[k], one);
    }
    if (width > 0)
      leq[c] =
          eda_curves_length(&s->curves, type, c, log(current[c] / weight[c]));
    outside |= guess > notable[c] * current[c] || !within(&s->curves, leq[c]);
  }
  out->ion[i] = current[EDA_ION];
  out->ioff[i] = current[EDA_IOFF];
  out->leq_ion[i] = leq[EDA_ION];
  out->leq_ioff[i] = leq[EDA_IOFF];
  out->weq[i] = width;
  out->area[i] = area;
  if (out->outside) out->outside[i] = outside;
}

int slicer_extract(const void *self, const eda_slices *in, eda_performance *out,
                   opc_error *error) {
  (void)error;
  for (size_t i = 0; i < in->count; i++) extract_gate(self, in, i, out);
  return OPC_OK;
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
  /* Some of its rules are good to 1e-11. */
  for (size_t i = 0; i < n; i++) s->width[i] /= sum;
  gsl_integration_glfixed_table_free(t);
}

int slicer_check(void *self, opc_error *error) {
  slicer *s = self;
  if (s->rule == CONTOUR &&
      (s->slices < CONTOUR_LEAST || s->slices > CONTOUR_MOST))
    return opc_fail(error, OPC_INVALID, "slices",
                    "the rule 'contour' takes %d to %d slices, not %d",
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
