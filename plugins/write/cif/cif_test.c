/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of small files as text, masks, units, and rejected layouts. */
#include <eda/gates.h>
#include <eda/layout.h>
#include <eda/memory.h>
#include <string.h>

#include "tools/devel/testing.h"

/* Return the file written for `object`, an input of that kind, or NULL and
 *error. */
static char *write_object(const char *kind, void *object, const char *more,
                          opc_error *error) {
  static int files;
  g_autofree char *name = g_strdup_printf("%d.cif", files++);
  g_autofree char *mapping = g_strdup_printf("{ file: %s%s }", name, more);
  g_autoptr(opc_module) module = opc_test_module("write.cif", mapping, error);
  if (!module) return NULL;
  opc_test_input(module, kind, object);
  void *none = NULL;
  char *text = NULL;
  if (opc_test_run(module, &none, error)) return NULL;
  g_autofree char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  return text;
}

static char *write_more(eda_layout *layout, const char *more,
                        opc_error *error) {
  return write_object("layout", layout, more, error);
}

static eda_layout *new_layout(double unit) {
  opc_error e;
  return eda_layout_new(unit, &e);
}

/* Test all commands as text in the file. */
static void test_text(void) {
  opc_error e = {0};
  eda_layout *layout = new_layout(0.5);
  int32_t top = eda_layout_cell(layout, "TOP", &e),
          leaf = eda_layout_cell(layout, "LEAF", &e);
  int32_t poly = eda_layout_layer(layout, "poly", &e);
  int32_t other = eda_layout_layer(layout, "65/7", &e);
  const eda_point kite[] = {{0, 0}, {50, 10}, {60, 60}};
  eda_layout_add_box(layout, leaf, poly, (eda_box){-5, -6, 7, 8}, &e);
  eda_layout_add_box(layout, leaf, poly, (eda_box){0, 0, 7, 8}, &e);
  eda_layout_add_polygon(layout, leaf, other, kite, 3, &e);
  eda_layout_add_text(layout, leaf, poly, (eda_point){1, -2}, "a b;", &e);
  const eda_placement placements[] = {
      {{0, 0}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}},
      {{-1, 2}, 1, 90, 1, 1, 1, {0, 0}, {0, 0}},
      {{3, 4}, 1, 180, 0, 2, 2, {10, 0}, {0, 20}},
      {{3, 4}, 1, -90, 0, 1, 1, {0, 0}, {0, 0}},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(placements); i++)
    eda_layout_add_instance(layout, top, leaf, &placements[i], NULL, &e);
  opc_test_forget();
  g_autofree char *got = write_more(layout, ", layers: { poly: CP }", &e);
  g_assert_cmpstr(got, ==,
                  "DS 1 1 20;\n9 TOP;\n"
                  "C 2;\nC 2 M Y R 0 1 T -1 2;\n"
                  "C 2 R -1 0 T 3 4;\nC 2 R -1 0 T 13 4;\n"
                  "C 2 R -1 0 T 3 24;\nC 2 R -1 0 T 13 24;\n"
                  "C 2 R 0 -1 T 3 4;\nDF;\n"
                  "DS 2 1 20;\n9 LEAF;\n"
                  "L CP;\nB 12 14 1 1;\nP 0 0 7 0 7 8 0 8;\n"
                  "L L65D7;\nP 0 0 50 10 60 60;\n"
                  "L CP;\n94 a_b_ 1 -2;\nDF;\n"
                  "C 1;\nE\n");
  g_assert_nonnull(strstr(opc_test_log(), "characters of 1 texts"));
  eda_layout_free(layout);
}

static void assert_refused(const eda_placement *p, const char *name,
                           const char *why) {
  opc_error e = {0};
  eda_layout *layout = new_layout(1);
  int32_t top = eda_layout_cell(layout, "TOP", &e),
          leaf = eda_layout_cell(layout, name, &e);
  eda_layout_add_instance(layout, top, leaf, p, NULL, &e);
  g_assert_null(write_more(layout, "", &e));
  if (!strstr(e.message, why)) g_error("%s", e.message);
  eda_layout_free(layout);
}

