/* SPDX-License-Identifier: BSD-3-Clause */
/* An extractor of a current of W / L. */
#include "compat.h"

static int prepare(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static size_t slicing(const void *self, const double **place,
                      const double **width) {
  static const double places[2] = {0.25, 0.75}, widths[2] = {0.5, 0.5};
  (void)self;
  *place = places;
  *width = widths;
  return 2;
}

static int extract(const void *self, const eda_slices *in, eda_performance *out,
                   opc_error *error) {
  size_t i;
  (void)self, (void)error;
  for (i = 0; i < in->count; i++) {
    double w = in->width[2 * i] + in->width[2 * i + 1];
    double l = (in->length[2 * i] + in->length[2 * i + 1]) / 2;
    out->ion[i] = l > 0 ? w / l * 1e-4 : 0;
    out->ioff[i] = out->ion[i] * 1e-5;
    out->leq_ion[i] = out->leq_ioff[i] = l;
    out->weq[i] = w;
    out->area[i] = w * l;
  }
  return OPC_OK;
}

static const eda_extractor functions = {
    .prepare = prepare, .slicing = slicing, .extract = extract};

COMPAT_PLAIN("compat.extractor", "extractor");
