/* SPDX-License-Identifier: BSD-3-Clause */
/* Rulings on hand-made prints: two vertical gates whose line ends face each
   other, on a 1 nm grid. */
#include "core/plugin/testing.h"

#include <math.h>
#include <string.h>

/* Lower line x 0..65, y 0..400; upper one y 400 + gap .. 900 + gap. The gates
   are at y 100..300 and, above, at gap + 500..700. */
typedef struct fixture {
  opc_point points[8];
  uint32_t start[3];
  opc_fragment fragments[8];
  opc_box box[2];
  uint8_t axis[2];
  double room[4], extension[4];
  uint32_t flags[2], vetoes[2];
  int32_t l[2], w[2], end[4];
  opc_gates gates;
} fixture;

static void setup(fixture *f, int32_t gap) {
  memset(f, 0, sizeof *f);
  int32_t low[2] = {0, 400 + gap}, high[2] = {400, 900 + gap};
  for (int i = 0; i < 2; i++) {
    opc_point p[4] = {{0, low[i]}, {65, low[i]}, {65, high[i]}, {0, high[i]}};
    uint8_t role[4] = {i ? OPC_END_LOW : OPC_FIXED, OPC_L_HIGH,
                       i ? OPC_FIXED : OPC_END_HIGH, OPC_L_LOW};
    for (int k = 0; k < 4; k++) {
      f->points[4 * i + k] = p[k];
      f->fragments[4 * i + k] = (opc_fragment){
          .from = p[k], .gate = role[k] ? i : -1, .role = role[k]};
    }
    f->start[i + 1] = 4 * (uint32_t)(i + 1);
    f->room[2 * i] = f->room[2 * i + 1] = 500;
    f->extension[2 * i] = f->extension[2 * i + 1] = INFINITY;
  }
  f->box[0] = (opc_box){0, 100, 65, 300};
  f->box[1] = (opc_box){0, 500 + gap, 65, 700 + gap};
  f->gates = (opc_gates){.size = sizeof f->gates, .grid = 1, .count = 2,
                         .extent = {-200, 0, 265, 900 + gap},
                         .box = f->box, .axis = f->axis, .room = f->room};
  f->gates.drawn[OPC_POLY] = (opc_shapes){2, f->start, f->points, NULL};
  f->gates.edges[OPC_POLY] = (opc_edges){2, f->start, f->fragments};
}

static opc_printed print_of(fixture *f) {
  return (opc_printed){.size = sizeof(opc_printed), .gates = &f->gates,
                       .flags = f->flags, .l = f->l, .w = f->w,
                       .extension = f->extension};
}

static size_t rule(opc_module *m, fixture *f) {
  const opc_regulator *r = m->plugin->operations;
  opc_printed p = print_of(f);
  memset(f->vetoes, 0, sizeof f->vetoes);
  opc_ruling ruling = {.size = sizeof ruling, .vetoes = f->vetoes, .end = f->end};
  opc_error error;
  g_assert_cmpint(r->rule(m->self, &p, &ruling, &error), ==, OPC_OK);
  return ruling.transistors;
}

static opc_module *make(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("drc.regulator", parameters, &error);
  g_assert_nonnull(m);
  return m;
}

/* The line end of the lower gate is 7 nm short of 20: it grows by 7, and then
   stays. */
static void test_extension(void) {
  g_autoptr(opc_module) m = make("{ min_extension: 20 nm }");
  fixture f;
  setup(&f, 1000);
  f.extension[1] = 13;
  g_assert_cmpuint(rule(m, &f), ==, 2);
  g_assert_cmpint(f.end[1], ==, 7);
  f.extension[1] = 20;
  rule(m, &f);
  g_assert_cmpint(f.end[1], ==, 7);
  f.extension[1] = -30;   /* far too short: by 10 nm at a time, to 60 nm */
  for (int i = 0; i < 10; i++) rule(m, &f);
  g_assert_cmpint(f.end[1], ==, 60);
  g_assert_cmpint(f.end[0], ==, 0);
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

static void test_vetoes(void) {
  g_autoptr(opc_module) m = make("{ min_space: 60 nm }");
  fixture f;
  setup(&f, 1000);
  g_assert_cmpuint(rule(m, &f), ==, 2);
  g_assert_cmpuint(f.vetoes[0] | f.vetoes[1], ==, 0);
  f.flags[0] = OPC_PRINT_MERGED;
  f.flags[1] = OPC_PRINT_OPEN;
  g_assert_cmpuint(rule(m, &f), ==, 0);
  g_assert_cmpuint(f.vetoes[0], ==, OPC_VETO_LONGER);
  g_assert_cmpuint(f.vetoes[1], ==, OPC_VETO_SHORTER | OPC_VETO_NARROWER);
  /* 100 nm of room: with l = 39 the next step leaves 60, with 40 it does
     not. */
  f.flags[0] = f.flags[1] = 0;
  f.room[0] = 100;
  f.l[0] = 39;
  rule(m, &f);
  g_assert_cmpuint(f.vetoes[0], ==, 0);
  f.l[0] = 40;
  rule(m, &f);
  g_assert_cmpuint(f.vetoes[0], ==, OPC_VETO_LONGER);
}

static void test_violations(void) {
  g_autoptr(opc_module) m = make("{ min_extension: 20 nm }");
  const opc_regulator *r = m->plugin->operations;
  fixture f;
  setup(&f, 1000);
  f.extension[1] = 12.5;
  f.flags[1] = OPC_PRINT_MERGED | OPC_PRINT_OPEN;
  opc_printed p = print_of(&f);
  opc_violation v[2];
  size_t count;
  opc_error error;
  g_assert_cmpint(r->violations(m->self, &p, v, 2, &count, &error), ==, OPC_OK);
  g_assert_cmpuint(count, ==, 3);   /* more than there was room for */
  g_assert_cmpstr(v[0].rule, ==, "extension");
  g_assert_cmpint(v[0].gate, ==, 0);
  g_assert_cmpfloat(v[0].value, ==, 12.5);
  g_assert_cmpfloat(v[0].limit, ==, 20);
  g_assert_cmpfloat(v[0].x, ==, 32.5);
  g_assert_cmpfloat(v[0].y, ==, 200);
  g_assert_cmpstr(v[1].rule, ==, "bridging");
  g_assert_cmpint(v[1].gate, ==, 1);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/extension", test_extension);
  g_test_add_func("/regulator/facing", test_facing);
  g_test_add_func("/regulator/vetoes", test_vetoes);
  g_test_add_func("/regulator/violations", test_violations);
  return g_test_run();
}
