/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests trims and repair shapes: lines that bridge, repair shapes that compete
   for a place. The reference is a printed image that follows the mask by a
   different formula. */
#include "chip_test.h"

/* ---- bridged lines ---- */

/* Return the level set of two lines, y 0..100 and 196..296, that bridge while
   the mask space is below 120 nm. */
static double two_bars(const chip *c, double x, double y) {
  int32_t low = 100 - cutout_depth(c, x, 100, 1),
          high = 196 + cutout_depth(c, x, 196, 0);
  double bars = fmax(fmin(y, 100 - y), fmin(y - 196, 296 - y));
  if (x < 0 || x > 900) return -60;
  return high - low < 120 ? fmin(y, 296 - y) : bars;
}

/* Edges of bridged lines move inwards until the lines separate, but not past a
   contact, and not below min_mask_width. Shapes added in front of an edge are
   cut out, too: each edge owns half of the gap. */
static void test_trims(void) {
  static const struct {
    const char *parameters, *rule;
    int contact;
  } cases[] = {
      {"{}", NULL, 0},
      {"{ overlay: 5 nm, min_mask_width: 60 nm }",
       "bridging: poly; drawn too close to trim its edges", 1},
      {"{ min_mask_width: 90 nm }",
       "bridging: poly; drawn too close to trim its edges", 0},
  };
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    g_autoptr(opc_module) m = drc_make(cases[k].parameters);
    chip c = {0};
    eda_violation v[40];
    int rounds = 0;
    add_poly(&c, 0, 0, 900, 100);
    add_poly(&c, 0, 196, 900, 296);
    if (cases[k].contact) add_contact(&c, 410, 10, 490, 94);
    chip_begin(&c);
    for (; rounds < 20; rounds++) {
      size_t n = c.ruling.cutouts[EDA_POLY].count;
      int32_t before =
          cutout_depth(&c, 200, 100, 1) + cutout_depth(&c, 200, 196, 0);
      chip_print(&c, two_bars);
      chip_judge(m, &c);
      if (n == c.ruling.cutouts[EDA_POLY].count &&
          before ==
              cutout_depth(&c, 200, 100, 1) + cutout_depth(&c, 200, 196, 0))
        break;
    }
    g_assert_cmpint(rounds, <, 8);
    size_t n = drc_violations(m, &c, v, 40);
    if (!cases[k].rule) {
      g_assert_cmpuint(n, ==, 0);
      g_assert_cmpint(cutout_depth(&c, 200, 100, 1), >=, 12);
      g_assert_cmpint(cutout_depth(&c, 200, 100, 1), <=, 17);
    }
    for (size_t i = 0; i < n; i++) {
      g_assert_cmpstr(v[i].rule, ==, cases[k].rule);
      g_assert_true(!cases[k].contact || (v[i].x > 380 && v[i].x < 520));
    }
    if (cases[k].rule) g_assert_cmpuint(n, >, 0);
    for (size_t i = 0; i < c.ruling.cutouts[EDA_POLY].count; i++) {
      eda_box b = c.ruling.cutouts[EDA_POLY].box[i];
      g_assert_true(!cases[k].contact || b.y0 >= 148 || b.x1 <= 410 ||
                    b.x0 >= 490);
      g_assert_true(b.y0 == 148 || b.y1 == 148);
      if (k == 2) g_assert_cmpint(b.y1 - b.y0, <=, 48 + 5);
    }
    chip_end(&c);
  }
}

/* Return the level set of the same two lines. The lower line vanishes where
   more than 7 nm are cut out. */
static double weak_bars(const chip *c, double x, double y) {
  if (x >= 0 && x <= 900 && cutout_depth(c, x, 100, 1) > 7)
    return fmin(y - 196, 296 - y);
  return two_bars(c, x, y);
}

/* A line pinched by a trim regains the drawn edge, and the other side of the
   gap moves instead. */
static void test_pinched(void) {
  g_autoptr(opc_module) m = drc_make("{}");
  chip c = {0};
  eda_violation v[1];
  add_poly(&c, 0, 0, 900, 100);
  add_poly(&c, 0, 196, 900, 296);
  chip_begin(&c);
  for (int i = 0; i < 12; i++) {
    chip_print(&c, weak_bars);
    chip_judge(m, &c);
  }
  g_assert_cmpint(cutout_depth(&c, 450, 100, 1), ==, 5);
  g_assert_cmpint(cutout_depth(&c, 450, 196, 0), ==, 20);
  g_assert_cmpuint(drc_violations(m, &c, v, 1), ==, 0);
  chip_end(&c);
}

