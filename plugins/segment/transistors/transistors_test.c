/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of drawings with known transistors, edges and names. */
#include "drawing_test.h"

/* ---- layouts by hand ---- */

static void test_vertical(void) {
  drawing d = drawing_new();
  draw_single(&d);
  segment_is(&d, "{}", "nx 150,0 65x200 space 300 370 ends 100 100\n",
             "150,-100 E<0; 215,-100 L>0; 215,300 E>0; 150,300 L<0\n",
             "0,0 W<0; 400,0 -; 400,200 W>0; 0,200 -\n");
  /* A line end further from the active than `line_end` belongs to no
     transistor. */
  d = drawing_new();
  draw_single(&d);
  segment_is(&d, "{ line_end: 99 nm }",
             "nx 150,0 65x200 space 300 370 ends inf inf\n",
             "150,-100 -; 215,-100 -; 215,-84 L>0; 215,284 -; 215,300 -; "
             "150,300 -; 150,284 L<0; 150,-84 -\n",
             "0,0 W<0; 400,0 -; 400,200 W>0; 0,200 -\n");
  /* Test a grid of 5 nm, and an overhang that is longer than the line beyond
     the active. */
  d = drawing_new();
  draw_single(&d);
  segment_is(&d, "{ line_end: 0 nm, overhang: 200 nm, grid: 5 nm }",
             "nx 30,0 65x200 space 300 370 ends inf inf\n",
             "30,-20 -; 43,-20 L>0; 43,60 -; 30,60 L<0\n",
             "0,0 W<0; 80,0 -; 80,40 W>0; 0,40 -\n");
}

/* Return 1 if line ends `reach` nm beyond the active belong to the transistor
   of length `length`. */
static int owns_end(int length, int reach) {
  drawing d = drawing_new();
  drawing_box(&d, "active", 0, 0, 2000, 1000);
  drawing_box(&d, "poly", 700, -reach, 700 + length, 1000 + reach);
  drawing_box(&d, "nimplant", -50, -50, 2050, 1050);
  result r = layout_segment(d.layout, "{}");
  const eda_gates *g = r.gates;
  int owns = isfinite(g->extension[0]) != 0;
  g_assert_cmpint(owns, ==, isfinite(g->extension[1]) != 0);
  result_free(&r);
  eda_layout_free(d.layout);
  return owns;
}

/* Test the defaults: 200 nm for a gate of 65 nm correspond to 461 nm for 150
   nm, and for 500 nm to 1538 nm, more than the limit of 1 um. */
static void test_lengths(void) {
  g_assert_true(owns_end(65, 200) && !owns_end(65, 201));
  g_assert_true(owns_end(150, 461) && !owns_end(150, 463));
  g_assert_true(owns_end(500, 600) && owns_end(500, 1000));
  g_assert_false(owns_end(500, 1001));
}

/* Test that the space is at least L before edges count as merged. */
static void test_narrow_active(void) {
  drawing d = drawing_new();
  drawing_box(&d, "active", 120, 0, 400, 200);
  drawing_box(&d, "poly", 150, -100, 215, 300);
  drawing_box(&d, "nimplant", -50, -50, 450, 250);
  segment_is(&d, "{}", "nx 150,0 65x200 space 130 370 ends 100 100\n",
             "150,-100 E<0; 215,-100 L>0; 215,300 E>0; 150,300 L<0\n",
             "120,0 W<0; 400,0 -; 400,200 W>0; 120,200 -\n");
}

static void test_horizontal(void) {
  drawing d = drawing_new();
  swap = 1;
  draw_single(&d);
  swap = 0;
  segment_is(&d, "{}", "ny 0,150 65x200 space 300 370 ends 100 100\n",
             "-100,150 L<0; 300,150 E>0; 300,215 L>0; -100,215 E<0\n",
             "0,0 -; 200,0 W>0; 200,400 -; 0,400 W<0\n");
}

/* Test figure 3.2 of the thesis: an upper and a lower transistor on each poly
   line, with three transistors on each diffusion; the left two lines extend far
   beyond. */
