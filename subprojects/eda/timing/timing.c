/* SPDX-License-Identifier: BSD-3-Clause */
/* Timing tables of cells and interpolation in the tables. */
#include <eda/timing.h>

#include <math.h>
#include <stdlib.h>

/* ---- the object ---- */

eda_timing *eda_timing_new(size_t count) {
  eda_timing *t = eda_alloc(1, sizeof *t);
  t->count = count;
  t->cell = eda_pool_alloc(&t->memory, count, sizeof *t->cell);
  return t;
}

void eda_timing_free(void *timing) {
  eda_timing *t = timing;
  if (!t) return;
  eda_pool_clear(&t->memory);
  free(t);
}

const eda_timing_cell *eda_timing_find(const eda_timing *timing,
                                       const char *name) {
  for (size_t i = 0; i < timing->count; i++)
    if (eda_same_name(timing->cell[i].name, name)) return &timing->cell[i];
  return NULL;
}

enum {
  POINTS = 3,    /* grid points with simulated size changes: (load, slew) at
                    positions (0, 0), (1, 0) and (0, 1) */
  CORNERS = 5,   /* simulated pairs of slews of two inputs: four corners of a
                    rectangle and one point inside */
  PAIR_SLEWS = 6 /* slews of both inputs of a pair: three for each input */
};

void eda_timing_cell_figures(eda_pool *pool, eda_timing_cell *c) {
  const size_t grid = c->slews * c->loads,
               changes = c->bundles * (size_t)EDA_SIZES,
               pins = c->inputs * 2 * EDA_CAPS,
               patterns = (c->inputs << c->inputs) * EDA_CAPS,
               gaps = CORNERS * EDA_TIMING_GAPS;
  c->figures = c->arcs * 2 * (grid + POINTS * changes) + pins * (1 + changes);
  c->pair_figures = patterns + c->pairs * (PAIR_SLEWS + 2 * gaps);
  c->figure =
      eda_pool_alloc(pool, c->figures + c->pair_figures, sizeof *c->figure);
  double *at = c->figure;
  for (size_t i = 0; i < c->arcs; i++) {
    eda_timing_arc *a = &c->arc[i];
    a->delay = at;
    a->slew = at + grid;
    a->delay_by = at + 2 * grid;
    a->slew_by = a->delay_by + POINTS * changes;
    at = a->slew_by + POINTS * changes;
  }
  c->capacitance = at;
  c->capacitance_by = at + pins;
  c->pin_capacitance = c->capacitance_by + pins * changes;
  at = c->pin_capacitance + patterns;
  for (size_t i = 0; i < c->pairs; i++, at += PAIR_SLEWS + 2 * gaps) {
    eda_timing_pair *p = &c->pair[i];
    p->at[0] = at;
    p->at[1] = at + PAIR_SLEWS / 2;
    p->delay = at + PAIR_SLEWS;
    p->slew = p->delay + gaps;
  }
}

static int check_cell(const eda_timing_cell *c, opc_error *error) {
  if (!c->name) return opc_fail(error, OPC_FAILED, NULL, "a cell has no name");
  if (c->trouble) return OPC_OK;
  if (!c->inputs || c->inputs > EDA_TIMING_INPUTS || !c->outputs ||
      c->slews < 2 || c->loads < 2 || c->slews > EDA_TIMING_GRID ||
      c->loads > EDA_TIMING_GRID || !c->level || !c->arc_of || !c->figure)
    return opc_fail(error, OPC_FAILED, NULL, "cell '%.100s' is incomplete",
                    c->name);
  for (size_t i = 0; i < c->figures + c->pair_figures; i++)
    if (!isfinite(c->figure[i]))
      return opc_fail(error, OPC_FAILED, NULL,
                      "figure %zu of cell '%.100s' is not a number", i,
                      c->name);
  return OPC_OK;
}

int eda_timing_check(const void *timing, opc_error *error) {
  const eda_timing *t = timing;
  if (t->count && !t->cell)
    return opc_fail(error, OPC_FAILED, NULL, "the library has no cells");
  for (size_t i = 0; i < t->count; i++)
    if (check_cell(&t->cell[i], error)) return error->code;
  return OPC_OK;
}

/* ---- interpolation ---- */

/* Return the slope at point i of the parabola through the point and its
   neighbours. */
static double slope_at(const double *x, const double *y, size_t n, size_t i) {
  if (n == 2) return (y[1] - y[0]) / (x[1] - x[0]);
  size_t m = i ? i + 1 < n ? i : n - 2 : 1;
  double h0 = x[m] - x[m - 1], h1 = x[m + 1] - x[m];
  double d0 = (y[m] - y[m - 1]) / h0, d1 = (y[m + 1] - y[m]) / h1;
  double bend = (d1 - d0) / (h0 + h1);
  return d0 + bend * (2 * x[i] - x[m - 1] - x[m]);
}

