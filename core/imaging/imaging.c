/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/imaging/imaging.h"
#include "core/imaging/edge.h"
#include "core/imaging/simd.h"
#include "core/imaging/spline.h"
#include "core/plugin/host.h"

static int wrap(int i, int n) {
  if (i >= 0 && i < n) return i;
  i %= n;
  return i < 0 ? i + n : i;
}

OPC_WIDE static void sample_points(const opc_field *field, const double *x,
                                   const double *y, size_t n, double *out) {
  double dx = field->frame.width / field->nx;
  double dy = field->frame.height / field->ny;
  for (size_t i = 0; i < n; i++) {
    double wx[OPC_SPLINE_TAPS], wy[OPC_SPLINE_TAPS], sum = 0;
    double line[OPC_SPLINE_TAPS] = {0};
    int a = opc_spline_weights((x[i] - field->frame.x0) / dx, wx);
    int b = opc_spline_weights((y[i] - field->frame.y0) / dy, wy);
    int inside = a >= 0 && a + OPC_SPLINE_TAPS <= field->nx;
    for (int j = 0; j < OPC_SPLINE_TAPS; j++) {
      const float *c = field->coefficients +
                       (size_t)wrap(b + j, field->ny) * (size_t)field->nx;
      if (inside)
        for (int k = 0; k < OPC_SPLINE_TAPS; k++) line[k] += wy[j] * c[a + k];
      else
        for (int k = 0; k < OPC_SPLINE_TAPS; k++)
          line[k] += wy[j] * c[wrap(a + k, field->nx)];
    }
    for (int k = 0; k < OPC_SPLINE_TAPS; k++) sum += wx[k] * line[k];
    out[i] = sum;
  }
}

static void sample(const opc_field *field, const double *x, const double *y,
                   size_t n, double *out) {
  sample_points(field, x, y, n, out);
}

static void release_spectrum(const opc_host *host, opc_spectrum *spectrum) {
  host->free(host, spectrum->data);
  *spectrum = (opc_spectrum){0};
}

static void release_field(const opc_host *host, opc_field *field) {
  host->free(host, field->coefficients);
  *field = (opc_field){0};
}

const opc_imaging_service opc_imaging_functions = {
    .size = sizeof(opc_imaging_service),
    .mask_spectrum = opc_mask_spectrum,
    .coherent_sum = opc_coherent_sum,
    .sample = sample,
    .contours = opc_contours,
    .release_spectrum = release_spectrum,
    .release_field = release_field,
    .gradient = opc_field_gradient,
    .diffuse = opc_field_diffuse,
    .resample = opc_field_resample,
    .samples = opc_field_samples,
    .from_samples = opc_field_from_samples,
    .edge = opc_field_edge,
};
