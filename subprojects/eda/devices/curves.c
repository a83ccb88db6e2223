/* SPDX-License-Identifier: BSD-3-Clause */
/* Interpolated currents of a device table, what they are beyond its ends, and
   the way back to a length. */
#include <eda/curves.h>
#include <eda/memory.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_interp.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_STEPS = 1 << 16, MOST_TRIES = 60 };
static const double finest = 1.0 / 32; /* nm */

/* How far a table goes on: these parts of its ends' lengths, below which no
   print is a gate and above which none is of this one; and this much of the
   logarithm, so that no sum overflows, whatever the slope. */
static const double least_part = 0.25, most_part = 4, most_change = 20;
/* The slope there: within this factor of the mean over that part of the
   lengths. Ends of tables from PTM and FreePDK45 cards are at 0.65 to 1.4 of
   it, but for Ioff where the channel is nearly gone, at 0.3. */
static const double freedom = 2, outermost = 0.1;

enum { LOW, HIGH };

/* Beyond an end of the table. */
typedef struct beyond {
  double length, logarithm; /* of the end */
  double slope;             /* of the logarithm, 1/nm, below 0 */
  double last;              /* the last length it goes on to */
} beyond;

/* [type * EDA_CURRENTS + current] */
struct eda_curve {
  double *logarithm; /* of the currents at the table's lengths */
  gsl_interp *spline;
  beyond beyond[2];
};

static const struct eda_curve *find(const eda_curves *c, int type, int k) {
  return &c->exact[type * EDA_CURRENTS + k];
}

/* Between the end and the first length that is a tenth of all away. */
static double mean_slope(const eda_devices *d, const double *y, int side) {
  size_t last = d->count - 1, end = side ? last : 0, i = end;
  double range = d->length[last] - d->length[0];
  do i += side ? (size_t)-1 : 1;
  while (fabs(d->length[i] - d->length[end]) < outermost * range);
  return (y[i] - y[end]) / (d->length[i] - d->length[end]);
}

static beyond find_beyond(const eda_devices *d, const struct eda_curve *curve,
                          int side) {
  const double *y = curve->logarithm;
  size_t end = side ? d->count - 1 : 0;
  beyond b = {.length = d->length[end], .logarithm = y[end]};
  double mean = mean_slope(d, y, side);
  b.slope = gsl_interp_eval_deriv(curve->spline, d->length, y, b.length, NULL);
  b.slope = fmin(fmax(b.slope, mean * freedom), mean / freedom);
  double reach = most_change / -b.slope;
  b.last = side ? fmin(most_part * b.length, b.length + reach)
                : fmax(least_part * b.length, b.length - reach);
  return b;
}

static int add_curve(eda_curves *c, int type, int k, const char *path,
                     opc_error *error) {
  const eda_devices *d = c->devices;
  const double *current = k == EDA_ION ? d->ion[type] : d->ioff[type];
  struct eda_curve *curve = &c->exact[type * EDA_CURRENTS + k];
  curve->logarithm = eda_alloc(d->count, sizeof *curve->logarithm);
  curve->spline = gsl_interp_alloc(gsl_interp_steffen, d->count);
  for (size_t i = 0; i < d->count; i++) {
    if (i && !(current[i] < current[i - 1]))
      return opc_fail(error, OPC_INVALID, "devices",
                      "'%s': a current does not fall from %g to %g nm, so "
                      "that it tells no length",
                      path, d->length[i - 1], d->length[i]);
    curve->logarithm[i] = log(current[i]);
  }
  gsl_interp_init(curve->spline, d->length, curve->logarithm, d->count);
  for (int side = LOW; side <= HIGH; side++)
    curve->beyond[side] = find_beyond(d, curve, side);
  for (size_t i = 0; i <= c->steps; i++)
    c->quick[type][EDA_CURRENTS * i + (size_t)k] =
        exp(eda_curves_at(c, type, k, d->length[0] + (double)i / c->per_nm));
  return OPC_OK;
}

