/* SPDX-License-Identifier: BSD-3-Clause */
/* Simultaneous, vectorised cuts through a printed line (cuts.h). */
#include "imaging/cuts.h"

#include <math.h>
#include <string.h>

#include <eda/simd.h>
#include "imaging/edge.h"

enum {
  TAPS = EDA_SPLINE_TAPS,
  TOGETHER = 16, /* cuts in a batch */
  PITCH = 128,   /* largest number of coefficients of a cut */
  BLOCK = 8192,  /* largest number of field coefficients near all cuts */
  LINE = 16,     /* the number of coefficients of a cut is a multiple of LINE */
  NEWTON = 4     /* steps of Newton's method */
};

/* Field coefficients near all cuts. A cut has cells k = 0 .. 2 * out; cell
   `out` contains the middle. Cell k has the coefficients k .. k + 5. */
typedef struct window {
  int out;
  size_t pitch;   /* coefficients of a cut, padded with zeros */
  double part[2]; /* from the middle to each end of the middle cell, in cells */
  double step, half;  /* cell size, nm; half of the drawn line, in cells */
  int first;          /* field row of the first row of `block` */
  float block[BLOCK]; /* rows of `pitch` coefficients */
} window;

/* Intermediate results of TOGETHER cuts. */
typedef struct batch {
  double part[TOGETHER], weight[TAPS][TOGETHER];
  const float *row[TOGETHER];
  float c[TOGETHER * PITCH + TAPS], node[TOGETHER * PITCH + TAPS];
  int changes[TOGETHER * PITCH];
  /* Arrays of the edges found. e: coefficients, ordered outwards, of the cell
     that contains the edge. t: position of the edge within this cell. begin:
     distance from the middle to this cell. Unit of t and begin: cells. */
  size_t edges;
  double e[TAPS][2 * TOGETHER], t[2 * TOGETHER], begin[2 * TOGETHER];
} batch;

/* ---- field near the cuts ---- */

/* Return a position in grid steps from node 0 of an axis; NAN if the distance
   exceeds 1e8 steps. */
static double in_steps(const eda_field *field, int axis, double at) {
  const eda_frame *f = &field->frame;
  double v = axis ? (at - f->y0) * field->ny / f->height
                  : (at - f->x0) * field->nx / f->width;
  return fabs(v) < 1e8 ? v : NAN;
}

static void copy_block(const eda_field *field, int axis, int column, int rows,
                       window *w) {
  int columns = 2 * w->out + TAPS;
  int along = axis ? field->ny : field->nx,
      across = axis ? field->nx : field->ny;
  size_t nx = (size_t)field->nx, pitch = w->pitch;
  column = eda_wrap(column, along);
  int row = eda_wrap(w->first, across);
  for (int r = 0; r < rows; r++, row = row + 1 == across ? 0 : row + 1) {
    const float *in =
        field->coefficients + (axis ? (size_t)row : nx * (size_t)row);
    float *out = w->block + pitch * (size_t)r;
    for (int i = 0, j = column; i < columns; j = 0) {
      int run = columns - i < along - j ? columns - i : along - j;
      if (axis)
        for (int k = 0; k < run; k++) out[i + k] = in[nx * (size_t)(j + k)];
      else
        memcpy(out + i, in + j, sizeof *out * (size_t)run);
      i += run;
    }
    for (size_t i = (size_t)columns; i < pitch; i++) out[i] = 0;
  }
}

/* Copy the coefficients near all cuts. Return 0 if too many are needed or a
   position is not valid, otherwise 1. */
static int make_window(const eda_field *field, int axis, double middle,
                       double half, size_t n, const double *at, window *w) {
  const eda_frame *f = &field->frame;
  int along = axis ? field->ny : field->nx;
  w->step = (axis ? f->height : f->width) / along;
  w->half = half / w->step;
  double x = in_steps(field, axis, middle), low = INFINITY, high = -INFINITY;
  if (isnan(x) || !(w->half >= 0 && w->half < PITCH / 2.0)) return 0;
  for (size_t j = 0; j < n; j++) {
    double v = in_steps(field, !axis, at[j]);
    if (isnan(v)) return 0;
    low = fmin(low, v);
    high = fmax(high, v);
  }
  w->out = (int)w->half + 2;
  size_t columns = 2 * (size_t)w->out + TAPS;
  w->pitch = (columns + LINE - 1) / LINE * LINE;
  double rows = floor(high) - floor(low) + TAPS;
  if (w->pitch > PITCH || columns > (size_t)along ||
      rows * (double)w->pitch > BLOCK)
    return 0;
  int cell = (int)floor(x);
  w->part[1] = 1 - (x - cell);
  w->part[0] = x - cell;
  w->first = (int)floor(low) - 2;
  copy_block(field, axis, cell - w->out - 2, (int)rows, w);
  return 1;
}

/* ---- cells ---- */

EDA_WIDE static void batch_weigh(size_t n, batch *u) {
  for (size_t j = 0; j < n; j++) {
    double weight[TAPS];
    eda_spline_cell(u->part[j], weight);
    for (int k = 0; k < TAPS; k++) u->weight[k][j] = weight[k];
  }
}

