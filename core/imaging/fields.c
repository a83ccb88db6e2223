/* SPDX-License-Identifier: BSD-3-Clause */
/* What is done to whole fields: diffusion, other grids, samples. All of them
   multiply the spectrum of the coefficients by something that is a factor of
   kx times one of ky, so that lines are filtered along x and then along y. */
#include "core/imaging/fft.h"
#include "core/imaging/imaging.h"
#include "core/imaging/spline.h"
#include "core/plugin/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 16, MAX_NODES = 1 << 28 };

/* Lines of n numbers become lines of m. Number i of line j is
   in[j * in_line + i * in_step]. */
typedef struct filter {
  int n, m, lines;
  const float *in;
  float *out;
  size_t in_step, in_line, out_step, out_line;
  const float *gain; /* of frequency k, up to min(n, m) / 2 */
  int failed;        /* atomic */
} filter;

static void filter_lines(void *data, size_t block) {
  filter *f = data;
  int first = (int)block * LINES;
  int last = first + LINES < f->lines ? first + LINES : f->lines;
  int longer = f->n > f->m ? f->n : f->m,
      kept = (f->n < f->m ? f->n : f->m) / 2;
  float *line = opc_fft_alloc(sizeof *line * (size_t)(longer + 2));
  float complex *half = opc_fft_alloc(sizeof *half * (size_t)(longer / 2 + 2));
  const opc_fft *forth = opc_fft_plan(OPC_FFT_REAL_FORWARD, f->n, 1);
  const opc_fft *back = opc_fft_plan(OPC_FFT_REAL_BACKWARD, f->m, 1);
  if (!line || !half) __atomic_store_n(&f->failed, 1, __ATOMIC_RELAXED);
  for (int j = first; j < last && line && half; j++) {
    const float *in = f->in + f->in_line * (size_t)j;
    float *out = f->out + f->out_line * (size_t)j;
    for (int i = 0; i < f->n; i++) line[i] = in[f->in_step * (size_t)i];
    opc_fft_run(forth, line, half);
    for (int k = 0; k <= kept; k++) half[k] *= f->gain[k];
    for (int k = kept + 1; k <= f->m / 2; k++) half[k] = 0;
    opc_fft_run(back, half, line);
    for (int i = 0; i < f->m; i++) out[f->out_step * (size_t)i] = line[i];
  }
  opc_fft_free(line);
  opc_fft_free(half);
}

/* The factor of frequency k of a line of n numbers and of length `length`. */
typedef double gain_function(int k, int n, int m, double length, double value);

static float *gains(gain_function *function, int n, int m, double length,
                    double value) {
  int kept = (n < m ? n : m) / 2;
  float *gain = malloc(sizeof *gain * (size_t)(kept + 1));
  for (int k = 0; gain && k <= kept; k++) {
    double g = function(k, n, m, length, value) / n;
    /* On another grid the highest frequency of an even number of nodes is two
       (k and -k), or none. */
    if (m != n && 2 * k == n) g /= 2;
    if (m != n && 2 * k == m) g = 0;
    gain[k] = (float)g;
  }
  return gain;
}

/* Filter the field, which gets nx x ny nodes. */
static int apply(const opc_host *host, opc_field *field, int nx, int ny,
                 gain_function *function, double value, opc_error *error) {
  int code = OPC_OK;
  float *gx = gains(function, field->nx, nx, field->frame.width, value);
  float *gy = gains(function, field->ny, ny, field->frame.height, value);
  float *wide = opc_fft_alloc(sizeof *wide * (size_t)nx * (size_t)field->ny);
  float *out = NULL;
  int same = nx == field->nx && ny == field->ny;
  if (gx && gy && wide)
    out = same ? field->coefficients
               : host->alloc(host, (size_t)nx * (size_t)ny, sizeof *out);
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
  if (out)
    host->parallel(host, (size_t)(x.lines + LINES - 1) / LINES, filter_lines,
                   &x);
  if (out && !x.failed)
    host->parallel(host, (size_t)(y.lines + LINES - 1) / LINES, filter_lines,
                   &y);
  if (!out || x.failed || y.failed) {
    if (!same) host->free(host, out);
    code = opc_fail(error, OPC_FAILED, NULL, "out of memory");
  } else if (!same) {
    host->free(host, field->coefficients);
    field->coefficients = out;
    field->nx = nx;
    field->ny = ny;
  }
  free(gx);
  free(gy);
  opc_fft_free(wide);
  return code;
}

