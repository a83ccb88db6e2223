/* SPDX-License-Identifier: BSD-3-Clause */
/* Operations on whole fields: diffusion, resampling, samples. Each operation
   multiplies the spectrum of the coefficients by a function of kx times a
   function of ky. Therefore lines are filtered along x, then along y. */
#include "imaging/fft.h"
#include "imaging/spline.h"
#include "imaging/values.h"

#include <complex.h>
#include <eda/imaging.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 16, MAX_NODES = 1 << 28 };

/* A filter of lines of n numbers to lines of m numbers. Number i of line j is
   in[j * in_line + i * in_step]. */
typedef struct filter {
  int n, m, lines;
  const float *in;
  float *out;
  size_t in_step, in_line, out_step, out_line;
  const float *gain; /* gain at frequency k = 0 .. min(n, m) / 2 */
} filter;

static void filter_lines(void *data, size_t block) {
  filter *f = data;
  int first = (int)block * LINES;
  int last = first + LINES < f->lines ? first + LINES : f->lines;
  int longer = f->n > f->m ? f->n : f->m,
      kept = (f->n < f->m ? f->n : f->m) / 2;
  float *line = eda_fft_alloc(sizeof *line * (size_t)(longer + 2));
  float complex *half = eda_fft_alloc(sizeof *half * (size_t)(longer / 2 + 2));
  const eda_fft *forth = eda_fft_plan(EDA_FFT_REAL_FORWARD, f->n, 1);
  const eda_fft *back = eda_fft_plan(EDA_FFT_REAL_BACKWARD, f->m, 1);
  for (int j = first; j < last; j++) {
    const float *in = f->in + f->in_line * (size_t)j;
    float *out = f->out + f->out_line * (size_t)j;
    for (int i = 0; i < f->n; i++) line[i] = in[f->in_step * (size_t)i];
    eda_fft_run(forth, line, half);
    for (int k = 0; k <= kept; k++) half[k] *= f->gain[k];
    for (int k = kept + 1; k <= f->m / 2; k++) half[k] = 0;
    eda_fft_run(back, half, line);
    for (int i = 0; i < f->m; i++) out[f->out_step * (size_t)i] = line[i];
  }
  eda_fft_free(line);
  eda_fft_free(half);
}

/* An operation and its parameter. */
enum { DIFFUSE, TO_SAMPLES, FROM_SAMPLES, RESAMPLE };
typedef struct operation {
  int what;
  double sigma; /* sigma of DIFFUSE, nm */
} operation;

/* Return the gain at frequency k for resampling n to m numbers on a length of
   `length` nm. */
static double gain_of(const operation *d, int k, int n, int m, double length) {
  double w = 2 * M_PI * k / length * d->sigma;
  if (d->what == DIFFUSE) return exp(-w * w / 2);
  double sampled = eda_spline_sampled((double)k / n);
  if (d->what == TO_SAMPLES) return sampled;
  if (d->what == FROM_SAMPLES) return 1 / sampled;
  return sampled / eda_spline_sampled((double)k / m);
}

static float *filter_gains(const operation *d, int n, int m, double length) {
  int kept = (n < m ? n : m) / 2;
  float *gain = eda_alloc((size_t)kept + 1, sizeof *gain);
  for (int k = 0; k <= kept; k++) {
    double g = gain_of(d, k, n, m, length) / n;
    /* If n < m, the highest frequency of n numbers becomes two frequencies, k
       and -k. If m < n, the highest frequency of m numbers is removed. */
    if (m != n && 2 * k == n) g /= 2;
    if (m != n && 2 * k == m) g = 0;
    gain[k] = (float)g;
  }
  return gain;
}