/* ---- repair shapes ---- */

/* Return the level set of two lines side by side that face each other above y
   300 and bridge where the left one grows. The contact is below. */
static double beside(const chip *c, double x, double y) {
  double left = fmin(fmin(x + 20, 104 + added_extent(c, 106, y) - x),
                     fmin(y + 20, 620 - y));
  double right = fmin(fmin(x - 310, 500 - x), fmin(y - 300, 600 - y));
  double bridge = fmin(fmin(x, 500 - x), fmin(y - 350, 450 - y));
  double bars = fmax(left, right);
  return added_extent(c, 106, 400) > 0 ? fmax(bars, bridge) : bars;
}

/* An edge whose full length closes a gap moves outwards only beside the
   contact. */
static void test_segment(void) {
  g_autoptr(opc_module) m = drc_make("{}");
  chip c = {0};
  eda_violation v[1];
  add_poly(&c, 0, 0, 106, 600);
  add_poly(&c, 310, 300, 500, 600);
  add_contact(&c, 20, 30, 100, 110);
  chip_begin(&c);
  chip_print(&c, beside);
  chip_judge(m, &c);
  g_assert_cmpint(added_extent(&c, 106, 400), >, 0); /* the whole edge moves,
                                                        without a jog */
  for (int i = 0; i < 6; i++) {
    chip_print(&c, beside);
    chip_judge(m, &c);
  }
  g_assert_cmpint(added_extent(&c, 106, 70), >=, 6);
  g_assert_cmpint(added_extent(&c, 106, 200), ==, 0);
  g_assert_cmpuint(drc_violations(m, &c, v, 1), ==, 0);
  chip_end(&c);
}

/* Return the level set of a line that prints 5 nm less than the contact needs
   on the left and below, and follows repair shapes there. */
static double short_bar(const chip *c, double x, double y) {
  int32_t left = 0, below = 0;
  for (size_t i = 0; i < c->ruling.added[EDA_POLY].count; i++) {
    eda_box b = c->ruling.added[EDA_POLY].box[i];
    if (b.x1 < 100) left = MAX(left, -b.x0);
    if (b.x1 > 100) below = MAX(below, -b.y0);
  }
  double bar =
      fmin(fmin(x - 55 + left, 320 - x), fmin(y - 15 + below, 160 - y));
  return fmax(bar, fmin(fmin(x + 80, 15 - x), fmin(y + 85, -45 - y)));
}

/* The segment below ends before the corner because of a neighbour, so the left
   side does not extend around the corner. */
static void test_corner(void) {
  g_autoptr(opc_module) m = drc_make("{}");
  chip c = {0};
  int left = 0, below = 0;
  add_poly(&c, 0, 0, 300, 140);
  add_poly(&c, -80, -85, 15, -45);
  add_contact(&c, 60, 20, 140, 120);
  chip_begin(&c);
  for (int i = 0; i < 4; i++) {
    chip_print(&c, short_bar);
    chip_judge(m, &c);
  }
  for (size_t i = 0; i < c.ruling.added[EDA_POLY].count; i++) {
    eda_box b = c.ruling.added[EDA_POLY].box[i];
    left += b.x0 < 0;
    below += b.y0 < 0;
    g_assert_false(b.x0 < 0 && b.y0 < 0);
  }
  g_assert_cmpint(left, ==, 1);
  g_assert_cmpint(below, ==, 1);
  chip_end(&c);
}

/* Return the level set of a pad beside a line, printed 4 nm past the contact,
   or as far as a repair shape. */
static double pad(const chip *c, double x, double y) {
  int32_t top = 0;
  for (size_t i = 0; i < c->ruling.added[EDA_POLY].count; i++)
    top = MAX(top, c->ruling.added[EDA_POLY].box[i].y1 - 140);
  double box = fmin(fmin(x + 20, 171 - x), fmin(y + 20, 138 + top - y));
  return fmax(box, fmin(fmin(x - 100, 180 - x), fmin(y + 320, 520 - y)));
}

/* A concave corner does not reduce the spacing of an edge: the repair shape
   fills the corner and overlaps the line, which may have become narrower. */
