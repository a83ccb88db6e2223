/* SPDX-License-Identifier: BSD-3-Clause */
/* Rulings on hand-made measurements (two vertical gates whose line ends face
   each other, on a 1 nm grid) and on hand-made prints; rules of masks against
   KLayout. */
#include <eda/eda.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/plugin/host.h"
#include "tools/devel/testing.h"

/* Contacts are not corrected. */
enum { CONTACT = 2, METAL = 3, LAYERS = 4 };
static char *names[] = {"poly", "active", "contact", "metal1"};
static uint8_t corrected[] = {1, 1, 0, 1};

/* Lower line x 0..65, y 0..400; upper one y 400 + gap .. 900 + gap. The gates
   are at y 100..300 and, above, at gap + 500..700. */
typedef struct fixture {
  eda_point points[8], moved[8];
  uint32_t start[3];
  eda_fragment fragments[8];
  eda_box box[2];
  uint8_t axis[2];
  double space[4], extension[4];
  uint32_t flags[2], vetoes[2];
  int32_t l[2], w[2], end[4];
  eda_boxes patches[LAYERS], bites[LAYERS];
  eda_shapes drawn[LAYERS], mask[LAYERS];
  eda_edges edges[LAYERS];
  eda_gates gates;
} fixture;

static void setup(fixture *f, int32_t gap) {
  memset(f, 0, sizeof *f);
  int32_t low[2] = {0, 400 + gap}, high[2] = {400, 900 + gap};
  for (int i = 0; i < 2; i++) {
    eda_point p[4] = {{0, low[i]}, {65, low[i]}, {65, high[i]}, {0, high[i]}};
    uint8_t role[4] = {i ? EDA_END_LOW : EDA_FIXED, EDA_L_HIGH,
                       i ? EDA_FIXED : EDA_END_HIGH, EDA_L_LOW};
    for (int k = 0; k < 4; k++) {
      f->points[4 * i + k] = p[k];
      f->fragments[4 * i + k] = (eda_fragment){
          .from = p[k], .gate = role[k] ? i : -1, .role = role[k]};
    }
    f->start[i + 1] = 4 * (uint32_t)(i + 1);
    f->space[2 * i] = f->space[2 * i + 1] = 500;
    f->extension[2 * i] = f->extension[2 * i + 1] = INFINITY;
  }
  f->box[0] = (eda_box){0, 100, 65, 300};
  f->box[1] = (eda_box){0, 500 + gap, 65, 700 + gap};
  f->gates = (eda_gates){.grid = 1,
                         .extent = {-200, 0, 265, 900 + gap},
                         .layers = LAYERS,
                         .layer = names,
                         .corrected = corrected,
                         .drawn = f->drawn,
                         .edges = f->edges,
                         .count = 2,
                         .box = f->box,
                         .axis = f->axis,
                         .space = f->space};
  f->drawn[EDA_POLY] = (eda_shapes){2, f->start, f->points, NULL};
  f->edges[EDA_POLY] = (eda_edges){2, f->start, f->fragments};
}

/* The mask has the line ends where the last ruling sent them. */
static eda_printed print_of(fixture *f) {
  memcpy(f->moved, f->points, sizeof f->moved);
  f->moved[2].y = f->moved[3].y += f->end[1];
  f->moved[4].y = f->moved[5].y -= f->end[2];
  f->mask[EDA_POLY] = (eda_shapes){2, f->start, f->moved, NULL};
  return (eda_printed){.gates = &f->gates,
                       .shapes = f->mask,
                       .flags = f->flags,
                       .l = f->l,
                       .w = f->w,
                       .extension = f->extension};
}

static size_t rule(opc_module *m, fixture *f) {
  const eda_regulator *r = m->functions;
  eda_printed p = print_of(f);
  memset(f->vetoes, 0, sizeof f->vetoes);
  eda_ruling ruling = {.vetoes = f->vetoes,
                       .end = f->end,
                       .patches = f->patches,
                       .bites = f->bites};
  opc_error error;
  g_assert_cmpint(r->rule(m->self, &p, &ruling, &error), ==, OPC_OK);
  return ruling.transistors;
}

static opc_module *make(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("regulator.drc", parameters, &error);
  g_assert_nonnull(m);
  return m;
}

/* A line end whose print follows the mask by 0.6 nm for each nm, is long enough
   after at most three prints, hardly too long, and then stays. */
