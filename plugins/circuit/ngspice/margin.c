/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes static noise margins (E. Seevinck, F. J. List, J. Lohstroh, IEEE J.
   Solid-State Circuits 22, 1987): the largest squares between the two transfer
   curves of a memory cell, in axes rotated by 45 degrees. */
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"

enum { CHUNK = 8 }; /* number of cells per process */

/* ---- squares ---- */

/* Curve in rotated axes: along and across the diagonal y = -x. */
typedef struct turned {
  double along[SWEEP], across[SWEEP];
} turned;

static double across_at(const turned *c, double along) {
  size_t low = 0, high = SWEEP - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (c->along[middle] <= along)
      low = middle;
    else
      high = middle;
  }
  double step = c->along[high] - c->along[low];
  double f = step > 0 ? (along - c->along[low]) / step : 0;
  return c->across[low] + f * (c->across[high] - c->across[low]);
}

/* Distance between two curves at a point of either curve: position along the
   diagonal, and height of the first curve above the second. */
typedef struct gap {
  double along, above;
} gap;

static int by_place(const void *a, const void *b) {
  double p = ((const gap *)a)->along, q = ((const gap *)b)->along;
  return (p > q) - (p < q);
}

static size_t list_gaps(const turned *c, gap *list) {
  double first = fmax(c[0].along[0], c[1].along[0]);
  double last = fmin(c[0].along[SWEEP - 1], c[1].along[SWEEP - 1]);
  size_t n = 0;
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < SWEEP; i++)
      if (c[k].along[i] >= first && c[k].along[i] <= last)
        list[n++].along = c[k].along[i];
  qsort(list, n, sizeof *list, by_place);
  for (size_t i = 0; i < n; i++)
    list[i].above =
        across_at(&c[0], list[i].along) - across_at(&c[1], list[i].along);
  return n;
}

static void keep_square(butterfly *f, int side, const turned *c, const gap *g) {
  const double root = sqrt(0.5);
  double at = g->along, a = across_at(&c[1], at), z = a + g->above;
  if (a > z) {
    double swap = a;
    a = z;
    z = swap;
  }
  f->margin[side] = (z - a) * root;
  f->corner[side][0] = (a + at) * root;
  f->corner[side][1] = (a - at) * root;
  f->corner[side][2] = (z + at) * root;
  f->corner[side][3] = (z - at) * root;
}

/* In a bistable cell the first curve crosses the second from above at one
   point. The lobes extend from this point to the next crossings on both sides.
   A cell with a third stable state between the others has two such points. Its
   left lobe is on the left of the first point, its right lobe on the right of
   the second. */
static void butterfly_squares(butterfly *f, double supply) {
  const double root = sqrt(0.5);
  turned c[2];
  gap list[2 * SWEEP];
  double best = 0;
  for (int i = 0; i < SWEEP; i++) {
    double x = supply * i / (SWEEP - 1);
    int back = SWEEP - 1 - i;
    c[0].along[i] = (x - f->right[i]) * root;
    c[0].across[i] = (x + f->right[i]) * root;
    c[1].along[back] = (f->up[i] - x) * root;
    c[1].across[back] = (f->up[i] + x) * root;
  }
  size_t n = list_gaps(c, list), left = SIZE_MAX;
  memset(f->margin, 0, sizeof f->margin);
  memset(f->corner, 0, sizeof f->corner);
  for (size_t i = 0; i + 1 < n; i++) {
    if (!(list[i].above > 0 && list[i + 1].above <= 0)) continue;
    size_t right = i + 1;
    for (size_t k = i + 1; k-- > 0 && list[k].above > 0;)
      if (left == SIZE_MAX || list[k].above > list[left].above) left = k;
    for (size_t k = i + 1; k < n && list[k].above <= 0; k++)
      if (list[k].above < list[right].above) right = k;
    double least = fmin(list[left].above, -list[right].above);
    if (!(least > best)) continue;
    best = least;
    keep_square(f, 0, c, &list[left]);
    keep_square(f, 1, c, &list[right]);
  }
}

/* ---- decks ---- */

/* Data shared by all jobs. */
typedef struct study {
  const cell *cells;
  const margins *out;
} study;

static int is_port(const cell_netlist *c, uint32_t net) {
  for (size_t i = 0; i < c->ports; i++)
    if (c->port[i] == net) return 1;
  return 0;
}

