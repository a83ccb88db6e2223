/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of layers that are corrected besides poly and active, and of notes
   (texts) on transistors. */
#include "drawing_test.h"

/* ---- further layers ---- */

static void check_layer(const eda_gates *g, size_t layer, const char *name,
                        int corrected, const char *edges) {
  g_assert_cmpstr(g->layer[layer], ==, name);
  g_assert_cmpint(g->corrected[layer], ==, corrected);
  g_autofree char *got = edges_text(&g->edges[layer]);
  g_assert_cmpstr(got, ==, edges);
}

/* Test that further layers are in the order of the flow, after drawn contacts.
   The edges belong to no transistor, and the extent includes the layers. */
static void test_also(void) {
  for (int contacts = 0; contacts < 2; contacts++) {
    drawing d = drawing_new();
    draw_single(&d);
    drawing_box(&d, "M1", 2000, 0, 2100, 50);
    drawing_box(&d, "M1", 2050, 50, 2100, 90);
    drawing_box(&d, "M2", 0, 0, 10, 10);
    if (contacts) drawing_box(&d, "contact", 20, 20, 80, 80);
    result r = layout_segment(d.layout, "{ also: { metal2: M2, metal1: M1 } }");
    const eda_gates *g = r.gates;
    size_t first = contacts ? 3 : 2;
    check_owned(g);
    g_assert_cmpuint(g->layers, ==, first + 2);
    g_assert_cmpint(eda_gates_layer(g, "contact"), ==, contacts ? 2 : -1);
    if (contacts) check_layer(g, 2, "contact", 0, "");
    check_layer(g, first, "metal2", 1, "0,0 -; 10,0 -; 10,10 -; 0,10 -\n");
    check_layer(g, first + 1, "metal1", 1,
                "2000,0 -; 2100,0 -; 2100,90 -; 2050,90 -; 2050,50 -; "
                "2000,50 -\n");
    check_rebuilt(g, (int)first + 1);
    g_assert_cmpint(g->extent.x1, ==, 2100);
    opc_error error;
    g_assert_cmpint(eda_gates_check(g, &error), ==, OPC_OK);
    result_free(&r);
    eda_layout_free(d.layout);
  }
}

static void test_also_refused(void) {
  static const struct {
    const char *map, *message;
  } bad[] = {
      {"poly: M1", "'poly': a layer of this name exists already"},
      {"contact: M1", "'contact': a layer of this name exists already"},
      {"gates: poly", "'gates': layer poly is 'poly' already"},
      {"a: M1, b: M1", "'b': layer M1 is 'a' already"},
      {"poly_drawn: M1", "'poly_drawn' cannot be the name of a layer"},
      {"'a b': M1", "'a b' cannot be the name of a layer"},
      {"'': M1", "'' cannot be the name of a layer"},
  };
  opc_error error;
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_autofree char *map = g_strdup_printf("{ also: { %s } }", bad[i].map);
    g_assert_null(opc_test_module("segment.transistors", map, &error));
    g_assert_nonnull(strstr(error.message, bad[i].message));
  }
  drawing d = drawing_new();
  draw_single(&d);
  assert_refused(&d, "{ also: { metal1: M1 } }", OPC_INVALID,
                 "the layout has no layer 'M1'");
  d = drawing_new();
  draw_single(&d);
  eda_layout_layer(d.layout, "M1", &error);
  assert_refused(&d, "{ also: { metal1: M1 } }", OPC_INVALID,
                 "layer 'M1' is empty");
}

/* ---- notes ---- */

static void write_note(drawing *d, int32_t x, int32_t y, const char *text) {
  opc_error error;
  int32_t l = eda_layout_layer(d->layout, "notes", &error);
  g_assert_cmpint(eda_layout_add_text(d->layout, d->cell, l, (eda_point){x, y},
                                      text, &error),
                  ==, OPC_OK);
}

/* Return a layout of an inverter with a note on its n-transistor. The layout
   has the inverter as drawn, rotated, mirrored, and four times in an array. */
