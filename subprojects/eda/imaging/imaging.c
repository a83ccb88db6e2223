/* SPDX-License-Identifier: BSD-3-Clause */
/* Values of fields; release of fields and spectra. */
#include <eda/imaging.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

#include <eda/simd.h>
#include "imaging/spline.h"
#include "imaging/values.h"

EDA_WIDE static void sample_points(const eda_field *field, const double *x,
                                   const double *y, size_t n, double *out) {
  double dx = field->frame.width / field->nx;
  double dy = field->frame.height / field->ny;
  for (size_t i = 0; i < n; i++) {
    double wx[EDA_SPLINE_TAPS], wy[EDA_SPLINE_TAPS], sum = 0;
    double line[EDA_SPLINE_TAPS] = {0};
    int a = eda_spline_weights((x[i] - field->frame.x0) / dx, wx);
    int b = eda_spline_weights((y[i] - field->frame.y0) / dy, wy);
    int inside = a >= 0 && a + EDA_SPLINE_TAPS <= field->nx;
    for (int j = 0; j < EDA_SPLINE_TAPS; j++) {
      const float *c = field->coefficients +
                       (size_t)eda_wrap(b + j, field->ny) * (size_t)field->nx;
      if (inside)
        for (int k = 0; k < EDA_SPLINE_TAPS; k++) line[k] += wy[j] * c[a + k];
      else
        for (int k = 0; k < EDA_SPLINE_TAPS; k++)
          line[k] += wy[j] * c[eda_wrap(a + k, field->nx)];
    }
    for (int k = 0; k < EDA_SPLINE_TAPS; k++) sum += wx[k] * line[k];
    out[i] = sum;
  }
}

void eda_field_sample(const eda_field *field, const double *x, const double *y,
                      size_t n, double *out) {
  sample_points(field, x, y, n, out);
}

double eda_margin(double band, double error) {
  return sqrt(0.05 / error) / band;
}

void eda_spectrum_clear(eda_spectrum *spectrum) {
  free(spectrum->data);
  *spectrum = (eda_spectrum){0};
}

int (*eda_values_take)(float *values);

void eda_values_free(float *values) {
  if (!eda_values_take || !eda_values_take(values)) free(values);
}

void eda_field_clear(eda_field *field) {
  eda_values_free(field->coefficients);
  *field = (eda_field){0};
}

float *eda_values_new(size_t n) {
  return g_malloc(n * sizeof(float) + EDA_VALUES_SPARE);
}

eda_field eda_field_scaled(const eda_field *field, double factor) {
  size_t n = (size_t)field->nx * (size_t)field->ny;
  eda_field out = *field;
  out.coefficients = eda_values_new(n);
  for (size_t i = 0; i < n; i++)
    out.coefficients[i] = (float)factor * field->coefficients[i];
  return out;
}