static double gaussian(int k, int n, int m, double length, double sigma) {
  (void)n;
  (void)m;
  double w = 2 * M_PI * k / length * sigma;
  return exp(-w * w / 2);
}

static double sampled(int k, int n, int m, double length, double value) {
  (void)m;
  (void)length;
  (void)value;
  return opc_spline_sampled((double)k / n);
}

static double prefilter(int k, int n, int m, double length, double value) {
  return 1 / sampled(k, n, m, length, value);
}

static double regrid(int k, int n, int m, double length, double value) {
  return sampled(k, n, m, length, value) / opc_spline_sampled((double)k / m);
}

int opc_field_diffuse(const opc_host *host, opc_field *field, double sigma,
                      opc_error *error) {
  if (!(sigma >= 0) || isinf(sigma))
    return opc_fail(error, OPC_INVALID, NULL, "no diffusion of %g nm", sigma);
  if (sigma == 0) return OPC_OK;
  return apply(host, field, field->nx, field->ny, gaussian, sigma, error);
}

int opc_field_resample(const opc_host *host, opc_field *field, double step,
                       opc_error *error) {
  const opc_frame *f = &field->frame;
  if (!(step > 0) || f->width / step * (f->height / step) > MAX_NODES)
    return opc_fail(error, OPC_INVALID, NULL,
                    "a field of %g x %g um does not fit a step of %g nm",
                    f->width / 1e3, f->height / 1e3, step);
  int nx = opc_fft_size(f->width / step), ny = opc_fft_size(f->height / step);
  if (nx == field->nx && ny == field->ny) return OPC_OK;
  return apply(host, field, nx, ny, regrid, 0, error);
}

int opc_field_samples(const opc_host *host, opc_field *field,
                      opc_error *error) {
  return apply(host, field, field->nx, field->ny, sampled, 0, error);
}

int opc_field_from_samples(const opc_host *host, opc_field *field,
                           opc_error *error) {
  return apply(host, field, field->nx, field->ny, prefilter, 0, error);
}

/* Six indices from `first` on, in 0 .. n - 1. */
static void wrapped(int first, int n, int out[OPC_SPLINE_TAPS]) {
  int i = first % n;
  if (i < 0) i += n;
  for (int k = 0; k < OPC_SPLINE_TAPS; k++) {
    out[k] = i;
    if (++i == n) i = 0;
  }
}

void opc_field_gradient(const opc_field *field, const double *x,
                        const double *y, size_t n, double *value, double *dx,
                        double *dy) {
  double step_x = field->frame.width / field->nx;
  double step_y = field->frame.height / field->ny;
  for (size_t i = 0; i < n; i++) {
    double wx[OPC_SPLINE_TAPS], wy[OPC_SPLINE_TAPS];
    double sx[OPC_SPLINE_TAPS], sy[OPC_SPLINE_TAPS];
    int column[OPC_SPLINE_TAPS], row[OPC_SPLINE_TAPS];
    double px = (x[i] - field->frame.x0) / step_x;
    double py = (y[i] - field->frame.y0) / step_y;
    wrapped(opc_spline_weights(px, wx), field->nx, column);
    wrapped(opc_spline_weights(py, wy), field->ny, row);
    opc_spline_slopes(px, sx);
    opc_spline_slopes(py, sy);
    double sum[3] = {0};
    for (int j = 0; j < OPC_SPLINE_TAPS; j++) {
      const float *c = field->coefficients + (size_t)row[j] * field->nx;
      double line = 0, slope = 0;
      for (int k = 0; k < OPC_SPLINE_TAPS; k++) {
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
