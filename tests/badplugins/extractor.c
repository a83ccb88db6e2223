/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty extractor, with currents proportional to W / L. */
#include "bad.h"

#include <sched.h>

static int bad_prepare(void *self, opc_error *error) {
  evil("prepare");
  (void)self, (void)error;
  return OPC_OK;
}

static size_t bad_slicing(const void *self, const double **place,
                          const double **width) {
  static const double places[2][2] = {{0.25, 0.75}, {0.75, 0.25}};
  static const double widths[2][2] = {{0.5, 0.5}, {0.5, 0.4}};
  (void)self;
  evil("slicing");
  *place = places[fault_is("order")];
  *width = widths[fault_is("sum")];
  return fault_is("slices") ? 0 : 2;
}

/* Return the length of a gate. The fault "scratch" uses static memory that all
   callers share, for up to 64 gates. */
static double length_of(const eda_slices *in, size_t gate) {
  static volatile double scratch[64];
  const double *l = in->length;
  for (size_t i = 0; i < in->count && i < 64; i++)
    scratch[i] = (l[2 * i] + l[2 * i + 1]) / 2;
  if (!fault_is("scratch")) return (l[2 * gate] + l[2 * gate + 1]) / 2;
  sched_yield(); /* provoke a race */
  return scratch[gate % 64];
}

static int bad_extract(const void *self, const eda_slices *in,
                       eda_performance *out, opc_error *error) {
  (void)self, (void)error;
  evil("extract");
  for (size_t i = 0; i < in->count; i++) {
    double w = in->width[2 * i] + in->width[2 * i + 1];
    double l = length_of(in, i);
    out->ion[i] = l > 0 ? w / l * 1e-4 : 0;
    if (fault_is("milli")) out->ion[i] *= 1e3;
    if (fault_is("narrow") && l > 0) out->ion[i] = 2e-6;
    out->ioff[i] = out->ion[i] * 1e-5;
    out->leq_ion[i] = out->leq_ioff[i] = l;
    out->weq[i] = w;
    out->area[i] = w * l;
  }
  if (fault_is("nan") && in->count > 1) out->ioff[1] = NAN;
  if (fault_is("overrun")) out->area[in->count] = 1;
  if (fault_is("underrun")) out->ion[-1] = 1;
  WRITE_AFAR(out->area, in->count);
  if (fault_is("negative")) out->ion[0] = -1;
  return fault_apply();
}

static const eda_extractor functions = {
    .prepare = bad_prepare, .slicing = bad_slicing, .extract = bad_extract};

BAD_PLUGIN("extractor", functions);