void eda_timing_cubic(const double *x, const double *y, size_t n,
                      double *coefficient) {
  for (size_t i = 0; i + 1 < n; i++) {
    double h = x[i + 1] - x[i], d = (y[i + 1] - y[i]) / h;
    double s0 = slope_at(x, y, n, i), s1 = slope_at(x, y, n, i + 1);
    double *c = coefficient + 4 * i;
    c[0] = y[i];
    c[1] = s0;
    c[2] = (3 * d - 2 * s0 - s1) / h;
    c[3] = (s0 + s1 - 2 * d) / (h * h);
  }
}

double eda_timing_cubic_at(const double *x, const double *coefficient, size_t n,
                           double at) {
  size_t i = 0;
  while (i + 2 < n && at > x[i + 1]) i++;
  const double *c = coefficient + 4 * i;
  double t = at - x[i], h = x[i + 1] - x[i];
  if (t < 0) return c[0] + c[1] * t;
  double over = 0;
  if (t > h) {
    over = (t - h) * (c[1] + h * (2 * c[2] + 3 * h * c[3]));
    t = h;
  }
  return c[0] + t * (c[1] + t * (c[2] + t * c[3])) + over;
}

/* ---- look-up ---- */

static double at_load(const eda_timing_cell *c, const double *row,
                      double load) {
  double coefficient[EDA_TIMING_POWERS * EDA_TIMING_GRID];
  eda_timing_cubic(c->at_load, row, c->loads, coefficient);
  return eda_timing_cubic_at(c->at_load, coefficient, c->loads, load);
}

/* Return the position of a value: 0 at at[near[0]] and 1 at at[near[1]], the
   two grid points with simulated size changes. */
static double position_between(const double *at, const size_t near[2],
                               double value) {
  return (value - at[near[0]]) / (at[near[1]] - at[near[0]]);
}

static double plane_through(const double at[POINTS], double load, double slew) {
  return at[0] + load * (at[1] - at[0]) + slew * (at[2] - at[0]);
}

static void sum_changes(const eda_timing_cell *c, const double *by,
                        const double *change, double sum[POINTS]) {
  const size_t n = c->bundles * (size_t)EDA_SIZES;
  for (size_t p = 0; p < POINTS; p++) {
    sum[p] = 0;
    for (size_t k = 0; k < n && change; k++)
      sum[p] += by[p * n + k] * change[k];
  }
}

void eda_timing_at(const eda_timing_cell *c, const eda_timing_arc *a,
                   double delay_load, double slew_load, const double *change,
                   double *delay, double *slew) {
  double by_delay[POINTS], by_slew[POINTS];
  double d = position_between(c->at_load, c->near_load, delay_load),
         l = position_between(c->at_load, c->near_load, slew_load);
  sum_changes(c, a->delay_by, change, by_delay);
  sum_changes(c, a->slew_by, change, by_slew);
  for (size_t i = 0; i < c->slews; i++) {
    double s = position_between(c->at_slew, c->near_slew, c->at_slew[i]);
    delay[i] = at_load(c, a->delay + i * c->loads, delay_load) +
               plane_through(by_delay, d, s);
    slew[i] = at_load(c, a->slew + i * c->loads, slew_load) +
              plane_through(by_slew, l, s);
  }
}

double eda_timing_capacitance(const eda_timing_cell *c, size_t input, int rises,
                              int cap, const double *change) {
  const size_t n = c->bundles * (size_t)EDA_SIZES;
  size_t i = (input * 2 + (size_t)rises) * EDA_CAPS + (size_t)cap;
  double sum = c->capacitance[i];
  for (size_t k = 0; k < n && change; k++)
    sum += c->capacitance_by[i * n + k] * change[k];
  return sum;
}

/* ---- two switching inputs ---- */

/* Simulated gaps, denser where two inputs interact most. The values were chosen
   for this program. */
const double eda_timing_gap[EDA_TIMING_GAPS] = {0, 0.2, 0.45, 0.8, 1.3, 2.5};

double eda_timing_blend(double gap, double cause, double other) {
  double part = gap < 1 ? (1 - gap) / 2 : 0;
  return (1 - part) * cause + part * other;
}

/* Largest extrapolation of factors beyond the two simulated slews, as a
   fraction of the distance between these slews. Factors are not linear further
   away. The value was chosen for this program. */
static const double beyond = 0.5;

/* Return the position of a value relative to at[0] (position 0) and at[1]
   (position 1), limited to -beyond .. 1 + beyond. */
static double place_of(const double at[2], double value) {
  double place = (value - at[0]) / (at[1] - at[0]);
  return fmin(1 + beyond, fmax(-beyond, place));
}

/* Return a factor at a gap by cubic interpolation. Between the last two
   simulated gaps the interpolation is linear, because a cubic would overshoot.
   Beyond the last gap, parallel inputs are independent, so the factor is 1. For
   inputs in series, the first input has permanently changed the charge of inner
   nodes, so the factor keeps its last value. */