static void test_extension(void) {
  static const double at_first[] = {13, 19.9, -30};
  for (size_t k = 0; k < G_N_ELEMENTS(at_first); k++) {
    g_autoptr(opc_module) m =
        make("{ min_extension: 20 nm, max_growth: 90 nm }");
    fixture f;
    int prints = 0;
    setup(&f, 1000);
    for (;; prints++) {
      int32_t before = f.end[1];
      f.extension[1] = at_first[k] + 0.6 * f.end[1];
      g_assert_cmpuint(rule(m, &f), ==, 2);
      if (f.end[1] == before) break;
    }
    g_assert_cmpint(prints, <=, 3);
    g_assert_cmpfloat(f.extension[1], >=, 20);
    g_assert_cmpfloat(f.extension[1], <, 22);
    g_assert_cmpint(f.end[0], ==, 0);
  }
}

/* Without min_extension twice the overlay is wanted; what never answers ends
   at max_growth. */
static void test_default_extension(void) {
  g_autoptr(opc_module) m = make("{ overlay: 6 nm, max_growth: 25 nm }");
  fixture f;
  setup(&f, 1000);
  f.extension[1] = 12;
  rule(m, &f);
  g_assert_cmpint(f.end[1], ==, 0);
  f.extension[1] = 11.9;
  for (int i = 0; i < 30; i++) rule(m, &f);
  g_assert_cmpint(f.end[1], ==, 25);
}

/* Other gates in the same place in memory are others, also before their first
   iteration. */
static void test_others(void) {
  g_autoptr(opc_module) m = make("{ min_space: 60 nm }");
  fixture f;
  for (uint64_t serial = 1; serial <= 2; serial++) {
    setup(&f, serial == 1 ? 1000 : 90);
    f.gates.serial = serial;
    f.extension[1] = f.extension[2] = 0;
    for (int i = 0; i < 10; i++) rule(m, &f);
  }
  g_assert_cmpint(f.end[1], ==, 15);
  g_assert_cmpint(f.end[2], ==, 15);
}

/* Two line ends 90 nm apart share the 30 nm that a space of 60 leaves. */
static void test_facing(void) {
  g_autoptr(opc_module) m = make("{ min_space: 60 nm }");
  fixture f;
  setup(&f, 90);
  f.extension[1] = f.extension[2] = 0;
  for (int i = 0; i < 10; i++) rule(m, &f);
  g_assert_cmpint(f.end[1], ==, 15);
  g_assert_cmpint(f.end[2], ==, 15);
}

/* If only one of them is too short, it gets what the other does not need, but
   for what a third of it rounds to. */
static void test_alone(void) {
  g_autoptr(opc_module) m = make("{ min_space: 60 nm }");
  fixture f;
  setup(&f, 90);
  f.extension[1] = 0;
  f.extension[2] = 100;
  for (int i = 0; i < 10; i++) rule(m, &f);
  g_assert_cmpint(f.end[1], >=, 28);
  g_assert_cmpint(f.end[1], <=, 30);
  g_assert_cmpint(f.end[2], ==, 0);
}

/* Whoever needs how much and when, the space between them is kept, and nearly
   all of it is used if both need all. */
static void test_turns(void) {
  guint32 seed = 1;
  for (int run = 0; run < 200; run++) {
    g_autoptr(opc_module) m = make("{ min_space: 60 nm }");
    fixture f;
    int32_t gap = 60 + run;
    setup(&f, gap);
    for (int i = 0; i < 30; i++) {
      for (int end = 1; end <= 2; end++) {
        seed = seed * 1664525u + 1013904223u;
        f.extension[end] = i > 20 ? 0 : (double)(seed >> 24) / 8;
      }
      rule(m, &f);
      g_assert_cmpint(gap - f.end[1] - f.end[2], >=, 60);
    }
    g_assert_cmpint(f.end[1] + f.end[2], >=, MIN(gap - 60, 120) - 5);
  }
}

