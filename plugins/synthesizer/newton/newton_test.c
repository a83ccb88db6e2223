/* SPDX-License-Identifier: BSD-3-Clause */
/* Newton's steps on transistors whose print and current are formulas: printed
   L and W linear in the mask's, with a little of the neighbour's, and currents
   exponential in L. */
#include <eda/eda.h>

#include "core/testing/testing.h"

#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

enum { MOST = 40, WIDTH = 400 };

typedef struct model {
  size_t n;
  double gain_l, gain_w, coupling;
  double spread;                   /* of the gain by L, as a part of it */
  double off_l[MOST], off_w[MOST]; /* printed minus drawn of the drawn mask */
  double thin[MOST]; /* a short line end: current that the mean length does
                        not tell of, as a logarithm, */
  int32_t grow;      /* gone once the regulator has moved it so far */
  int knows_ends;    /* the loop tells of that before it prints it */
  uint32_t veto[MOST];
  int32_t l[MOST], w[MOST], jog[MOST], aside[MOST];
  double ion[MOST], area[MOST], ioff[MOST]; /* deviations at the end */
  double leaky;                             /* log of what leaks besides */
  double second; /* the worst of Ion in the second print */
  int prints;
  int late;      /* a print after which transistor 3 draws 2 % less */
  double steep;  /* log Ion falls by so much more a nm for each nm shorter, */
  double table;  /* down to a printed length where the device table ends; */
  double open;   /* below this one the poly is open: no figures; */
  double merge;  /* above this one it is merged; 0: never */
  int32_t room;  /* the active merges once an end is further out; 0: never */
  int ends_open; /* so is it while a line end is too short */
  int regulated; /* an open line may get neither shorter nor narrower */
  uint32_t flags[MOST];
  double bracket[MOST][2]; /* lengths that were open, too long */
  int held;                /* moves that a bracket of two ends held */
  int guarded;             /* look at that */
} model;

static const double length = 65;

static eda_wish *wishes; /* of the gates; NULL: none */

/* The sides reach 60 nm past the gate. What each nm of them does rises over
   200 nm around the gate's ends, here summed. */
static double ramp(double x) {
  return x < -100 ? 0 : x < 100 ? (x + 100) * (x + 100) / 400 : x;
}

static double part(int32_t jog) {
  double at = CLAMP(jog, 0, WIDTH + 120) - 60;
  double none = ramp(-60) - ramp(-60 - WIDTH),
         all = ramp(WIDTH + 60) - ramp(60);
  return (ramp(at) - ramp(at - WIDTH) - none) / (all - none);
}

/* What transistor i prints, and its logarithmic errors. */
static void print(model *t, const int32_t *end, eda_performance *p) {
  for (size_t i = 0; i < t->n; i++) {
    size_t next = (i + 1) % t->n;
    double l = t->l[i] + part(t->jog[i]),
           beside = t->l[next] + part(t->jog[next]);
    double gain = t->gain_l * (1 + t->spread * sin((double)i));
    double printed = length + t->off_l[i] + gain * (l + t->coupling * beside);
    double weq = WIDTH + t->off_w[i] + t->gain_w * t->w[i];
    double thin = end[2 * i + 1] < t->grow ? t->thin[i] : 0;
    int open = printed < t->open || (t->ends_open && thin > 0);
    int32_t low = (t->w[i] >> 1) - t->aside[i], high = t->w[i] - low;
    int merged = (t->merge > 0 && printed > t->merge) ||
                 (t->room > 0 && MAX(low, high) > t->room);
    t->flags[i] = open ? EDA_PRINT_OPEN : merged ? EDA_PRINT_MERGED : 0;
    if (t->regulated)
      t->veto[i] = open ? EDA_VETO_SHORTER | EDA_VETO_NARROWER : 0;
    double known = fmax(printed, t->table);
    p->leq_ion[i] = known - thin / 0.022;
    p->leq_ioff[i] = printed;
    p->weq[i] = weq;
    p->area[i] = weq * printed;
    double off = p->leq_ion[i] - length, bent = fmin(off, 0);
    p->ion[i] = 1e-6 * weq * exp(-0.022 * off + t->steep * bent * bent / 2);
    if (t->flags[i] & EDA_PRINT_OPEN) p->ion[i] = p->area[i] = 0;
    if (t->late && t->prints > t->late && i == 3) p->ion[i] *= 0.98;
    p->ioff[i] = 1e-10 * weq * exp(t->leaky - 0.3 * (printed - length));
    t->ion[i] = 100 * (p->ion[i] / (1e-6 * WIDTH) - 1);
    t->ioff[i] = 100 * (p->ioff[i] / (1e-10 * WIDTH) - 1);
    t->area[i] = 100 * (p->area[i] / (WIDTH * length) - 1);
  }
  t->prints++;
}

