/* SPDX-License-Identifier: BSD-3-Clause */
/* Statistics of the deviations of printed transistors from drawn
   transistors. */
#include <eda/print.h>
#include <math.h>

enum { ALL = 2, GROUPS = 3 };

typedef struct sums {
  double n, off, square, printed, drawn;
} sums;

static void sums_add(sums *s, double off, double printed, double drawn) {
  s->n++;
  s->off += off;
  s->square += off * off;
  s->printed += printed;
  s->drawn += drawn;
}

eda_spread eda_spread_of(const eda_gates *gates, const eda_performance *design,
                         const eda_performance *printed,
                         const uint32_t *flags) {
  eda_spread out = {.ion_worst = NAN};
  sums of[GROUPS] = {{0}};
  for (size_t i = 0; i < gates->count; i++) {
    if (flags[i] & ~(uint32_t)EDA_PRINT_NOTES) {
      out.failed++;
      continue;
    }
    double off = eda_deviation(printed->ion[i], design->ion[i]);
    if (!(fabs(off) <= fabs(out.ion_worst))) out.ion_worst = off;
    out.outside += (flags[i] & EDA_PRINT_OUTSIDE) != 0;
    sums_add(&of[gates->type[i]], off, printed->ioff[i], design->ioff[i]);
    sums_add(&of[ALL], off, printed->ioff[i], design->ioff[i]);
  }
  for (int t = 0; t < GROUPS; t++) {
    double mean = of[t].off / of[t].n; /* NAN if the group is empty */
    out.ion_mean[t] = mean;
    double variance = of[t].square / of[t].n - mean * mean;
    out.ion_sd[t] = isnan(mean) ? NAN : sqrt(fmax(0, variance));
    out.leakage[t] = of[t].printed / of[t].drawn;
  }
  return out;
}