static void test_vetoes(void) {
  g_autoptr(opc_module) m = make("{ min_space: 60 nm }");
  fixture f;
  setup(&f, 1000);
  g_assert_cmpuint(rule(m, &f), ==, 2);
  g_assert_cmpuint(f.vetoes[0] | f.vetoes[1], ==, 0);
  f.flags[0] = EDA_PRINT_MERGED;
  f.flags[1] = EDA_PRINT_OPEN;
  g_assert_cmpuint(rule(m, &f), ==, 0);
  g_assert_cmpuint(f.vetoes[0], ==, EDA_VETO_LONGER);
  g_assert_cmpuint(f.vetoes[1], ==, EDA_VETO_SHORTER | EDA_VETO_NARROWER);
  /* 100 nm of room: with l = 39 the next step leaves 60, with 40 it does
     not. */
  f.flags[0] = f.flags[1] = 0;
  f.space[0] = 100;
  f.l[0] = 39;
  rule(m, &f);
  g_assert_cmpuint(f.vetoes[0], ==, 0);
  f.l[0] = 40;
  rule(m, &f);
  g_assert_cmpuint(f.vetoes[0], ==, EDA_VETO_LONGER);
}

static size_t violations(opc_module *m, const eda_printed *p, eda_violation *v,
                         size_t room) {
  const eda_regulator *r = m->functions;
  opc_error error;
  size_t count = 0;
  g_assert_cmpint(r->violations(m->self, p, v, room, &count, &error), ==,
                  OPC_OK);
  return count;
}

static void test_violations(void) {
  g_autoptr(opc_module) m = make("{ min_extension: 20 nm }");
  fixture f;
  setup(&f, 50);
  f.extension[1] = 12.5;
  f.extension[2] = 19;
  f.flags[1] = EDA_PRINT_MERGED | EDA_PRINT_OPEN;
  eda_printed p = print_of(&f);
  eda_violation v[3];
  g_assert_cmpuint(violations(m, &p, v, 2), ==, 4); /* more than room */
  g_assert_cmpstr(v[0].rule, ==, "extension: could still move");
  g_assert_cmpint(v[0].gate, ==, 0);
  g_assert_cmpfloat(v[0].value, ==, 12.5);
  g_assert_cmpfloat(v[0].limit, ==, 20);
  g_assert_cmpfloat(v[0].x, ==, 32.5);
  g_assert_cmpfloat(v[0].y, ==, 300);
  g_assert_cmpstr(v[1].rule, ==, "bridging");
  g_assert_cmpint(v[1].gate, ==, 1);
  for (int i = 0; i < 5; i++) rule(m, &f); /* 5 nm of room */
  violations(m, &p, v, 3);
  g_assert_cmpint(f.end[1], ==, 5);
  g_assert_cmpstr(v[0].rule, ==, "extension; no room before the line end");
}

/* ---- prints ---- */

/* Up to 16 boxes of a layer, as shapes and as what prints. */
typedef struct boxes {
  eda_point points[64];
  uint32_t start[17];
  eda_shapes shapes;
} boxes;

static void add_box(boxes *b, int32_t x0, int32_t y0, int32_t x1, int32_t y1) {
  eda_point p[4] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  size_t n = b->shapes.count++;
  memcpy(b->points + 4 * n, p, sizeof p);
  b->start[n + 1] = 4 * (uint32_t)(n + 1);
  b->shapes.start = b->start;
  b->shapes.points = b->points;
}

/* The level set whose contours are the boxes' sides, but for corners. */
static eda_field field_of(const boxes *b) {
  enum { STEP = 8, N = 250 };
  const opc_host *host = opc_test_host();
  eda_field f = {.frame = {-500, -500, STEP * N, STEP * N}, .nx = N, .ny = N};
  f.coefficients = eda_alloc(N * N, sizeof(float));
  for (int j = 0; j < N; j++)
    for (int i = 0; i < N; i++) {
      double x = -500 + STEP * i, y = -500 + STEP * j, best = -60;
      for (size_t k = 0; k < b->shapes.count; k++) {
        eda_point low = b->points[4 * k], high = b->points[4 * k + 2];
        double d =
            fmin(fmin(x - low.x, high.x - x), fmin(y - low.y, high.y - y));
        best = fmax(best, d);
      }
      f.coefficients[j * N + i] = (float)fmin(best, 60);
    }
  eda_field_from_samples(host->context, &f);
  return f;
}

/* A layout without gates, its mask as drawn, and what prints of it. */
typedef struct chip {
  boxes drawn[LAYERS], printed[LAYERS];
  eda_gates gates;
  eda_shapes shapes[LAYERS], mask[LAYERS];
  eda_edges edges[LAYERS];
  eda_field print[LAYERS];
  eda_boxes patches[LAYERS], bites[LAYERS];
  eda_printed p;
  eda_ruling ruling;
  uint32_t veto[1];
} chip;

