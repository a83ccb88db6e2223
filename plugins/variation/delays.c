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

void delay_global(const circuit *c, const eda_delays *d, const eda_delay *delay,
                  size_t tile, double *out) {
  const surrogate *s = c->surrogate;
  for (size_t k = 0; k < delay->terms; k++) {
    const eda_delay_term *term = &delay->term[k];
    size_t i = term->gate;
    if (c->tile_of && c->tile_of[i] != tile) continue;
    double a = (double)term->by[EDA_SIZE_C];
    const float *of[] = {s->coefficient[LOG_LENGTH], s->coefficient[WIDTH],
                         s->coefficient[AREA]};
    const double by[] = {(double)term->by[EDA_SIZE_L],
                         (double)term->by[EDA_SIZE_W] - a, a};
    /* Constants: the surrogate is relative to drawn, the delay to `size`. */
    const double drawn[] = {c->drawn_length[i], c->drawn_width[i],
                            c->drawn_area[i]};
    for (int q = 0; q < EDA_SIZES; q++) {
      out[0] += by[q] * log(drawn[q] / d->size[q][i]);
      for (size_t t = 0; t < s->terms; t++)
        out[t] += by[q] * (double)of[q][t * s->gates + i];
    }
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
      float local = one->term[k].by[EDA_SIZE_L];
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