/* Compute the coefficients of all cells of each cut. */
EDA_WIDE static void batch_contract(const window *w, size_t n, batch *u) {
  size_t pitch = w->pitch;
  for (size_t j = 0; j < n; j++) {
    const float *row = u->row[j];
    float k0 = (float)u->weight[0][j], k1 = (float)u->weight[1][j],
          k2 = (float)u->weight[2][j], k3 = (float)u->weight[3][j],
          k4 = (float)u->weight[4][j], k5 = (float)u->weight[5][j];
    float *c = u->c + pitch * j;
    for (size_t i = 0; i < pitch; i++)
      c[i] = (k0 * row[i] + k1 * row[pitch + i]) +
             (k2 * row[2 * pitch + i] + k3 * row[3 * pitch + i]) +
             (k4 * row[4 * pitch + i] + k5 * row[5 * pitch + i]);
  }
}

/* Count the sign changes of the Bernstein coefficients of each cell. Adjacent
   cells have identical coefficients at their common end. */
EDA_WIDE static void count_changes(size_t n, const float *c, float *node,
                                   int *changes) {
  for (size_t i = 0; i <= n; i++)
    node[i] = c[i] + c[i + 4] + 26 * (c[i + 1] + c[i + 3]) + 66 * c[i + 2];
  for (size_t i = 0; i < n; i++) {
    float c1 = c[i + 1], c2 = c[i + 2], c3 = c[i + 3], c4 = c[i + 4];
    int s0 = node[i] > 0, s5 = node[i + 1] > 0;
    int s1 = 8 * c1 + 33 * c2 + 18 * c3 + c4 > 0;
    int s2 = 2 * c1 + 15 * c2 + 12 * c3 + c4 > 0;
    int s3 = c1 + 12 * c2 + 15 * c3 + 2 * c4 > 0;
    int s4 = c1 + 18 * c2 + 33 * c3 + 8 * c4 > 0;
    changes[i] = (s0 ^ s1) + (s1 ^ s2) + (s2 ^ s3) + (s3 ^ s4) + (s4 ^ s5);
  }
}

/* Return the cell of the first edge on a side, counted from the middle cell.
   Return 0 if there is no edge, or several edges. */
static int find_cell(const window *w, const int *changes, int side) {
  int sign = side ? 1 : -1, k = 1;
  changes += w->out;
  while (k <= w->out && !changes[sign * k]) k++;
  if (k > w->out || changes[sign * k] != 1) return 0;
  for (int i = k + 1; i <= w->out && w->part[side] + i - 1 < w->half; i++)
    if (changes[sign * i]) return 0;
  return k;
}

static void add_edge(const window *w, size_t j, int side, int cell, batch *u) {
  const float *c = u->c + w->pitch * j + w->out + (side ? cell : -cell);
  size_t i = u->edges++;
  for (int k = 0; k < TAPS; k++)
    u->e[k][i] = (double)c[side ? k : TAPS - 1 - k];
  u->begin[i] = w->part[side] + cell - 1;
}

/* Compute the position of each edge in its cell by Newton's method; NAN if the
   method does not converge. */
EDA_WIDE static void find_places(batch *u) {
  for (size_t i = 0; i < u->edges; i++) {
    double c[TAPS], b[TAPS], a[TAPS], slope;
    for (int k = 0; k < TAPS; k++) c[k] = u->e[k][i];
    eda_bernstein(c, b);
    eda_powers(b, a);
    double t = b[0] / (b[0] - b[5]), move = 0;
    for (int k = 0; k < NEWTON; k++) {
      double f = eda_polynomial(a, t, &slope);
      move = f / slope;
      t -= move;
    }
    u->t[i] = t >= 0 && t <= 1 && fabs(move) < 1e-5 ? t : NAN;
  }
}

/* ---- cuts ---- */

static void cuts_batch(const eda_field *field, int axis, const window *w,
                       size_t n, const double *at, double (*distance)[2],
                       batch *u) {
  size_t number[TOGETHER];
  for (size_t j = 0; j < n; j++) {
    double place = in_steps(field, !axis, at[j]) - w->first;
    size_t cell = (size_t)place;
    u->part[j] = place - (double)cell;
    u->row[j] = w->block + w->pitch * (cell - 2);
  }
  batch_weigh(n, u);
  batch_contract(w, n, u);
  size_t all = n * w->pitch;
  for (size_t i = all; i < all + TAPS; i++) u->c[i] = 0;
  count_changes(all, u->c, u->node, u->changes);
  u->edges = 0;
  for (size_t j = 0; j < n; j++) {
    const int *changes = u->changes + w->pitch * j;
    int simple = !changes[w->out] && u->node[w->pitch * j + (size_t)w->out] > 0;
    int low = simple ? find_cell(w, changes, 0) : 0;
    int high = low ? find_cell(w, changes, 1) : 0;
    number[j] = high ? u->edges : TOGETHER * 2;
    if (!high) continue;
    add_edge(w, j, 0, low, u);
    add_edge(w, j, 1, high, u);
  }
  find_places(u);
  for (size_t j = 0; j < n; j++) {
    distance[j][0] = distance[j][1] = NAN;
    size_t i = number[j];
    if (i >= u->edges || isnan(u->t[i]) || isnan(u->t[i + 1])) continue;
    for (int side = 0; side < 2; side++, i++)
      distance[j][side] = (u->begin[i] + u->t[i]) * w->step;
  }
}

void eda_cut_many(const eda_field *field, int axis, double middle, double half,
                  size_t n, const double *at, double (*distance)[2]) {
  window w;
  batch u;
  if (make_window(field, axis, middle, half, n, at, &w))
    for (size_t j = 0; j < n; j += TOGETHER)
      cuts_batch(field, axis, &w, n - j < TOGETHER ? n - j : TOGETHER, at + j,
                 distance + j, &u);
  else
    for (size_t j = 0; j < n; j++) distance[j][0] = distance[j][1] = NAN;
}