static void show(chip *c) {
  static double nowhere[1];
  c->gates.grid = 1;
  c->gates.extent = (eda_box){-500, -500, 1500, 1500};
  c->gates.layers = LAYERS;
  c->gates.layer = names;
  c->gates.corrected = corrected;
  c->gates.drawn = c->shapes;
  c->gates.edges = c->edges;
  for (int layer = 0; layer < LAYERS; layer++) {
    c->shapes[layer] = c->drawn[layer].shapes;
    if (!corrected[layer]) continue;
    eda_field_clear(&c->print[layer]);
    c->print[layer] = field_of(&c->printed[layer]);
    c->mask[layer] = c->shapes[layer];
  }
  c->p = (eda_printed){.gates = &c->gates,
                       .shapes = c->mask,
                       .print = c->print,
                       .extension = nowhere};
}

static void judge(opc_module *m, chip *c) {
  const eda_regulator *r = m->functions;
  opc_error error;
  c->ruling =
      (eda_ruling){.vetoes = c->veto, .patches = c->patches, .bites = c->bites};
  g_assert_cmpint(r->rule(m->self, &c->p, &c->ruling, &error), ==, OPC_OK);
}

static void end(chip *c) {
  for (int layer = 0; layer < LAYERS; layer++)
    eda_field_clear(&c->print[layer]);
}

/* A contact in a pad whose right side prints 4 nm beyond it, where 10 are
   needed: a patch moves the whole side, by so much that the print follows. */
static void test_enclosure(void) {
  g_autoptr(opc_module) m = make("{ overlay: 10 nm }");
  chip c = {0};
  eda_violation v;
  add_box(&c.drawn[EDA_POLY], 0, 0, 106, 140);
  add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
  add_box(&c.printed[EDA_POLY], -10, -10, 104, 150);
  show(&c);
  judge(m, &c);
  g_assert_cmpuint(c.ruling.patches[EDA_ACTIVE].count, ==, 0);
  g_assert_cmpuint(c.ruling.patches[EDA_POLY].count, ==, 1);
  eda_box patch = c.ruling.patches[EDA_POLY].box[0];
  g_assert_cmpint(patch.y0, ==, 0);
  g_assert_cmpint(patch.y1, ==, 140);
  g_assert_cmpint(patch.x1, >=, 112);
  g_assert_cmpint(patch.x1, <=, 116);
  g_assert_cmpuint(violations(m, &c.p, &v, 1), ==, 1);
  g_assert_cmpstr(v.rule, ==, "enclosure: could still move");
  g_assert_cmpfloat(fabs(v.value - 4), <, 0.5);
  g_assert_cmpfloat(v.limit, ==, 10);
  g_assert_cmpfloat(v.x, ==, 60);
  c.printed[EDA_POLY].points[1].x = c.printed[EDA_POLY].points[2].x = 111;
  show(&c);
  judge(m, &c);
  g_assert_cmpuint(c.ruling.patches[EDA_POLY].count, ==, 1); /* it stays */
  g_assert_cmpint(c.ruling.patches[EDA_POLY].box[0].x1, ==, patch.x1);
  g_assert_cmpuint(violations(m, &c.p, &v, 1), ==, 0);
  end(&c);
}

/* The same where a neighbour is 46 nm away: 3 nm may be had, and then the sides
   beside it take the corners along. */
static void test_near_neighbour(void) {
  g_autoptr(opc_module) m = make("{ overlay: 10 nm, min_space: 40 nm }");
  chip c = {0};
  eda_violation v;
  add_box(&c.drawn[EDA_ACTIVE], 0, 0, 106, 140);
  add_box(&c.drawn[EDA_ACTIVE], 152, 0, 400, 140);
  add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
  add_box(&c.printed[EDA_ACTIVE], -10, -10, 104, 150);
  show(&c);
  judge(m, &c);
  g_assert_cmpuint(c.ruling.patches[EDA_ACTIVE].count, ==, 1);
  g_assert_cmpint(c.ruling.patches[EDA_ACTIVE].box[0].x1, ==, 109);
  judge(m, &c);
  g_assert_cmpuint(c.ruling.patches[EDA_ACTIVE].count, ==, 3);
  violations(m, &c.p, &v, 1);
  g_assert_cmpstr(v.rule, ==, "enclosure: could still move");
  for (int i = 0; i < 12; i++) judge(m, &c);
  for (size_t i = 0; i < 3; i++)
    g_assert_cmpint(c.ruling.patches[EDA_ACTIVE].box[i].x1, ==, 109);
  g_assert_cmpuint(violations(m, &c.p, &v, 1), ==, 1);
  g_assert_cmpstr(v.rule, ==, "enclosure; too near a neighbour");
  end(&c);
}

