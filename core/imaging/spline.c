/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/imaging/spline.h"

#include <math.h>

/* The nonzero B-splines of degree n at the fraction t of a cell, by the
   recurrence of Cox and de Boor; weight[0] belongs to the spline that ends
   first. */
static void recurrence(int degree, double t, double *weight) {
  weight[0] = 1;
  for (int d = 1; d <= degree; d++) {
    weight[d] = weight[d - 1] * t / d;
    for (int i = d - 1; i > 0; i--)
      weight[i] =
          (weight[i - 1] * (t + d - i) + weight[i] * (1 - t + i)) / d;
    weight[0] *= (1 - t) / d;
  }
}

int opc_spline_weights(double x, double weight[OPC_SPLINE_TAPS]) {
  double cell = floor(x);
  recurrence(5, x - cell, weight);
  return (int)cell - 2;
}

/* The derivative of a B-spline is the difference of two of a degree less. */
void opc_spline_slopes(double x, double slope[OPC_SPLINE_TAPS]) {
  double below[OPC_SPLINE_TAPS - 1];
  recurrence(4, x - floor(x), below);
  slope[0] = -below[0];
  for (int i = 1; i < OPC_SPLINE_TAPS - 1; i++)
    slope[i] = below[i - 1] - below[i];
  slope[OPC_SPLINE_TAPS - 1] = below[OPC_SPLINE_TAPS - 2];
}

int opc_spline_step(double x, double weight[OPC_STEP_TAPS]) {
  double cell = floor(x);
  recurrence(OPC_RASTER_DEGREE + 1, x - cell, weight);
  return (int)cell - OPC_RASTER_DEGREE / 2;
}

int opc_spline_smoothing(double x, double weight[OPC_STEP_TAPS - 1]) {
  double cell = floor(x);
  recurrence(OPC_RASTER_DEGREE, x - cell, weight);
  return (int)cell - OPC_RASTER_DEGREE / 2;
}

double opc_spline_sampled(double f) {
  double c = 2 * M_PI * f;
  return (66 + 52 * cos(c) + 2 * cos(2 * c)) / 120;
}

static int wrap(int i, int n) {
  i %= n;
  return i < 0 ? i + n : i;
}

int opc_line_room(const opc_field *field, int axis, double from, double to) {
  double step = axis ? field->frame.height / field->ny
                     : field->frame.width / field->nx;
  return (int)ceil((to - from) / step) + OPC_SPLINE_TAPS + 2;
}

void opc_line_cut(const opc_field *field, int axis, double at, double from,
                  double to, opc_line *line) {
  const opc_frame *f = &field->frame;
  int along = axis ? field->ny : field->nx, across = axis ? field->nx : field->ny;
  double step = (axis ? f->height : f->width) / along;
  double step_across = (axis ? f->width : f->height) / across;
  double origin = axis ? f->y0 : f->x0, origin_across = axis ? f->x0 : f->y0;
  double weight[OPC_SPLINE_TAPS];
  int row = opc_spline_weights((at - origin_across) / step_across, weight);

  line->origin = origin;
  line->step = step;
  line->first = (int)floor((from - origin) / step) - 2;
  line->n = (int)floor((to - origin) / step) + 3 - line->first + 1;
  size_t stride = axis ? (size_t)field->nx : 1;
  size_t stride_across = axis ? 1 : (size_t)field->nx;
  const float *rows[OPC_SPLINE_TAPS];
  for (int k = 0; k < OPC_SPLINE_TAPS; k++)
    rows[k] = field->coefficients + stride_across * wrap(row + k, across);
  int j = wrap(line->first, along);
  for (int i = 0; i < line->n; i++) {
    size_t offset = stride * j;
    double sum = 0;
    for (int k = 0; k < OPC_SPLINE_TAPS; k++)
      sum += weight[k] * rows[k][offset];
    line->coefficient[i] = sum;
    if (++j == along) j = 0;
  }
}

double opc_line_value(const opc_line *line, double place) {
  double weight[OPC_SPLINE_TAPS];
  int first =
      opc_spline_weights((place - line->origin) / line->step, weight) -
      line->first;
  const double *c = line->coefficient + first;
  double sum = 0;
  for (int k = 0; k < OPC_SPLINE_TAPS; k++) sum += weight[k] * c[k];
  return sum;
}