/* Transistors do not couple: once a length was open and another one too long,
   the next ones lie between. */
static void hold_bracket(model *t) {
  for (size_t i = 0; i < t->n; i++) {
    double l = t->l[i] + part(t->jog[i]);
    double *low = &t->bracket[i][0], *high = &t->bracket[i][1];
    if (*low < *high) {
      t->held += *low > -1000 && *high < 1000;
      g_assert_cmpfloat(l, >, *low);
      g_assert_cmpfloat(l, <, *high + 1);
    }
  }
}

static void note_bracket(model *t) {
  for (size_t i = 0; i < t->n; i++) {
    double l = t->l[i] + part(t->jog[i]);
    int open = t->flags[i] & EDA_PRINT_OPEN;
    if (open) t->bracket[i][0] = fmax(t->bracket[i][0], l);
    if (!open && t->ion[i] < -20) t->bracket[i][1] = fmin(t->bracket[i][1], l);
  }
}

static double worst(const double *x, size_t n) {
  double most = 0;
  for (size_t i = 0; i < n; i++) most = fmax(most, fabs(x[i]));
  return most;
}

static void run(opc_module *m, model *t) {
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
                     .wish = wishes,
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
  opc_error error;
  g_assert_cmpint(s->begin(m->self, &f, &error), ==, OPC_OK);
  f.printed = &printed;
  for (int done = 0; !done && f.iteration < 50; f.iteration++) {
    print(t, end, &printed);
    if (f.iteration == 1) t->second = worst(t->ion, t->n);
    if (t->guarded) note_bracket(t);
    g_assert_cmpint(s->update(m->self, &f, &moves, &done, &error), ==, OPC_OK);
    if (t->guarded) hold_bracket(t);
    done &= !memcmp(end, next, sizeof end) && t->prints > t->late + 1;
    memcpy(end, next, sizeof end);
  }
  print(t, end, &printed);
}

static model made_up(size_t n) {
  model t = {.n = n, .gain_l = 2.6, .gain_w = 1.05, .coupling = 0.02};
  GRand *random = g_rand_new_with_seed(5);
  for (size_t i = 0; i < n; i++) {
    t.off_l[i] = g_rand_double_range(random, -8, 12);
    t.off_w[i] = g_rand_double_range(random, -15, 5);
  }
  g_rand_free(random);
  return t;
}

static opc_module *make_any(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("synthesizer.newton", parameters, &error);
  if (!m) g_printerr("%s\n", error.message);
  g_assert_nonnull(m);
  return m;
}

/* Of the target that weights are for. */
static opc_module *make(const char *parameters) {
  g_autofree char *all = g_strconcat("{ target: plain, ", parameters + 1, NULL);
  return make_any(all);
}

