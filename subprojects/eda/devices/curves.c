/* SPDX-License-Identifier: BSD-3-Clause */
/* Currents of a device table: interpolation and extrapolation in L and W, and
   the inverse from current to length. */
#include <eda/curves.h>
#include <eda/memory.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_interp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_STEPS = 1 << 16, MOST_TRIES = 60 };
static const double finest =
    1.0 / 32; /* smallest step of `quick` for the widest transistors, nm */
/* Number of steps of `quick` for each narrow width, from the shortest length.
   Narrow widths are many and their curves are smoother. */
enum { NARROW_STEPS = 1 << 13 };
static const double narrow_finest =
    1.0 / 8; /* step of `quick` for narrow widths, nm */
/* Smallest |slope| of an extrapolation, 1/nm. The extrapolated current
   therefore falls with length even if the current at the end of the table does
   not. */
static const double least_slope = 1e-4;

/* Limits of extrapolation. least_part and most_part: fractions of the shortest
   and longest length; gates beyond these lengths do not occur. most_change:
   largest change of the logarithm, which prevents overflow of sums. */
static const double least_part = 0.25, most_part = 4, most_change = 20;
/* The slope of an extrapolation is limited to within the factor `freedom` of
   the mean slope over the outermost tenth of the lengths. In tables from PTM
   and FreePDK45 cards, the slope of the last step is 0.65 to 1.4 times the
   mean. For Ioff at the shortest lengths, where the channel nearly vanishes,
   the ratio is 0.3. */
static const double freedom = 2, outermost = 0.1;

enum { LOW, HIGH };

/* Extrapolation beyond one end of the table. */
typedef struct beyond {
  double length, logarithm; /* length (nm) and logarithm of the current at the
                               end of the table */
  double slope;             /* d(logarithm)/d(length), 1/nm, negative */
  double last;              /* length at which the extrapolation ends, nm */
} beyond;

/* Curve of one current of one transistor type at one width. Array index: [width
   * CURVES + type * EDA_CURRENTS + current]; width 0 is the largest width,
   followed by the narrow widths. */
struct eda_curve {
  double *
      logarithm; /* natural logarithm of the current per width at each length */
  gsl_interp *spline;
  beyond beyond[2];
  int falls; /* 1: the current falls with length everywhere, so the inverse is
                unique */
  double *quick;     /* narrow widths: logarithm at steps of narrow_finest */
  double least_part; /* narrow widths: smallest ratio (at most 1) of the current
                        per width to that of the largest width */
};

enum { CURVES = 2 * EDA_CURRENTS }; /* curves of one width */

/* Return a curve of width i; i = devices->narrow denotes the largest width. */
static const struct eda_curve *of_width(const eda_curves *c, size_t i, int type,
                                        int k) {
  size_t at = i < c->devices->narrow ? i + 1 : 0;
  return &c->exact[at * CURVES + (size_t)(type * EDA_CURRENTS + k)];
}

/* Return the mean slope from one end to the nearest length that is at least a
   tenth of the range away. */
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
  double mean = fmin(mean_slope(d, y, side), -least_slope);
  b.slope = gsl_interp_eval_deriv(curve->spline, d->length, y, b.length, NULL);
  b.slope = fmin(fmax(b.slope, mean * freedom), mean / freedom);
  double reach = most_change / -b.slope;
  b.last = side ? fmin(most_part * b.length, b.length + reach)
                : fmax(least_part * b.length, b.length - reach);
  return b;
}

static double value_at(const eda_curves *c, const struct eda_curve *curve,
                       double length) {
  const beyond *b = curve->beyond;
  length = fmin(fmax(length, b[LOW].last), b[HIGH].last);
  for (int side = LOW; side <= HIGH; side++)
    if (side ? length > b[HIGH].length : length < b[LOW].length)
      return b[side].logarithm + b[side].slope * (length - b[side].length);
  return gsl_interp_eval(curve->spline, c->devices->length, curve->logarithm,
                         length, NULL);
}

