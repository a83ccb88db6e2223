/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes the delays of all input transitions at all sets of sizes, and the
   deviations from the delays at drawn sizes (thesis eq. 3.15, tables 3.5 and
   5.1, figures 3.14 and 5.6). */
#include <eda/drawing.h>
#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "paths.h"

/* ---- all transitions, in blocks ---- */

enum {
  BLOCK = 128
}; /* patterns per work unit; fixed, so that results do not
      depend on threads */

typedef struct block {
  size_t count, capacity;
  arrival *arrival; /* final transition for each delay of the block and each set
                       of sizes, [delay * states + state] */
} block;

typedef struct work {
  const paths *p;
  block *block;
} work;

static void run_block(void *data, size_t index) {
  const work *all = data;
  const paths *p = all->p;
  const graph *g = &p->graph;
  block *b = &all->block[index];
  size_t from = index * BLOCK,
         to = from + BLOCK < p->patterns ? from + BLOCK : p->patterns;
  waves w;
  if (opc_cancelled(p->host->context)) return;
  waves_init(&w, p);
  /* Process one set of sizes after another, so that the tables of a set stay in
     the cache. */
  for (size_t s = 0; s < p->states; s++) {
    size_t k = 0;
    for (size_t i = from; i < to; i++) {
      pattern_at(p, i, w.before, w.after);
      waves_run(&w, &p->state[s]);
      for (size_t o = 0; o < g->outputs; o++) {
        arrival a = waves_arrival(&w, o);
        if (isnan(a.time)) continue;
        if (!s) {
          eda_grow(&b->arrival, &b->capacity, (k + 1) * p->states,
                   sizeof *b->arrival);
          b->count = k + 1;
        }
        b->arrival[k++ * p->states + s] = a;
      }
    }
  }
  waves_clear(&w);
}

int delays_find(paths *p, delays *out, opc_error *error) {
  size_t blocks = (p->patterns + BLOCK - 1) / BLOCK, n = 0;
  work all = {p, eda_alloc(blocks, sizeof *all.block)};
  opc_parallel(p->host->context, blocks, run_block, &all);
  for (size_t i = 0; i < blocks; i++) n += all.block[i].count;
  *out = (delays){n, eda_alloc(p->states, sizeof *out->arrival)};
  for (size_t s = 0; s < p->states; s++) {
    arrival *to = out->arrival[s] = eda_alloc(n, sizeof *to);
    for (size_t i = 0; i < blocks; i++)
      for (size_t k = 0; k < all.block[i].count; k++)
        *to++ = all.block[i].arrival[k * p->states + s];
  }
  for (size_t i = 0; i < blocks; i++) free(all.block[i].arrival);
  free(all.block);
  if (opc_cancelled(p->host->context))
    return opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
  if (n) return OPC_OK;
  return opc_fail(error, OPC_FAILED, NULL,
                  "no output changes at any transition of the inputs");
}

void delays_clear(delays *d, size_t states) {
  for (size_t s = 0; d->arrival && s < states; s++) free(d->arrival[s]);
  free(d->arrival);
  *d = (delays){0};
}

/* ---- figures ---- */

static int path_same(const delays *d, size_t s, size_t i) {
  return d->arrival[s][i].path == d->arrival[0][i].path;
}

static double arrival_deviation(const delays *d, size_t s, size_t i) {
  double drawn = d->arrival[0][i].time;
  return 100 * (d->arrival[s][i].time - drawn) / drawn;
}

/* Compute the longest and the shortest delay of state s, ps. */
static void find_ends(const delays *d, size_t s, double *longest,
                      double *shortest) {
  *longest = 0;
  *shortest = INFINITY;
  for (size_t i = 0; i < d->count; i++) {
    *longest = fmax(*longest, d->arrival[s][i].time);
    *shortest = fmin(*shortest, d->arrival[s][i].time);
  }
}

static spread spread_of(const delays *d, size_t s) {
  spread r = {.lowest = (double)NAN, .highest = (double)NAN};
  double sum = 0, squares = 0, longest[2], shortest[2];
  for (size_t i = 0; i < d->count; i++) {
    if (!path_same(d, s, i)) continue;
    double x = arrival_deviation(d, s, i);
    r.compared++;
    sum += fabs(x);
    r.lowest = fmin(r.lowest, x);
    r.highest = fmax(r.highest, x);
  }
  r.mean = r.compared ? sum / (double)r.compared : (double)NAN;
  for (size_t i = 0; i < d->count; i++) {
    double x = fabs(arrival_deviation(d, s, i)) - r.mean;
    if (path_same(d, s, i)) squares += x * x;
  }
  if (r.compared > 1) r.stdv = sqrt(squares / (double)(r.compared - 1));
  find_ends(d, 0, &longest[0], &shortest[0]);
  find_ends(d, s, &longest[1], &shortest[1]);
  r.longest = 100 * (longest[1] / longest[0] - 1);
  r.shortest = 100 * (shortest[1] / shortest[0] - 1);
  return r;
}

typedef struct row {
  const char *name;
  int64_t delays, others;
  double delay, longest, shortest, statically, static_by;
  spread by;
} row;

