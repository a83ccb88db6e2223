/* SPDX-License-Identifier: BSD-3-Clause */
#include "bench/lines.h"

#include <glib.h>
#include <math.h>

void lines_require(int code, const opc_error *error) {
  if (code) g_error("%s", error->message);
}

eda_shapes lines_shapes(double side) {
  size_t columns = (size_t)(side / 250), rows = (size_t)(side / 1800);
  eda_shapes s = {.count = columns * rows};
  s.start = g_new0(uint32_t, s.count + 1);
  s.points = g_new(eda_point, 4 * s.count);
  for (size_t k = 0; k < s.count; k++) {
    int i = (int)(k % columns), j = (int)(k / columns);
    int x = i * 250 + 92, y = j * 1800 + 100 + i % 7 * 13,
        h = 1400 - i % 5 * 31;
    eda_point p[4] = {{x, y}, {x + 65, y}, {x + 65, y + h}, {x, y + h}};
    for (int c = 0; c < 4; c++) s.points[4 * k + (size_t)c] = p[c];
    s.start[k + 1] = (uint32_t)(4 * (k + 1));
  }
  return s;
}

eda_frame lines_frame(double side) {
  return (eda_frame){-1000, -1000, side + 2000, side + 2000};
}

opc_module *lines_litho(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("litho.hopkins", parameters, &error);
  if (!m) g_error("%s", error.message);
  const eda_litho *l = m->functions;
  lines_require(l->prepare(m->self, &error), &error);
  return m;
}

/* Compute the transfer function of a point source on a ring: the shifted
   pupil. */
static void lines_transfer(const void *self, size_t s, const double *fx,
                           double fy, size_t n, float *out) {
  const size_t *count = self;
  double angle = 2 * M_PI * (double)s / (double)*count;
  double x = LINES_SIGMA * cos(angle),
         y = fy / LINES_CUTOFF + LINES_SIGMA * sin(angle);
  for (size_t i = 0; i < n; i++) {
    double u = fx[i] / LINES_CUTOFF + x;
    out[2 * i] = u * u + y * y <= 1;
    out[2 * i + 1] = 0;
  }
}

enum { LINES_KERNELS = 64 };

eda_kernels lines_kernels(size_t *count, double scale) {
  static double weight[LINES_KERNELS];
  for (size_t i = 0; i < *count; i++) weight[i] = 1 / (double)*count;
  return (eda_kernels){.count = *count,
                       .weight = weight,
                       .band = (1 + LINES_SIGMA) * LINES_CUTOFF,
                       .intensity_band = 2 * LINES_CUTOFF * scale,
                       .transfer = lines_transfer,
                       .self = count};
}
