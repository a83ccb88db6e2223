/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of synthesizer.newton: transistors whose printed lengths and
   currents are formulas of the mask, and the loop that corrects them. */
#pragma once

#include <eda/eda.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

enum { MOST = 40, WIDTH = 400 };

typedef struct model {
  size_t n;
  double gain_l, gain_w, coupling;
  double spread;                   /* relative spread of the gain of L */
  double off_l[MOST], off_w[MOST]; /* printed minus drawn size with the drawn
                                      mask */
  double thin[MOST]; /* effect of a short line end on the logarithm of the
                        current, in addition to that of the mean length */
  int32_t grow;      /* displacement of the line end by the regulator beyond
                        which `thin` has no effect */
  int knows_ends;    /* 1: moves of line ends are known before the next
                        simulation */
  uint32_t veto[MOST];
  int32_t l[MOST], w[MOST], jog[MOST], aside[MOST];
  double ion[MOST], area[MOST], ioff[MOST]; /* final deviations */
  double leaky;                             /* logarithm of additional
                                               leakage */
  double second; /* largest Ion deviation in the second iteration */
  int prints;
  int late;     /* iteration after which transistor 3 has 2 % less current */
  int undone;   /* iteration until which the regulator undoes moves of L */
  double steep; /* increase of |d log Ion / dL| per nm of length below
                   nominal */
  double table; /* printed length at the end of the device table */
  double open;  /* printed length below which the line is open and has no
                   figures */
  double merge; /* printed length above which the line merges; 0: never */
  int32_t active_limit; /* largest outward move of an end of the active; beyond
                           it the active merges; 0: no limit */
  int32_t contact;      /* least outward move of an end of the active, below
                           which the regulator vetoes a narrower gate; 0: no
                           limit */
  int ends_open;        /* 1: also open while a line end is too short */
  int regulated; /* 1: vetoes an open line from becoming shorter or narrower */
  eda_field *tapered; /* image of gates in the second simulation; afterwards
                         `even`; NULL: no images */
  eda_field *even;
  double surge; /* additional leaky in the third simulation, after which line
                   ends move by 9 steps */
  eda_part part[MOST * EDA_PARTS];
  uint32_t flags[MOST];
  double bracket[MOST][2]; /* largest length that was open, and smallest length
                              that was too long */
  int held;                /* number of moves limited by a bracket of two
                              ends */
  int guarded;             /* 1: check that moves stay within the bracket */
} model;

static const double length = 65;

static eda_goal *goals; /* goals of the gates; NULL: none */

/* Return the effect of the part of a side up to x. Sides extend 60 nm past the
   gate, and the effect per nm rises over 200 nm around the ends of the gate. */
static inline double ramp_integral(double x) {
  return x < -100 ? 0 : x < 100 ? (x + 100) * (x + 100) / 400 : x;
}

static inline double model_part(int32_t jog) {
  double at = CLAMP(jog, 0, WIDTH + 120) - 60;
  double none = ramp_integral(-60) - ramp_integral(-60 - WIDTH),
         all = ramp_integral(WIDTH + 60) - ramp_integral(60);
  return (ramp_integral(at) - ramp_integral(at - WIDTH) - none) / (all - none);
}

