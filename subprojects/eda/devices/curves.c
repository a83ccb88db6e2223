/* SPDX-License-Identifier: BSD-3-Clause */
/* Interpolated currents of a device table, and the way back to a length. */
#include <eda/curves.h>
#include <eda/memory.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_interp.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_STEPS = 1 << 16, MOST_TRIES = 60 };
static const double finest = 1.0 / 32; /* nm */

/* [type * EDA_CURRENTS + current] */
struct eda_curve {
  double *logarithm; /* of the currents at the table's lengths */
  gsl_interp *spline;
};

static const struct eda_curve *find(const eda_curves *c, int type, int k) {
  return &c->exact[type * EDA_CURRENTS + k];
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
  length = fmin(fmax(length, eda_curves_shortest(c)), eda_curves_longest(c));
  return gsl_interp_eval(curve->spline, c->devices->length, curve->logarithm,
                         length, NULL);
}

double eda_curves_length(const eda_curves *c, int type, int k,
                         double logarithm) {
  const eda_devices *d = c->devices;
  const double *y = find(c, type, k)->logarithm;
  size_t low = 0, high = d->count - 1;
  if (!(logarithm < y[0])) return d->length[0];
  if (!(logarithm > y[high])) return d->length[high];
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