double worst_path(const paths *p, const state *s) {
  eda_pool pool = {0};
  arrivals a = static_arrivals(&p->graph, s, p->at.slew, &pool);
  double worst = 0;
  for (size_t o = 0; o < 2 * p->graph.outputs; o++)
    worst = fmax(worst, a.time[p->graph.output[o / 2] * 2 + o % 2]);
  eda_pool_clear(&pool);
  return worst;
}

static row row_of(const paths *p, const delays *d, size_t s, double drawn) {
  row r = {.name = p->state[s].name,
           .delays = (int64_t)d->count,
           .shortest = INFINITY,
           .statically = worst_path(p, &p->state[s])};
  for (size_t i = 0; i < d->count; i++)
    r.delay += d->arrival[s][i].time / (double)d->count;
  find_ends(d, s, &r.longest, &r.shortest);
  if (!s) drawn = r.statically;
  r.static_by = 100 * (r.statically / drawn - 1);
  r.by = spread_of(d, s);
  r.others = (int64_t)(d->count - r.by.compared);
  return r;
}

static int metrics_report(paths *p, const delays *d, const row *r, size_t n,
                          opc_error *error) {
  /* The first set of printed sizes, which is that of `mask` if given. */
  const row *first = n > 1 && r[1].by.compared ? &r[1] : NULL;
#define PRINTED(name) (first ? (name) : NULL)
  const opc_metric_value values[] = {
      {"cells", (double)p->graph.instances},
      {"transitions", (double)p->patterns},
      {"delays", (double)d->count},
      {"delay", r->delay},
      {"delay_max", r->longest},
      {"delay_min", r->shortest},
      {"static", r->statically},
      {n > 1 ? "others" : NULL, n > 1 ? (double)r[1].others : 0},
      {PRINTED("mean"), first ? first->by.mean : 0},
      {PRINTED("stdv"), first ? first->by.stdv : 0},
      {PRINTED("lowest"), first ? first->by.lowest : 0},
      {PRINTED("highest"), first ? first->by.highest : 0},
      {PRINTED("longest"), first ? first->by.longest : 0},
      {PRINTED("shortest"), first ? first->by.shortest : 0},
      {PRINTED("static_deviation"), first ? first->static_by : 0}};
#undef PRINTED
  return opc_put_metrics(p->host, OPC_ARRAY(values), error);
}

/* Report the latest path of static analysis, as drawn. */
static int path_report(paths *p, opc_error *error) {
  const graph *g = &p->graph;
  arrivals a = static_arrivals(g, &p->state[0], p->at.slew, &p->pool);
  uint32_t at = g->output[0] * 2;
  for (size_t o = 0; o < 2 * g->outputs; o++) {
    uint32_t k = g->output[o / 2] * 2 + (uint32_t)(o % 2);
    if (a.time[k] > a.time[at]) at = k;
  }
  struct {
    const char *net, *edge;
    double time, slew;
  } *step = eda_pool_alloc(&p->pool, g->nets + 1, sizeof *step);
  size_t n = 0;
  for (; at != UINT32_MAX && n < g->nets; at = a.from[at], n++) {
    step[n].net = g->net[at / 2];
    step[n].edge = at % 2 ? "rises" : "falls";
    step[n].time = a.time[at];
    step[n].slew = a.slew[at];
  }
  const opc_column columns[] = {{"net", NULL, OPC_TEXT, 0, &step->net},
                                {"edge", NULL, OPC_TEXT, 0, &step->edge},
                                {"time", "ps", OPC_REAL, 3, &step->time},
                                {"slew", "ps", OPC_REAL, 3, &step->slew}};
  return opc_put_rows(p->host, "static_path", 0, n, sizeof *step,
                      OPC_ARRAY(columns), error);
}

int delays_report(paths *p, const delays *d, opc_error *error) {
  row *r = eda_pool_alloc(&p->pool, p->states, sizeof *r);
  for (size_t s = 0; s < p->states; s++)
    r[s] = row_of(p, d, s, r[0].statically);
  const opc_column columns[] = {
      {"sizes", NULL, OPC_TEXT, 0, &r->name},
      {"delays", NULL, OPC_INT, 0, &r->delays},
      {"others", NULL, OPC_INT, 0, &r->others},
      {"delay", "ps", OPC_REAL, 2, &r->delay},
      {"delay_max", "ps", OPC_REAL, 2, &r->longest},
      {"delay_min", "ps", OPC_REAL, 2, &r->shortest},
      {"static", "ps", OPC_REAL, 2, &r->statically},
      {"mean", "%", OPC_REAL, 4, &r->by.mean},
      {"stdv", "%", OPC_REAL, 4, &r->by.stdv},
      {"lowest", "%", OPC_REAL, 3, &r->by.lowest},
      {"highest", "%", OPC_REAL, 3, &r->by.highest},
      {"longest", "%", OPC_REAL, 3, &r->by.longest},
      {"shortest", "%", OPC_REAL, 3, &r->by.shortest},
      {"static_deviation", "%", OPC_REAL, 3, &r->static_by},
  };
  int code = opc_put_rows(p->host, "paths", OPC_TABLE_PRINT, p->states,
                          sizeof *r, OPC_ARRAY(columns), error);
  if (!code) code = metrics_report(p, d, r, p->states, error);
  return code ? code : path_report(p, error);
}

