/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of shapes with known merged edges, and of rejected layouts. */
#include <eda/gates.h>
#include <eda/layout.h>

#include "tools/devel/testing.h"

#include <string.h>

static eda_layout *make_layout(int layers) {
  opc_error error;
  eda_layout *l = eda_layout_new(0.5, &error);
  int32_t cell = eda_layout_cell(l, "TOP", &error);
  int32_t m1 = eda_layout_layer(l, "M1", &error);
  if (layers > 1) eda_layout_layer(l, "M2", &error);
  /* An L of two overlapping boxes, and a ring; a unit is 0.5 nm. */
  const eda_box boxes[] = {{0, 0, 400, 100},    {0, 0, 100, 600},
                           {800, 0, 1200, 100}, {800, 300, 1200, 400},
                           {800, 0, 900, 400},  {1100, 0, 1200, 400}};
  for (size_t i = 0; i < G_N_ELEMENTS(boxes); i++)
    g_assert_cmpint(eda_layout_add_box(l, cell, m1, boxes[i], &error), ==,
                    OPC_OK);
  return l;
}

static int layout_segment(eda_layout *layout, const char *parameters,
                          void **out, opc_module **m, opc_error *error) {
  *m = opc_test_module("segment.edges", parameters, error);
  g_assert_nonnull(*m);
  opc_test_input(*m, "layout", layout);
  return opc_test_run(*m, out, error);
}

static void test_shapes(void) {
  opc_error error;
  void *out[1];
  eda_layout *layout = make_layout(1);
  g_autoptr(opc_module) m = NULL;
  g_assert_cmpint(layout_segment(layout, "{ grid: 2 nm }", out, &m, &error), ==,
                  OPC_OK);
  const eda_gates *g = out[0];
  g_assert_cmpuint(g->count, ==, 0);
  g_assert_cmpstr(g->name, ==, "TOP");
  g_assert_cmpfloat(g->grid, ==, 2);
  eda_box want = {0, 0, 300, 150};
  g_assert_cmpmem(&g->extent, sizeof want, &want, sizeof want);
  g_assert_cmpuint(g->drawn[EDA_POLY].count, ==, 3); /* the L, the ring and the
                                                        hole of the ring */
  g_assert_cmpuint(g->layers, ==, 1);
  g_assert_cmpstr(g->layer[0], ==, "M1");
  g_assert_cmpint(g->corrected[0], ==, 1);
  /* Areas in square steps of 2 nm: the L has 100 x 25 + 25 x 125; the ring
     follows. */
  g_assert_cmpint(eda_area2(&g->drawn[EDA_POLY]), ==,
                  2 * (100 * 25 + 25 * 125 + 100 * 100 - 50 * 50));
  const eda_edges *e = &g->edges[EDA_POLY];
  g_assert_cmpuint(e->polygons, ==, 3);
  g_assert_cmpuint(e->start[3], ==, 6 + 4 + 4);
  for (uint32_t i = 0; i < e->start[3]; i++) {
    g_assert_cmpint(e->fragments[i].role, ==, EDA_FIXED);
    g_assert_cmpint(e->fragments[i].gate, ==, -1);
    g_assert_cmpmem(&e->fragments[i].from, sizeof(eda_point),
                    &g->drawn[EDA_POLY].points[i], sizeof(eda_point));
  }
  g_assert_cmpfloat(opc_test_metric("polygons"), ==, 3);
  g_assert_cmpfloat(opc_test_metric("edges"), ==, 14);
  opc_test_release(m, out);
  eda_layout_free(layout);
}

/* Test a corner that deviates by 1 nm from a box of 200 x 50 nm; 2 nm are
   rejected. */
static void test_slanted(void) {
  for (int32_t off = 2; off <= 4; off += 2) {
    opc_error error;
    void *out[1];
    eda_layout *l = eda_layout_new(0.5, &error);
    const eda_point p[] = {{0, 0}, {400, 0}, {400 + off, 100}, {0, 100}};
    int32_t cell = eda_layout_cell(l, "TOP", &error);
    g_assert_cmpint(
        eda_layout_add_polygon(l, cell, eda_layout_layer(l, "M1", &error), p, 4,
                               &error),
        ==, OPC_OK);
    g_autoptr(opc_module) m = NULL;
    int code = layout_segment(l, "{}", out, &m, &error);
    if (off == 2) {
      const eda_gates *g = out[0];
      g_assert_cmpint(code, ==, OPC_OK);
      g_assert_cmpint(eda_area2(&g->drawn[0]), ==, 2 * 200 * 50);
      g_assert_cmpfloat(opc_test_metric("snapped"), ==, 1);
      opc_test_release(m, out);
    } else {
      g_assert_cmpint(code, ==, OPC_INVALID);
      g_assert_nonnull(strstr(error.message, "slanted edge"));
    }
    eda_layout_free(l);
  }
}

static void assert_refused(int layers, const char *parameters,
                           const char *message) {
  opc_error error;
  void *out[1];
  eda_layout *layout = make_layout(layers);
  g_autoptr(opc_module) m = NULL;
  g_assert_cmpint(layout_segment(layout, parameters, out, &m, &error), !=,
                  OPC_OK);
  if (!strstr(error.message, message))
    g_error("'%s' instead of '%s'", error.message, message);
  eda_layout_free(layout);
}

static void test_refused(void) {
  assert_refused(1, "{ layer: M7 }", "no layer 'M7'");
  assert_refused(2, "{}", "2 layers");
  assert_refused(2, "{ layer: M2 }", "'M2' is empty");
  assert_refused(1, "{ top: NONE }", "no cell 'NONE'");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/edges/shapes", test_shapes);
  g_test_add_func("/edges/refused", test_refused);
  g_test_add_func("/edges/slanted", test_slanted);
  return g_test_run();
}