static int read_curves(eda_curves *c, const char *path, opc_error *error) {
  gsl_set_error_handler_off(); /* its default aborts */
  eda_devices *d = c->devices = eda_devices_read(path, error);
  if (!d) return error->code;
  unsigned least = gsl_interp_type_min_size(gsl_interp_steffen);
  if (d->count < least)
    return opc_fail(error, OPC_INVALID, "devices",
                    "'%s' has %zu lengths, at least %u are needed", path,
                    d->count, least);
  double range = d->length[d->count - 1] - d->length[0];
  c->steps = (size_t)fmin(MOST_STEPS, ceil(range / finest));
  c->per_nm = (double)c->steps / range;
  c->exact = eda_alloc(2 * EDA_CURRENTS, sizeof *c->exact);
  for (int type = 0; type < 2; type++) {
    /* One step more: of it the last one takes nothing. */
    c->quick[type] = eda_alloc(EDA_CURRENTS * (c->steps + 2), sizeof(double));
    for (int k = 0; k < EDA_CURRENTS; k++) {
      int code = add_curve(c, type, k, path, error);
      if (code) return code;
    }
  }
  return OPC_OK;
}

int eda_curves_read(eda_curves *c, const char *path, opc_error *error) {
  if (c->devices) return OPC_OK;
  int code = read_curves(c, path, error);
  if (code) eda_curves_clear(c);
  return code;
}

void eda_curves_clear(eda_curves *c) {
  for (int i = 0; c->exact && i < 2 * EDA_CURRENTS; i++) {
    free(c->exact[i].logarithm);
    if (c->exact[i].spline) gsl_interp_free(c->exact[i].spline);
  }
  free(c->exact);
  for (int type = 0; type < 2; type++) free(c->quick[type]);
  eda_devices_free(c->devices);
  *c = (eda_curves){0};
}

double eda_curves_shortest(const eda_curves *c) {
  return c->devices->length[0];
}

double eda_curves_longest(const eda_curves *c) {
  return c->devices->length[c->devices->count - 1];
}

double eda_curves_at(const eda_curves *c, int type, int k, double length) {
  const struct eda_curve *curve = find(c, type, k);
  const beyond *b = curve->beyond;
  length = fmin(fmax(length, b[LOW].last), b[HIGH].last);
  for (int side = LOW; side <= HIGH; side++)
    if (side ? length > b[HIGH].length : length < b[LOW].length)
      return b[side].logarithm + b[side].slope * (length - b[side].length);
  return gsl_interp_eval(curve->spline, c->devices->length, curve->logarithm,
                         length, NULL);
}

static double length_beyond(const beyond *b, double logarithm) {
  double length = b->length + (logarithm - b->logarithm) / b->slope;
  return b->last < b->length ? fmax(length, b->last) : fmin(length, b->last);
}

double eda_curves_length(const eda_curves *c, int type, int k,
                         double logarithm) {
  const eda_devices *d = c->devices;
  const struct eda_curve *curve = find(c, type, k);
  const double *y = curve->logarithm;
  size_t low = 0, high = d->count - 1;
  if (!(logarithm < y[0])) return length_beyond(&curve->beyond[LOW], logarithm);
  if (!(logarithm > y[high]))
    return length_beyond(&curve->beyond[HIGH], logarithm);
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (y[middle] > logarithm)
      low = middle;
    else
      high = middle;
  }
  double a = d->length[low], b = d->length[high];
  double fa = y[low] - logarithm, fb = y[high] - logarithm;
  double x = a;
  /* Regula falsi, Illinois variant. */
  for (int i = 0; i < MOST_TRIES; i++) {
    x = (a * fb - b * fa) / (fb - fa);
    double f = eda_curves_at(c, type, k, x) - logarithm;
    if (fabs(f) < 1e-13) break;
    if ((f > 0) == (fb > 0))
      fa /= 2;
    else
      a = b, fa = fb;
    b = x;
    fb = f;
  }
  return x;
}
