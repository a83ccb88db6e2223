/* SPDX-License-Identifier: BSD-3-Clause */
/* A litho model: a plain blur of the amplitude of the mask. */
#include "compat.h"

static const double blur = 25, band_limit = 0.02; /* nm, 1/nm */

static int prepare(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static double band(const void *self) {
  (void)self;
  return band_limit;
}

static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  const double f = 3.14159265358979323846 * blur;
  size_t i;
  (void)self, (void)s;
  for (i = 0; i < n; i++) {
    out[2 * i] = (float)exp(-2 * f * f * (fx[i] * fx[i] + fy * fy));
    out[2 * i + 1] = 0;
  }
}

static int image(const void *self, int layer, const eda_spectrum *mask,
                 eda_field *out, opc_error *error) {
  const double one = 1;
  const eda_systems systems = {.count = 1,
                               .weight = &one,
                               .band = band_limit,
                               .intensity_band = 2 * band_limit,
                               .transfer = transfer,
                               .scale = {1, 0}};
  (void)layer;
  return eda_coherent_sum(((const plain *)self)->host->context, mask, &systems,
                          0, out, error);
}

static const eda_litho functions = {
    .prepare = prepare, .band = band, .image = image};

COMPAT_PLAIN("compat.litho", "litho");
