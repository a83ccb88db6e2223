/* SPDX-License-Identifier: BSD-3-Clause */
#include "slicer.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CONTOUR, GAUSS, EQUAL };

/* ---- work ---- */

int slicer_prepare(void *self, opc_error *error) {
  slicer *s = self;
  return curves_load(&s->curves, s->host, s->path, error);
}

size_t slicer_slicing(const void *self, const double **place,
                      const double **width) {
  const slicer *s = self;
  *place = s->place;
  *width = s->width;
  return s->slices;
}

void slicer_slice(const void *self, const opc_printed_gate *gate,
                  double *place, double *width) {
  const slicer *s = self;
  if (s->contour && contour_slice(s->contour, &s->curves, s->weight, s, gate,
                                  s->slices, place, width))
    return;
  memcpy(place, s->place, s->slices * sizeof *place);
  memcpy(width, s->width, s->slices * sizeof *width);
}

/* The sums of eq. 2.2 and 3.2. An equivalent length is that of the rectangle of
   the same width and current whose slices have the same weights. */
static void extract_gate(const slicer *s, const opc_slices *in, size_t i,
                         opc_performance *out) {
  double current[CURRENTS] = {0}, weight[CURRENTS] = {0};
  double width = 0, area = 0, leq[CURRENTS] = {0};
  size_t first = i * in->slices, last = first + in->slices;
  int type = in->type[i];
  for (size_t k = first; k < last; k++) {
    width += in->width[k];
    area += in->width[k] * in->length[k];
  }
  for (int c = 0; c < CURRENTS; c++) {
    for (size_t k = first; k < last; k++) {
      double w = in->width[k];
      if (s->weight) w *= s->weight(s, type, c, in->edge[k], width);
      current[c] += w * exp(curves_at(&s->curves, type, c, in->length[k]));
      weight[c] += w;
    }
    if (width > 0)
      leq[c] =
          curves_length(&s->curves, type, c, log(current[c] / weight[c]));
  }
  out->ion[i] = current[ION];
  out->ioff[i] = current[IOFF];
  out->leq_ion[i] = leq[ION];
  out->leq_ioff[i] = leq[IOFF];
  out->weq[i] = width;
  out->area[i] = area;
}

int slicer_extract(const void *self, const opc_slices *in,
                   opc_performance *out, opc_error *error) {
  (void)error;
  for (size_t i = 0; i < in->count; i++) extract_gate(self, in, i, out);
  return OPC_OK;
}

/* ---- parameters ---- */

static int place_slices(slicer *s, int64_t rule) {
  if (rule == EQUAL) {
    for (size_t i = 0; i < s->slices; i++) {
      s->place[i] = ((double)i + 0.5) / (double)s->slices;
      s->width[i] = 1 / (double)s->slices;
    }
    return 1;
  }
  gsl_integration_glfixed_table *t =
      gsl_integration_glfixed_table_alloc(s->slices);
  if (!t) return 0;
  double sum = 0;
  for (size_t i = 0; i < s->slices; i++) {
    gsl_integration_glfixed_point(0, 1, i, &s->place[i], &s->width[i], t);
    sum += s->width[i];
  }
  /* Some of its rules are good to 1e-11. */
  for (size_t i = 0; i < s->slices; i++) s->width[i] /= sum;
  gsl_integration_glfixed_table_free(t);
  return 1;
}

int slicer_make(slicer *s, const opc_host *host, const opc_value *values,
                opc_error *error) {
  int64_t n = values[SLICER_SLICES].integer, rule = values[SLICER_RULE].integer;
  s->host = host;
  s->path = values[SLICER_DEVICES].text;
  s->slices = (size_t)n;
  if (rule == CONTOUR && (n < CONTOUR_LEAST || n > CONTOUR_MOST)) {
    host->fail(host, error, OPC_INVALID, "slices",
               "the rule 'contour' takes %d to %d slices, not %d",
               CONTOUR_LEAST, CONTOUR_MOST, (int)n);
    return 0;
  }
  s->place = calloc(s->slices, sizeof *s->place);
  s->width = calloc(s->slices, sizeof *s->width);
  if (rule == CONTOUR) s->contour = contour_new();
  if (s->place && s->width && (s->contour || rule != CONTOUR) &&
      place_slices(s, rule))
    return 1;
  host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  return 0;
}

void slicer_clear(slicer *s) {
  curves_clear(&s->curves, s->host);
  contour_free(s->contour);
  free(s->place);
  free(s->width);
}
