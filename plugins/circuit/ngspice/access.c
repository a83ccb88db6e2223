/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulates memory cells that are read and written. The results are the current
   from a bit line into the cell, the voltage of a bit line that flips the cell,
   and the leakage at rest. */
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench.h"

/* The bit line is lowered from the supply to 0 in this number of steps. */
enum { WRITE_STEPS = 3600 };

/* Data shared by all jobs. Job 2 k + side lowers the bit line at Q (side 0) or
   QB (side 1) of cell k. */
typedef struct accesses_study {
  const cell *cells;
  const accesses *out;
} accesses_study;

/* Return the bit line of a side that is read or written: that of the first
   access transistor at the node. Return its word line, too. */
static uint32_t bit_line(const bench *b, const cell *m, int side,
                         uint32_t *word) {
  uint32_t node = side ? m->qb : m->q;
  for (uint32_t i = m->devices - m->accesses; i < m->devices; i++) {
    const eda_device *d = &b->circuit->device[m->device[i]];
    *word = d->gate;
    if (d->drain == node) return d->source;
    if (d->source == node) return d->drain;
  }
  return UINT32_MAX;
}

/* Return 1 if a net is the gate of access n-transistors. */
static int is_word_line(const bench *b, const cell *m, uint32_t net, int *n) {
  for (uint32_t i = m->devices - m->accesses; i < m->devices; i++) {
    const eda_device *d = &b->circuit->device[m->device[i]];
    *n = d->type == EDA_NMOS;
    if (d->gate == net) return 1;
  }
  return 0;
}

/* Write an instance of the cell as it is read and written, or at rest. The
   swept node `in` is the bit line of `side`; the current of the other bit line
   flows through the source `vread`. The instance at rest is supplied by
   `vrest`. */
static void put_instance(const bench *b, const cell *m, const cell_netlist *c,
                         int side, int rest, FILE *out) {
  uint32_t word[2], bit[2];
  for (int s = 0; s < 2; s++) bit[s] = bit_line(b, m, s, &word[s]);
  fprintf(out, "x%s", rest ? "rest" : "access");
  for (size_t i = 0; i < c->ports; i++) {
    uint32_t net = c->port[i];
    int n;
    if (net == m->q || net == m->qb)
      fprintf(out, " %s%s", net == m->q ? "q" : "qb", rest ? "r" : "a");
    else if (is_word_line(b, m, net, &n))
      fputs(n == (!rest && (net == word[0] || net == word[1])) ? " vdd" : " 0",
            out);
    else if (!rest && net == bit[side])
      fputs(" in", out);
    else if (!rest && net == bit[!side])
      fputs(" read", out);
    else {
      const char *at = cell_connection(b, m, net);
      fprintf(out, " %s", rest && *at == 'v' ? "rest" : at);
    }
  }
  fprintf(out, " %s\n.nodeset v(q%c)=%.17g v(qb%c)=%.17g\n", c->name,
          rest ? 'r' : 'a', side ? 0 : b->supply, rest ? 'r' : 'a',
          side ? b->supply : 0);
}

static void write_access(bench_task *j, FILE *out, const void *how) {
  const bench *b = j->b;
  const accesses_study *s = j->of;
  const cell *m = &s->cells[j->from / 2];
  int side = j->from % 2;
  (void)how;
  job_begin(j, out, 1e-5, 1e-15);
  for (int rest = 0; rest < 2 && !j->code; rest++) {
    cell_netlist c;
    if (cell_put(j, out, m, rest ? "rest" : "access", rest ? SIZE_OFF : SIZE_ON,
                 &c))
      return;
    put_instance(b, m, &c, side, rest, out);
  }
  fprintf(out,
          "vdd vdd 0 dc %.17g\nvread vdd read dc 0\nvrest vdd rest dc 0\n"
          "vin in 0 dc %.17g\n.save v(in) v(qa) v(qba) v(qr) v(qbr) i(vread) "
          "i(vrest)\n.end\n",
          b->supply, b->supply);
}

/* Return the first value of a vector, or NAN. */
static double first_of(const eda_spice_plot *plot, const char *name) {
  const eda_spice_vector *v = eda_spice_vector_find(plot, name);
  return v && v->count ? v->value[0] : (double)NAN;
}

/* Return the voltage of the bit line between the last point before the flip and
   the first point after the flip; 0 if the cell does not flip. */
