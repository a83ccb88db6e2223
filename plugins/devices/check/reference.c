/* SPDX-License-Identifier: BSD-3-Clause */
/* The currents of the reference: a channel between two strips without current
   at the edges of the active. */
#include "reference.h"

#include <math.h>

enum { SLICES = REFERENCE_SLICES };

static int reference_prepare(void *self, opc_error *error) {
  (void)self;
  (void)error;
  return OPC_OK;
}

static size_t reference_slicing(const void *self, const double **place,
                                const double **width) {
  const reference *r = self;
  *place = r->place;
  *width = r->share;
  return SLICES;
}

/* Return the part of slice k, from 0 to 1 of its width, that is in the channel.
   `strip`: width of the strip without current, in slices. */
static double slice_part(size_t k, double strip) {
  double from_edge = (double)(k < SLICES / 2 ? k : SLICES - 1 - k);
  if (strip < 0) return from_edge < 1 ? 1 - strip : 1;
  return fmin(1, fmax(0, from_edge + 1 - strip));
}

/* Compute one current of a gate, A, from its slices: widths, lengths. */
static double gate_current(const eda_curves *c, int type, int current,
                           const double *width, const double *length) {
  double whole = 0, area = 0, sum = 0;
  for (size_t k = 0; k < SLICES; k++) {
    whole += width[k];
    area += width[k] * length[k];
  }
  if (!(whole > 0)) return 0;
  eda_curves_width narrow = eda_curves_among(c, whole);
  double mean = area / whole;
  double share = exp(eda_curves_narrow_at(c, type, current, mean, &narrow) -
                     eda_curves_at(c, type, current, mean));
  double strip = (1 - share) * SLICES / 2;
  for (size_t k = 0; k < SLICES; k++)
    sum += width[k] * slice_part(k, strip) *
           exp(eda_curves_at(c, type, current, length[k]));
  return sum;
}

static int reference_extract(const void *self, const eda_slices *in,
                             eda_performance *out, opc_error *error) {
  const eda_curves *c = ((const reference *)self)->curves;
  (void)error;
  for (size_t i = 0; i < in->count; i++) {
    const double *width = in->width + i * SLICES;
    const double *length = in->length + i * SLICES;
    double area = 0, sum = 0;
    for (size_t k = 0; k < SLICES; k++) {
      sum += width[k];
      area += width[k] * length[k];
    }
    out->ion[i] = gate_current(c, in->type[i], EDA_ION, width, length);
    out->ioff[i] = gate_current(c, in->type[i], EDA_IOFF, width, length);
    out->leq_ion[i] = out->leq_ioff[i] = sum > 0 ? area / sum : 0;
    out->weq[i] = sum;
    out->area[i] = area;
    if (out->outside) out->outside[i] = 0;
  }
  return OPC_OK;
}

void reference_init(reference *r, const eda_curves *curves) {
  r->curves = curves;
  for (size_t k = 0; k < SLICES; k++) {
    r->place[k] = ((double)k + 0.5) / SLICES;
    r->share[k] = 1.0 / SLICES;
  }
}

opc_module reference_module(reference *r) {
  static const eda_extractor functions = {.prepare = reference_prepare,
                                          .slicing = reference_slicing,
                                          .extract = reference_extract};
  return (opc_module){&functions, r, "devices.check"};
}