/* Compute the figures of transistor i and its logarithmic errors. */
static inline void model_print(model *t, const int32_t *end,
                               eda_performance *p) {
  for (size_t i = 0; i < t->n; i++) {
    size_t next = (i + 1) % t->n;
    double l = t->l[i] + model_part(t->jog[i]),
           beside = t->l[next] + model_part(t->jog[next]);
    double gain = t->gain_l * (1 + t->spread * sin((double)i));
    if (t->prints > 1 && t->prints < t->undone) gain = 0;
    double printed = length + t->off_l[i] + gain * (l + t->coupling * beside);
    double weq = WIDTH + t->off_w[i] + t->gain_w * t->w[i];
    double thin = end[2 * i + 1] < t->grow ? t->thin[i] : 0;
    int open = printed < t->open || (t->ends_open && thin > 0);
    int32_t low = (t->w[i] >> 1) - t->aside[i], high = t->w[i] - low;
    int merged = (t->merge > 0 && printed > t->merge) ||
                 (t->active_limit > 0 && MAX(low, high) > t->active_limit);
    t->flags[i] = open ? EDA_PRINT_OPEN : merged ? EDA_PRINT_MERGED : 0;
    if (t->regulated)
      t->veto[i] = open ? EDA_VETO_SHORTER | EDA_VETO_NARROWER : 0;
    if (t->contact)
      t->veto[i] = MIN(low, high) < t->contact ? EDA_VETO_NARROWER : 0;
    double known = fmax(printed, t->table);
    p->leq_ion[i] = known - thin / 0.022;
    p->leq_ioff[i] = printed - t->leaky / 0.3;
    p->weq[i] = weq;
    p->area[i] = weq * printed;
    double off = p->leq_ion[i] - length, bent = fmin(off, 0);
    p->ion[i] = 1e-6 * weq * exp(-0.022 * off + t->steep * bent * bent / 2);
    if (t->flags[i] & EDA_PRINT_OPEN) p->ion[i] = p->area[i] = 0;
    if (t->late && t->prints > t->late && i == 3) p->ion[i] *= 0.98;
    double leaky = t->leaky + (t->prints == 2 ? t->surge : 0);
    p->ioff[i] = 1e-10 * weq * exp(leaky - 0.3 * (printed - length));
    t->ion[i] = 100 * (p->ion[i] / (1e-6 * WIDTH) - 1);
    t->ioff[i] = 100 * (p->ioff[i] / (1e-10 * WIDTH) - 1);
    t->area[i] = 100 * (p->area[i] / (WIDTH * length) - 1);
  }
  t->prints++;
}

/* Check the bracket: once one length was open and another too long, the next
   lengths must be between them, because transistors of the model do not
   couple. */
static inline void hold_bracket(model *t) {
  for (size_t i = 0; i < t->n; i++) {
    double l = t->l[i] + model_part(t->jog[i]);
    double *low = &t->bracket[i][0], *high = &t->bracket[i][1];
    if (*low < *high) {
      t->held += *low > -1000 && *high < 1000;
      g_assert_cmpfloat(l, >, *low);
      g_assert_cmpfloat(l, <, *high + 1);
    }
  }
}

static inline void note_bracket(model *t) {
  for (size_t i = 0; i < t->n; i++) {
    double l = t->l[i] + model_part(t->jog[i]);
    int open = t->flags[i] & EDA_PRINT_OPEN;
    if (open) t->bracket[i][0] = fmax(t->bracket[i][0], l);
    if (!open && t->ion[i] < -20) t->bracket[i][1] = fmin(t->bracket[i][1], l);
  }
}

static inline double model_worst(const double *x, size_t n) {
  double most = 0;
  for (size_t i = 0; i < n; i++) most = fmax(most, fabs(x[i]));
  return most;
}

