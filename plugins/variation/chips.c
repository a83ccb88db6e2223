/* SPDX-License-Identifier: BSD-3-Clause */
/* Sampling of chips. The variables of a chip determine the terms of the
   surrogate. The logarithms of the currents of all gates are sums of terms,
   plus the effect of the line edges of each gate. */
#include <eda/check.h>
#include <eda/memory.h>
#include <eda/simd.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "variation.h"

enum { TOGETHER = 4 }; /* chips whose sums of terms are computed together */

/* ---- gates, LANES at a time ---- */

/* Figures that the sampling computes: LENGTH, LENGTH_OFF, WIDTH. */
enum { SAMPLED = 3 };

/* Constants of LANES gates. A gate beyond the last one has the weight 0. */
typedef struct lane_group {
  float length[LANES];            /* drawn, nm */
  float nominal[LANES];           /* equivalent length of Ion minus drawn, nm */
  int32_t curve[CURRENTS][LANES]; /* position of the curve in curves.value */
  int32_t rough[LANES];           /* position in circuit.rough, in floats */
  float leakage[LANES];           /* drawn Ioff over the drawn total */
  float mean[2][LANES];           /* weight of Ion in the mean of a type */
  uint32_t gate[LANES];
  size_t tile, used;
} lane_group;

typedef struct plan {
  const circuit *c;
  size_t terms, groups;
  lane_group *group;
  float *coefficient; /* [((group * terms) + term) * SAMPLED * LANES] */
} plan;

static void lane_set(lane_group *g, size_t k, const circuit *c, size_t gate) {
  g->length[k] = (float)c->drawn_length[gate];
  g->nominal[k] = (float)(c->nominal[gate] - c->drawn_length[gate]);
  g->curve[ION][k] = (int32_t)(c->curves->kind[gate] * c->curves->count);
  g->curve[IOFF][k] = (int32_t)(c->leakage->kind[gate] * c->leakage->count);
  g->rough[k] = (int32_t)(gate * KNOTS * (sizeof *c->rough / sizeof(float)));
  g->gate[k] = (uint32_t)gate;
}

static void group_add(plan *p, size_t gate, size_t tile, double total,
                      const double count[2]) {
  const circuit *c = p->c;
  lane_group *g = p->groups ? &p->group[p->groups - 1] : NULL;
  if (!g || g->used == LANES || g->tile != tile) {
    g = &p->group[p->groups++];
    *g = (lane_group){.tile = tile};
    for (size_t k = 0; k < LANES; k++) lane_set(g, k, c, gate);
  }
  size_t k = g->used++, type = c->type[gate];
  lane_set(g, k, c, gate);
  g->leakage[k] = (float)(c->ioff[gate] / total);
  g->mean[type][k] = (float)(1 / count[type]);
}

static void plan_init(plan *p, const circuit *c) {
  double total = 0, count[2] = {0};
  *p = (plan){.c = c, .terms = c->surrogate->terms};
  for (size_t i = 0; i < c->gates; i++) {
    total += c->ioff[i];
    count[c->type[i]]++;
  }
  p->group = eda_alloc(c->gates / LANES + c->tiles + 1, sizeof *p->group);
  for (size_t t = 0; t < c->tiles; t++)
    for (size_t i = 0; i < c->gates; i++)
      if (!c->tile_of || c->tile_of[i] == t) group_add(p, i, t, total, count);
  p->coefficient =
      eda_alloc(p->groups * p->terms * SAMPLED * LANES, sizeof(float));
  float *to = p->coefficient;
  for (size_t g = 0; g < p->groups; g++)
    for (size_t t = 0; t < p->terms; t++)
      for (int q = 0; q < SAMPLED; q++)
        for (size_t k = 0; k < LANES; k++)
          *to++ =
              c->surrogate->coefficient[q][t * c->gates + p->group[g].gate[k]];
}

static void plan_clear(plan *p) {
  free(p->group);
  free(p->coefficient);
}