/* A wrong first guess of the gain, and still all are there after 4 moves. */
static void test_ion(void) {
  g_autoptr(opc_module) m =
      make("{ tolerance: 0.05 %, limit: 0 %, gain: { l: 2 } }");
  model t = made_up(MOST);
  run(m, &t);
  g_assert_cmpfloat(worst(t.ion, t.n), <=, 0.05);
  g_assert_cmpint(t.prints, <=, 6);
  for (size_t i = 0; i < t.n; i++) g_assert_cmpint(t.w[i], ==, 0);
  /* Each has a gain of its own. */
  model u = made_up(MOST);
  u.spread = 0.5;
  run(m, &u);
  g_assert_cmpfloat(worst(u.ion, u.n), <=, 0.05);
  g_assert_cmpint(u.prints, <=, 8);
}

/* Near resolution: currents bend away, the device table ends, lines open and
   merge; with a first guess of the gain that is right, up to 6 times too small
   or 10 times too large; of many transistors, which learn together, and of one.
   The root is known: the print is as long as it is drawn. */
static void test_near_resolution(void) {
  static const double guess[] = {2.6, 5.2}, true_gain[] = {0.5, 2, 8};
  int held = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(guess); k++)
    for (size_t j = 0; j < G_N_ELEMENTS(true_gain); j++)
      for (size_t n = 1; n <= MOST; n += MOST - 1) {
        g_autofree char *text = g_strdup_printf(
            "{ iterations: 20, max_bias: 200 nm, gain: { l: %g } }", guess[k]);
        g_autoptr(opc_module) m = make(text);
        model t = {.n = n,
                   .gain_l = true_gain[j],
                   .gain_w = 1.05,
                   .steep = 0.005,
                   .table = 57,
                   .open = 55,
                   .merge = 100,
                   .regulated = 1,
                   .guarded = 1};
        for (size_t i = 0; i < n; i++) {
          t.off_l[i] = 12 + 10.0 * (double)i / MOST;
          t.bracket[i][0] = -1e6, t.bracket[i][1] = 1e6;
        }
        run(m, &t);
        held += t.held;
        for (size_t i = 0; i < n; i++) {
          g_assert_cmpint(t.flags[i], ==, 0);
          g_assert_cmpint(abs(t.w[i]), <=, 1); /* L alone does it */
        }
        g_assert_cmpfloat(worst(t.ion, n), <=, 0.5);
        g_test_message("guess %g, gain %g, %zu: %d prints", guess[k],
                       true_gain[j], n, t.prints);
        g_assert_cmpint(t.prints, <=, 16);
      }
  g_assert_cmpint(held, >, 10);
}

/* Lines that are open as drawn, or merged, are found. */
static void test_lost_as_drawn(void) {
  g_autoptr(opc_module) m = make("{ iterations: 20 }");
  model t = {.n = 2,
             .gain_l = 2,
             .gain_w = 1.05,
             .open = 50,
             .merge = 90,
             .off_l = {-30, 40}};
  run(m, &t);
  g_assert_cmpint(t.flags[0], ==, 0);
  g_assert_cmpint(t.flags[1], ==, 0);
  g_assert_cmpfloat(worst(t.ion, 2), <=, 0.5);
}

/* A line that was open for its short line end alone is as long as it was, once
   that has grown. */
static void test_open_by_its_end(void) {
  g_autoptr(opc_module) m = make("{}");
  model t = {.n = 2,
             .gain_l = 2,
             .gain_w = 1.05,
             .thin = {0.3, 0.3},
             .grow = 40,
             .ends_open = 1,
             .off_l = {0, 4}};
  run(m, &t);
  g_assert_cmpfloat(worst(t.ion, 2), <=, 0.5);
}

/* A target that only an open line would reach leaves a line that prints, no
   worse than drawn. */
static void test_out_of_reach(void) {
  static eda_wish wish[] = {{1, {3, 1, 1}, 1}};
  g_autoptr(opc_module) m = make("{}");
  const eda_synthesizer *s = m->functions;
  model t = {.n = 1, .gain_l = 2, .gain_w = 1.05, .open = 50, .off_l = {10}};
  wishes = wish;
  run(m, &t);
  wishes = NULL;
  g_assert_cmpint(t.flags[0], ==, 0);
  g_assert_cmpfloat(t.ion[0], >, 20); /* drawn: -20 */
  g_assert_cmpfloat(s->target(m->self, 0), ==, 3);
}