double eda_curves_at(const eda_curves *c, int type, int k, double length) {
  return value_at(c, &c->exact[type * EDA_CURRENTS + k], length);
}

/* Text for messages, such as " of 420 nm wide transistors"; "" for a table of
   one width. */
typedef struct width_text {
  char text[48];
} width_text;

static width_text of_width_text(const eda_devices *d, double width) {
  width_text out = {""};
  if (d->narrow)
    (void)snprintf(out.text, sizeof out.text, " of %g nm wide transistors",
                   width);
  return out;
}

/* Set a curve from the currents per width at the lengths of the table. `must`:
   1: fail if the current does not fall with length. */
static int set_curve(const eda_curves *c, struct eda_curve *curve,
                     const double *current, double width, int must,
                     const char *path, opc_error *error) {
  const eda_devices *d = c->devices;
  curve->logarithm = eda_alloc(d->count, sizeof *curve->logarithm);
  curve->spline = gsl_interp_alloc(gsl_interp_steffen, d->count);
  curve->falls = 1;
  for (size_t i = 0; i < d->count; i++) {
    int falls = !i || current[i] < current[i - 1];
    curve->falls &= falls;
    if (!falls && must)
      return opc_fail(error, OPC_INVALID, "devices",
                      "'%s': a current%s does not fall from %g to %g nm, so "
                      "that a length cannot be computed",
                      path, of_width_text(d, width).text, d->length[i - 1],
                      d->length[i]);
    curve->logarithm[i] = log(current[i]);
  }
  gsl_interp_init(curve->spline, d->length, curve->logarithm, d->count);
  for (int side = LOW; side <= HIGH; side++)
    curve->beyond[side] = find_beyond(d, curve, side);
  return OPC_OK;
}

static int add_curve(eda_curves *c, int type, int k, const char *path,
                     opc_error *error) {
  const eda_devices *d = c->devices;
  const double *current = k == EDA_ION ? d->ion[type] : d->ioff[type];
  int code = set_curve(c, &c->exact[type * EDA_CURRENTS + k], current, d->width,
                       !d->narrow || k == EDA_ION, path, error);
  for (size_t i = 0; i <= c->steps && !code; i++)
    c->quick[type][EDA_CURRENTS * i + (size_t)k] =
        exp(eda_curves_at(c, type, k, d->length[0] + (double)i / c->per_nm));
  return code;
}

/* Add the curve of narrow width n. */
static int add_narrow(eda_curves *c, size_t n, int type, int k,
                      const char *path, opc_error *error) {
  const eda_devices *d = c->devices;
  size_t at = (n + 1) * CURVES + (size_t)(type * EDA_CURRENTS + k);
  struct eda_curve *curve = &c->exact[at];
  const double *wide = c->exact[type * EDA_CURRENTS + k].logarithm;
  const double *current =
      (k == EDA_ION ? d->narrow_ion : d->narrow_ioff)[type] + n * d->count;
  int code = set_curve(c, curve, current, d->narrow_width[n], 0, path, error);
  if (code) return code;
  curve->least_part = 1;
  for (size_t i = 0; i < d->count; i++)
    curve->least_part =
        fmin(curve->least_part, exp(curve->logarithm[i] - wide[i]));
  curve->quick = eda_alloc(NARROW_STEPS + 1, sizeof *curve->quick);
  for (size_t i = 0; i <= NARROW_STEPS; i++)
    curve->quick[i] =
        value_at(c, curve, d->length[0] + (double)i * narrow_finest);
  return OPC_OK;
}

