/* SPDX-License-Identifier: BSD-3-Clause */
/* Rasterisation of masks. Each corner of a rectilinear polygon is a step in x
   times a step in y, both smoothed by a B-spline. The raster stores the
   differences of these steps, 11 x 11 numbers for each corner, which are summed
   once at the end. Threads process bands of rows, to which they add the parts
   of all polygons. */
#include "imaging/raster.h"

#include <eda/simd.h>
#include "imaging/fft.h"
#include "imaging/spline.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BANDS = 16, COLUMNS = 64 };

/* Origin of the period that contains the lower left corner of a polygon, nm,
   and the rows that the polygon affects. */
typedef struct place {
  double x, y;
  int low, high;
} place;

typedef struct laying {
  eda_raster *raster;
  const eda_shapes *shapes;
  double grid;
  eda_frame frame;
  place *places;
} laying;

double eda_raster_transform(double f) {
  double x = M_PI * f;
  if (fabs(x) < 1e-8) return 1;
  double s = sin(x) / x;
  return pow(s, EDA_RASTER_DEGREE + 1);
}

/* ---- deposition ---- */

/* A smoothed step in x or y: position of the first difference in the array, and
   the differences. */
typedef struct step {
  double at; /* position in grid steps from sample 0; NAN: not computed */
  int first;
  double weight[EDA_STEP_TAPS];
} step;

/* Compute the differences of a step, unless *s already has them. Successive
   corners of a polygon share x or y. */
static void make_step(double at, step *s) {
  if (s->at == at) return;
  s->at = at;
  s->first = eda_spline_step(at, s->weight) + EDA_RASTER_MARGIN;
}

/* Add n rows of differences of a corner. */
EDA_WIDE static void add_corner(double *restrict to, size_t columns,
                                const double *restrict wx,
                                const double *restrict wy, double sign, int n) {
  for (int b = 0; b < n; b++, to += columns) {
    double w = sign * wy[b];
    for (int a = 0; a < EDA_STEP_TAPS; a++) to[a] += w * wx[a];
  }
}

/* Add a corner at (x, y), in grid steps from sample (0, 0). Only rows low ..
   high - 1 of the array are changed. */
static void corner_deposit(const eda_raster *r, double x, double y, double sign,
                           int low, int high, step *in_x, step *in_y) {
  int j = (int)floor(y) - EDA_RASTER_DEGREE / 2 + EDA_RASTER_MARGIN;
  if (j >= high || j + EDA_STEP_TAPS <= low) return;
  make_step(x, in_x);
  make_step(y, in_y);
  int from = j < low ? low - j : 0;
  int to = j + EDA_STEP_TAPS > high ? high - j : EDA_STEP_TAPS;
  add_corner(r->step + (size_t)(j + from) * r->columns + in_x->first,
             (size_t)r->columns, in_x->weight, in_y->weight + from, sign,
             to - from);
}

static void lay_polygon(const laying *l, size_t p, int low, int high) {
  const eda_raster *r = l->raster;
  const eda_shapes *s = l->shapes;
  const place *o = &l->places[p];
  size_t n = s->start[p + 1] - s->start[p];
  const eda_point *v = s->points + s->start[p];
  step in_x = {.at = NAN}, in_y[2] = {{.at = NAN}, {.at = NAN}};
  for (size_t i = 0; i < n; i++) {
    eda_point a = v[i], b = v[i + 1 < n ? i + 1 : 0];
    if (a.y == b.y) continue;
    double ax = (a.x * l->grid - o->x) / r->dx;
    double ay = (a.y * l->grid - o->y) / r->dy;
    double by = (b.y * l->grid - o->y) / r->dy;
    if (a.x != b.x) {
      eda_raster_slanted(r, ax, ay, (b.x * l->grid - o->x) / r->dx, by, low,
                         high);
      continue;
    }
    /* The interior is on the left. A downward edge adds 1 to its right between
       its ends; an upward edge subtracts 1. Successive edges share the step in
       y of their common corner. */
    int other = in_y[0].at == ay;
    corner_deposit(r, ax, by, 1, low, high, &in_x, &in_y[other]);
    corner_deposit(r, ax, ay, -1, low, high, &in_x, &in_y[!other]);
  }
}

static void lay_band(void *data, size_t band) {
  const laying *l = data;
  int rows = l->raster->rows;
  int low = (int)((int64_t)rows * (int64_t)band / BANDS);
  int high = (int)((int64_t)rows * (int64_t)(band + 1) / BANDS);
  size_t columns = (size_t)l->raster->columns;
  memset(l->raster->step + (size_t)low * columns, 0,
         (size_t)(high - low) * columns * sizeof *l->raster->step);
  for (size_t p = 0; p < l->shapes->count; p++)
    if (l->places[p].low < high && l->places[p].high > low)
      lay_polygon(l, p, low, high);
}