/* What a patch or a neighbour does to one that rested is answered. */
static void test_late(void) {
  g_autoptr(opc_module) m = make("{ limit: 3 % }");
  model t = made_up(MOST);
  t.late = 6;
  run(m, &t);
  g_assert_cmpint(t.prints, >, 8);
  g_assert_cmpfloat(worst(t.ion, t.n), <=, 1.5);
}

/* Where no jog may lie, W takes a part of what the grid leaves of L. */
static void test_coarse(void) {
  g_autoptr(opc_module) m = make("{ min_jog: 1000 nm }");
  g_autoptr(opc_module) none = make("{ fine: none }");
  model t = made_up(MOST), u = made_up(MOST);
  run(m, &t);
  run(none, &u);
  g_assert_cmpfloat(worst(u.ion, u.n), >, 2);
  g_assert_cmpfloat(worst(t.ion, t.n), <, 0.9 * worst(u.ion, u.n));
  int moved = 0;
  for (size_t i = 0; i < t.n; i++) moved += t.w[i] != 0;
  g_assert_cmpint(moved, >, 0);
}

/* No print more than the limit needs. */
static void test_limit(void) {
  g_autoptr(opc_module) m = make("{ limit: 2 % }");
  model t = made_up(MOST);
  run(m, &t);
  g_assert_cmpfloat(worst(t.ion, t.n), <=, 2);
  g_autoptr(opc_module) all = make("{ limit: 0 % }");
  model u = made_up(MOST);
  run(all, &u);
  g_assert_cmpint(t.prints, <, u.prints);
}

/* Line ends that come with the first move, and end a tenth of the current, are
   reckoned with. */
static void test_line_ends(void) {
  g_autoptr(opc_module) m = make("{}");
  model t = made_up(MOST);
  t.grow = 25;
  for (size_t i = 0; i < t.n; i++) t.thin[i] = 0.05 + 0.1 * (double)i / MOST;
  model u = t;
  t.knows_ends = 1;
  run(m, &t);
  g_assert_cmpfloat(t.second, <, 1.5);
  g_assert_cmpfloat(worst(t.ion, t.n), <=, 0.5);
  run(m, &u); /* a loop that does not tell: too large by all of it */
  g_assert_cmpfloat(u.second, >, 10);
  g_assert_cmpfloat(worst(u.ion, u.n), <=, 0.5);
  g_assert_cmpint(t.prints, <, u.prints);
}

/* Without a jog, a step of L is 2.6 nm, 5.7 % of Ion: half of it is left. */
static void test_quantum(void) {
  g_autoptr(opc_module) m = make("{ fine: none }");
  model t = made_up(MOST);
  run(m, &t);
  g_assert_cmpfloat(worst(t.ion, t.n), >, 1);
  g_assert_cmpfloat(worst(t.ion, t.n), <, 3.2);
  g_autoptr(opc_module) width = make("{ fine: width, limit: 0 % }");
  t = made_up(MOST);
  run(width, &t);
  /* Half of 1.05 / 400; a fifth less would not be worth a move. */
  g_assert_cmpfloat(worst(t.ion, t.n), <, 0.131 / 0.8 + 0.01);
  for (size_t i = 0; i < t.n; i++) g_assert_cmpint(t.jog[i], ==, 0);
}

static void test_area(void) {
  g_autoptr(opc_module) m = make("{ weight: { area: 1 }, limit: 0 % }");
  model t = made_up(MOST);
  run(m, &t);
  /* W's rounding is shared by both. */
  g_assert_cmpfloat(worst(t.ion, t.n), <=, 0.23);
  g_assert_cmpfloat(worst(t.area, t.n), <=, 0.23);
}

static void test_ioff(void) {
  g_autoptr(opc_module) m = make("{ weight: { ioff: 0.01 }, limit: 0 % }");
  model t = made_up(MOST);
  run(m, &t);
  g_assert_cmpfloat(worst(t.ion, t.n), <=, 0.2);
  g_assert_cmpfloat(worst(t.ioff, t.n), <=, 2);
}