/* The patch on the right side of an active whose lower and upper edges are the
   ends of a gate's width ends with them, however far they lie aside; where they
   have met there is none. */
static void test_width(void) {
  static const struct {
    int32_t w, aside, low, high;
  } cases[] = {{0, 0, 0, 140},    {9, 0, -4, 145},   {9, 4, 0, 149},
               {8, -7, -11, 137}, {-139, 0, 70, 71}, {-140, 0, 0, 0},
               {-150, 0, 75, 65}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) m = make("{ overlay: 10 nm }");
    uint32_t start[] = {0, 4};
    eda_fragment active[] = {{{0, 0}, 0, EDA_W_LOW},
                             {{106, 0}, -1, EDA_FIXED},
                             {{106, 140}, 0, EDA_W_HIGH},
                             {{0, 140}, -1, EDA_FIXED}};
    chip c = {.edges[EDA_ACTIVE] = {1, start, active}};
    add_box(&c.drawn[EDA_ACTIVE], 0, 0, 106, 140);
    add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
    add_box(&c.printed[EDA_ACTIVE], -10, -10, 104, 150);
    show(&c);
    c.p.w = &cases[i].w;
    c.p.aside = &cases[i].aside;
    judge(m, &c);
    size_t n = cases[i].low < cases[i].high;
    g_assert_cmpuint(c.ruling.patches[EDA_ACTIVE].count, ==, n);
    eda_box b = n ? c.ruling.patches[EDA_ACTIVE].box[0] : (eda_box){0};
    g_assert_cmpint(b.y0, ==, n ? cases[i].low : 0);
    g_assert_cmpint(b.y1, ==, n ? cases[i].high : 0);
    end(&c);
  }
}

/* A contact in active that poly prints 6 nm away from. */
static void test_contact(void) {
  g_autoptr(opc_module) m = make("{ overlay: 10 nm }");
  chip c = {0};
  eda_violation v;
  add_box(&c.drawn[EDA_ACTIVE], -100, -100, 300, 300);
  add_box(&c.drawn[EDA_POLY], 0, -200, 65, 400);
  add_box(&c.drawn[CONTACT], 110, 60, 190, 140);
  add_box(&c.printed[EDA_ACTIVE], -100, -100, 300, 300);
  add_box(&c.printed[EDA_POLY], 0, -200, 104, 400);
  show(&c);
  judge(m, &c);
  g_assert_cmpuint(violations(m, &c.p, &v, 1), ==, 1);
  g_assert_cmpstr(v.rule, ==, "bridging: contact");
  g_assert_cmpfloat(fabs(v.value - 6), <, 0.5);
  c.printed[EDA_POLY].points[1].x = c.printed[EDA_POLY].points[2].x = 99;
  show(&c);
  judge(m, &c);
  g_assert_cmpuint(violations(m, &c.p, &v, 1), ==, 0);
  end(&c);
}

/* A line of 60 nm that has a neck of 24 nm: patches widen it there, on both
   sides, and nowhere else. */
static void test_neck(void) {
  g_autoptr(opc_module) m = make("{ min_width: 40 nm }");
  chip c = {0};
  eda_violation v[4];
  add_box(&c.drawn[EDA_POLY], 0, 0, 60, 1000);
  add_box(&c.printed[EDA_POLY], 0, 0, 60, 450);
  add_box(&c.printed[EDA_POLY], 18, 400, 42, 600);
  add_box(&c.printed[EDA_POLY], 0, 550, 60, 1000);
  show(&c);
  judge(m, &c);
  size_t n = violations(m, &c.p, v, 4);
  g_assert_cmpuint(n, >=, 1);
  g_assert_cmpuint(n, <=, 2);
  for (size_t i = 0; i < n; i++) {
    g_assert_cmpstr(v[i].rule, ==, "pinching: could still move");
    g_assert_cmpfloat(fabs(v[i].value - 24), <, 1);
    g_assert_cmpfloat(fabs(v[i].y - 500), <=, 60);
    g_assert_cmpfloat(v[i].x, ==, 30);
  }
  g_assert_cmpuint(c.ruling.patches[EDA_POLY].count, ==, 2 * n);
  for (size_t i = 0; i < 2 * n; i++) {
    eda_box b = c.ruling.patches[EDA_POLY].box[i];
    g_assert_cmpint(b.y0, >, 380);
    g_assert_cmpint(b.y1, <, 620);
    g_assert_true((b.x1 >= 69 && b.x1 <= 75) || (b.x0 <= -9 && b.x0 >= -15));
  }
  /* As wide as it must be, but off the middle of what is drawn: good. */
  c.printed[EDA_POLY].points[5].x = c.printed[EDA_POLY].points[6].x = 60;
  show(&c);
  g_assert_cmpuint(violations(m, &c.p, v, 4), ==, 0);
  /* Gone. */
  c.printed[EDA_POLY].shapes.count = 1;
  show(&c);
  g_assert_cmpuint(violations(m, &c.p, v, 4), >=, 4);
  g_assert_cmpfloat(v[3].value, ==, 0);
  end(&c);
}

