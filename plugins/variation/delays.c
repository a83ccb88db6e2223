/* SPDX-License-Identifier: BSD-3-Clause */
/* Delays of the paths of sampled chips. A delay is linear in the logarithms of
   the sizes of the transistors (eda/delays.h). The logarithms are polynomials
   in the variables of a chip, so the delay of a path is one polynomial, plus
   the effect of the line edges of each transistor. */
#include <eda/memory.h>
#include <eda/simd.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "variation.h"

/* ---- one delay ---- */

/* Add factor * x^2 to a polynomial with these terms, up to degree 2, where x is
   the polynomial with the coefficients `c` of gate i. */
static void square_add(const surrogate *s, const float *c, size_t i,
                       double factor, double *to) {
  double part[VARIABLES] = {0}, constant = 0;
  for (size_t t = 0; t < s->terms; t++) {
    const uint8_t *power = s->power[t];
    int degree = 0, of = 0;
    for (int v = 0; v < VARIABLES; v++) {
      degree += power[v];
      if (power[v]) of = v;
    }
    double value = (double)c[t * s->gates + i];
    if (!degree) constant = value;
    if (degree == 1) part[of] = value;
  }
  for (size_t t = 0; t < s->terms; t++) {
    const uint8_t *power = s->power[t];
    int degree = 0, of[2] = {0, 0}, n = 0;
    for (int v = 0; v < VARIABLES; v++) {
      degree += power[v];
      for (int k = 0; k < power[v] && n < 2; k++) of[n++] = v;
    }
    if (degree == 0) to[t] += factor * constant * constant;
    if (degree == 1) to[t] += factor * 2 * constant * part[of[0]];
    if (degree == 2)
      to[t] += factor * part[of[0]] * part[of[1]] * (of[0] == of[1] ? 1 : 2);
  }
}

/* Return d ln(length) / d ln(Ion) of a gate at its nominal length. */
static double length_by_ion(const circuit *c, size_t gate) {
  const double step = 1;
  double at = c->nominal[gate];
  double slope = (curves_at(c->curves, gate, ION, at + step) -
                  curves_at(c->curves, gate, ION, at - step)) /
                 (2 * step);
  return 1 / (slope * at);
}

double delay_local(const circuit *c, const eda_delay_term *term) {
  return (double)term->by[EDA_SIZE_L] * length_by_ion(c, term->gate);
}

/* The length is expanded to the second order, ln(1 + x) = x - x^2 / 2, because
   its deviations reach some percent. */
void delay_global(const circuit *c, const eda_delays *d, const eda_delay *delay,
                  size_t tile, double *out) {
  const surrogate *s = c->surrogate;
  for (size_t k = 0; k < delay->terms; k++) {
    const eda_delay_term *term = &delay->term[k];
    size_t i = term->gate;
    if (c->tile_of && c->tile_of[i] != tile) continue;
    double length = d->size[EDA_SIZE_L][i], l = (double)term->by[EDA_SIZE_L];
    double w = (double)term->by[EDA_SIZE_W], a = (double)term->by[EDA_SIZE_C];
    const float *of[] = {s->coefficient[LENGTH], s->coefficient[WIDTH],
                         s->coefficient[AREA]};
    const double by[] = {l / length, w - a, a};
    /* Constants: the surrogate is relative to drawn, the delay to `size`. */
    double first = c->drawn_length[i] / length - 1;
    out[0] += l * (first - first * first / 2) +
              (w - a) * log(c->drawn_width[i] / d->size[EDA_SIZE_W][i]) +
              a * log(c->drawn_area[i] / d->size[EDA_SIZE_C][i]);
    for (size_t t = 0; t < s->terms; t++)
      for (int q = 0; q < 3; q++)
        out[t] += by[q] * (double)of[q][t * s->gates + i];
    for (size_t t = 0; t < s->terms; t++)
      out[t] -= l * first / length * (double)of[0][t * s->gates + i];
    square_add(s, of[0], i, -l / (2 * length * length), out);
  }
}

/* ---- all paths ---- */

void delay_model_init(delay_model *m, const circuit *c, const eda_delays *d) {
  size_t terms = c->surrogate->terms, all = 0;
  for (size_t p = 0; p < d->paths; p++) all += d->path[p].delay.terms;
  *m = (delay_model){.paths = d->paths, .tiles = c->tiles, .terms = terms};
  m->time = eda_alloc(d->paths, sizeof *m->time);
  m->global = eda_alloc(d->paths * c->tiles * terms, sizeof *m->global);
  m->first = eda_alloc(d->paths + 1, sizeof *m->first);
  m->gate = eda_alloc(all, sizeof *m->gate);
  m->local = eda_alloc(all, sizeof *m->local);
  double *row = eda_alloc(terms, sizeof *row);
  for (size_t p = 0; p < d->paths; p++) {
    const eda_delay *one = &d->path[p].delay;
    m->time[p] = (float)one->time;
    for (size_t tile = 0; tile < c->tiles; tile++) {
      memset(row, 0, terms * sizeof *row);
      delay_global(c, d, one, tile, row);
      for (size_t t = 0; t < terms; t++)
        m->global[(p * c->tiles + tile) * terms + t] = (float)row[t];
    }
    m->first[p + 1] = m->first[p];
    for (size_t k = 0; k < one->terms; k++) {
      float local = (float)delay_local(c, &one->term[k]);
      if (local == 0) continue;
      m->gate[m->first[p + 1]] = one->term[k].gate;
      m->local[m->first[p + 1]++] = local;
    }
  }
  free(row);
}

void delay_model_clear(delay_model *m) {
  free(m->time);
  free(m->global);
  free(m->first);
  free(m->gate);
  free(m->local);
}

EDA_WIDE void delays_longest(const delay_model *m, const float *terms,
                             const float *edges, float *out) {
  size_t rows = m->tiles * m->terms;
  for (int k = 0; k < BLOCK; k++) out[k] = 0;
  for (size_t p = 0; p < m->paths; p++) {
    float sum[BLOCK];
    const float *global = m->global + p * rows;
    for (int k = 0; k < BLOCK; k++) sum[k] = m->time[p];
    for (size_t t = 0; t < rows; t++)
      for (int k = 0; k < BLOCK; k++)
        sum[k] += global[t] * terms[t * BLOCK + (size_t)k];
    for (size_t e = m->first[p]; e < m->first[p + 1]; e++) {
      const float *edge = edges + (size_t)m->gate[e] * BLOCK;
      for (int k = 0; k < BLOCK; k++) sum[k] += m->local[e] * edge[k];
    }
    for (int k = 0; k < BLOCK; k++) out[k] = fmaxf(out[k], sum[k]);
  }
}