static double flip_voltage(const eda_spice_plot *plot, int side) {
  const eda_spice_vector *in = eda_spice_vector_find(plot, "v(in)");
  const eda_spice_vector *q = eda_spice_vector_find(plot, "v(qa)");
  const eda_spice_vector *qb = eda_spice_vector_find(plot, "v(qba)");
  if (!in || !q || !qb) return NAN;
  for (size_t i = 1; i < in->count; i++)
    if ((q->value[i] > qb->value[i]) == side)
      return (in->value[i] + in->value[i - 1]) / 2;
  return 0;
}

static void run_job(bench_task *j) {
  const bench *b = j->b;
  const accesses_study *s = j->of;
  int side = j->from % 2;
  access_figures *f = &s->out->of[j->state][j->from / 2];
  eda_spice_result r;
  char command[128];
  snprintf(command, sizeof command, "dc vin %.17g 0 %.17g", b->supply,
           -b->supply / WRITE_STEPS);
  g_autofree char *deck = job_text(j, write_access, NULL);
  job_simulate(j, deck, command, &r);
  if (!j->code && (!r.count || isnan(first_of(&r.plot[0], "i(vread)"))))
    j->code = opc_fail(&j->error, OPC_FAILED, NULL,
                       "'ngspice' ended the sweep too early");
  f->read[!side] = f->write[side] = f->leakage[side] = NAN;
  if (!j->code) {
    const eda_spice_plot *p = &r.plot[0];
    /* The cell loses its value as soon as it is accessed, or at rest. */
    int lost = (first_of(p, "v(qa)") > first_of(p, "v(qba)")) == side;
    int fails = (first_of(p, "v(qr)") > first_of(p, "v(qbr)")) == side;
    if (!lost) f->read[!side] = first_of(p, "i(vread)");
    if (!lost) f->write[side] = flip_voltage(p, side);
    if (!fails) f->leakage[side] = first_of(p, "i(vrest)");
  }
  eda_spice_clear(&r);
}

/* Refuse cells whose lines cannot be driven separately. */
static int check_lines(const bench *b, const cell *m, opc_error *error) {
  const eda_circuit *c = b->circuit;
  const uint32_t node[2] = {m->q, m->qb};
  uint32_t word[2], bit[2];
  int n;
  for (int s = 0; s < 2; s++) {
    bit[s] = bit_line(b, m, s, &word[s]);
    if (bit[s] == UINT32_MAX)
      return opc_fail(error, OPC_INVALID, "circuit",
                      "storage node '%s' has no access transistor",
                      c->net[node[s]]);
    if (is_word_line(b, m, bit[s], &n))
      return opc_fail(error, OPC_INVALID, "circuit",
                      "the bit line '%s' of storage node '%s' is a word line",
                      c->net[bit[s]], c->net[node[s]]);
  }
  for (uint32_t i = m->devices - m->accesses; i < m->devices; i++) {
    const eda_device *d = &c->device[m->device[i]];
    if (is_rail(eda_circuit_role(c, d->gate)))
      return opc_fail(error, OPC_INVALID, "circuit",
                      "the word line of '%s', at storage nodes '%s' and '%s', "
                      "is the supply or ground '%s'",
                      d->name, c->net[m->q], c->net[m->qb], c->net[d->gate]);
  }
  if (bit[0] != bit[1]) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "circuit",
                  "storage nodes '%s' and '%s' have one bit line, '%s', "
                  "expected two",
                  c->net[m->q], c->net[m->qb], c->net[bit[0]]);
}

int accesses_find(bench *b, const cell *cells, size_t count, accesses *out,
                  opc_error *error) {
  for (size_t i = 0; i < count; i++)
    if (check_lines(b, &cells[i], error)) return error->code;
  const accesses_study s = {cells, out};
  for (int state = 0; state < EDA_STATES; state++)
    if (!out->of[state])
      out->of[state] = eda_pool_alloc(&b->pool, count, sizeof(access_figures));
  return jobs_run(b, 2 * count, 1, run_job, &s, error);
}

int cells_measure(bench *b, const cell *cells, size_t count, margins m[2],
                  accesses *a, opc_error *error) {
  for (b->reads = 0; b->reads < 2; b->reads++)
    if (margins_find(b, cells, count, &m[b->reads], error)) return error->code;
  return accesses_find(b, cells, count, a, error);
}