/* Two lines that print as one over half of their length. */
static void test_gap(void) {
  g_autoptr(opc_module) m = make("{}");
  chip c = {0};
  eda_violation v[10];
  add_box(&c.drawn[EDA_POLY], 0, 0, 60, 600);
  add_box(&c.drawn[EDA_POLY], 180, 0, 240, 600);
  add_box(&c.printed[EDA_POLY], 0, 0, 60, 600);
  add_box(&c.printed[EDA_POLY], 180, 0, 240, 600);
  show(&c);
  g_assert_cmpuint(violations(m, &c.p, v, 10), ==, 0);
  add_box(&c.printed[EDA_POLY], 0, 0, 240, 300);
  show(&c);
  size_t n = violations(m, &c.p, v, 10);
  g_assert_cmpuint(n, ==, 5); /* each 60 nm */
  for (size_t i = 0; i < n; i++) {
    g_assert_cmpstr(v[i].rule, ==, "bridging: poly: could still move");
    g_assert_cmpfloat(v[i].x, ==, 120);
    g_assert_cmpfloat(v[i].y, <, 300);
  }
  end(&c);
}

/* The same of a further layer. A contact that it covers by 4 nm is not its
   rule. */
static void test_metal(void) {
  g_autoptr(opc_module) m = make("{ overlay: 10 nm }");
  chip c = {0};
  eda_violation v[20];
  add_box(&c.drawn[METAL], 0, 0, 106, 600);
  add_box(&c.drawn[METAL], 230, 0, 300, 600);
  add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
  add_box(&c.printed[METAL], -10, 0, 104, 600);
  add_box(&c.printed[METAL], 230, 0, 300, 600);
  add_box(&c.printed[METAL], 50, 300, 260, 500);
  show(&c);
  judge(m, &c);
  g_assert_cmpuint(c.ruling.patches[EDA_POLY].count, ==, 0);
  g_assert_cmpuint(c.ruling.patches[METAL].count, ==, 0);
  size_t n = violations(m, &c.p, v, 20);
  g_assert_cmpuint(n, ==, 3); /* each 60 nm */
  for (size_t i = 0; i < n; i++) {
    g_assert_cmpstr(v[i].rule, ==, "bridging: metal1");
    g_assert_cmpfloat(v[i].x, ==, 168);
    g_assert_cmpfloat(fabs(v[i].y - 400), <, 100);
  }
  end(&c);
}

/* Line ends that were moved so far that their prints met go back, and are not
   sent there again. */
static void test_back(void) {
  g_autoptr(opc_module) m = make("{ min_space: 20 nm, min_extension: 30 nm }");
  fixture f;
  boxes printed = {0}, none = {0};
  eda_field print[LAYERS] = {{{0}, 0, 0, NULL}};
  eda_shapes mask[LAYERS] = {{0}};
  const eda_regulator *r = m->functions;
  opc_error error;
  setup(&f, 150);
  for (int i = 0; i < 4; i++) {
    f.extension[1] = 5;
    rule(m, &f);
  }
  g_assert_cmpint(f.end[1], ==, 60);
  add_box(&printed, 0, 0, 65, 1000);
  print[EDA_POLY] = field_of(&printed);
  print[EDA_ACTIVE] = field_of(&none);
  eda_printed p = print_of(&f);
  p.print = print;
  p.shapes = mask;
  eda_ruling ruling = {
      .vetoes = f.vetoes, .end = f.end, .patches = f.patches, .bites = f.bites};
  for (int i = 1; i < 4; i++) {
    int32_t before = f.end[1];
    g_assert_cmpint(r->rule(m->self, &p, &ruling, &error), ==, OPC_OK);
    g_assert_cmpint(f.end[1], <, before);
    g_assert_cmpint(f.end[1], >=, 60 - 5 * i);
  }
  g_assert_cmpuint(f.vetoes[0], ==, 0); /* not the gate's length is to blame */
  for (int layer = 0; layer < LAYERS; layer++) eda_field_clear(&print[layer]);
}