typedef float vector __attribute__((vector_size(4 * LANES)));

/* Compute x[(chip * SAMPLED + figure) * LANES + lane], sums of terms, of
   TOGETHER chips. `terms`: [chip * n + term]. */
EDA_WIDE static void sum_terms(size_t n, const float *coefficient,
                               const float *terms, float *x) {
  vector sum[SAMPLED * TOGETHER];
  for (int k = 0; k < SAMPLED * TOGETHER; k++) sum[k] = (vector){0};
  for (size_t t = 0; t < n; t++) {
    vector c[SAMPLED];
    memcpy(c, coefficient + SAMPLED * t * LANES, sizeof c);
    for (int k = 0; k < TOGETHER; k++)
      for (int q = 0; q < SAMPLED; q++)
        sum[k * SAMPLED + q] += terms[(size_t)k * n + t] * c[q];
  }
  memcpy(x, sum, sizeof sum);
}

/* Return exp(x): 2^n exp(r) with |r| <= ln 2 / 2, Taylor to the 6th order. */
static inline float exp_of(float x) {
  x = fminf(fmaxf(x, -80.0F), 80.0F);
  float n = (x * 1.44269504F + 12582912.0F) - 12582912.0F;
  float r = x - n * 0.693145752F - n * 1.42860677e-6F;
  float e =
      1 + r * (1 + r * (0.5F +
                        r * (0.166666667F +
                             r * (0.0416666667F +
                                  r * (0.00833333333F + r * 0.00138888889F)))));
  int32_t bits = ((int32_t)n + 127) * (1 << 23);
  float scale;
  memcpy(&scale, &bits, sizeof scale);
  return e * scale;
}

/* Interpolate a table, whose elements are `stride` floats apart, at the
   position t, clamped to the ends of the table. */
static inline float table_at(const float *table, int stride, float last,
                             float t) {
  t = fminf(fmaxf(t, 0.0F), last - 1e-3F);
  int32_t i = (int32_t)t;
  float low = table[i * stride], high = table[(i + 1) * stride];
  return low + (t - (float)i) * (high - low);
}

/* Write the logarithms of the currents without line edges, log[2][LANES]. */
EDA_WIDE static void group_curves(const lane_group *g, const curves *const of[],
                                  const float *x, float *log) {
  for (int q = 0; q < CURRENTS; q++) {
    const curves *c = of[q];
    float last = (float)(c->count - 1), scale = (float)(1 / c->step);
    float first = (float)c->first;
    for (int k = 0; k < LANES; k++) {
      float t = (g->length[k] + x[q * LANES + k] - first) * scale;
      log[q * LANES + k] = x[WIDTH * LANES + k] +
                           table_at(c->value[q] + g->curve[q][k], 1, last, t);
    }
  }
}

/* Add the effect of the line edges to the logarithms, from the normal numbers
   `a` and `b`. */
EDA_WIDE static void group_edges(const lane_group *g,
                                 const roughness_effect *rough, const float *x,
                                 const float *a, const float *b, float *log) {
  enum { STRIDE = sizeof *rough / sizeof(float) };
  const float *all = rough->shift;
  float last = KNOTS - 1, scale = (float)(1 / knot_step);
  for (int k = 0; k < LANES; k++) {
    float t = (x[k] - g->nominal[k]) * scale + KNOT_ZERO;
    const float *one = all + g->rough[k];
    float shift_on = table_at(one, STRIDE, last, t);
    float shift_off = table_at(one + 1, STRIDE, last, t);
    float sigma_on = table_at(one + 2, STRIDE, last, t);
    float sigma_off = table_at(one + 3, STRIDE, last, t);
    float rho = table_at(one + 4, STRIDE, last, t);
    float own = sqrtf(fmaxf(0.0F, 1.0F - rho * rho));
    log[k] += shift_on + sigma_on * a[k];
    log[LANES + k] += shift_off + sigma_off * (rho * a[k] + own * b[k]);
  }
}

