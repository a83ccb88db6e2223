/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements deviations of drive currents and the colour scale of the
   deviations. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drawer.h"

/* Fraction of the transistors within the colour scale. Insets show transistors
   beyond. */
static const double holds = 0.98;

static const double most_asked = 1e6; /* % */

int drawer_check_scale(drawer *d, opc_error *error) {
  char *end;
  if (!strcmp(d->scale, "auto")) return OPC_OK;
  d->asked = strtod(d->scale, &end);
  while (*end == ' ') end++;
  if (end != d->scale && !strcmp(end, "%") && d->asked > 0 &&
      d->asked <= most_asked)
    return OPC_OK;
  return opc_fail(
      error, OPC_INVALID, "scale",
      "'scale' is '%.100s', expected a percentage above 0, as in 2 %%, or auto",
      d->scale);
}

int drawer_fails(const drawer *d, size_t gate) {
  if (d->state == BEFORE) return !(d->mask->before.ion[gate] > 0);
  return eda_print_failed(d->mask->flags[gate]);
}

double drawer_deviation(const drawer *d, const eda_performance *p,
                        size_t gate) {
  double off = eda_deviation(p->ion[gate], d->mask->design.ion[gate]);
  return isfinite(off) ? off : NAN;
}

double drawer_figure(const drawer *d, size_t gate) {
  double before = drawer_deviation(d, &d->mask->before, gate);
  double after = drawer_deviation(d, &d->mask->after, gate);
  return d->state == BEFORE  ? before
         : d->state == AFTER ? after
                             : fabs(after) - fabs(before);
}

static double rounded_up(double x) {
  static const double steps[] = {0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100};
  size_t k = 0;
  while (k + 1 < sizeof steps / sizeof steps[0] && steps[k] < x - 1e-9) k++;
  return steps[k];
}

void drawer_set_range(drawer *d) {
  size_t n = 0;
  double *all = eda_alloc(d->mask->gates->count, sizeof *all);
  for (size_t i = 0; i < d->mask->gates->count; i++) {
    double x = fabs(drawer_figure(d, i));
    if (!drawer_fails(d, i) && !isnan(x)) all[n++] = x;
  }
  qsort(all, n, sizeof *all, eda_doubles_rise);
  d->range = d->asked > 0 ? d->asked
             : n          ? rounded_up(all[(size_t)ceil(holds * (double)n) - 1])
                          : rounded_up(0);
  d->beyond = 0;
  for (size_t i = 0; i < n; i++) d->beyond += all[i] > d->range + 1e-9;
  free(all);
}

void drawer_statistics(const drawer *d, const eda_performance *of, double *mean,
                       double *max) {
  size_t n = 0;
  *mean = *max = 0;
  for (size_t i = 0; i < d->mask->gates->count; i++) {
    double off = fabs(drawer_deviation(d, of, i));
    if (isnan(off)) continue;
    *mean += off;
    *max = fmax(*max, off);
    n++;
  }
  if (n) *mean /= (double)n;
}