/* Leakage that L alone cannot take away, as a ripple makes it: L and W get both
   currents to where they were drawn. With Ion alone it stays. */
static void test_balanced(void) {
  g_autoptr(opc_module) both = make_any("{ target: balanced }");
  g_autoptr(opc_module) plain = make("{}");
  model t = made_up(MOST), u = made_up(MOST);
  t.leaky = u.leaky = 0.3;
  run(both, &t);
  run(plain, &u);
  g_assert_cmpfloat(worst(t.ion, t.n), <=, 0.2);
  g_assert_cmpfloat(worst(t.ioff, t.n), <=, 5);
  g_assert_cmpfloat(worst(u.ioff, u.n), >, 30);
  g_assert_cmpint(t.prints, <=, 12);
}

/* Neighbours couple, and each answers to L in a way of its own, so that Ion
   often gets worse by the step that W takes for Ioff. W goes on for all that.
 */
static void test_width_goes_on(void) {
  static const double leaky[] = {1.2, 1.6}, spread[] = {0, 0.6};
  g_autoptr(opc_module) both = make_any("{ target: balanced }");
  for (int k = 0; k < 4; k++) {
    model t = made_up(MOST);
    t.leaky = leaky[k & 1];
    t.spread = spread[k >> 1];
    t.coupling = 0.25;
    run(both, &t);
    g_assert_cmpfloat(worst(t.ion, t.n), <=, 0.5);
    g_assert_cmpfloat(worst(t.ioff, t.n), <=, 12);
    g_assert_cmpint(t.prints, <=, 11);
  }
}

/* W for Ioff makes the active meet its neighbours: it steps back to where there
   is room, and L gives Ion there. */
static void test_room(void) {
  g_autoptr(opc_module) m = make_any("{}");
  model t = made_up(40);
  for (size_t i = 0; i < t.n; i++) t.off_w[i] -= 15;
  t.room = 5;
  run(m, &t);
  g_assert_cmpfloat(worst(t.ion, t.n), <=, 0.5);
  for (size_t i = 0; i < t.n; i++) {
    g_assert_cmpuint(t.flags[i], ==, 0);
    g_assert_cmpint(t.w[i], >=, t.room);
  }
}

static void test_weights_of_plain(void) {
  opc_error error;
  g_assert_null(opc_test_module(
      "synthesizer.newton", "{ target: full, weight: { area: 1 } }", &error));
  g_assert_nonnull(strstr(error.message, "weights are for 'target: plain'"));
}

/* A jog keeps its distance from both ends of the gate. */
static void test_jog(void) {
  g_autoptr(opc_module) m = make("{ min_jog: 150 nm, limit: 0 % }");
  model t = made_up(MOST);
  run(m, &t);
  int some = 0;
  for (size_t i = 0; i < t.n; i++) {
    some += t.jog[i] > 0;
    g_assert_true(t.jog[i] == 0 ||
                  (t.jog[i] >= 150 && t.jog[i] <= WIDTH + 120 - 150));
  }
  g_assert_cmpint(some, >, MOST / 2);
}

/* A length that the regulator forbids is left to W. */
static void test_veto(void) {
  g_autoptr(opc_module) m = make("{ limit: 0 % }");
  const eda_synthesizer *s = m->functions;
  model t = {.n = 2, .gain_l = 2.6, .gain_w = 1.05, .off_l = {-4, -4}};
  t.veto[0] = EDA_VETO_LONGER;
  run(m, &t);
  g_assert_cmpint(t.l[0], ==, 0);
  g_assert_cmpint(t.w[0], <, -20);
  g_assert_cmpfloat(fabs(t.ion[0]), <, 0.15);
  g_assert_cmpint(t.l[1], >, 0);
  g_assert_cmpint(t.w[1], ==, 0);
  t.veto[0] = t.veto[1] = 15;
  memset(t.l, 0, sizeof t.l);
  memset(t.w, 0, sizeof t.w);
  memset(t.jog, 0, sizeof t.jog);
  run(m, &t);
  g_assert_cmpstr(s->verdict(m->self, 0), ==, "bridging");
}