EDA_WIDE static void group_exp(const float *log, float *current) {
  for (int k = 0; k < CURRENTS * LANES; k++) current[k] = exp_of(log[k]);
}

/* Sums of a chip over all groups, by lane. */
typedef struct lane_sums {
  float sum[3][LANES], least[LANES], most[LANES];
} lane_sums;

EDA_WIDE static void sums_add(lane_sums *s, const lane_group *g,
                              const float *x) {
  for (int k = 0; k < LANES; k++) {
    s->sum[0][k] += g->leakage[k] * x[LANES + k];
    s->sum[1][k] += g->mean[0][k] * x[k];
    s->sum[2][k] += g->mean[1][k] * x[k];
  }
  for (size_t k = 0; k < g->used; k++) {
    s->least[k] = fminf(s->least[k], x[k]);
    s->most[k] = fmaxf(s->most[k], x[k]);
  }
}

/* Add the logarithms of a group; write those of Ion to ion[gates]. */
static void moments_add(moments *m, const lane_group *g, const float *log,
                        float *ion) {
  for (size_t k = 0; k < g->used; k++) {
    moments *one = &m[g->gate[k]];
    double x[2] = {(double)log[k], (double)log[LANES + k]};
    for (int q = 0; q < 2; q++) {
      one->sum[q] += x[q];
      one->square[q] += x[q] * x[q];
      one->cube[q] += x[q] * x[q] * x[q];
    }
    one->product += x[0] * x[1];
    ion[g->gate[k]] = log[k];
  }
}

/* ---- chips ---- */

/* Return the scaled variable v of a chip at a tile. The first numbers of a
   stream belong to the chip, the next to the tiles. */
static double chip_draw(const circuit *c, const uint32_t stream[SOURCES],
                        uint64_t chip, int v, size_t tile) {
  int source = v < OVERLAY_X ? v : SOURCE_OVERLAY;
  uint32_t k = (uint32_t)v;
  double z = 0, all = hypot(c->global[v], c->field[v]);
  if (!(all > 0)) return 0;
  if (c->global[v] > 0)
    z = c->global[v] * normal_at(c->seed, stream[source], chip, k);
  for (size_t t = 0; t <= tile && c->field[v] > 0; t++) {
    double mix = c->tiles > 1 ? c->mix[tile * c->tiles + t] : 1;
    uint32_t number = k + (uint32_t)(t + 1) * VARIABLES;
    z += c->field[v] * mix * normal_at(c->seed, stream[source], chip, number);
  }
  /* The variables are scaled, so that the ends of the range are +-1. */
  return fmin(1, fmax(-1, z));
}

void circuit_variables(const circuit *c, const uint32_t stream[SOURCES],
                       uint64_t chip, size_t tile, double u[VARIABLES]) {
  for (int v = 0; v < VARIABLES; v++)
    u[v] = chip_draw(c, stream, chip, v, tile);
}

static void chip_terms(const circuit *c, const uint32_t stream[SOURCES],
                       uint64_t chip, size_t tile, double *work, float *out) {
  double u[VARIABLES];
  circuit_variables(c, stream, chip, tile, u);
  surrogate_features(c->surrogate, u, work);
  for (size_t t = 0; t < c->surrogate->terms; t++) out[t] = (float)work[t];
}

typedef struct sampling {
  const plan *plan;
  const uint32_t *stream;
  uint64_t first;
  size_t count;
  float *const *chip;
  moments *moments; /* [block * gates] */
} sampling;

/* Memory of a block of chips: terms of the surrogate, ln Ion of all gates, and
   the input of delays_longest. */
typedef struct block_memory {
  double *work; /* [terms] */
  float *some;  /* [TOGETHER * terms] */
  float *ion;   /* [TOGETHER * gates] */
  float *terms; /* [(tile * terms + term) * BLOCK + chip] */
  float *edges; /* [gate * BLOCK + chip] */
} block_memory;