/* Without a print only gates and line ends are judged. */
static void test_no_print(void) {
  g_autoptr(opc_module) m = make("{}");
  chip c = {0};
  eda_violation v;
  add_box(&c.drawn[EDA_POLY], 0, 0, 106, 140);
  add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
  show(&c);
  c.p.shapes = NULL;
  c.p.print = NULL;
  judge(m, &c);
  g_assert_cmpuint(c.ruling.patches[EDA_POLY].count, ==, 0);
  g_assert_cmpuint(violations(m, &c.p, &v, 1), ==, 0);
  end(&c);
}

/* ---- masks ---- */

static size_t count_rule(const eda_violation *v, size_t n, const char *name,
                         double value) {
  size_t found = 0;
  for (size_t i = 0; i < n; i++)
    found += !strcmp(v[i].rule, name) && fabs(v[i].value - value) < 1e-9;
  return found;
}

/* Widths, spaces and corners by hand; a jog is neither. */
static void test_mask(void) {
  static const struct {
    const char *name;
    size_t n, spaces, widths;
    int32_t xy[20][2];
    double value;
  } cases[] = {
      {"jog",
       8,
       0,
       0,
       {{-2, 0},
        {100, 0},
        {100, 50},
        {103, 50},
        {103, 200},
        {0, 200},
        {0, 100},
        {-2, 100}},
       0},
      {"narrow", 4, 0, 1, {{0, 0}, {39, 0}, {39, 200}, {0, 200}}, 39},
      {"wide enough", 4, 0, 0, {{0, 0}, {40, 0}, {40, 200}, {0, 200}}, 0},
      {"notch",
       8,
       1,
       0,
       {{0, 0},
        {300, 0},
        {300, 100},
        {160, 100},
        {160, 50},
        {130, 50},
        {130, 100},
        {0, 100}},
       30},
      {"neck",
       8,
       0,
       1,
       {{0, 0},
        {100, 0},
        {100, 70},
        {200, 70},
        {200, 200},
        {70, 200},
        {70, 100},
        {0, 100}},
       30 * M_SQRT2},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) m =
        make("{ min_mask_width: 45 nm, min_space: 40 nm }");
    if (cases[i].value < 40)
      opc_test_module_free(g_steal_pointer(&m)),
          m = make("{ min_mask_width: 40 nm, min_space: 40 nm }");
    chip c = {0};
    eda_violation v[10];
    boxes b = {0};
    for (size_t k = 0; k < cases[i].n; k++)
      b.points[k] = (eda_point){cases[i].xy[k][0], cases[i].xy[k][1]};
    b.start[1] = (uint32_t)cases[i].n;
    show(&c);
    c.mask[EDA_POLY] = (eda_shapes){1, b.start, b.points, NULL};
    size_t n = violations(m, &c.p, v, 10);
    g_test_message("%s", cases[i].name);
    g_assert_cmpuint(n, ==, cases[i].spaces + cases[i].widths);
    g_assert_cmpuint(count_rule(v, n, "mask space", cases[i].value), ==,
                     cases[i].spaces);
    g_assert_cmpuint(count_rule(v, n, "mask width", cases[i].value), ==,
                     cases[i].widths);
    end(&c);
  }
}

static const char script[] =
    "import sys, klayout.db as k\n"
    "r = k.Region()\n"
    "for line in sys.stdin:\n"
    "  r.insert(k.Box(*map(int, line.split())))\n"
    "r.merge()\n"
    "p = k.Region.Projection\n"
    "for c in (r.width_check(40, False, p), r.space_check(40, False, p)):\n"
    "  print(*sorted(e.distance() for e in c.each()))\n";