const char *cell_connection(const bench *b, const cell *m, uint32_t net) {
  const eda_circuit *c = b->circuit;
  int role = eda_circuit_role(c, net);
  if (role == EDA_PIN_GROUND) return "0";
  if (role == EDA_PIN_SUPPLY) return "vdd";
  for (uint32_t i = 0; i < m->devices; i++) {
    const eda_device *d = &c->device[m->device[i]];
    int is_access = i >= m->devices - m->accesses;
    int is_n = d->type == EDA_NMOS;
    if (is_access && d->gate == net) return is_n == b->reads ? "vdd" : "0";
    if (is_access && (d->drain == net || d->source == net)) return "vdd";
    if (d->bulk == net) return is_n ? "0" : "vdd";
  }
  return "0";
}

int cell_put(bench_task *j, FILE *out, const cell *m, const char *name,
             int sizes, cell_netlist *c) {
  const bench *b = j->b;
  eda_device devices[CELL_DEVICES];
  eda_circuit own = b->plain;
  *c = (cell_netlist){.ports = 0};
  snprintf(c->name, sizeof c->name, "%s", name);
  own.name = c->name;
  own.port = c->port;
  own.count = m->devices;
  own.device = devices;
  for (uint32_t i = 0; i < m->devices; i++) {
    const eda_device *d = &b->plain.device[m->device[i]];
    const uint32_t net[4] = {d->drain, d->gate, d->source, d->bulk};
    devices[i] = *d;
    for (int t = 0; t < 4; t++)
      if (!is_port(c, net[t])) c->port[c->ports++] = net[t];
  }
  own.ports = c->ports;
  char *text = bench_netlist(b, &own, j->state, sizes, &j->error);
  if (!text) return j->code = j->error.code;
  fputs(text, out);
  free(text);
  return OPC_OK;
}

/* Write a cell and two instances: one driven at Q, one at QB. */
static void put_cell(bench_task *j, FILE *out, size_t k) {
  const bench *b = j->b;
  const study *s = j->of;
  const cell *m = &s->cells[k];
  cell_netlist c;
  char name[32];
  snprintf(name, sizeof name, "cell%zu", k);
  if (cell_put(j, out, m, name, SIZE_ON, &c)) return;
  for (int side = 0; side < 2; side++) {
    fprintf(out, "x%zu%c", k, "ab"[side]);
    for (size_t i = 0; i < c.ports; i++) {
      uint32_t net = c.port[i];
      if (net == (side ? m->qb : m->q))
        fputs(" in", out);
      else if (net == (side ? m->q : m->qb))
        fprintf(out, " %c%zu", "ab"[side], k);
      else
        fprintf(out, " %s", cell_connection(b, m, net));
    }
    fprintf(out, " %s\n.save v(%c%zu)\n", name, "ab"[side], k);
  }
}

static void write_deck(bench_task *j, FILE *out, const void *how) {
  (void)how;
  job_begin(j, out, 1e-5, 1e-15);
  for (size_t k = j->from; k < j->to && !j->code; k++) put_cell(j, out, k);
  fprintf(out, "vdd vdd 0 dc %.17g\nvin in 0 dc 0\n.end\n", j->b->supply);
}

/* ---- curves ---- */

static int keep_curve(const eda_spice_plot *plot, char side, size_t k,
                      double *out) {
  char name[32];
  snprintf(name, sizeof name, "v(%c%zu)", side, k);
  const eda_spice_vector *v = eda_spice_vector_find(plot, name);
  if (!v || v->count < SWEEP) return 0;
  for (int i = 0; i < SWEEP; i++) out[i] = v->value[i];
  return 1;
}

static void run_job(bench_task *j) {
  const bench *b = j->b;
  const study *s = j->of;
  eda_spice_result r;
  char command[128];
  double step = b->supply / (SWEEP - 1);
  snprintf(command, sizeof command, "dc vin 0 %.17g %.17g",
           b->supply + step / 100, step);
  g_autofree char *deck = job_text(j, write_deck, NULL);
  job_simulate(j, deck, command, &r);
  for (size_t k = j->from; !j->code && k < j->to; k++) {
    butterfly *f = &s->out->of[j->state][k];
    if (!r.count || !keep_curve(&r.plot[0], 'a', k, f->right) ||
        !keep_curve(&r.plot[0], 'b', k, f->up))
      j->code = opc_fail(&j->error, OPC_FAILED, NULL,
                         "'ngspice' ended the sweep too early");
    else
      butterfly_squares(f, b->supply);
  }
  eda_spice_clear(&r);
}

int margins_find(bench *b, const cell *cells, size_t count, margins *out,
                 opc_error *error) {
  const study s = {cells, out};
  for (int state = 0; state < EDA_STATES; state++)
    if (!out->of[state])
      out->of[state] = eda_pool_alloc(&b->pool, count, sizeof(butterfly));
  return jobs_run(b, count, CHUNK, run_job, &s, error);
}