static opc_module *with_bytes(const char *text, gssize size, char **path) {
  g_autofree char *yaml = NULL;
  g_file_set_contents(*path, text, size, NULL);
  yaml = g_strdup_printf("{ limit: 0 %%, wishes: %s }", *path);
  return make(yaml);
}

static opc_module *with_wishes(const char *text, char **path) {
  return with_bytes(text, -1, path);
}

/* What `begin` says of a bad table. */
static void refused_wishes(opc_module *bad, const char *message) {
  char *cell[] = {"cell"}, *none[] = {""};
  uint32_t number[] = {1};
  eda_gates gates = {
      .grid = 1, .count = 1, .cell = cell, .instance = none, .number = number};
  eda_feedback f = {.gates = &gates};
  const eda_synthesizer *s = bad->functions;
  opc_error error;
  g_assert_cmpint(s->begin(bad->self, &f, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "wishes");
  g_assert_nonnull(strstr(error.message, message));
}

/* One wants 2 % more, one any error below 5 %, one nothing. */
static void test_wishes(void) {
  g_autofree char *path =
      g_build_filename(g_get_tmp_dir(), "newton-wishes.csv", NULL);
  g_autoptr(opc_module) m = with_wishes(
      "# slack\ntransistor, ion, "
      "weight\ncell:1,1.02\ncell:2,,0.01\ncell:3,,0\n",
      &path);
  model t = {.n = 4, .gain_l = 2.6, .gain_w = 1.05, .off_l = {3, 2, 7, -4}};
  run(m, &t);
  g_assert_cmpfloat_with_epsilon(t.ion[0], 2, 0.06);
  g_assert_cmpint(t.l[1], ==, 0);
  g_assert_cmpint(t.jog[1], ==, 0);
  g_assert_cmpint(t.l[2], ==, 0);
  const eda_synthesizer *s = m->functions;
  g_assert_true(isnan(s->target(m->self, 2)));
  g_assert_cmpfloat(fabs(t.ion[3]), <, 0.05);

  static const struct {
    const char *text, *message;
  } wrong[] = {
      {"weight\n1\n", ":1:1: there is no column 'transistor'"},
      {"transistor,slack\n", ":1:12: unknown column 'slack'"},
      {"ion,transistor,ion\n", ":1:16: a column twice: 'ion'"},
      {"transistor,weight\ncell:1,1\ncell:9,1\n",
       ":3:1: there is no transistor 'cell:9'"},
      {"transistor,weight\ncell:1,1,2\n", ":2:10: a field too many: '2'"},
      {"transistor,weight\ncell:1,-1\n", ":2:8: no weight: '-1'"},
      {"transistor,ion\ncell:1,2 %\n",
       ":2:8: no multiple of a current from 0.1 to 10: '2 %'"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(wrong); i++) {
    g_autoptr(opc_module) bad = with_wishes(wrong[i].text, &path);
    refused_wishes(bad, wrong[i].message);
  }
  static const char cut[] = "transistor,weight\ncell:1,1\0\ncell:1,2\n";
  g_autoptr(opc_module) with_nul = with_bytes(cut, sizeof cut - 1, &path);
  refused_wishes(with_nul, "is no text: byte 26 is 0");
  gssize size = (64 << 20) + 1;
  g_autofree char *blanks = g_strnfill((gsize)size, '\n');
  g_autoptr(opc_module) large = with_bytes(blanks, size, &path);
  refused_wishes(large, "67108865 bytes, more than 64 MB");
  g_remove(path);
}

/* A length that is 4 nm more: less Ion, Ioff and area by the model's own law,
   and W as drawn. A wish for one of them leaves the others at what is drawn. */
static void test_longer(void) {
  g_autoptr(opc_module) m = make_any("{ target: balanced }");
  model t = {.n = 4, .gain_l = 2.6, .gain_w = 1.05, .off_l = {3, 2, 7, -4}};
  const double by = 4;
  const eda_wish longer = {
      1, {exp(-0.022 * by), exp(-0.3 * by), 1 + by / length}, 1};
  eda_wish all[] = {longer, longer, eda_wish_none, {1, {1, 0.8, 1}, 1}};
  wishes = all;
  run(m, &t);
  wishes = NULL;
  for (int i = 0; i < 2; i++) {
    g_assert_cmpfloat_with_epsilon(t.ion[i], 100 * expm1(-0.022 * by), 0.1);
    g_assert_cmpfloat_with_epsilon(log1p(t.ioff[i] / 100), -0.3 * by, 0.15);
    g_assert_cmpfloat_with_epsilon(t.area[i], 100 * by / length, 1);
  }
  g_assert_cmpfloat(fabs(t.ioff[2]), <, 15);
  g_assert_cmpfloat(fabs(t.ion[3]), <, 0.1);
  g_assert_cmpfloat_with_epsilon(t.ioff[3], -20, 5);
}

/* Values of the table replace those of the gates; what the table leaves out
   stays. */
static void test_wishes_of_gates(void) {
  static eda_wish all[] = {{1, {1.02, 1, 1}, 1},
                           {0, {1, 1, 1}, 1},
                           {1, {1, 1, 1}, 0},
                           {0, {1.05, 1, 1}, 1}};
  g_autofree char *path =
      g_build_filename(g_get_tmp_dir(), "newton-gates.csv", NULL);
  g_autoptr(opc_module) m =
      with_wishes("transistor,ion,weight\ncell:2,,1\ncell:4,,1\n", &path);
  model t = {.n = 4, .gain_l = 2.6, .gain_w = 1.05, .off_l = {3, 2, 7, -4}};
  wishes = all;
  run(m, &t);
  wishes = NULL;
  const eda_synthesizer *f = m->functions;
  g_assert_cmpfloat(f->target(m->self, 0), ==, 1.02);
  g_assert_cmpfloat(f->target(m->self, 2), ==, 1);
  g_assert_cmpfloat_with_epsilon(t.ion[0], 2, 0.06);
  g_assert_cmpfloat(fabs(t.ion[1]), <, 0.06);
  g_assert_cmpfloat(fabs(t.ion[2]), <, 0.06);
  g_assert_cmpfloat_with_epsilon(t.ion[3], 5, 0.06);
  g_remove(path);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/newton/ion", test_ion);
  g_test_add_func("/newton/near-resolution", test_near_resolution);
  g_test_add_func("/newton/lost-as-drawn", test_lost_as_drawn);
  g_test_add_func("/newton/open-by-its-end", test_open_by_its_end);
  g_test_add_func("/newton/out-of-reach", test_out_of_reach);
  g_test_add_func("/newton/limit", test_limit);
  g_test_add_func("/newton/longer", test_longer);
  g_test_add_func("/newton/late", test_late);
  g_test_add_func("/newton/coarse", test_coarse);
  g_test_add_func("/newton/line-ends", test_line_ends);
  g_test_add_func("/newton/quantum", test_quantum);
  g_test_add_func("/newton/area", test_area);
  g_test_add_func("/newton/ioff", test_ioff);
  g_test_add_func("/newton/balanced", test_balanced);
  g_test_add_func("/newton/width_goes_on", test_width_goes_on);
  g_test_add_func("/newton/room", test_room);
  g_test_add_func("/newton/weights-of-plain", test_weights_of_plain);
  g_test_add_func("/newton/jog", test_jog);
  g_test_add_func("/newton/veto", test_veto);
  g_test_add_func("/newton/wishes", test_wishes);
  g_test_add_func("/newton/wishes-of-gates", test_wishes_of_gates);
  return g_test_run();
}