static eda_shapes random_mask(uint32_t seed, GString *text, int n) {
  g_autoptr(GRand) rand = g_rand_new_with_seed(seed);
  opc_error error;
  g_autofree eda_point *points = g_new(eda_point, 4 * n);
  g_autofree uint32_t *start = g_new0(uint32_t, n + 1);
  for (int i = 0; i < n; i++) {
    int32_t x = g_rand_int_range(rand, 0, 6 * n),
            w = g_rand_int_range(rand, 5, 200);
    int32_t y = g_rand_int_range(rand, 0, 6 * n),
            h = g_rand_int_range(rand, 5, 200);
    eda_point p[4] = {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}};
    memcpy(points + 4 * i, p, sizeof p);
    start[i + 1] = 4 * (uint32_t)(i + 1);
    if (text) g_string_append_printf(text, "%d %d %d %d\n", x, y, x + w, y + h);
  }
  eda_shapes in = {(size_t)n, start, points, NULL}, out;
  g_assert_cmpint(eda_boolean(EDA_OR, &in, NULL, &out, &error), ==, OPC_OK);
  return out;
}

static char *ask_klayout(const char *text) {
  g_autofree char *path = g_build_filename(opc_test_folder(), "boxes", NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  g_autofree char *quoted = g_shell_quote(script);
  g_autofree char *command =
      g_strdup_printf("python3 -c %s < '%s'", quoted, path);
  const char *argv[] = {"sh", "-c", command, NULL};
  char *out = NULL;
  int status = -1;
  if (!g_spawn_sync(NULL, (char **)argv, NULL,
                    G_SPAWN_SEARCH_PATH | G_SPAWN_STDERR_TO_DEV_NULL, NULL,
                    NULL, &out, NULL, &status, NULL) ||
      status != 0) {
    g_free(out);
    return NULL;
  }
  return out;
}

/* Random rectangles: as many edges face each other at each distance as KLayout
   says; a few corners do so at whole distances too. */
static void test_klayout(void) {
  static const char *const rules[] = {"mask width", "mask space"};
  enum { ROOM = 100000 };
  g_autofree eda_violation *v = g_new(eda_violation, ROOM);
  for (uint32_t seed = 1; seed < 6; seed++) {
    g_autoptr(opc_module) m =
        make("{ min_mask_width: 40 nm, min_space: 40 nm }");
    g_autoptr(GString) text = g_string_new(NULL);
    chip c = {0};
    show(&c);
    c.mask[EDA_POLY] = random_mask(seed, text, 300);
    g_autofree char *out = ask_klayout(text->str);
    size_t n = violations(m, &c.p, v, ROOM);
    eda_shapes_clear(&c.mask[EDA_POLY]);
    end(&c);
    if (!out) {
      g_test_skip("no klayout module for python3");
      return;
    }
    g_auto(GStrv) lines = g_strsplit(out, "\n", 0);
    for (int k = 0; k < 2; k++) {
      g_auto(GStrv) words = g_strsplit(lines[k], " ", 0);
      guint theirs[40] = {0}, ours[40] = {0};
      for (size_t i = 0; words[i]; i++) theirs[atoi(words[i])]++;
      for (size_t i = 0; i < n; i++)
        if (!strcmp(v[i].rule, rules[k]) && v[i].value == floor(v[i].value))
          ours[(int)v[i].value]++;
      guint all = 0, more = 0;
      for (int d = 1; d < 40; d++) {
        g_assert_cmpuint(theirs[d], <=, ours[d]);
        all += theirs[d];
        more += ours[d] - theirs[d];
      }
      g_test_message("%s: KLayout %u places, and %u corners", rules[k], all,
                     more);
      g_assert_cmpuint(all, >, 30);
      g_assert_cmpuint(more, <, all / 8);
    }
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/extension", test_extension);
  g_test_add_func("/regulator/default_extension", test_default_extension);
  g_test_add_func("/regulator/others", test_others);
  g_test_add_func("/regulator/facing", test_facing);
  g_test_add_func("/regulator/alone", test_alone);
  g_test_add_func("/regulator/turns", test_turns);
  g_test_add_func("/regulator/vetoes", test_vetoes);
  g_test_add_func("/regulator/violations", test_violations);
  g_test_add_func("/regulator/enclosure", test_enclosure);
  g_test_add_func("/regulator/width", test_width);
  g_test_add_func("/regulator/near_neighbour", test_near_neighbour);
  g_test_add_func("/regulator/contact", test_contact);
  g_test_add_func("/regulator/neck", test_neck);
  g_test_add_func("/regulator/gap", test_gap);
  g_test_add_func("/regulator/metal", test_metal);
  g_test_add_func("/regulator/back", test_back);
  g_test_add_func("/regulator/no_print", test_no_print);
  g_test_add_func("/regulator/mask", test_mask);
  g_test_add_func("/regulator/klayout", test_klayout);
  return g_test_run();
}
