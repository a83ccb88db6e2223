/* SPDX-License-Identifier: BSD-3-Clause */
/* Statistics of the deviations of printed transistors from drawn
   transistors. */
#include <eda/print.h>
#include <math.h>

enum { ALL = 2, GROUPS = 3 };

/* Add n equal transistors to a group. */
static void group_add(eda_spread_sums *s, int group, double n, double off,
                      double printed, double drawn) {
  s->of[group].n += n;
  s->of[group].off += n * off;
  s->of[group].square += n * off * off;
  s->of[group].printed += n * printed;
  s->of[group].drawn += n * drawn;
}

void eda_spread_add(eda_spread_sums *s, const eda_gates *gates,
                    const uint32_t *count, const eda_performance *design,
                    const eda_performance *printed, const uint32_t *flags) {
  for (size_t i = 0; i < gates->count; i++) {
    size_t n = count ? count[i] : 1;
    if (!n) continue;
    if (eda_print_failed(flags[i])) {
      s->failed += n;
      continue;
    }
    double off = eda_deviation(printed->ion[i], design->ion[i]);
    if (!s->of[ALL].n || !(fabs(off) <= fabs(s->worst))) s->worst = off;
    s->outside += flags[i] & EDA_PRINT_OUTSIDE ? n : 0;
    group_add(s, gates->type[i], (double)n, off, printed->ioff[i],
              design->ioff[i]);
    group_add(s, ALL, (double)n, off, printed->ioff[i], design->ioff[i]);
  }
}

eda_spread eda_spread_end(const eda_spread_sums *s) {
  eda_spread out = {.ion_worst = s->of[ALL].n ? s->worst : NAN,
                    .failed = s->failed,
                    .outside = s->outside};
  for (int t = 0; t < GROUPS; t++) {
    double mean = s->of[t].off / s->of[t].n; /* NAN if the group is empty */
    out.ion_mean[t] = mean;
    double variance = s->of[t].square / s->of[t].n - mean * mean;
    out.ion_sd[t] = isnan(mean) ? NAN : sqrt(fmax(0, variance));
    out.leakage[t] = s->of[t].printed / s->of[t].drawn;
  }
  return out;
}

eda_spread eda_spread_of(const eda_gates *gates, const eda_performance *design,
                         const eda_performance *printed,
                         const uint32_t *flags) {
  eda_spread_sums sums = {0};
  eda_spread_add(&sums, gates, NULL, design, printed, flags);
  return eda_spread_end(&sums);
}
