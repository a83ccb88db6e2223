/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws the distributions of the total leakage and of the mean Ion. */
#include <eda/drawing.h>
#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include "variation.h"

enum { BINS = 60, CHARTS = 3, WIDTH_OF = 1230, HEIGHT_OF = 400, SIDE = 320 };
static const double font = 14;

/* Quantiles at the ends of the charts; 0.1 % of the chips are beyond each. */
static const double tail = 0.001;

typedef struct histogram {
  double low, high; /* of the axis; logarithms for leakage */
  double middle[BINS], share[BINS];
} histogram;

/* Count sorted values, chips in % for each bin. */
static void histogram_fill(histogram *h, const float *value, size_t n,
                           int logarithm) {
  size_t first = (size_t)(tail * (double)n), last = n - 1 - first;
  double low = (double)value[first], high = (double)value[last];
  if (!(high > low)) high = low + fmax(1e-6, 1e-6 * fabs(low));
  h->low = logarithm ? log10(low) : low;
  h->high = logarithm ? log10(high) : high;
  for (int k = 0; k < BINS; k++) {
    double at = h->low + (h->high - h->low) * (k + 0.5) / BINS;
    h->middle[k] = logarithm ? pow(10, at) : at;
  }
  for (size_t i = 0; i < n; i++) {
    double x = logarithm ? log10((double)value[i]) : (double)value[i];
    double t = (x - h->low) / (h->high - h->low) * BINS;
    if (t >= 0 && t < BINS) h->share[(int)t] += 100 / (double)n;
  }
}

static void histogram_draw(const eda_paper *paper, int place,
                           const histogram *h, int logarithm, double limit,
                           const char *title) {
  double zero[BINS] = {0};
  eda_chart c = {.paper = paper,
                 .left = 60 + place * (SIDE + 85),
                 .top = 40,
                 .width = SIDE,
                 .height = SIDE,
                 .title = title,
                 .x = {.log = logarithm},
                 .y = {.low = 0}};
  c.x.low = logarithm ? pow(10, h->low) : h->low;
  c.x.high = logarithm ? pow(10, h->high) : h->high;
  for (int k = 0; k < BINS; k++) c.y.high = fmax(c.y.high, 1.05 * h->share[k]);
  eda_chart_axes(&c);
  eda_chart_band(&c, eda_diverging(0.2), h->middle, zero, h->share, BINS);
  eda_chart_line(&c, eda_ink, 1.5, 0, h->middle, h->share, BINS);
  const double x[] = {limit, limit}, y[] = {0, c.y.high};
  if (limit > c.x.low && limit < c.x.high)
    eda_chart_line(&c, eda_diverging(1), 2, 6, x, y, 2);
}

int variation_draw(const variation *v, opc_error *error) {
  static const char *const titles[CHARTS] = {
      "total leakage over drawn, % of chips", "mean Ion of n over drawn",
      "mean Ion of p over drawn"};
  const char *path = v->host->output_path(v->host, v->file, error);
  eda_paper *paper =
      path ? eda_paper_open(path, WIDTH_OF, HEIGHT_OF, font, error) : NULL;
  if (!paper) return error->code;
  typedef struct row {
    const char *figure;
    double middle, share;
  } row;
  static const char *const names[CHARTS] = {"leakage", "ion_n", "ion_p"};
  row *r = eda_alloc((size_t)CHARTS * BINS, sizeof *r);
  for (int k = 0; k < CHARTS; k++) {
    histogram h = {0};
    int log = k == CHIP_LEAKAGE;
    histogram_fill(&h, v->chip[k], (size_t)v->chips, log);
    histogram_draw(paper, k, &h, log,
                   log ? v->leakage_limit : 1 - v->speed_limit / 100,
                   titles[k]);
    for (int b = 0; b < BINS; b++)
      r[k * BINS + b] = (row){names[k], h.middle[b], h.share[b]};
  }
  const opc_column columns[] = {{"figure", NULL, OPC_TEXT, 0, &r->figure},
                                {"middle", NULL, OPC_REAL, 5, &r->middle},
                                {"chips", "%", OPC_REAL, 4, &r->share}};
  int code = opc_put_rows(v->host, "histograms", 0, (size_t)CHARTS * BINS,
                          sizeof *r, OPC_ARRAY(columns), error);
  free(r);
  return eda_paper_close(paper, code, error);
}