static inline void model_run(opc_module *m, model *t) {
  const eda_synthesizer *s = m->functions;
  double d[6][MOST], p[6][MOST] = {{0}}, long_[MOST], wide[MOST];
  eda_box box[MOST];
  double extension[2 * MOST];
  int32_t end[2 * MOST] = {0}, next[2 * MOST] = {0};
  uint8_t type[MOST] = {0}, axis[MOST] = {0};
  uint32_t number[MOST];
  char *name[MOST], *none[MOST];
  for (size_t i = 0; i < t->n; i++) {
    d[0][i] = 1e-6 * WIDTH, d[1][i] = 1e-10 * WIDTH;
    d[2][i] = d[3][i] = long_[i] = length;
    d[4][i] = wide[i] = WIDTH;
    d[5][i] = WIDTH * length;
    box[i] = (eda_box){0, 0, 65, WIDTH};
    number[i] = (uint32_t)i + 1;
    name[i] = "cell", none[i] = "";
    extension[2 * i] = INFINITY, extension[2 * i + 1] = 60;
    next[2 * i + 1] = t->grow;
  }
  eda_fragment sides[4 * MOST];
  uint32_t start[MOST + 1];
  for (size_t i = 0; i < t->n; i++) {
    start[i] = (uint32_t)(4 * i);
    eda_fragment *f = sides + 4 * i;
    f[0] = (eda_fragment){{65, -60}, (int32_t)i, EDA_L_HIGH};
    f[1] = (eda_fragment){{65, WIDTH + 60}, -1, EDA_FIXED};
    f[2] = (eda_fragment){{0, WIDTH + 60}, (int32_t)i, EDA_L_LOW};
    f[3] = (eda_fragment){{0, -60}, -1, EDA_FIXED};
  }
  start[t->n] = (uint32_t)(4 * t->n);
  eda_edges edges[2] = {{t->n, start, sides}, {0}};
  eda_gates gates = {.grid = 1,
                     .count = t->n,
                     .box = box,
                     .type = type,
                     .axis = axis,
                     .length = long_,
                     .width = wide,
                     .extension = extension,
                     .instance = none,
                     .cell = name,
                     .number = number,
                     .goal = goals,
                     .layers = 2,
                     .edges = edges};
  uint8_t outside[MOST] = {0};
  eda_performance drawn = {t->n, d[0], d[1], d[2], d[3], d[4], d[5], outside};
  eda_performance printed = {t->n, p[0], p[1], p[2], p[3], p[4], p[5], outside};
  eda_feedback f = {.gates = &gates,
                    .design = &drawn,
                    .flags = t->flags,
                    .vetoes = t->veto,
                    .end = end,
                    .next_end = t->knows_ends ? next : end};
  eda_moves moves = {.l = t->l, .w = t->w, .jog = t->jog, .aside = t->aside};
  if (t->tapered) moves.part = t->part;
  opc_error error;
  g_assert_cmpint(s->begin(m->self, &f, &error), ==, OPC_OK);
  f.printed = &printed;
  for (int done = 0; !done && f.iteration < 50; f.iteration++) {
    model_print(t, end, &printed);
    if (f.iteration == 1) t->second = model_worst(t->ion, t->n);
    f.print = f.iteration == 1 ? t->tapered : t->even;
    if (t->surge > 0 && f.iteration == 2)
      for (size_t i = 0; i < t->n; i++) next[2 * i + 1] += 9;
    if (t->guarded) note_bracket(t);
    g_assert_cmpint(s->update(m->self, &f, &moves, &done, &error), ==, OPC_OK);
    if (t->guarded) hold_bracket(t);
    done &= !memcmp(end, next, sizeof end) && t->prints > t->late + 1;
    memcpy(end, next, sizeof end);
  }
  model_print(t, end, &printed);
}

static inline model made_up(size_t n) {
  model t = {.n = n, .gain_l = 2.6, .gain_w = 1.05, .coupling = 0.02};
  GRand *random = g_rand_new_with_seed(5);
  for (size_t i = 0; i < n; i++) {
    t.off_l[i] = g_rand_double_range(random, -8, 12);
    t.off_w[i] = g_rand_double_range(random, -15, 5);
  }
  g_rand_free(random);
  return t;
}

static inline opc_module *make_any(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("synthesizer.newton", parameters, &error);
  if (!m) g_printerr("%s\n", error.message);
  g_assert_nonnull(m);
  return m;
}

/* Return a module of synthesizer.newton whose target is defined by weights. */
static inline opc_module *model_make(const char *parameters) {
  g_autofree char *all = g_strconcat("{ target: plain, ", parameters + 1, NULL);
  return make_any(all);
}