/* Make all curves of a table. */
static int make_curves(eda_curves *c, const char *path, opc_error *error) {
  const eda_devices *d = c->devices;
  unsigned least = gsl_interp_type_min_size(gsl_interp_steffen);
  if (d->count < least)
    return opc_fail(error, OPC_INVALID, "devices",
                    "'%s' has %zu lengths, expected at least %u", path,
                    d->count, least);
  double range = d->length[d->count - 1] - d->length[0];
  c->steps = (size_t)fmin(MOST_STEPS, ceil(range / finest));
  c->per_nm = (double)c->steps / range;
  c->exact = eda_alloc((d->narrow + 1) * CURVES, sizeof *c->exact);
  for (int type = 0; type < 2; type++) {
    /* Interpolation at the last step reads one more step with weight 0. */
    c->quick[type] = eda_alloc(EDA_CURRENTS * (c->steps + 2), sizeof(double));
    for (int k = 0; k < EDA_CURRENTS; k++) {
      int code = add_curve(c, type, k, path, error);
      for (size_t n = 0; n < d->narrow && !code; n++)
        code = add_narrow(c, n, type, k, path, error);
      if (code) return code;
    }
  }
  return OPC_OK;
}

int eda_curves_read(eda_curves *c, const char *path, opc_error *error) {
  if (c->devices) return OPC_OK;
  gsl_set_error_handler_off(); /* the default handler aborts */
  c->devices = eda_devices_read(path, error);
  if (!c->devices) return error->code;
  int code = make_curves(c, path, error);
  for (eda_curves *of = c; of->devices->next && !code; of = of->next) {
    of->next = eda_alloc(1, sizeof *of->next);
    of->next->devices = of->devices->next;
    code = make_curves(of->next, path, error);
  }
  if (code) eda_curves_clear(c);
  return code;
}

const eda_curves *eda_curves_of(const eda_curves *c, const char *flavour) {
  if (!flavour || !*flavour) return c;
  do c = c->next;
  while (c && strcmp(c->devices->flavour, flavour) != 0);
  return c;
}

static void clear_curves(eda_curves *c) {
  size_t curves = c->exact ? (c->devices->narrow + 1) * CURVES : 0;
  for (size_t i = 0; i < curves; i++) {
    free(c->exact[i].logarithm);
    free(c->exact[i].quick);
    if (c->exact[i].spline) gsl_interp_free(c->exact[i].spline);
  }
  free(c->exact);
  for (int type = 0; type < 2; type++) free(c->quick[type]);
}

void eda_curves_clear(eda_curves *c) {
  eda_curves *next = c->next;
  clear_curves(c);
  while (next) {
    eda_curves *of = next;
    next = of->next;
    clear_curves(of);
    free(of);
  }
  eda_devices_free(c->devices);
  *c = (eda_curves){0};
}

double eda_curves_shortest(const eda_curves *c) {
  return c->devices->length[0];
}

double eda_curves_modelled(const eda_curves *c, int type) {
  return fmax(c->devices->modelled[type], eda_curves_shortest(c));
}

double eda_curves_longest(const eda_curves *c) {
  return c->devices->length[c->devices->count - 1];
}

static double length_beyond(const beyond *b, double logarithm) {
  double length = b->length + (logarithm - b->logarithm) / b->slope;
  return b->last < b->length ? fmax(length, b->last) : fmin(length, b->last);
}

