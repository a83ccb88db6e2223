/* SPDX-License-Identifier: BSD-3-Clause */
/* Sign changes of a field along a line. A quintic spline is a polynomial in
   each cell of the grid. The number of sign changes of the Bernstein
   coefficients is an upper bound for the number of sign changes of the
   polynomial. Therefore no pair of close changes is missed, and cells without a
   change take nearly no time. */
#include "imaging/edge.h"

#include <float.h>
#include <math.h>

enum { DEGREE = EDA_SPLINE_TAPS - 1, HALVINGS = 24 };

/* ---- one cell ---- */

/* Compute the Bernstein coefficients of the parts of a cell before and after t
   (de Casteljau's algorithm). */
static void spline_split(const double b[EDA_SPLINE_TAPS], double t,
                         double before[EDA_SPLINE_TAPS],
                         double after[EDA_SPLINE_TAPS]) {
  for (int i = 0; i <= DEGREE; i++) after[i] = b[i];
  for (int level = 0; level <= DEGREE; level++) {
    before[level] = after[0];
    for (int i = 0; i < DEGREE - level; i++)
      after[i] += t * (after[i + 1] - after[i]);
  }
}

static int sign_changes(const double b[EDA_SPLINE_TAPS]) {
  int n = 0;
  for (int i = 0; i < DEGREE; i++) n += (b[i] > 0) != (b[i + 1] > 0);
  return n;
}

/* Return the position of the only sign change in a cell, by Newton's method
   within a bracket. */
static double only_change(const double b[EDA_SPLINE_TAPS]) {
  double a[EDA_SPLINE_TAPS], slope;
  eda_powers(b, a);
  double low = 0, high = 1, t = b[0] / (b[0] - b[5]);
  for (int i = 0; i < 60; i++) {
    double f = eda_polynomial(a, t, &slope);
    if ((f > 0) == (b[0] > 0))
      low = t;
    else
      high = t;
    double next = t - f / slope;
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    if (fabs(next - t) < 1e-5)
      return next; /* the error is about the square of the last step */
    t = next;
  }
  return t;
}

/* Return the position of the first sign change in a cell or part of a cell, 0
   to 1; NAN if there is none. `halvings` limits the recursion depth. */
static double first_change(const double b[EDA_SPLINE_TAPS], int halvings) {
  double before[EDA_SPLINE_TAPS], after[EDA_SPLINE_TAPS];
  int n = sign_changes(b);
  if (n == 0) return NAN;
  if (n == 1) return only_change(b);
  if (halvings == 0) return (b[0] > 0) != (b[DEGREE] > 0) ? 0.5 : NAN;
  spline_split(b, 0.5, before, after);
  double t = first_change(before, halvings - 1);
  if (isnan(t)) t = 1 + first_change(after, halvings - 1);
  return t / 2;
}

/* ---- a line ---- */

void eda_line_make(const eda_field *field, int axis, double at,
                   eda_line *line) {
  const eda_frame *f = &field->frame;
  int across = axis ? field->nx : field->ny;
  line->n = axis ? field->ny : field->nx;
  line->step = (axis ? f->height : f->width) / line->n;
  line->origin = axis ? f->y0 : f->x0;
  double step = (axis ? f->width : f->height) / across;
  size_t next = axis ? 1 : (size_t)field->nx;
  line->stride = axis ? (size_t)field->nx : 1;
  double place = (at - (axis ? f->x0 : f->y0)) / step;
  if (!(place >= 0 && place < across)) place -= across * floor(place / across);
  if (!(place >= 0 && place <= across))
    place = 0; /* too far away for double precision */
  int row = eda_spline_weights(place, line->weight);
  for (int k = 0; k < EDA_SPLINE_TAPS; k++)
    line->row[k] =
        field->coefficients + next * (size_t)eda_wrap(row + k, across);
}

static double line_coefficient(const eda_line *line, int i) {
  size_t offset = line->stride * (size_t)eda_wrap(i, line->n);
  double sum = 0;
  for (int k = 0; k < EDA_SPLINE_TAPS; k++)
    sum += line->weight[k] * line->row[k][offset];
  return sum;
}

/* Compute the spline coefficients of a cell. The three branches compute equal
   sums. The first two branches read memory in order; they apply if neither the
   coefficients along the line nor the rows wrap around at the frame. */
static void cell_coefficients(const eda_line *line, int first,
                              double c[EDA_SPLINE_TAPS]) {
  const float *const *row = line->row;
  int inner = first >= 0 && first + EDA_SPLINE_TAPS <= line->n;
  size_t offset = line->stride * (size_t)first;
  if (inner && line->stride == 1) {
    for (int i = 0; i < EDA_SPLINE_TAPS; i++) c[i] = 0;
    for (int k = 0; k < EDA_SPLINE_TAPS; k++)
      for (int i = 0; i < EDA_SPLINE_TAPS; i++)
        c[i] += line->weight[k] * row[k][offset + (size_t)i];
  } else if (inner &&
             row[EDA_SPLINE_TAPS - 1] - row[0] == EDA_SPLINE_TAPS - 1) {
    for (int i = 0; i < EDA_SPLINE_TAPS; i++, offset += line->stride) {
      double sum = 0;
      for (int k = 0; k < EDA_SPLINE_TAPS; k++)
        sum += line->weight[k] * row[0][offset + (size_t)k];
      c[i] = sum;
    }
  } else {
    for (int i = 0; i < EDA_SPLINE_TAPS; i++)
      c[i] = line_coefficient(line, first + i);
  }
}