static void test_refusals(void) {
  eda_placement p = {{0, 0}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}};
  assert_refused(&p, "A;B",
                 "'A;B' is not allowed as the name of a cell in CIF");
  p.magnification = 2;
  assert_refused(&p, "LEAF", "'LEAF' in 'TOP': CIF cannot magnify a cell");
  p.magnification = 1;
  p.angle = 45;
  assert_refused(&p, "LEAF", "'LEAF' in 'TOP': CIF output supports");
  p.angle = 0;
  p.columns = p.rows = 1u << 31;
  assert_refused(&p, "LEAF", "'LEAF' in 'TOP': CIF has no arrays");
  opc_error e = {0};
  eda_layout *layout = new_layout(1e-10);
  eda_layout_cell(layout, "TOP", &e);
  g_autofree char *text = write_more(layout, "", &e);
  g_assert_null(text);
  g_assert_nonnull(strstr(e.message, "cannot be represented in CIF"));
  g_assert_null(write_more(layout, ", layers: { poly: 'a b' }", &e));
  g_assert_nonnull(strstr(e.message, "'a b': invalid layer (example: CP)"));
  eda_layout_free(layout);
}

/* Return a box, one size per layer of a mask. */
static eda_shapes box_of(int side) {
  eda_shapes s = {.count = 1,
                  .start = eda_alloc(2, sizeof *s.start),
                  .points = eda_alloc(4, sizeof *s.points)};
  s.start[1] = 4;
  s.points[1] = (eda_point){side, 0};
  s.points[2] = (eda_point){side, side};
  s.points[3] = (eda_point){0, side};
  return s;
}

static void test_mask(void) {
  static const char *const names[] = {"poly", "active", "contact", "metal1"};
  opc_error e = {0};
  eda_gates *g = eda_gates_new(4, 0);
  eda_mask *mask = eda_mask_new(g);
  g->name = eda_gates_text(g, "chip");
  g->grid = 10;
  for (int k = 0; k < 4; k++) {
    g->layer[k] = eda_gates_text(g, names[k]);
    g->corrected[k] = k != 2;
    g->drawn[k] = box_of(20 + 2 * k);
    if (k != 2) mask->shapes[k] = box_of(2 + 2 * k);
  }
  g_autofree char *text =
      write_object("mask", mask, ", layers: { metal1_drawn: '11/5' }", &e);
  g_assert_cmpstr(text, ==,
                  "DS 1 1 1;\n9 chip;\nL CP;\nB 2 2 1 1;\nL CA;\nB 4 4 2 2;\n"
                  "L CC;\nB 24 24 12 12;\nL metal1;\nB 8 8 4 4;\n"
                  "L XP;\nB 20 20 10 10;\nL XA;\nB 22 22 11 11;\n"
                  "L L11D5;\nB 26 26 13 13;\nDF;\nC 1;\nE\n");
  g_assert_null(write_object("mask", mask, ", layers: { poly: metal1 }", &e));
  g_assert_nonnull(strstr(e.message, "'poly' and 'metal1' would both be"));
  eda_mask_free(mask);
  eda_gates_free(g);
}

/* Test that units are kept exactly. */
static void test_units(void) {
  static const struct {
    double unit;
    const char *scale;
  } cases[] = {{10, "DS 1 1 1;"},         {1, "DS 1 1 10;"},
               {25, "DS 1 5 2;"},         {0.13, "DS 1 13 1000;"},
               {1e-3, "DS 1 1 10000;"},   {10 / 3.0, "DS 1 1 3;"},
               {65 * 0.7, "DS 1 91 20;"}, {1000, "DS 1 100 1;"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error e = {0};
    eda_layout *layout = new_layout(cases[i].unit);
    eda_layout_cell(layout, "TOP", &e);
    g_autofree char *text = write_more(layout, "", &e);
    if (!text) g_error("%s", e.message);
    if (!g_str_has_prefix(text, cases[i].scale)) g_error("%s", text);
    eda_layout_free(layout);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/write-cif/text", test_text);
  g_test_add_func("/write-cif/refusals", test_refusals);
  g_test_add_func("/write-cif/mask", test_mask);
  g_test_add_func("/write-cif/units", test_units);
  return g_test_run();
}