static drawing noted(drawing *inverter) {
  static const eda_placement places[] = {
      {{1000, 0}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}},
      {{0, 2000}, 1, 90, 0, 1, 1, {0, 0}, {0, 0}},
      {{3000, 2000}, 1, 180, 1, 1, 1, {0, 0}, {0, 0}},
      {{5000, 0}, 1, 0, 0, 2, 2, {800, 0}, {0, 1500}},
  };
  static const char *const names[] = {"X1", "X2", "X3", "XA"};
  opc_error error;
  drawing d = drawing_new();
  *inverter = d;
  inverter->cell = eda_layout_cell(d.layout, "INV", &error);
  drawing_box(inverter, "active", 0, 0, 300, 100);
  drawing_box(inverter, "active", 0, 400, 300, 600);
  drawing_box(inverter, "nwell", -100, 300, 400, 700);
  drawing_box(inverter, "poly", 100, -100, 165, 700);
  write_note(inverter, 100, 0, "weight=2");
  for (int i = 0; i < 4; i++)
    g_assert_cmpint(eda_layout_add_instance(d.layout, d.cell, inverter->cell,
                                            &places[i], names[i], &error),
                    ==, OPC_OK);
  return d;
}

static void test_notes(void) {
  drawing inverter, d = noted(&inverter);
  /* Write a note for one instance at the far corner of the gate, a note without
     a value, a note on a p-transistor, and a repeated note. */
  write_note(&d, 1165, 100, "ion=1.05");
  write_note(&d, 5101, 1, "");
  write_note(&d, 1130, 500, "ion=0.9");
  write_note(&d, 1131, 501, "ion=0.9");
  opc_test_forget();
  result r = layout_segment(d.layout, "{ top: TOP }");
  const eda_gates *g = r.gates;
  g_assert_cmpuint(g->count, ==, 14);
  for (size_t i = 0; i < g->count; i++) {
    int n = g->type[i] == EDA_NMOS, own = !strcmp(g->instance[i], "X1"),
        taken = !strcmp(g->instance[i], "XA[0,0]");
    g_assert_cmpint(g->goal[i].given, ==, (n && !taken) || own);
    g_assert_cmpfloat(g->goal[i].weight, ==, n && !own && !taken ? 2 : 1);
    g_assert_cmpfloat(g->goal[i].target[EDA_GOAL_ION], ==,
                      !own ? 1
                      : n  ? 1.05
                           : 0.9);
  }
  g_assert_null(strstr(opc_test_log(), "no transistor"));
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);

  /* This note is 1 nm outside of the gate in every instance. */
  write_note(&inverter, 166, 50, "lost");
  opc_test_forget();
  r = layout_segment(d.layout, "{ top: TOP }");
  g_assert_nonnull(strstr(opc_test_log(),
                          "texts of layer 'notes' on no transistor: 7, the "
                          "first 'lost' at (1166, 50) nm, instance 'X1'"));
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);
  write_note(&inverter, 130, 50, "weight=3");
  assert_refused(
      &d, "{ top: TOP }", OPC_INVALID,
      "transistor 'X2:2' has two notes: 'weight=2', and at (-50, 2130) nm "
      "'weight=3'");
  drawing bad = drawing_new();
  draw_single(&bad);
  write_note(&bad, 160, 100, "wieght=2");
  assert_refused(
      &bad, "{}", OPC_INVALID,
      "note of 'TOP:1': unknown word 'wieght', did you mean 'weight'?");
}

/* Test a missing layer, a layer without texts, and a coarse grid. */
static void test_no_notes(void) {
  opc_error error;
  drawing d = drawing_new();
  draw_single(&d);
  result r = layout_segment(d.layout, "{}");
  g_assert_null(((const eda_gates *)r.gates)->goal);
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);
  eda_layout_layer(d.layout, "notes", &error);
  r = layout_segment(d.layout, "{}");
  const eda_gates *g = r.gates;
  g_assert_nonnull(g->goal);
  for (size_t i = 0; i < g->count; i++)
    g_assert_cmpint(g->goal[i].given, ==, 0);
  eda_box b = g->box[0];
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);
  write_note(&d, b.x1, b.y1, "area=1.5");
  r = layout_segment(d.layout, "{ grid: 5 nm }");
  g = r.gates;
  g_assert_cmpfloat(g->goal[0].target[EDA_GOAL_AREA], ==, 1.5);
  opc_test_release(r.module, &r.gates);
  opc_test_module_free(r.module);
  eda_layout_free(d.layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/transistors/also", test_also);
  g_test_add_func("/transistors/also-refused", test_also_refused);
  g_test_add_func("/transistors/notes", test_notes);
  g_test_add_func("/transistors/no-notes", test_no_notes);
  return g_test_run();
}
