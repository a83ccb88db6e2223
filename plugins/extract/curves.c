/* SPDX-License-Identifier: BSD-3-Clause */
#include "curves.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_STEPS = 1 << 16 };
static const double finest = 1.0 / 32;   /* nm */

static int make_curve(curves *c, int type, int k, const opc_host *host,
                      const char *path, opc_error *error) {
  const opc_devices *d = c->devices;
  const double *current = k == ION ? d->ion[type] : d->ioff[type];
  double *y = malloc(d->count * sizeof *y);
  gsl_interp *curve = gsl_interp_alloc(gsl_interp_steffen, d->count);
  c->logarithm[type][k] = y;
  c->curve[type][k] = curve;
  if (!y || !curve)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < d->count; i++) {
    if (i && !(current[i] < current[i - 1]))
      return host->fail(host, error, OPC_INVALID, "devices",
                        "'%s': a current does not fall from %g to %g nm, so "
                        "that it tells no length",
                        path, d->length[i - 1], d->length[i]);
    y[i] = log(current[i]);
  }
  gsl_interp_init(curve, d->length, y, d->count);
  for (size_t i = 0; i <= c->steps; i++)
    c->quick[type][CURRENTS * i + (size_t)k] =
        exp(curves_at(c, type, k, d->length[0] + (double)i / c->per_nm));
  return OPC_OK;
}

int curves_load(curves *c, const opc_host *host, const char *path,
                opc_error *error) {
  if (c->devices) return OPC_OK;
  gsl_set_error_handler_off();   /* its default aborts */
  opc_devices *d = host->devices->load(host, path, error);
  if (!d) return error->code;
  c->devices = d;
  if (d->count < gsl_interp_type_min_size(gsl_interp_steffen))
    return host->fail(host, error, OPC_INVALID, "devices",
                      "'%s' has %zu lengths, at least %u are needed", path,
                      d->count, gsl_interp_type_min_size(gsl_interp_steffen));
  double range = d->length[d->count - 1] - d->length[0];
  c->steps = (size_t)fmin(MOST_STEPS, ceil(range / finest));
  c->per_nm = (double)c->steps / range;
  for (int type = 0; type < 2; type++) {
    /* One step more: of it the last one takes nothing. */
    c->quick[type] = calloc(CURRENTS * (c->steps + 2), sizeof(double));
    if (!c->quick[type])
      return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    for (int k = 0; k < CURRENTS; k++) {
      int code = make_curve(c, type, k, host, path, error);
      if (code) return code;
    }
  }
  return OPC_OK;
}

void curves_clear(curves *c, const opc_host *host) {
  for (int type = 0; type < 2; type++) {
    free(c->quick[type]);
    for (int k = 0; k < CURRENTS; k++) {
      if (c->curve[type][k]) gsl_interp_free(c->curve[type][k]);
      free(c->logarithm[type][k]);
    }
  }
  if (c->devices) host->devices->release(c->devices);
}

double curves_shortest(const curves *c) { return c->devices->length[0]; }
double curves_longest(const curves *c) {
  return c->devices->length[c->devices->count - 1];
}

double curves_at(const curves *c, int type, int k, double length) {
  length = fmin(fmax(length, curves_shortest(c)), curves_longest(c));
  return gsl_interp_eval(c->curve[type][k], c->devices->length,
                         c->logarithm[type][k], length, NULL);
}

double curves_length(const curves *c, int type, int k, double logarithm) {
  const opc_devices *d = c->devices;
  const double *y = c->logarithm[type][k];
  size_t low = 0, high = d->count - 1;
  if (!(logarithm < y[0])) return d->length[0];
  if (!(logarithm > y[high])) return d->length[high];
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (y[middle] > logarithm) low = middle;
    else high = middle;
  }
  double a = d->length[low], b = d->length[high];
  double fa = y[low] - logarithm, fb = y[high] - logarithm;
  double x = a;
  /* Regula falsi, Illinois variant. */
  for (int i = 0; i < 60; i++) {
    x = (a * fb - b * fa) / (fb - fa);
    double f = curves_at(c, type, k, x) - logarithm;
    if (fabs(f) < 1e-13) break;
    if ((f > 0) == (fb > 0)) fa /= 2;
    else a = b, fa = fb;
    b = x;
    fb = f;
  }
  return x;
}
