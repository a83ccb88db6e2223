/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty litho model, a blur of the mask amplitude. */
#include "bad.h"

static const double blur = 25, band_limit = 0.02; /* nm, 1/nm */

/* Static memory: free() of this memory is invalid. */
static float fixed[1 << 20];

static int bad_prepare(void *self, opc_error *error) {
  evil("prepare");
  (void)self, (void)error;
  return OPC_OK;
}

static double bad_band(const void *self) {
  evil("band");
  (void)self;
  return fault_is("band") ? NAN : band_limit;
}

static void bad_transfer(const void *self, size_t s, const double *fx,
                         double fy, size_t n, float *out) {
  (void)self, (void)s;
  for (size_t i = 0; i < n; i++) {
    double f = M_PI * blur;
    out[2 * i] = (float)exp(-2 * f * f * (fx[i] * fx[i] + fy * fy));
    out[2 * i + 1] = 0;
  }
}

static int bad_image(const void *self, int layer, const eda_spectrum *mask,
                     eda_field *out, opc_error *error) {
  const int dark = fault_is("dark");
  const double one = fault_is("dim") || dark ? 0.9 : 1;
  evil("image");
  (void)self, (void)layer;
  int code = fault_apply();
  if (code) return code;
  const eda_kernels kernels = {.count = 1,
                               .weight = &one,
                               .band = band_limit,
                               .intensity_band = 2 * band_limit,
                               .transfer = bad_transfer,
                               .offset = {dark, 0},
                               .scale = {dark ? -1 : 1, 0}};
  code = eda_coherent_sum(host->context, mask, &kernels, 0, out, error);
  if (code) return code;
  if (fault_is("nan")) out->coefficients[out->nx + 2] = NAN;
  if (fault_is("infinite")) out->coefficients[0] = -INFINITY;
  if (fault_is("shape")) out->nx = 0;
  if (fault_is("frame")) out->frame.width *= 2;
  if (fault_is("empty")) eda_field_clear(out);
  if (fault_is("dangling")) out->coefficients = (float *)16;
  if (fault_is("static")) out->coefficients = fixed;
  return OPC_OK;
}

/* The intensity depends on the requested error. */
static int image_fine(const void *self, int layer, const eda_spectrum *mask,
                      double defocus, double wanted, eda_field *out,
                      opc_error *error) {
  (void)defocus;
  int code = bad_image(self, layer, mask, out, error);
  for (int i = 0; !code && fault_is("fine") && i < out->nx * out->ny; i++)
    out->coefficients[i] *= (float)(1.01 - 2 * wanted);
  return code;
}

static const eda_litho functions = {.prepare = bad_prepare,
                                    .band = bad_band,
                                    .image = bad_image,
                                    .image_fine = image_fine};

BAD_PLUGIN("litho", functions);
