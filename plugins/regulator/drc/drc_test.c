/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests rulings on synthetic measurements: two vertical gates whose line ends
   face each other, on a 1 nm grid. */
#include "boxes_test.h"

/* Lower line x 0..65, y 0..400; upper one y 400 + gap .. 900 + gap. The gates
   are at y 100..300 and at gap + 500..700. */
typedef struct fixture {
  eda_point points[8], moved[8];
  uint32_t start[3];
  eda_fragment fragments[8];
  eda_box box[2];
  uint8_t axis[2];
  double space[4], extension[4];
  uint32_t flags[2], vetoes[2];
  int32_t l[2], w[2], end[4];
  eda_boxes added[LAYERS], cutouts[LAYERS];
  eda_shapes drawn[LAYERS], mask[LAYERS];
  eda_edges edges[LAYERS];
  eda_gates gates;
} fixture;

static void fixture_init(fixture *f, int32_t gap) {
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

/* Return measurements of a mask with the line ends of the last ruling. */
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

static size_t fixture_rule(opc_module *m, fixture *f) {
  const eda_regulator *r = m->functions;
  eda_printed p = print_of(f);
  memset(f->vetoes, 0, sizeof f->vetoes);
  eda_ruling ruling = {.vetoes = f->vetoes,
                       .end = f->end,
                       .added = f->added,
                       .cutouts = f->cutouts};
  opc_error error;
  g_assert_cmpint(r->rule(m->self, &p, &ruling, &error), ==, OPC_OK);
  return ruling.transistors;
}

/* A line end whose printed end moves by 0.6 nm per nm reaches the limit after
   at most three iterations, with little excess, and then does not move. */
static void test_extension(void) {
  static const double at_first[] = {13, 19.9, -30};
  for (size_t k = 0; k < G_N_ELEMENTS(at_first); k++) {
    g_autoptr(opc_module) m =
        drc_make("{ min_extension: 20 nm, max_growth: 90 nm }");
    fixture f;
    int prints = 0;
    fixture_init(&f, 1000);
    for (;; prints++) {
      int32_t before = f.end[1];
      f.extension[1] = at_first[k] + 0.6 * f.end[1];
      g_assert_cmpuint(fixture_rule(m, &f), ==, 2);
      if (f.end[1] == before) break;
    }
    g_assert_cmpint(prints, <=, 3);
    g_assert_cmpfloat(f.extension[1], >=, 20);
    g_assert_cmpfloat(f.extension[1], <, 22);
    g_assert_cmpint(f.end[0], ==, 0);
  }
}

/* The default of min_extension is twice the overlay; a line end whose printed
   end does not move stops at max_growth. */
static void test_default_extension(void) {
  g_autoptr(opc_module) m = drc_make("{ overlay: 6 nm, max_growth: 25 nm }");
  fixture f;
  fixture_init(&f, 1000);
  f.extension[1] = 12;
  fixture_rule(m, &f);
  g_assert_cmpint(f.end[1], ==, 0);
  f.extension[1] = 11.9;
  for (int i = 0; i < 30; i++) fixture_rule(m, &f);
  g_assert_cmpint(f.end[1], ==, 25);
}

/* Different gates at the same address are recognized, also before the first
   iteration with the other gates. */
static void test_others(void) {
  g_autoptr(opc_module) m = drc_make("{ min_space: 60 nm }");
  fixture f;
  for (uint64_t serial = 1; serial <= 2; serial++) {
    fixture_init(&f, serial == 1 ? 1000 : 90);
    f.gates.serial = serial;
    f.extension[1] = f.extension[2] = 0;
    for (int i = 0; i < 10; i++) fixture_rule(m, &f);
  }
  g_assert_cmpint(f.end[1], ==, 15);
  g_assert_cmpint(f.end[2], ==, 15);
}

/* Two line ends 90 nm apart share the 30 nm that a space of 60 leaves. */
static void test_facing(void) {
  g_autoptr(opc_module) m = drc_make("{ min_space: 60 nm }");
  fixture f;
  fixture_init(&f, 90);
  f.extension[1] = f.extension[2] = 0;
  for (int i = 0; i < 10; i++) fixture_rule(m, &f);
  g_assert_cmpint(f.end[1], ==, 15);
  g_assert_cmpint(f.end[2], ==, 15);
}

/* If only one line end is too short, it may use the share of the other line
   end. Each displacement uses one third of the remaining space, so the last 2
   nm may remain. */
static void test_alone(void) {
  g_autoptr(opc_module) m = drc_make("{ min_space: 60 nm }");
  fixture f;
  fixture_init(&f, 90);
  f.extension[1] = 0;
  f.extension[2] = 100;
  for (int i = 0; i < 10; i++) fixture_rule(m, &f);
  g_assert_cmpint(f.end[1], >=, 28);
  g_assert_cmpint(f.end[1], <=, 30);
  g_assert_cmpint(f.end[2], ==, 0);
}

/* Whatever the order and size of displacements, the line ends keep min_space.
   If both line ends are too short, they use almost the entire spacing. */
static void test_turns(void) {
  guint32 seed = 1;
  for (int run = 0; run < 200; run++) {
    g_autoptr(opc_module) m = drc_make("{ min_space: 60 nm }");
    fixture f;
    int32_t gap = 60 + run;
    fixture_init(&f, gap);
    for (int i = 0; i < 30; i++) {
      for (int end = 1; end <= 2; end++) {
        seed = seed * 1664525u + 1013904223u;
        f.extension[end] = i > 20 ? 0 : (double)(seed >> 24) / 8;
      }
      fixture_rule(m, &f);
      g_assert_cmpint(gap - f.end[1] - f.end[2], >=, 60);
    }
    g_assert_cmpint(f.end[1] + f.end[2], >=, MIN(gap - 60, 120) - 5);
  }
}

static void test_vetoes(void) {
  g_autoptr(opc_module) m = drc_make("{ min_space: 60 nm }");
  fixture f;
  fixture_init(&f, 1000);
  g_assert_cmpuint(fixture_rule(m, &f), ==, 2);
  g_assert_cmpuint(f.vetoes[0] | f.vetoes[1], ==, 0);
  f.flags[0] = EDA_PRINT_MERGED;
  f.flags[1] = EDA_PRINT_OPEN;
  g_assert_cmpuint(fixture_rule(m, &f), ==, 0);
  g_assert_cmpuint(f.vetoes[0], ==, EDA_VETO_LONGER);
  g_assert_cmpuint(f.vetoes[1], ==, EDA_VETO_SHORTER | EDA_VETO_NARROWER);
  /* The drawn space is 100 nm: at l = 39, a further step leaves 60 nm, at l =
     40 less. */
  f.flags[0] = f.flags[1] = 0;
  f.space[0] = 100;
  f.l[0] = 39;
  fixture_rule(m, &f);
  g_assert_cmpuint(f.vetoes[0], ==, 0);
  f.l[0] = 40;
  fixture_rule(m, &f);
  g_assert_cmpuint(f.vetoes[0], ==, EDA_VETO_LONGER);
}

static void test_violations(void) {
  g_autoptr(opc_module) m = drc_make("{ min_extension: 20 nm }");
  fixture f;
  fixture_init(&f, 50);
  f.extension[1] = 12.5;
  f.extension[2] = 19;
  f.flags[1] = EDA_PRINT_MERGED | EDA_PRINT_OPEN;
  eda_printed p = print_of(&f);
  eda_violation v[3];
  g_assert_cmpuint(drc_violations(m, &p, v, 2), ==,
                   4); /* more violations than the capacity */
  g_assert_cmpstr(v[0].rule, ==, "extension: could still move");
  g_assert_cmpint(v[0].gate, ==, 0);
  g_assert_cmpfloat(v[0].value, ==, 12.5);
  g_assert_cmpfloat(v[0].limit, ==, 20);
  g_assert_cmpfloat(v[0].x, ==, 32.5);
  g_assert_cmpfloat(v[0].y, ==, 300);
  g_assert_cmpstr(v[1].rule, ==, "bridging");
  g_assert_cmpint(v[1].gate, ==, 1);
  for (int i = 0; i < 5; i++)
    fixture_rule(m, &f); /* the line end has 5 nm of
                            spacing */
  drc_violations(m, &p, v, 3);
  g_assert_cmpint(f.end[1], ==, 5);
  g_assert_cmpstr(v[0].rule, ==, "extension; no space before the line end");
}

/* Line ends that moved until their printed ends merged move back. Later they
   are extended again by half a step, once. */
static void test_back(void) {
  g_autoptr(opc_module) m =
      drc_make("{ min_space: 20 nm, min_extension: 30 nm }");
  fixture f;
  boxes printed = {0}, none = {0};
  eda_field print[LAYERS] = {{{0}, 0, 0, NULL}};
  eda_shapes mask[LAYERS] = {{0}};
  const eda_regulator *r = m->functions;
  opc_error error;
  fixture_init(&f, 150);
  for (int i = 0; i < 4; i++) {
    f.extension[1] = 5;
    fixture_rule(m, &f);
  }
  g_assert_cmpint(f.end[1], ==, 60);
  add_box(&printed, 0, 0, 65, 1000);
  print[EDA_POLY] = field_of(&printed);
  print[EDA_ACTIVE] = field_of(&none);
  eda_printed p = print_of(&f);
  p.print = print;
  p.shapes = mask;
  eda_ruling ruling = {
      .vetoes = f.vetoes, .end = f.end, .added = f.added, .cutouts = f.cutouts};
  for (int i = 1; i < 4; i++) {
    int32_t before = f.end[1];
    g_assert_cmpint(r->rule(m->self, &p, &ruling, &error), ==, OPC_OK);
    g_assert_cmpint(f.end[1], <, before);
    g_assert_cmpint(f.end[1], >=, 60 - 5 * i);
  }
  g_assert_cmpuint(f.vetoes[0], ==, 0); /* the length of the gate is not the
                                           cause, so there is no veto */
  int32_t back = f.end[1];
  for (int i = 0; i < 4; i++) {
    fixture_rule(m, &f);
    g_assert_cmpint(f.end[1], ==, back + 2);
  }
  /* A line end that merges wherever it is beyond the drawn one stays there. */
  p.extension = f.extension;
  for (int i = 0; i < 40; i++) {
    p.print = f.end[1] > 0 ? print : NULL;
    g_assert_cmpint(r->rule(m->self, &p, &ruling, &error), ==, OPC_OK);
    if (i > 30) g_assert_cmpint(f.end[1], ==, 0);
  }
  for (int layer = 0; layer < LAYERS; layer++) eda_field_clear(&print[layer]);
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
  g_test_add_func("/regulator/back", test_back);
  return g_test_run();
}