/* ---- the histogram ---- */

/* Bins of a histogram, and the largest number of histograms in the picture. */
enum { BINS = 120, PANELS = 50 };

typedef struct histogram {
  const char *sizes;
  double from, to, share;
} histogram;

/* Range of the histogram. At each end, at most one in OUTLIERS values of a set
   is beyond the range. The margin at each end is the fraction `beside` of the
   range, at least `least_beside` percentage points. */
enum { OUTLIERS = 100 };
static const double beside = 0.02, least_beside = 1e-3;

/* Compute the common range of the histograms of all sets of sizes. Outliers are
   counted in the first and the last bin, because a range with all values would
   make the other bins too wide. */
static void find_range(const delays *d, size_t states, double *low,
                       double *high) {
  double *x = eda_alloc(d->count, sizeof *x);
  *low = INFINITY;
  *high = -INFINITY;
  for (size_t s = 1; s < states; s++) {
    size_t n = 0;
    for (size_t i = 0; i < d->count; i++)
      if (path_same(d, s, i)) x[n++] = arrival_deviation(d, s, i);
    if (!n) continue;
    qsort(x, n, sizeof *x, eda_doubles_rise);
    *low = fmin(*low, x[n / OUTLIERS]);
    *high = fmax(*high, x[n - 1 - n / OUTLIERS]);
  }
  free(x);
  if (!(*low <= *high)) *low = *high = 0; /* no delay was compared */
  double margin = fmax(least_beside, beside * (*high - *low));
  *low -= margin;
  *high += margin;
}

int draw_histogram(const paths *p, const delays *d, const char *path,
                   opc_error *error) {
  double low, high, x[2 * BINS + 2], y[2 * BINS + 2];
  if (p->states < 2) return OPC_OK;
  find_range(d, p->states, &low, &high);
  size_t states = p->states - 1, n = states * BINS;
  histogram *bin = eda_alloc(n, sizeof *bin);
  double most = 0, step = (high - low) / BINS;
  for (size_t k = 0; k < n; k++)
    bin[k] = (histogram){p->state[1 + k / BINS].name,
                         low + step * (double)(k % BINS),
                         low + step * (double)(k % BINS + 1), 0};
  for (size_t s = 0; s < states; s++) {
    double unit = 100 / (double)spread_of(d, s + 1).compared;
    for (size_t i = 0; i < d->count; i++) {
      if (!path_same(d, s + 1, i)) continue;
      double at = (arrival_deviation(d, s + 1, i) - low) / step;
      size_t b = at > 0 ? (size_t)at : 0;
      histogram *h = &bin[s * BINS + (b < BINS ? b : BINS - 1)];
      h->share += unit;
      most = fmax(most, h->share);
    }
  }
  const opc_column columns[] = {{"sizes", NULL, OPC_TEXT, 0, &bin->sizes},
                                {"from", "%", OPC_REAL, 4, &bin->from},
                                {"to", "%", OPC_REAL, 4, &bin->to},
                                {"share", "%", OPC_REAL, 4, &bin->share}};
  int code = opc_put_rows(p->host, "histogram", 0, n, sizeof *bin,
                          OPC_ARRAY(columns), error);
  /* One chart for each set of sizes, stacked, with common axes. */
  const double panel = 150;
  if (states > PANELS) states = PANELS;
  double height = 90 + panel * (double)states;
  eda_paper *paper = code ? NULL : eda_paper_open(path, 900, height, 14, error);
  if (paper) {
    paper->margin = 70;
    double top = 20 + eda_heading(paper, 20, p->graph.name);
    eda_chart c = {.paper = paper, .left = 70, .width = 800, .height = 80};
    c.y = (eda_axis){.low = 0, .high = 1.05 * most, .title = "paths, %"};
    for (size_t s = 0; s < states; s++) {
      char title[200];
      spread r = spread_of(d, s + 1);
      snprintf(title, sizeof title, "%.100s: mean %.3g %%, stdv %.3g %%",
               p->state[s + 1].name, r.mean, r.stdv);
      c.x = (eda_axis){.low = low, .high = high};
      if (s + 1 == states) c.x.title = "deviation of path delays from drawn, %";
      c.title = title;
      c.top = top + 30 + panel * (double)s;
      for (size_t b = 0; b < BINS; b++) {
        const histogram *h = &bin[s * BINS + b];
        x[2 * b] = h->from;
        x[2 * b + 1] = h->to;
        y[2 * b] = y[2 * b + 1] = h->share;
      }
      eda_chart_axes(&c);
      eda_chart_line(&c, eda_layer_contour(0), 2, 0, x, y, 2 * BINS);
    }
  }
  code = paper ? eda_paper_close(paper, OPC_OK, error) : error->code;
  free(bin);
  return code;
}
