/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the transistor types by wells and implants, and of rejected layouts
   with their messages. */
#include "drawing_test.h"

/* ---- types ---- */

/* Assert the type of a single transistor. Each letter of `layers` is a drawn
   layer: n and p are wells, N and P implants. A layer covers the transistor, in
   brackets is beside the transistor, and after '<' covers the transistor
   partly. */
static void type_is(const char *layers, int code, const char *want) {
  static const char letters[] = "npNP";
  static const char *const names[] = {"nwell", "pwell", "nimplant", "pimplant"};
  drawing d = drawing_new();
  drawing_box(&d, "active", 0, 0, 400, 200);
  drawing_box(&d, "poly", 150, -100, 215, 300);
  int shift = 0;
  for (const char *c = layers; *c; c++) {
    if (*c == '(') shift = 1000;
    if (*c == ')') shift = 0;
    if (*c == '<') shift = 580;
    const char *l = strchr(letters, *c);
    if (l)
      drawing_box(&d, names[l - letters], -400 + shift, -400, 600 + shift, 600);
  }
  if (code) {
    g_autofree char *message = g_strdup_printf(
        "transistor from (150, 0) to (215, 200) nm, cell 'TOP': %s", want);
    assert_refused(&d, "{}", code, message);
    return;
  }
  result r = layout_segment(d.layout, "{}");
  const eda_gates *g = r.gates;
  g_assert_cmpuint(g->count, ==, 1);
  g_assert_true("np"[g->type[0]] == *want);
  g_assert_cmpfloat(opc_test_metric("nmos"), ==, *want == 'n');
  g_assert_cmpfloat(opc_test_metric("pmos"), ==, *want == 'p');
  result_free(&r);
  eda_layout_free(d.layout);
}

static void test_type(void) {
  type_is("n", 0, "p");
  type_is("(n)", 0, "n");
  type_is("p", 0, "n");
  type_is("(p)", 0, "p");
  type_is("n(p)", 0, "p");
  type_is("(n)p", 0, "n");
  type_is("N", 0, "n");
  type_is("P", 0, "p");
  type_is("N(P)", 0, "n");
  type_is("nN", 0, "n");
  type_is("(n)P", 0, "p");
  type_is("n(NP)", 0, "p");
  type_is("NP", OPC_INVALID, "both implants cover the transistor");
  type_is("np", OPC_INVALID, "both wells cover the transistor");
  type_is("<n", OPC_INVALID, "'nwell' covers the transistor in part");
  type_is("<p", OPC_INVALID, "'pwell' covers the transistor in part");
  type_is("n<N", OPC_INVALID, "'nimplant' covers the transistor in part");
  type_is("<P", OPC_INVALID, "'pimplant' covers the transistor in part");
  const char *unknown =
      "the type is unknown: no layer 'nwell' or 'pwell' exists, and no implant "
      "covers the transistor";
  type_is("", OPC_INVALID, unknown);
  type_is("(N)", OPC_INVALID, unknown);
}

/* Test that a well layer without shapes (for example with the number of its
   text layer) causes a warning, because all transistors then have one type. A
   well elsewhere in the layout causes no warning. */
static void test_no_well(void) {
  static const char *const wells[] = {"nwell", "pwell"};
  for (int k = 0; k < 2; k++)
    for (int shapes = 0; shapes < 2; shapes++) {
      opc_error error;
      drawing d = drawing_new();
      drawing_box(&d, "active", 0, 0, 400, 200);
      drawing_box(&d, "poly", 150, -100, 215, 300);
      g_assert_cmpint(eda_layout_layer(d.layout, wells[k], &error), >=, 0);
      if (shapes) drawing_box(&d, wells[k], 1000, 0, 1100, 100);
      opc_test_forget();
      result r = layout_segment(d.layout, "{}");
      g_autofree char *want = g_strdup_printf(
          "layer '%s' has no shape, so that all transistors are "
          "%c-transistors",
          wells[k], "np"[k]);
      g_assert_true((strstr(opc_test_log(), want) == NULL) == shapes);
      result_free(&r);
      eda_layout_free(d.layout);
    }
}

