/* SPDX-License-Identifier: BSD-3-Clause */
/* Sums up the slices of a gate, after thesis eq. 2.2 and 3.2. */
#include "slicer.h"

#include <eda/memory.h>
#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CONTOUR, GAUSS, EQUAL };

/* ---- work ---- */

int slicer_prepare(void *self, opc_error *error) {
  slicer *s = self;
  return eda_curves_read(&s->curves, s->path, error);
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

/* The sums of eq. 2.2 and 3.2. An equivalent length is that of the rectangle of
   the same width and current whose slices have the same weights. */
static void extract_gate(const slicer *s, const eda_slices *in, size_t i,
                         eda_performance *out) {
  double current[EDA_CURRENTS] = {0}, weight[EDA_CURRENTS] = {0};
  double width = 0, area = 0, leq[EDA_CURRENTS] = {0};
  size_t first = i * in->slices, last = first + in->slices;
  int type = in->type[i];
  for (size_t k = first; k < last; k++) {
    width += in->width[k];
    area += in->width[k] * in->length[k];
  }
  for (int c = 0; c < EDA_CURRENTS; c++) {
    for (size_t k = first; k < last; k++) {
      double w = in->width[k];
      if (s->weight) w *= s->weight(s, type, c, in->edge[k], width);
      current[c] += w * exp(eda_curves_at(&s->curves, type, c, in->length[k]));
      weight[c] += w;
    }
    if (width > 0)
      leq[c] =
          eda_curves_length(&s->curves, type, c, log(current[c] / weight[c]));
  }
  out->ion[i] = current[EDA_ION];
  out->ioff[i] = current[EDA_IOFF];
  out->leq_ion[i] = leq[EDA_ION];
  out->leq_ioff[i] = leq[EDA_IOFF];
  out->weq[i] = width;
  out->area[i] = area;
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