/* Keep the values that delays need of chip number k of the block. */
static void keep_terms(const sampling *s, const block_memory *b, size_t tile,
                       const float *terms, size_t k) {
  size_t n = s->plan->terms;
  for (size_t t = 0; t < n; t++)
    b->terms[(tile * n + t) * BLOCK + k] = terms[t];
}

/* Write the change of ln L by line edges of LANES gates: a rectangular gate
   with the new length has the current after line edges. The first step has the
   slope at the length, the second the slope of the chord of the first step.
   `before`, `after`: ln Ion. */
EDA_WIDE static void group_lengths(const lane_group *g, const curves *c,
                                   const float *x, const float *before,
                                   const float *after, float *out) {
  float last = (float)(c->count - 1), scale = (float)(1 / c->step);
  float first = (float)c->first;
  for (int k = 0; k < LANES; k++) {
    const float *curve = c->value[ION] + g->curve[ION][k];
    float length = g->length[k] + x[k], t = (length - first) * scale;
    float at = table_at(curve, 1, last, t), change = after[k] - before[k];
    float slope = table_at(curve, 1, last, t + scale) - at;
    float move = change / fminf(slope, -1e-4F);
    float size = fmaxf(fabsf(move), 0.05F), step = move < 0 ? -size : size;
    slope = (table_at(curve, 1, last, t + step * scale) - at) / step;
    float y = change / fminf(slope, -1e-4F) / length;
    out[k] = y * (1 - y * (0.5F - y * 0.333333333F));
  }
}

static void keep_edges(const block_memory *b, const lane_group *g,
                       const float *lengths, size_t k) {
  for (size_t i = 0; i < g->used; i++)
    b->edges[(size_t)g->gate[i] * BLOCK + k] = lengths[i];
}

/* Sample TOGETHER chips from number `at` on. Chips beyond the last one are
   computed, but not stored. */
static void sample_some(const sampling *s, size_t at,
                        const block_memory *memory, moments *m) {
  const plan *p = s->plan;
  const circuit *c = p->c;
  lane_sums sums[TOGETHER];
  uint64_t key[TOGETHER];
  float x[TOGETHER * SAMPLED * LANES], log[2 * LANES], current[2 * LANES];
  float a[LANES], b[LANES], plain[LANES], *terms = memory->some;
  size_t tile = SIZE_MAX;
  for (size_t k = 0; k < TOGETHER; k++) {
    key[k] = normal_key(c->seed, s->stream[SOURCE_EDGES], s->first + at + k);
    memset(&sums[k], 0, sizeof sums[k]);
    for (int l = 0; l < LANES; l++) sums[k].least[l] = INFINITY;
  }
  for (size_t g = 0; g < p->groups; g++) {
    const lane_group *group = &p->group[g];
    if (group->tile != tile) {
      tile = group->tile;
      for (size_t k = 0; k < TOGETHER; k++) {
        float *own = terms + k * p->terms;
        chip_terms(c, s->stream, s->first + at + k, tile, memory->work, own);
        if (c->delays) keep_terms(s, memory, tile, own, at % BLOCK + k);
      }
    }
    sum_terms(p->terms, p->coefficient + g * p->terms * SAMPLED * LANES, terms,
              x);
    for (size_t k = 0; k < TOGETHER; k++) {
      const float *one = x + k * SAMPLED * LANES;
      normal_pairs(key[k], (uint32_t)(g * LANES), a, b);
      group_curves(group, (const curves *const[]){c->curves, c->leakage}, one,
                   log);
      memcpy(plain, log, sizeof plain);
      group_edges(group, c->rough, one, a, b, log);
      if (memory->edges) {
        group_lengths(group, c->curves, one, plain, log, a);
        keep_edges(memory, group, a, at % BLOCK + k);
      }
      group_exp(log, current);
      sums_add(&sums[k], group, current);
      if (m && at + k < s->count)
        moments_add(m, group, log, memory->ion + k * c->gates);
    }
  }
  for (size_t k = 0; m && k < TOGETHER && at + k < s->count; k++)
    for (size_t i = 0; i < c->gates; i++)
      m[i].neighbour += (double)memory->ion[k * c->gates + i] *
                        (double)memory->ion[k * c->gates + c->neighbour[i]];
  for (size_t k = 0; k < TOGETHER && at + k < s->count; k++) {
    float least = INFINITY, most = 0, sum[3] = {0};
    for (int l = 0; l < LANES; l++) {
      least = fminf(least, sums[k].least[l]);
      most = fmaxf(most, sums[k].most[l]);
      for (int q = 0; q < 3; q++) sum[q] += sums[k].sum[q][l];
    }
    for (int q = 0; q < 3; q++) s->chip[CHIP_LEAKAGE + q][at + k] = sum[q];
    s->chip[CHIP_LEAST][at + k] = least;
    s->chip[CHIP_MOST][at + k] = most;
  }
}