/* ---- refusals ---- */

static void test_refused(void) {
  drawing d = drawing_new();
  drawing_box(&d, "active", 0, 0, 400, 200);
  assert_refused(&d, "{}", OPC_INVALID,
                 "no transistors: the layout has no layer 'poly', but active; "
                 "name the layer in 'layers' of the reader");
  d = drawing_new();
  drawing_box(&d, "active", 0, 0, 400, 200);
  drawing_box(&d, "poly", 400, 0, 465, 200);
  assert_refused(&d, "{}", OPC_INVALID,
                 "no transistors: layers 'poly' and 'active' do not overlap");
  d = drawing_new();
  draw_single(&d);
  assert_refused(&d, "{ top: NAND }", OPC_INVALID,
                 "the layout has no cell 'NAND'");

  static const struct {
    eda_box poly[2];
    const char *fault;
  } bad[] = {
      {{{150, -100, 215, 150}},
       "(150, 0) to (215, 150)"
       " nm, cell 'TOP': poly ends on active"},
      {{{150, 50, 215, 150}},
       "(150, 50) to (215, 150)"
       " nm, cell 'TOP': poly ends on active"},
      {{{350, -50, 450, 150}},
       "(350, 0) to (400, 150)"
       " nm, cell 'TOP': poly ends on active"},
      {{{150, -100, 215, 150}, {150, 100, 500, 150}},
       "(150, 0) to (400, 150) nm, cell 'TOP': the gate is not a rectangle"},
      {{{-50, -50, 450, 250}},
       "(0, 0) to (400, 200) nm, cell 'TOP': "
       "no two opposite sides are edges of poly"},
      {{{350, -50, 450, 250}},
       "(350, 0) to (400, 200) nm, cell 'TOP': "
       "no two opposite sides are edges of poly"},
      {{{350, -50, 400, 250}},
       "(350, 0) to (400, 200) nm, cell 'TOP': an edge of poly coincides with "
       "an edge of active"},
      {{{150, 0, 215, 250}},
       "(150, 0) to (215, 200) nm, cell 'TOP': an edge of poly coincides with "
       "an edge of active"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_autofree char *message =
        g_strdup_printf("transistor from %s", bad[i].fault);
    d = drawing_new();
    drawing_box(&d, "active", 0, 0, 400, 200);
    drawing_box(&d, "nwell", 0, 0, 1, 1);
    for (int k = 0; k < 2 && bad[i].poly[k].x1; k++)
      drawing_box(&d, "poly", bad[i].poly[k].x0, bad[i].poly[k].y0,
                  bad[i].poly[k].x1, bad[i].poly[k].y1);
    assert_refused(&d, "{}", OPC_INVALID, message);
  }
}

static void test_refused_shapes(void) {
  /* Test a ring of poly on active, and a slanted edge. */
  drawing d = drawing_new();
  drawing_box(&d, "active", 0, 0, 500, 500);
  drawing_box(&d, "poly", 100, 100, 400, 150);
  drawing_box(&d, "poly", 100, 350, 400, 400);
  drawing_box(&d, "poly", 100, 100, 150, 400);
  drawing_box(&d, "poly", 350, 100, 400, 400);
  assert_refused(
      &d, "{}", OPC_INVALID,
      "transistor from (100, 100) to (400, 400) nm, cell 'TOP': poly ends "
      "on active");
  d = drawing_new();
  draw_single(&d);
  opc_error error;
  eda_point slanted[] = {{0, 0}, {100, 0}, {0, 100}};
  eda_layout_add_polygon(d.layout, d.cell,
                         eda_layout_layer(d.layout, "poly", &error), slanted, 3,
                         &error);
  assert_refused(
      &d, "{}", OPC_INVALID,
      "layer 'poly', in units of 1 nm: slanted edge from (100, 0) to (0, "
      "100)");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/transistors/type", test_type);
  g_test_add_func("/transistors/no-well", test_no_well);
  g_test_add_func("/transistors/refused", test_refused);
  g_test_add_func("/transistors/refused-shapes", test_refused_shapes);
  return g_test_run();
}
