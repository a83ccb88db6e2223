/* SPDX-License-Identifier: BSD-3-Clause */
/* compat.litho: one coherent system that lets low frequencies through. */
#include "compat.h"

enum { CUT, PARAMETERS };

static int prepare(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static double band(const void *self) {
  const compat *c = self;
  return 4 / c->values[CUT].real;
}

static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  const compat *c = self;
  double cut = c->values[CUT].real;
  (void)s;
  for (size_t i = 0; i < n; i++) {
    double r = (fx[i] * fx[i] + fy * fy) * cut * cut;
    out[2 * i] = (float)(1 / ((1 + r) * (1 + r)));
    out[2 * i + 1] = 0;
  }
}

static int image(const void *self, int layer, const opc_spectrum *mask,
                 opc_field *out, opc_error *error) {
  static const double one = 1;
  const compat *c = self;
  (void)layer;
  const opc_systems systems = {.size = sizeof systems,
                               .count = 1,
                               .weight = &one,
                               .band = band(self),
                               .intensity_band = 2 * band(self),
                               .transfer = transfer,
                               .self = self,
                               .scale = {1, 0}};
  return c->host->imaging->coherent_sum(c->host, mask, &systems, 0, out, error);
}

static const opc_parameter parameters[PARAMETERS] = {
    {"cut", OPC_REAL, OPC_ABOVE, "nm", "120 nm", 0, 0, NULL,
     "period that gets through with a quarter of its amplitude"},
};

static const opc_litho operations = {
    .size = sizeof operations, .prepare = prepare, .band = band, .image = image};

COMPAT_PLUGIN("compat.litho", OPC_KIND_LITHO, OPC_PARAMETERS(parameters));