static void sample_block(void *data, size_t block) {
  const sampling *s = data;
  const circuit *c = s->plan->c;
  size_t terms = s->plan->terms, first = block * BLOCK;
  size_t count = s->count - first < BLOCK ? s->count - first : BLOCK;
  block_memory b = {
      eda_alloc(terms, sizeof *b.work),
      eda_alloc(TOGETHER * terms, sizeof *b.some),
      s->moments ? eda_alloc(TOGETHER * c->gates, sizeof *b.ion) : NULL, NULL,
      NULL};
  if (c->delays) b.terms = eda_alloc(c->tiles * terms * BLOCK, sizeof *b.terms);
  if (c->delays || s->first + first < c->kept)
    b.edges = eda_alloc(c->gates * BLOCK, sizeof *b.edges);
  moments *m = s->moments ? s->moments + block * c->gates : NULL;
  for (size_t at = first; at < first + count; at += TOGETHER)
    sample_some(s, at, &b, m);
  if (c->delays) {
    float longest[BLOCK];
    delays_longest(c->delays, b.terms, b.edges, longest);
    memcpy(s->chip[CHIP_DELAY] + first, longest, count * sizeof *longest);
  }
  for (size_t k = 0; k < count && s->first + first + k < c->kept; k++)
    for (size_t i = 0; i < c->gates; i++)
      c->edges[(s->first + first + k) * c->gates + i] = b.edges[i * BLOCK + k];
  free(b.work);
  free(b.some);
  free(b.ion);
  free(b.terms);
  free(b.edges);
}

/* Add the moments of all blocks, in their order. */
static void moments_sum(const moments *from, size_t blocks, size_t gates,
                        moments *to) {
  for (size_t b = 0; b < blocks; b++)
    for (size_t i = 0; i < gates; i++) {
      const moments *one = &from[b * gates + i];
      for (int q = 0; q < 2; q++) {
        to[i].sum[q] += one->sum[q];
        to[i].square[q] += one->square[q];
        to[i].cube[q] += one->cube[q];
      }
      to[i].product += one->product;
      to[i].neighbour += one->neighbour;
    }
}

int circuit_sample(const circuit *c, const uint32_t stream[SOURCES],
                   uint64_t first, size_t count, float *const chip[CHIP],
                   moments *out, opc_error *error) {
  plan p;
  size_t blocks = (count + BLOCK - 1) / BLOCK;
  plan_init(&p, c);
  sampling s = {&p, stream, first, count, chip, NULL};
  if (out) s.moments = eda_alloc(blocks * c->gates, sizeof *s.moments);
  opc_parallel(c->context, blocks, sample_block, &s);
  if (out) moments_sum(s.moments, blocks, c->gates, out);
  free(s.moments);
  plan_clear(&p);
  if (!opc_cancelled(c->context)) return OPC_OK;
  return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
}
