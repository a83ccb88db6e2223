/* SPDX-License-Identifier: BSD-3-Clause */
/* Statistics of single paths and arcs: mean and standard deviation of the
   polynomial of each delay, and of the effect of line edges. */
#include <eda/memory.h>
#include <eda/sdf.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include "variation.h"

/* Standard deviations of the first and the third value of an SDF triplet. */
static const double triplet = 3;

typedef struct delay_statistics {
  double mean, sigma, edges; /* ps; edges: standard deviation by line edges */
} delay_statistics;

typedef struct delay_task {
  const variation *v;
  const term_moments *m;
  delay_statistics *out; /* paths, then arcs */
} delay_task;

/* Compute the statistics of a delay. The variables of all gates are those of
   one tile: a path or an arc is short against the correlation length. */
static delay_statistics statistics_of_delay(const variation *v,
                                            const term_moments *m,
                                            const eda_delay *d) {
  circuit c = v->circuit;
  size_t n = v->surrogate.terms;
  double *a = eda_alloc(n, sizeof *a), variance = 0;
  delay_statistics s = {.mean = d->time};
  c.tile_of = NULL;
  delay_global(&c, v->delays, d, 0, a);
  for (size_t i = 0; i < n; i++) {
    double row = 0;
    for (size_t j = 0; j < n; j++) row += m->covariance[i * n + j] * a[j];
    s.mean += a[i] * m->mean[i];
    variance += a[i] * row;
  }
  for (size_t k = 0; k < d->terms; k++) {
    const roughness_effect *e = &v->effect[d->term[k].gate * KNOTS + KNOT_ZERO];
    double local = delay_local(&c, &d->term[k]);
    s.mean += local * (double)e->shift[ION];
    s.edges += pow(local * (double)e->sigma[ION], 2);
  }
  s.sigma = sqrt(fmax(0, variance) + s.edges);
  s.edges = sqrt(s.edges);
  free(a);
  return s;
}

static void delay_evaluate(void *data, size_t i) {
  const delay_task *t = data;
  const eda_delays *d = t->v->delays;
  const eda_delay *one =
      i < d->paths ? &d->path[i].delay : &d->arc[i - d->paths].delay;
  t->out[i] = statistics_of_delay(t->v, t->m, one);
}

static int put_paths(const variation *v, const delay_statistics *s,
                     opc_error *error) {
  const eda_delays *d = v->delays;
  typedef struct row {
    const char *from, *to, *edge;
    double printed;
    delay_statistics s;
  } row;
  row *r = eda_alloc(d->paths, sizeof *r);
  for (size_t i = 0; i < d->paths; i++) {
    const eda_delay_path *p = &d->path[i];
    r[i] = (row){p->from, p->to, p->rises ? "rises" : "falls", p->delay.time,
                 s[i]};
  }
  const opc_column columns[] = {{"from", NULL, OPC_TEXT, 0, &r->from},
                                {"to", NULL, OPC_TEXT, 0, &r->to},
                                {"edge", NULL, OPC_TEXT, 0, &r->edge},
                                {"printed", "ps", OPC_REAL, 3, &r->printed},
                                {"mean", "ps", OPC_REAL, 3, &r->s.mean},
                                {"sigma", "ps", OPC_REAL, 4, &r->s.sigma},
                                {"edges", "ps", OPC_REAL, 4, &r->s.edges}};
  int code = opc_put_rows(v->host, "paths", 0, d->paths, sizeof *r,
                          OPC_ARRAY(columns), error);
  free(r);
  return code;
}

static int same_arc(const eda_delay_arc *a, const eda_delay_arc *b) {
  return !strcmp(a->instance, b->instance) && a->input == b->input &&
         a->output == b->output;
}

static int sdf_write(const variation *v, const delay_statistics *s,
                     opc_error *error) {
  const eda_delays *d = v->delays;
  const char *path = v->host->output_path(v->host, v->sdf, error);
  if (!path) return error->code;
  eda_sdf_arc *all = eda_alloc(d->arcs, sizeof *all);
  size_t n = 0;
  for (size_t i = 0; i < d->arcs; i++) {
    const eda_delay_arc *a = &d->arc[i];
    if (!i || !same_arc(a, a - 1))
      all[n++] = (eda_sdf_arc){a->cell,
                               a->instance,
                               a->input,
                               a->output,
                               {{NAN, NAN, NAN}, {NAN, NAN, NAN}}};
    for (int k = 0; k < 3; k++)
      all[n - 1].delay[a->rises][k] =
          s[i].mean + (k - 1) * triplet * s[i].sigma;
  }
  int code = eda_sdf_write(path, d->name,
                           "opcflow variation, -3 sigma : mean : 3 sigma",
                           d->supply, d->temperature, n, all, error);
  free(all);
  return code;
}

int delays_report(const variation *v, opc_error *error) {
  const eda_delays *d = v->delays;
  size_t n = d->paths + (v->sdf ? d->arcs : 0);
  term_moments m;
  delay_task task = {v, &m, eda_alloc(n, sizeof *task.out)};
  terms_sample(v, &m);
  opc_parallel(v->host->context, n, delay_evaluate, &task);
  int code = put_paths(v, task.out, error);
  if (!code && v->sdf) code = sdf_write(v, task.out + d->paths, error);
  free(task.out);
  free(m.mean);
  free(m.covariance);
  return code;
}