static void test_figure(void) {
  drawing d = drawing_new();
  drawing_box(&d, "active", 0, 0, 900, 100);
  drawing_box(&d, "active", 0, 300, 900, 500);
  drawing_box(&d, "nwell", -100, 200, 1000, 600);
  drawing_box(&d, "poly", 100, -400, 165, 900);
  drawing_box(&d, "poly", 365, -120, 430, 620);
  drawing_box(&d, "poly", 700, -120, 765, 620);
  segment_is(
      &d, "{}",
      "nx 100,0 65x100 space 200 200 ends inf inf\n"
      "nx 365,0 65x100 space 200 270 ends 120 inf\n"
      "nx 700,0 65x100 space 270 270 ends 120 inf\n"
      "px 100,300 65x200 space 200 200 ends inf inf\n"
      "px 365,300 65x200 space 200 270 ends inf 120\n"
      "px 700,300 65x200 space 270 270 ends inf 120\n",
      "100,-400 -; 165,-400 -; 165,-84 L>0; 165,184 -; 165,216 L>3; 165,584 -; "
      "165,900 -; 100,900 -; 100,584 L<3; 100,216 -; 100,184 L<0; 100,-84 -\n"
      "365,-120 E<1; 430,-120 L>1; 430,184 -; 430,216 L>4; 430,620 E>4; "
      "365,620 L<4; 365,216 -; 365,184 L<1\n"
      "700,-120 E<2; 765,-120 L>2; 765,184 -; 765,216 L>5; 765,620 E>5; "
      "700,620 L<5; 700,216 -; 700,184 L<2\n",
      "0,0 W<0; 265,0 W<1; 565,0 W<2; 900,0 -; 900,100 W>2; 565,100 W>1; "
      "265,100 W>0; 0,100 -\n"
      "0,300 W<3; 265,300 W<4; 565,300 W<5; 900,300 -; 900,500 W>5; "
      "565,500 W>4; 265,500 W>3; 0,500 -\n");
}

/* Test that an edge too short for two overhangs is divided equally. */
static void test_shared_poly(void) {
  drawing d = drawing_new();
  drawing_box(&d, "active", -100, -200, 200, -100);
  drawing_box(&d, "active", -100, 51, 200, 150);
  drawing_box(&d, "nimplant", -150, -250, 250, -50);
  drawing_box(&d, "pimplant", -150, 0, 250, 200);
  drawing_box(&d, "poly", 0, -300, 65, 250);
  segment_is(&d, "{}",
             "nx 0,-200 65x100 space 200 270 ends 100 inf\n"
             "px 0,51 65x99 space 200 270 ends inf 100\n",
             "0,-300 E<0; 65,-300 L>0; 65,-25 L>1; 65,250 E>1; 0,250 L<1; "
             "0,-25 L<0\n",
             "-100,-200 W<0; 200,-200 -; 200,-100 W>0; -100,-100 -\n"
             "-100,51 W<1; 200,51 -; 200,150 W>1; -100,150 -\n");
}

/* Test that a line end within `line_end` but beyond another gate does not
   belong to the transistor. */
static void test_near_end(void) {
  drawing d = drawing_new();
  drawing_box(&d, "active", -100, 0, 200, 100);
  drawing_box(&d, "active", -100, 200, 200, 300);
  drawing_box(&d, "active", -100, 400, 200, 500);
  drawing_box(&d, "nwell", -150, -50, 250, 550);
  drawing_box(&d, "poly", 0, -100, 65, 600);
  segment_is(&d, "{ line_end: 2000 nm }",
             "px 0,0 65x100 space 200 270 ends 100 inf\n"
             "px 0,200 65x100 space 200 270 ends inf inf\n"
             "px 0,400 65x100 space 200 270 ends inf 100\n",
             "0,-100 E<0; 65,-100 L>0; 65,150 L>1; 65,350 L>2; 65,600 E>2; "
             "0,600 L<2; 0,350 L<1; 0,150 L<0\n",
             "-100,0 W<0; 200,0 -; 200,100 W>0; -100,100 -\n"
             "-100,200 W<1; 200,200 -; 200,300 W>1; -100,300 -\n"
             "-100,400 W<2; 200,400 -; 200,500 W>2; -100,500 -\n");
}

/* Test a poly that turns right 50 nm beyond the active, with a field poly
   nearby. */
static void test_turning_poly(void) {
  drawing d = drawing_new();
  drawing_box(&d, "active", 0, 0, 400, 200);
  drawing_box(&d, "pwell", -500, -500, 900, 900);
  drawing_box(&d, "poly", 150, -60, 215, 600);
  drawing_box(&d, "poly", 215, 250, 700, 350);
  drawing_box(&d, "poly", 450, -60, 515, 150);
  segment_is(
      &d, "{}", "nx 150,0 65x200 space 300 235 ends 60 inf\n",
      "150,-60 E<0; 215,-60 L>0; 215,250 -; 700,250 -; 700,350 -; 215,350 -; "
      "215,600 -; 150,600 -; 150,284 L<0\n"
      "450,-60 -; 515,-60 -; 515,150 -; 450,150 -\n",
      "0,0 W<0; 400,0 -; 400,200 W>0; 0,200 -\n");
}

/* Test an active with a jog at the end of the poly: the edge of the active
   belongs to the gate up to the jog. A word line crosses the same active in the
   other direction. */