static void test_concave(void) {
  static const int32_t xy[8][2] = {{0, 0},      {106, 0},   {106, -300},
                                   {171, -300}, {171, 500}, {106, 500},
                                   {106, 140},  {0, 140}};
  g_autoptr(opc_module) m = drc_make("{}");
  chip c = {0};
  for (int i = 0; i < 8; i++) {
    c.points[i] = (eda_point){xy[i][0], xy[i][1]};
    c.fragments[i] = (eda_fragment){.from = c.points[i], .gate = -1};
  }
  c.start[1] = 8;
  c.shapes[EDA_POLY].count = 1;
  add_contact(&c, 20, 30, 96, 134);
  chip_begin(&c);
  for (int i = 0; i < 3; i++) {
    chip_print(&c, pad);
    chip_judge(m, &c);
  }
  g_assert_cmpuint(c.ruling.added[EDA_POLY].count, ==, 1);
  eda_box b = c.ruling.added[EDA_POLY].box[0];
  g_assert_cmpint(b.y1, >=, 146);
  g_assert_cmpint(b.x0, ==, 0);
  g_assert_cmpint(b.x1, >, 106);
  g_assert_cmpint(b.x1, <, 171);
  chip_end(&c);
}

static double plain_bar(const chip *c, double x, double y) {
  double bar = fmin(fmin(x + 20, 104 + added_extent(c, 106, y) - x),
                    fmin(y + 20, 160 - y));
  return fmax(bar, fmin(fmin(x - 160, 300 - x), fmin(y - 145, 300 - y)));
}

/* A repair shape whose corner was too close to another corner of the last mask
   is reduced, as far as the contact permits. */
static void test_too_near(void) {
  g_autoptr(opc_module) m = drc_make("{}");
  chip c = {0};
  add_poly(&c, 0, 0, 106, 140);
  add_poly(&c, 160, 145, 300, 300);
  add_contact(&c, 20, 30, 100, 110);
  chip_begin(&c);
  chip_print(&c, plain_bar);
  chip_judge(m, &c);
  g_assert_cmpint(added_extent(&c, 106, 135), ==, 7); /* half of 54 - 40 */
  chip_judge(m, &c);
  g_assert_cmpint(added_extent(&c, 106, 135), ==, 7);
  memcpy(c.moved, c.points, sizeof c.moved);
  c.moved[1].x = c.moved[2].x = 125; /* the corner is now 35 nm from the other
                                        corner */
  c.mask[EDA_POLY].points = c.moved;
  chip_judge(m, &c);
  g_assert_cmpint(added_extent(&c, 106, 135), ==, 0);
  g_assert_cmpint(added_extent(&c, 106, 70), ==, 7);
  chip_end(&c);
}

/* Return the level set of two lines as above. The lower line needs a repair
   shape for a contact, and that shape bridges the lines. */
static double two_pads(const chip *c, double x, double y) {
  int32_t up = 0;
  for (size_t i = 0; i < c->ruling.added[EDA_POLY].count; i++) {
    eda_box b = c->ruling.added[EDA_POLY].box[i];
    if (x >= b.x0 && x <= b.x1) up = MAX(up, b.y1 - 100);
  }
  int32_t low = 100 + up - cutout_depth(c, x, 100, 1);
  int32_t high = 196 + cutout_depth(c, x, 196, 0);
  double bars = fmax(fmin(y + 30, low - 3 - y), fmin(y - high, 326 - y));
  if (x < 0 || x > 900) return -60;
  return high - low < 120 ? fmin(y + 30, 326 - y) : bars;
}

/* A repair shape that was reduced, but that the contact requires, grows again
   by less each time. Then edges that no contact requires move inwards. The
   violation of the contact remains, with its cause. */
static void test_contested(void) {
  g_autoptr(opc_module) m = drc_make("{}");
  chip c = {0};
  eda_violation v[10];
  add_poly(&c, 0, 0, 900, 100);
  add_poly(&c, 0, 196, 900, 296);
  add_contact(&c, 400, 14, 480, 94);
  chip_begin(&c);
  for (int i = 0; i < 20; i++) {
    chip_print(&c, two_pads);
    chip_judge(m, &c);
  }
  chip_print(&c, two_pads);
  size_t n = drc_violations(m, &c, v, 10);
  g_assert_cmpuint(n, ==, 1);
  g_assert_cmpstr(v[0].rule, ==, "enclosure; too near a neighbour");
  g_assert_cmpint(cutout_depth(&c, 440, 196, 0), >=, 20);
  g_assert_cmpint(cutout_depth(&c, 440, 100, 1), ==, 0);
  chip_end(&c);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/trims", test_trims);
  g_test_add_func("/regulator/pinched", test_pinched);
  g_test_add_func("/regulator/piece", test_segment);
  g_test_add_func("/regulator/corner", test_corner);
  g_test_add_func("/regulator/concave", test_concave);
  g_test_add_func("/regulator/too-near", test_too_near);
  g_test_add_func("/regulator/contested", test_contested);
  return g_test_run();
}