static double factor_at(const double *value, int parallel, double gap) {
  enum { LAST = EDA_TIMING_GAPS - 1 };
  const double *x = eda_timing_gap;
  double coefficient[4 * (LAST - 1)];
  if (gap >= x[LAST]) return parallel ? 1 : value[LAST];
  if (gap >= x[LAST - 1])
    return value[LAST - 1] + (value[LAST] - value[LAST - 1]) *
                                 (gap - x[LAST - 1]) / (x[LAST] - x[LAST - 1]);
  eda_timing_cubic(x, value, LAST, coefficient);
  return eda_timing_cubic_at(x, coefficient, LAST, gap);
}

static double blend_linear(const double *v, double a, double b) {
  const size_t n = EDA_TIMING_GAPS;
  return (1 - a) * ((1 - b) * v[0] + b * v[n]) +
         a * ((1 - b) * v[2 * n] + b * v[3 * n]);
}

/* Return a weight for the positions a and b of two slews: a (1 - a) b (1 - b)
   inside the unit square, otherwise 0. The maximum is 1/16. */
static double bulge(double a, double b) {
  return fmax(0, a * (1 - a)) * fmax(0, b * (1 - b));
}

void eda_timing_pair_at(const eda_timing_pair *p, double gap, double first,
                        double second, double *delay, double *slew) {
  double part[2][EDA_TIMING_GAPS], a = place_of(p->at[0], first),
                                   b = place_of(p->at[1], second);
  double a0 = place_of(p->at[0], p->at[0][2]),
         b0 = place_of(p->at[1], p->at[1][2]);
  double most = bulge(a0, b0), share = most > 0 ? bulge(a, b) / most : 0;
  const double *of[2] = {p->delay, p->slew};
  for (int k = 0; k < 2; k++)
    for (size_t g = 0; g < EDA_TIMING_GAPS; g++) {
      const double *v = of[k] + g;
      double over = v[4 * EDA_TIMING_GAPS] - blend_linear(v, a0, b0);
      part[k][g] = blend_linear(v, a, b) + share * over;
    }
  *delay = factor_at(part[0], p->parallel, gap);
  *slew = factor_at(part[1], p->parallel, gap);
}

/* ---- input ramps ---- */

/* Level at which the linear part of a ramp ends and the exponential part
   begins, for falling [0] and rising [1] ramps. Let r be the time from 50 to 90
   % of a transition divided by the time from 30 to 70 %. In simulations of 65
   nm inverters and NAND gates with loads of 0 to 8 fF, r was 1.4 to 1.8 for
   rising and 1.1 to 1.3 for falling outputs. The rising ramp has r = 1.7, the
   falling ramp r = 1.3. With a level of 0.5 for both directions, delays of a
   chain are 5 % too short for falling outputs and 5 % too long for rising
   outputs. */
static const double bend[] = {0.7, 0.55};

/* End of the ramp: level of the last point of the exponential part, and
   duration of the final straight line from this level to 1, in units of
   eda_timing_ramp. The values were chosen for this program: the last percent of
   a gate's input changes no relevant current. */
static const double ramp_last = 0.99, ramp_step = 0.1;

double eda_timing_ramp(int rises, double level) {
  double b = bend[!!rises];
  return level <= b ? level : b + (1 - b) * log((1 - b) / (1 - level));
}

void eda_timing_ramp_points(int rises, double time[EDA_TIMING_RAMP],
                            double level[EDA_TIMING_RAMP]) {
  const double first = bend[!!rises], last = ramp_last;
  level[0] = time[0] = 0;
  for (int i = 1; i < EDA_TIMING_RAMP - 1; i++) {
    /* The differences between these levels and 1 form a geometric series. */
    double part = (double)(i - 1) / (EDA_TIMING_RAMP - 3);
    level[i] = 1 - (1 - first) * pow((1 - last) / (1 - first), part);
    time[i] = eda_timing_ramp(rises, level[i]);
  }
  level[EDA_TIMING_RAMP - 1] = 1;
  time[EDA_TIMING_RAMP - 1] = time[EDA_TIMING_RAMP - 2] + ramp_step;
}

double eda_timing_ramp_time(const eda_timing *timing, double slew, int rises) {
  return slew / (eda_timing_ramp(rises, timing->high) -
                 eda_timing_ramp(rises, timing->low));
}

void eda_timing_ramp_write(FILE *out, const eda_timing *timing, int from,
                           int to, double slew, double middle) {
  double whole = eda_timing_ramp_time(timing, slew, to),
         begin = middle - whole * eda_timing_ramp(to, 0.5);
  double t[EDA_TIMING_RAMP], level[EDA_TIMING_RAMP];
  eda_timing_ramp_points(to, t, level);
  fprintf(out, "pwl(0 %.17g", timing->supply * from);
  for (int i = 0; i < EDA_TIMING_RAMP; i++)
    fprintf(out, "\n+ %.17g %.17g", begin + whole * t[i],
            timing->supply * (from + (to - from) * level[i]));
  fputs(")\n", out);
}