static void test_bent_active(void) {
  drawing d = drawing_new();
  drawing_box(&d, "active", 0, 0, 300, 200);
  drawing_box(&d, "active", 215, 0, 300, 700);
  drawing_box(&d, "pwell", -500, -500, 900, 900);
  drawing_box(&d, "poly", 150, -100, 215, 300);
  drawing_box(&d, "poly", 50, 400, 500, 465);
  segment_is(&d, "{}",
             "nx 150,0 65x200 space 300 170 ends 100 100\n"
             "ny 215,400 65x85 space 800 470 ends 165 200\n",
             "150,-100 E<0; 215,-100 L>0; 215,300 E>0; 150,300 L<0\n"
             "50,400 L<1; 500,400 E>1; 500,465 L>1; 50,465 E<1\n",
             "0,0 W<0; 300,0 W>1; 300,700 -; 215,700 W<1; 215,200 W>0; "
             "0,200 -\n");
}

/* ---- instances ---- */

static void test_instances(void) {
  drawing d = drawing_new();
  opc_error error;
  drawing inverter = d;
  inverter.cell = eda_layout_cell(d.layout, "INV", &error);
  drawing_box(&inverter, "active", 0, 0, 300, 100);
  drawing_box(&inverter, "active", 0, 400, 300, 600);
  drawing_box(&inverter, "nwell", -100, 300, 400, 700);
  drawing_box(&inverter, "poly", 100, -100, 165, 700);
  eda_placement p = {
      .origin = {1000, 0}, .magnification = 1, .columns = 1, .rows = 1};
  g_assert_cmpint(eda_layout_add_instance(d.layout, d.cell, inverter.cell, &p,
                                          "X1", &error),
                  ==, OPC_OK);
  p.origin = (eda_point){0, 1000};
  p.angle = 90;
  g_assert_cmpint(eda_layout_add_instance(d.layout, d.cell, inverter.cell, &p,
                                          "X2", &error),
                  ==, OPC_OK);
  /* The top cell draws poly over the active of X1. Its own active touches the
     active of X1 and covers an active of X2, where the active of the top cell
     comes first. */
  drawing_box(&d, "active", -100, 1000, 0, 1300);
  drawing_box(&d, "poly", 1230, -100, 1270, 200);
  drawing_box(&d, "active", 1300, 0, 1500, 100);
  drawing_box(&d, "poly", 1400, -100, 1440, 200);
  result r = layout_segment(d.layout, "{ top: TOP }");
  const eda_gates *g = r.gates;
  check_all(g);
  static const struct {
    const char *instance, *cell;
    unsigned number;
    int32_t x0, y0;
    int type, axis;
  } want[] = {
      {"X1", "INV", 1, 1100, 0, EDA_NMOS, EDA_X},
      {"X1", "INV", 2, 1230, 0, EDA_NMOS, EDA_X},
      {"", "TOP", 1, 1400, 0, EDA_NMOS, EDA_X},
      {"X1", "INV", 3, 1100, 400, EDA_PMOS, EDA_X},
      {"X2", "INV", 1, -600, 1100, EDA_PMOS, EDA_Y},
      {"", "TOP", 2, -100, 1100, EDA_NMOS, EDA_Y},
  };
  g_assert_cmpstr(g->name, ==, "TOP");
  g_assert_cmpuint(g->count, ==, G_N_ELEMENTS(want));
  for (size_t i = 0; i < g->count; i++) {
    g_assert_cmpstr(g->instance[i], ==, want[i].instance);
    g_assert_cmpstr(g->cell[i], ==, want[i].cell);
    g_assert_cmpuint(g->number[i], ==, want[i].number);
    g_assert_cmpint(g->box[i].x0, ==, want[i].x0);
    g_assert_cmpint(g->box[i].y0, ==, want[i].y0);
    g_assert_cmpint(g->type[i], ==, want[i].type);
    g_assert_cmpint(g->axis[i], ==, want[i].axis);
  }
  g_assert_cmpint(g->extent.x0, ==, -700);
  g_assert_cmpint(g->extent.x1, ==, 1500);
  result_free(&r);
  drawing_box(&inverter, "poly", 200, -50, 240, 50);
  assert_refused(&d, "{}", OPC_INVALID,
                 "transistor from (1200, 0) to (1270, 100) nm, cell 'INV', "
                 "instance 'X1': the gate is not a rectangle");
}

static void test_cancel(void) {
  drawing d = drawing_new();
  draw_single(&d);
  opc_test_cancel(TRUE);
  assert_refused(&d, "{}", OPC_CANCELLED, "cancelled");
  opc_test_cancel(FALSE);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/transistors/vertical", test_vertical);
  g_test_add_func("/transistors/lengths", test_lengths);
  g_test_add_func("/transistors/horizontal", test_horizontal);
  g_test_add_func("/transistors/figure-3.2", test_figure);
  g_test_add_func("/transistors/shared-poly", test_shared_poly);
  g_test_add_func("/transistors/narrow-active", test_narrow_active);
  g_test_add_func("/transistors/near-end", test_near_end);
  g_test_add_func("/transistors/turning-poly", test_turning_poly);
  g_test_add_func("/transistors/bent-active", test_bent_active);
  g_test_add_func("/transistors/instances", test_instances);
  g_test_add_func("/transistors/cancel", test_cancel);
  return g_test_run();
}
