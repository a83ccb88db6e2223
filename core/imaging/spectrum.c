/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask spectra. The mask, smoothed by a quintic B-spline, is sampled exactly:
   each vertex of a rectilinear polygon is a step in x times a step in y, and
   smoothed steps are laid down as their differences (7 x 7 numbers a vertex)
   and summed up once at the end. The B-spline is then divided out of the
   spectrum. Its sixth-order zeros at the multiples of the sampling frequency
   keep what folds down below 1.4e-3 of what folds, that is 1e-5 of the
   clear field in all. */
#include "core/imaging/fft.h"
#include "core/imaging/imaging.h"
#include "core/imaging/spline.h"
#include "core/plugin/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Samples per shortest period of the band. */
static const double oversampling = 4;

enum { MARGIN = 4, MAX_SAMPLES = 1 << 28 };

typedef struct raster {
  double x0, y0, dx, dy;   /* sample (0, 0) and the steps, nm */
  int nx, ny;              /* the period */
  int columns, rows;       /* with what reaches beyond it on both sides */
  double *step;            /* rows * columns; sample (0, 0) is [MARGIN, MARGIN] */
} raster;

static void deposit(raster *r, double x, double y, double sign) {
  double wx[OPC_STEP_TAPS], wy[OPC_STEP_TAPS];
  int i = opc_spline_step(x, wx) + MARGIN, j = opc_spline_step(y, wy) + MARGIN;
  for (int b = 0; b < OPC_STEP_TAPS; b++) {
    double *row = r->step + (size_t)(j + b) * r->columns + i;
    double w = sign * wy[b];
    for (int a = 0; a < OPC_STEP_TAPS; a++) row[a] += w * wx[a];
  }
}

/* How many periods to move a polygon by, so that its lower left corner lies in
   the frame. */
static double periods(int32_t low, double grid, double origin, double period) {
  return floor((low * grid - origin) / period);
}

static void polygon(raster *r, const opc_shapes *s, size_t p, double grid,
                    opc_frame f) {
  size_t n = s->start[p + 1] - s->start[p];
  const opc_point *v = s->points + s->start[p];
  int32_t x0 = INT32_MAX, y0 = INT32_MAX;
  for (size_t i = 0; i < n; i++) {
    x0 = v[i].x < x0 ? v[i].x : x0;
    y0 = v[i].y < y0 ? v[i].y : y0;
  }
  double ox = f.x0 + f.width * periods(x0, grid, f.x0, f.width);
  double oy = f.y0 + f.height * periods(y0, grid, f.y0, f.height);
  for (size_t i = 0; i < n; i++) {
    opc_point a = v[i], b = v[i + 1 < n ? i + 1 : 0];
    if (a.x != b.x || a.y == b.y) continue;
    /* The inside is on the left: an edge upwards ends it, one downwards
       begins it, from its end to its beginning. */
    double x = (a.x * grid - ox) / r->dx;
    deposit(r, x, (b.y * grid - oy) / r->dy, 1);
    deposit(r, x, (a.y * grid - oy) / r->dy, -1);
  }
}

/* The samples the polygons need beyond the period, the largest over all. */
static void measure(raster *r, const opc_shapes *s, double grid, opc_frame f) {
  double w = f.width, h = f.height;
  for (size_t p = 0; p < s->count; p++) {
    opc_box b = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      opc_point v = s->points[i];
      b.x0 = v.x < b.x0 ? v.x : b.x0;
      b.y0 = v.y < b.y0 ? v.y : b.y0;
      b.x1 = v.x > b.x1 ? v.x : b.x1;
      b.y1 = v.y > b.y1 ? v.y : b.y1;
    }
    double x = b.x1 * grid - f.x0 - f.width * periods(b.x0, grid, f.x0, f.width);
    double y =
        b.y1 * grid - f.y0 - f.height * periods(b.y0, grid, f.y0, f.height);
    w = x > w ? x : w;
    h = y > h ? y : h;
  }
  r->columns = (int)ceil(w / r->dx) + 2 * MARGIN + OPC_STEP_TAPS;
  r->rows = (int)ceil(h / r->dy) + 2 * MARGIN + OPC_STEP_TAPS;
}