/* Filter a field in place, and set the number of nodes to nx x ny. */
static void filter_apply(const opc_context *context, eda_field *field, int nx,
                         int ny, operation d) {
  float *gx = filter_gains(&d, field->nx, nx, field->frame.width);
  float *gy = filter_gains(&d, field->ny, ny, field->frame.height);
  float *wide = eda_fft_alloc(sizeof *wide * (size_t)nx * (size_t)field->ny);
  int same = nx == field->nx && ny == field->ny;
  float *out =
      same ? field->coefficients : eda_values_new((size_t)nx * (size_t)ny);
  filter x = {.n = field->nx,
              .m = nx,
              .lines = field->ny,
              .in = field->coefficients,
              .out = wide,
              .gain = gx,
              .in_step = 1,
              .in_line = (size_t)field->nx,
              .out_step = 1,
              .out_line = (size_t)nx};
  filter y = {.n = field->ny,
              .m = ny,
              .lines = nx,
              .in = wide,
              .out = out,
              .gain = gy,
              .in_step = (size_t)nx,
              .in_line = 1,
              .out_step = (size_t)nx,
              .out_line = 1};
  opc_parallel(context, (size_t)(x.lines + LINES - 1) / LINES, filter_lines,
               &x);
  opc_parallel(context, (size_t)(y.lines + LINES - 1) / LINES, filter_lines,
               &y);
  if (!same) {
    eda_values_free(field->coefficients);
    field->coefficients = out;
    field->nx = nx;
    field->ny = ny;
  }
  free(gx);
  free(gy);
  eda_fft_free(wide);
}

int eda_field_diffuse(const opc_context *context, eda_field *field,
                      double sigma, opc_error *error) {
  if (!(sigma >= 0) || isinf(sigma))
    return opc_fail(error, OPC_INVALID, NULL,
                    "diffusion length is %g nm, expected 0 or more", sigma);
  if (sigma == 0) return OPC_OK;
  filter_apply(context, field, field->nx, field->ny,
               (operation){DIFFUSE, sigma});
  return OPC_OK;
}

int eda_field_resample(const opc_context *context, eda_field *field,
                       double step, opc_error *error) {
  const eda_frame *f = &field->frame;
  if (!(step > 0) || f->width / step * (f->height / step) > MAX_NODES)
    return opc_fail(error, OPC_INVALID, NULL,
                    "a field of %g x %g um does not fit a step of %g nm",
                    f->width / 1e3, f->height / 1e3, step);
  int nx = eda_fft_size(f->width / step), ny = eda_fft_size(f->height / step);
  if (nx == field->nx && ny == field->ny) return OPC_OK;
  filter_apply(context, field, nx, ny, (operation){RESAMPLE, 0});
  return OPC_OK;
}

void eda_field_samples(const opc_context *context, eda_field *field) {
  filter_apply(context, field, field->nx, field->ny,
               (operation){TO_SAMPLES, 0});
}

void eda_field_from_samples(const opc_context *context, eda_field *field) {
  filter_apply(context, field, field->nx, field->ny,
               (operation){FROM_SAMPLES, 0});
}

void eda_field_gradient(const eda_field *field, const double *x,
                        const double *y, size_t n, double *value, double *dx,
                        double *dy) {
  double step_x = field->frame.width / field->nx;
  double step_y = field->frame.height / field->ny;
  for (size_t i = 0; i < n; i++) {
    double wx[EDA_SPLINE_TAPS], wy[EDA_SPLINE_TAPS];
    double sx[EDA_SPLINE_TAPS], sy[EDA_SPLINE_TAPS];
    int column[EDA_SPLINE_TAPS];
    double px = (x[i] - field->frame.x0) / step_x;
    double py = (y[i] - field->frame.y0) / step_y;
    int first = eda_spline_weights(px, wx), row = eda_spline_weights(py, wy);
    for (int k = 0; k < EDA_SPLINE_TAPS; k++)
      column[k] = eda_wrap(first + k, field->nx);
    eda_spline_slopes(px, sx);
    eda_spline_slopes(py, sy);
    double sum[3] = {0};
    for (int j = 0; j < EDA_SPLINE_TAPS; j++) {
      const float *c = field->coefficients +
                       (size_t)eda_wrap(row + j, field->ny) * field->nx;
      double line = 0, slope = 0;
      for (int k = 0; k < EDA_SPLINE_TAPS; k++) {
        line += wx[k] * c[column[k]];
        slope += sx[k] * c[column[k]];
      }
      sum[0] += wy[j] * line;
      sum[1] += wy[j] * slope;
      sum[2] += sy[j] * line;
    }
    if (value) value[i] = sum[0];
    if (dx) dx[i] = sum[1] / step_x;
    if (dy) dy[i] = sum[2] / step_y;
  }
}