/* Set the origins and rows of all polygons, and the size of the array. The
   array includes margins, because polygons may extend beyond the period. */
static void place_polygons(laying *l) {
  eda_raster *r = l->raster;
  const eda_shapes *s = l->shapes;
  eda_frame f = l->frame;
  double w = f.width, h = f.height;
  for (size_t p = 0; p < s->count; p++) {
    eda_box b = eda_shape_box(s, p);
    place *o = &l->places[p];
    o->x = f.x0 + f.width * floor((b.x0 * l->grid - f.x0) / f.width);
    o->y = f.y0 + f.height * floor((b.y0 * l->grid - f.y0) / f.height);
    o->low = (int)floor((b.y0 * l->grid - o->y) / r->dy);
    o->high =
        (int)ceil((b.y1 * l->grid - o->y) / r->dy) + 2 * EDA_RASTER_MARGIN;
    w = fmax(w, b.x1 * l->grid - o->x);
    h = fmax(h, b.y1 * l->grid - o->y);
  }
  r->columns = (int)ceil(w / r->dx) + 2 * EDA_RASTER_MARGIN + EDA_STEP_TAPS;
  r->rows = (int)ceil(h / r->dy) + 2 * EDA_RASTER_MARGIN + EDA_STEP_TAPS;
}

void eda_raster_lay(const opc_context *context, const eda_shapes *shapes,
                    double grid, eda_frame frame, int nx, int ny,
                    eda_raster *out) {
  *out = (eda_raster){
      .dx = frame.width / nx, .dy = frame.height / ny, .nx = nx, .ny = ny};
  laying l = {out, shapes, grid, frame,
              eda_alloc(shapes->count, sizeof *l.places)};
  place_polygons(&l);
  out->step =
      eda_fft_alloc((size_t)out->rows * out->columns * sizeof *out->step);
  opc_parallel(context, BANDS, lay_band, &l);
  free(l.places);
}

/* ---- summation ---- */

typedef struct summing {
  eda_raster *raster;
  float *out;
} summing;

EDA_WIDE static void row_add(double *restrict to, const double *restrict from,
                             int n) {
  for (int i = 0; i < n; i++) to[i] += from[i];
}

EDA_WIDE static void add_to_floats(float *restrict to,
                                   const double *restrict from, int n) {
  for (int i = 0; i < n; i++) to[i] += (float)from[i];
}

/* Sum a block of columns along y. */
static void sum_columns(void *data, size_t block) {
  const eda_raster *r = ((summing *)data)->raster;
  int x = (int)block * COLUMNS;
  int n = r->columns - x < COLUMNS ? r->columns - x : COLUMNS;
  for (int j = 1; j < r->rows; j++) {
    double *row = r->step + (size_t)j * r->columns + x;
    row_add(row, row - r->columns, n);
  }
}

/* Write row y of the period: for all rows of the array that are equal modulo
   the period, sum along x, and add to the period modulo its width. */
static void sum_row(void *data, size_t y) {
  const summing *s = data;
  const eda_raster *r = s->raster;
  float *to = s->out + y * (size_t)r->nx;
  memset(to, 0, sizeof *to * (size_t)r->nx);
  int first = ((int)y + EDA_RASTER_MARGIN) % r->ny;
  for (int j = first; j < r->rows; j += r->ny) {
    double *row = r->step + (size_t)j * r->columns;
    for (int i = 1; i < r->columns; i++) row[i] += row[i - 1];
    int x = (r->nx - EDA_RASTER_MARGIN % r->nx) % r->nx;
    for (int i = 0; i < r->columns;) {
      int n = r->nx - x < r->columns - i ? r->nx - x : r->columns - i;
      add_to_floats(to + x, row + i, n);
      i += n;
      x = 0;
    }
  }
}

void eda_raster_sum(const opc_context *context, eda_raster *raster,
                    float *out) {
  summing s = {raster, out};
  opc_parallel(context, (size_t)(raster->columns + COLUMNS - 1) / COLUMNS,
               sum_columns, &s);
  opc_parallel(context, (size_t)raster->ny, sum_row, &s);
}

void eda_raster_clear(eda_raster *raster) {
  eda_fft_free(raster->step);
  *raster = (eda_raster){0};
}