/* Sum the steps up in both directions and fold what lies beyond the period
   back into it. */
static void sum_up(const raster *r, float *out) {
  memset(out, 0, sizeof(float) * (size_t)r->nx * r->ny);
  for (int j = 0; j < r->rows; j++) {
    double *row = r->step + (size_t)j * r->columns;
    if (j)
      for (int i = 0; i < r->columns; i++) row[i] += row[i - r->columns];
    float *to = out + (size_t)((j - MARGIN + r->ny) % r->ny) * r->nx;
    double sum = 0;
    for (int i = 0, k = (r->nx - MARGIN) % r->nx; i < r->columns; i++) {
      sum += row[i];
      to[k] += (float)sum;
      if (++k == r->nx) k = 0;
    }
  }
}

/* Keep the band of the raster's transform, without the B-spline. */
static void keep_band(const raster *r, const float complex *transform,
                      opc_spectrum *out) {
  int half = (out->rows - 1) / 2, width = r->nx / 2 + 1;
  double scale = -1.0 / ((double)r->nx * r->ny);
  float complex *a = (float complex *)out->data;
  for (int l = -half; l <= half; l++) {
    double fy = l / out->frame.height;
    double sy = scale / opc_spline_transform((double)l / r->ny);
    const float complex *from = transform + (size_t)((l + r->ny) % r->ny) * width;
    float complex *to = a + (size_t)((l + out->rows) % out->rows) * out->columns;
    for (int k = 0; k < out->columns; k++) {
      double fx = k / out->frame.width;
      if (fx * fx + fy * fy > out->band * out->band) continue;
      to[k] = from[k] * (float)(sy / opc_spline_transform((double)k / r->nx));
    }
  }
  a[0] += 1;   /* the clear field */
}

int opc_mask_spectrum(const opc_host *host, const opc_shapes *shapes,
                      double grid, opc_frame frame, double band,
                      opc_spectrum *out, opc_error *error) {
  memset(out, 0, sizeof *out);
  if (!(frame.width > 0 && frame.height > 0 && band > 0 && grid > 0) ||
      !isfinite(frame.width * frame.height * band))
    return opc_fail(error, OPC_INVALID, NULL,
                    "a frame of %g x %g nm has no area", frame.width,
                    frame.height);
  if (frame.width * frame.height * band * band * oversampling * oversampling >
      MAX_SAMPLES)
    return opc_fail(error, OPC_INVALID, NULL,
                    "a frame of %g x %g um is too large for one field",
                    frame.width / 1e3, frame.height / 1e3);
  raster r = {.x0 = frame.x0, .y0 = frame.y0};
  r.nx = opc_fft_size(frame.width * band * oversampling);
  r.ny = opc_fft_size(frame.height * band * oversampling);
  r.dx = frame.width / r.nx;
  r.dy = frame.height / r.ny;
  measure(&r, shapes, grid, frame);

  int code = OPC_OK;
  size_t n = (size_t)r.nx * r.ny;
  float *samples = opc_fft_alloc(n * sizeof *samples);
  float complex *transform =
      opc_fft_alloc((size_t)r.ny * (r.nx / 2 + 1) * sizeof *transform);
  r.step = calloc((size_t)r.rows * r.columns, sizeof *r.step);
  *out = (opc_spectrum){.frame = frame, .band = band};
  out->columns = (int)floor(frame.width * band) + 1;
  out->rows = 2 * (int)floor(frame.height * band) + 1;
  out->data = host->alloc(host, (size_t)out->columns * out->rows,
                          sizeof(float complex));
  if (!samples || !transform || !r.step || !out->data) {
    host->free(host, out->data);
    out->data = NULL;
    code = opc_fail(error, OPC_FAILED, NULL, "out of memory");
    goto done;
  }
  for (size_t p = 0; p < shapes->count; p++) polygon(&r, shapes, p, grid, frame);
  sum_up(&r, samples);
  opc_fft_forward_real(r.nx, r.ny, samples, transform);
  keep_band(&r, transform, out);
done:
  free(r.step);
  opc_fft_free(samples);
  opc_fft_free(transform);
  return code;
}