double eda_line_start(const eda_line *line, double place, eda_line_search *down,
                      eda_line_search *up) {
  double x = (place - line->origin) / line->step;
  if (!(x >= 0 && x < line->n)) x -= line->n * floor(x / line->n);
  if (!(x >= 0 && x <= line->n)) x = 0; /* too far away for double precision */
  int cell = (int)x;
  double t = x - cell, b[EDA_SPLINE_TAPS], reversed[EDA_SPLINE_TAPS];
  *up = (eda_line_search){
      .line = line, .out = 1, .next = cell + 4, .part = 1 - t, .found = NAN};
  *down = (eda_line_search){
      .line = line, .out = -1, .next = cell - 3, .part = t, .found = NAN};
  cell_coefficients(line, cell - 2, up->c);
  for (int k = 0; k < EDA_SPLINE_TAPS; k++) down->c[DEGREE - k] = up->c[k];
  eda_bernstein(up->c, b);
  if (!sign_changes(b)) {
    /* The cell has no sign change, so only the sign of the value is needed. */
    double weight[EDA_SPLINE_TAPS], value = 0;
    eda_spline_weights(t, weight);
    for (int k = 0; k < EDA_SPLINE_TAPS; k++) value += weight[k] * up->c[k];
    for (int k = 0; k < EDA_SPLINE_TAPS; k++) up->b[k] = down->b[k] = b[0];
    return value;
  }
  spline_split(b, t, reversed, up->b);
  for (int k = 0; k < EDA_SPLINE_TAPS; k++) down->b[k] = reversed[DEGREE - k];
  return up->b[0];
}

/* Restrict b[] to the part of the cell beyond the sign change found last. */
static void search_advance(eda_line_search *w) {
  double before[EDA_SPLINE_TAPS], after[EDA_SPLINE_TAPS];
  int was = w->b[0] > 0;
  spline_split(w->b, w->found, before, after);
  after[0] = was ? -DBL_MIN : DBL_MIN;
  for (int k = 0; k < EDA_SPLINE_TAPS; k++) w->b[k] = after[k];
  w->done += w->found * w->part;
  w->part *= 1 - w->found;
  w->found = NAN;
}

/* Search the remainder of the current cell. If there is a sign change, return
   the distance from the start, nm; the next call continues beyond the sign
   change. Otherwise return NAN; the next call searches the next cell. */
static double line_search_cell(eda_line_search *w) {
  if (!isnan(w->found)) search_advance(w);
  w->found = first_change(w->b, HALVINGS);
  if (!isnan(w->found)) return (w->done + w->found * w->part) * w->line->step;
  w->done += w->part;
  w->part = 1;
  for (int k = 0; k < DEGREE; k++) w->c[k] = w->c[k + 1];
  w->c[DEGREE] = line_coefficient(w->line, w->next);
  w->next += w->out;
  eda_bernstein(w->c, w->b);
  return NAN;
}

/* Return whether the covered distance is at most `limit` and at most one
   period. False for NAN. */
static int is_within(const eda_line_search *w, double limit) {
  return w->done * w->line->step <= limit && w->done <= w->line->n;
}

double eda_line_search_to(eda_line_search *w, double limit) {
  limit = fmin(limit, w->line->n * w->line->step);
  double found = NAN;
  while (isnan(found) && is_within(w, limit)) found = line_search_cell(w);
  return found <= limit ? found : NAN;
}

double eda_field_edge(const eda_field *field, int axis, double x, double y,
                      double reach) {
  double at = axis ? x : y, place = axis ? y : x, found = NAN;
  if (!isfinite(at) || !isfinite(place) || !(reach >= 0)) return NAN;
  eda_line line;
  eda_line_search search[2];
  eda_line_make(field, axis, at, &line);
  eda_line_start(&line, place, &search[0], &search[1]);
  reach = fmin(reach, line.n * line.step);
  /* Advance the search with the smaller covered distance. */
  for (;;) {
    int up = search[1].done <= search[0].done;
    if (!is_within(&search[up], reach)) break;
    double distance = line_search_cell(&search[up]);
    if (isnan(distance)) continue;
    if (distance <= reach) {
      reach = distance;
      found = up ? distance : -distance;
    }
    search[up].done = INFINITY;
  }
  return found;
}

double eda_field_epe(const eda_field *field, int axis, int out, double x,
                     double y, double reach) {
  eda_line line;
  eda_line_search search[2]; /* down, up */
  eda_line_make(field, axis, axis ? x : y, &line);
  double value = eda_line_start(&line, axis ? y : x, &search[0], &search[1]);
  int sign = value > 0 ? 1 : -1;
  return sign * eda_line_search_to(&search[sign * out > 0], reach);
}