double eda_curves_length(const eda_curves *c, int type, int k,
                         double logarithm) {
  const eda_devices *d = c->devices;
  const struct eda_curve *curve = &c->exact[type * EDA_CURRENTS + k];
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
  /* Regula falsi (Illinois variant). */
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

/* ---- narrow transistors ---- */

double eda_curves_narrowest(const eda_curves *c) {
  return c->devices->narrow ? c->devices->narrow_width[0] : 0;
}

static double width_of(const eda_devices *d, size_t i) {
  return i < d->narrow ? d->narrow_width[i] : d->width;
}

eda_curves_width eda_curves_among(const eda_curves *c, double width) {
  const eda_devices *d = c->devices;
  eda_curves_width w = {.width = width,
                        .is_wide = !d->narrow || !(width < d->width)};
  if (w.is_wide || !(width > width_of(d, 0))) return w;
  while (w.low + 1 < d->narrow && width >= width_of(d, w.low + 1)) w.low++;
  double from = 1 / width_of(d, w.low), to = 1 / width_of(d, w.low + 1);
  w.part = (from - 1 / width) / (from - to);
  return w;
}

double eda_curves_narrow_at(const eda_curves *c, int type, int k, double length,
                            const eda_curves_width *w) {
  if (w->is_wide) return eda_curves_at(c, type, k, length);
  double a = value_at(c, of_width(c, w->low, type, k), length);
  double b = value_at(c, of_width(c, w->low + 1, type, k), length);
  return a + w->part * (b - a);
}

void eda_curves_narrow_quick(const eda_curves *c, int type, double length,
                             const eda_curves_width *w,
                             double current[EDA_CURRENTS]) {
  double x = (length - c->devices->length[0]) / narrow_finest;
  int inside = x >= 0 && x < NARROW_STEPS;
  size_t i = inside ? (size_t)x : 0;
  double part = x - (double)i, wide[EDA_CURRENTS];
  int high_is_wide = w->low + 1 == c->devices->narrow;
  if (inside && high_is_wide) eda_curves_quick(c, type, length, wide);
  for (int k = 0; k < EDA_CURRENTS; k++) {
    const double *low = of_width(c, w->low, type, k)->quick + i;
    double y = low[0] + part * (low[1] - low[0]), to;
    if (!inside) {
      y = eda_curves_narrow_at(c, type, k, length, w);
    } else {
      const double *high = of_width(c, w->low + 1, type, k)->quick;
      to = high_is_wide ? log(wide[k])
                        : high[i] + part * (high[i + 1] - high[i]);
      y += w->part * (to - y);
    }
    current[k] = exp(y);
  }
}

double eda_curves_least_share(const eda_curves *c, int type, int k,
                              const eda_curves_width *w) {
  if (w->is_wide) return 1;
  const struct eda_curve *low = of_width(c, w->low, type, k),
                         *high = of_width(c, w->low + 1, type, k);
  double to = high->quick ? high->least_part : 1;
  return low->least_part + w->part * (to - low->least_part);
}

/* Return the length between `low` and `high` at which the curve equals
   `logarithm`, by bisection. */
static double curve_crossing(const eda_curves *c, int type, int k,
                             double logarithm, const eda_curves_width *w,
                             double low, double high) {
  double sign = eda_curves_narrow_at(c, type, k, low, w) > logarithm ? 1 : -1;
  for (int i = 0; i < MOST_TRIES && high - low > 1e-11 * high; i++) {
    double middle = (low + high) / 2;
    double more = eda_curves_narrow_at(c, type, k, middle, w) - logarithm;
    if (sign * more > 0)
      low = middle;
    else
      high = middle;
  }
  return (low + high) / 2;
}

/* Search in steps of 1 nm in both directions from `near` for a length with the
   given current. Return `near` if no such length is within 200 nm. */
static double nearest_length(const eda_curves *c, int type, int k,
                             double logarithm, const eda_curves_width *w,
                             double near) {
  const double step = 1, most = 200; /* nm */
  int is_more = eda_curves_narrow_at(c, type, k, near, w) > logarithm;
  for (double far = step; far <= most; far += step)
    for (int side = -1; side < 2; side += 2) {
      double at = near + side * far, before = at - side * step;
      if ((eda_curves_narrow_at(c, type, k, at, w) > logarithm) != is_more)
        return curve_crossing(c, type, k, logarithm, w, fmin(at, before),
                              fmax(at, before));
    }
  return near;
}

double eda_curves_narrow_length(const eda_curves *c, int type, int k,
                                double logarithm, const eda_curves_width *w,
                                double near) {
  const struct eda_curve *low = of_width(c, w->low, type, k),
                         *high = of_width(c, w->low + 1, type, k);
  if (!w->is_wide && low->falls && high->falls)
    return curve_crossing(c, type, k, logarithm, w,
                          least_part * eda_curves_shortest(c),
                          most_part * eda_curves_longest(c));
  if (w->is_wide && c->exact[type * EDA_CURRENTS + k].falls)
    return eda_curves_length(c, type, k, logarithm);
  return nearest_length(c, type, k, logarithm, w, near);
}
