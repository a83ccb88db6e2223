/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the limits of the regulator, each against a distance drawn in the test
   or against arithmetic. */
#include "chip_test.h"

/* ---- line ends ---- */

static void rule_alone(opc_module *m, chip *c, double extension) {
  c->p.print = NULL;
  c->extension[0] = INFINITY;
  c->extension[1] = extension;
  chip_judge(m, c);
}

/* The first displacement assumes 0.8 nm of printed image per nm of mask, the
   second uses the measured response, at least 0.3. The target is 1 nm above 20,
   and the largest displacement is 60 nm. */
static void test_response(void) {
  static const struct {
    double first, second;
    int32_t to, then;
  } cases[] = {{5, 15, 20, 20 + 12},     /* 16 / 0.8; 6 / 0.5 */
               {5, 6, 20, 20 + 50},      /* 15 / 0.3 */
               {5, -20, 20, 20 + 60},    /* 41 / 0.3 */
               {-100, -10, 60, 60 + 21}, /* 31 / 1.5 */
               {19.5, 19.9, 2, 2 + 4}};  /* 1.1 / 0.3 */
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) m =
        drc_make("{ min_extension: 20 nm, max_growth: 300 nm }");
    chip c = {0};
    add_end(&c, 700);
    chip_begin(&c);
    rule_alone(m, &c, cases[i].first);
    g_assert_cmpint(c.end[1], ==, cases[i].to);
    rule_alone(m, &c, cases[i].second);
    g_assert_cmpint(c.end[1], ==, cases[i].then);
  }
}

/* Defaults follow wavelength / NA: at 248 nm, NA 0.7 the overlay is 0.039 *
   354.3 = 14 nm, the extension of a line end 28 nm, and the largest move 0.233
     354.3 = 83 nm. At 193 nm and NA 0.75, the extension is 20 nm and the
   largest move 60 nm. */
static void test_follows(void) {
  static const struct {
    eda_scanner scanner;
    double least;
    int32_t most;
  } cases[] = {{{248, 0.7}, 28, 83}, {{193, 0.75}, 20, 60}, {{0, 0}, 20, 60}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (int kept = 0; kept < 2; kept++) {
      g_autoptr(opc_module) m = drc_make("{}");
      chip c = {0};
      add_end(&c, 700);
      chip_begin(&c);
      c.p.scanner = cases[i].scanner;
      for (int k = 0; k < 8; k++)
        rule_alone(m, &c, cases[i].least + (kept ? 0.1 : -1000));
      g_assert_cmpint(c.end[1], ==, kept ? 0 : cases[i].most);
    }
}

/* A line end keeps min_space to a contact. */
static void test_end_before_contact(void) {
  for (int32_t d = 35; d < 90; d += 9) {
    g_autoptr(opc_module) m =
        drc_make("{ min_space: 40 nm, max_growth: 60 nm }");
    chip c = {0};
    add_end(&c, 700);
    add_contact(&c, 0, 400 + d, 65, 480 + d);
    chip_begin(&c);
    for (int i = 0; i < 8; i++) rule_alone(m, &c, 5);
    g_assert_cmpint(c.end[1], ==, CLAMP(d - 40, 0, 60));
  }
}

static double two_lines(const chip *c, double x, double y) {
  double other = fmin(fmin(x - 145, 210 - x), fmin(y, 1000 - y));
  return fmax(line_ends(c, x, y), other);
}

/* A head keeps min_space to contacts and active, and uses half of the spacing
   to another line. */
static void test_head_beside(void) {
  enum { LINE, CONTACTS, ACTIVES, KINDS };
  for (int kind = 0; kind < KINDS; kind++) {
    static const uint32_t one[] = {0, 4};
    g_autoptr(opc_module) m = drc_make("{ min_space: 40 nm, max_head: 30 nm }");
    eda_point q[4];
    chip c = {0};
    add_end(&c, 50);
    if (kind == LINE) add_poly(&c, 145, 0, 210, 1000);
    if (kind == CONTACTS) add_contact(&c, 125, 330, 205, 410);
    box_points(q, 125, 330, 400, 410);
    if (kind == ACTIVES)
      c.shapes[EDA_ACTIVE] = (eda_shapes){1, (uint32_t *)one, q, NULL};
    chip_begin(&c);
    c.mask[EDA_ACTIVE] = c.shapes[EDA_ACTIVE];
    c.extension[0] = INFINITY;
    c.extension[1] = 5;
    for (int i = 0; i < 12; i++) {
      chip_print(&c, kind == LINE ? two_lines : line_ends);
      chip_judge(m, &c);
    }
    g_assert_cmpint(head_width(&c), ==, 20);
    chip_end(&c);
  }
}

/* ---- contacts ---- */

/* Return the level set of a pad with cut corners. */
static double octagon(const chip *c, double x, double y) {
  (void)c;
  return 80 - fabs(x - 60) - fabs(y - 70);
}

/* Return the level set of the half plane x + y < 285. Its edge is outside of
   the contact whose lower left corner is (140, 150), but less than the overlay
   away. */
static double slope(const chip *c, double x, double y) {
  (void)c;
  return (285 - x - y) / sqrt(2);
}

/* Coverage is checked away from corners, which print round; clearance is
   checked at corners too. */
static void test_corners(void) {
  g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm }");
  eda_violation v[4];
  chip c = {0}, d = {0};
  add_poly(&c, 0, 0, 120, 140);
  add_contact(&c, 20, 30, 100, 110);
  chip_begin(&c);
  chip_print(&c, octagon);
  chip_judge(m, &c);
  g_assert_cmpuint(drc_violations(m, &c, v, 4), ==, 0);
  chip_end(&c);
  g_autoptr(opc_module) n = drc_make("{ overlay: 10 nm }");
  add_poly(&d, 0, 0, 100, 100);
  add_contact(&d, 140, 150, 220, 230);
  chip_begin(&d);
  chip_print(&d, slope);
  chip_judge(n, &d);
  g_assert_cmpuint(drc_violations(n, &d, v, 4), ==, 1);
  g_assert_cmpstr(v[0].rule, ==, "bridging: contact");
  chip_end(&d);
}

/* Return the level set of a pad that prints 4 nm beyond the contact on the
   right, and follows repair shapes. */
static double short_pad(const chip *c, double x, double y) {
  return fmin(fmin(x + 20, 104 + added_extent(c, 106, 70) - x),
              fmin(y + 20, 160 - y));
}

/* A repair shape of poly keeps min_space to contacts that poly must not touch,
   and to active. */
static void test_added_beside(void) {
  for (int active = 0; active < 2; active++)
    for (int32_t d = 38; d < 60; d += 3) {
      static const uint32_t one[] = {0, 4}, two[] = {0, 4, 8};
      g_autoptr(opc_module) m = drc_make("{ min_space: 40 nm }");
      eda_point q[4], p[8];
      chip c = {0};
      add_poly(&c, 0, 0, 106, 140);
      box_points(p, 20, 30, 100, 110);
      box_points(p + 4, 106 + d, 30, 186 + d, 110);
      box_points(q, 106 + d, 0, 300, 140);
      chip_begin(&c);
      c.shapes[CONTACT] =
          (eda_shapes){active ? 1 : 2, (uint32_t *)two, p, NULL};
      if (active)
        c.shapes[EDA_ACTIVE] = c.mask[EDA_ACTIVE] =
            (eda_shapes){1, (uint32_t *)one, q, NULL};
      for (int i = 0; i < 5; i++) {
        chip_print(&c, short_pad);
        chip_judge(m, &c);
      }
      int32_t spacing = MAX(d - 40, 0), wanted = 7; /* the repair shape extends
                                                       1 nm further than
                                                       required */
      g_assert_cmpint(added_extent(&c, 106, 70), <=, MIN(spacing, wanted + 2));
      g_assert_cmpint(added_extent(&c, 106, 70), >=, MIN(spacing, wanted));
      chip_end(&c);
    }
}

/* ---- trims ---- */

/* Return the level set of lines that bridge while the mask space is below 120
   nm. */
static double close_bars(const chip *c, double x, double y) {
  int32_t low = 100 - cutout_depth(c, x, 100, 1),
          high = 196 + cutout_depth(c, x, 196, 0);
  double bars = fmax(fmin(y, low - y), fmin(y - high, 296 - y));
  if (x < 0 || x > 900) return -60;
  return high - low < 120 ? fmin(y, 296 - y) : bars;
}

/* Edges close to a gate, and up to 20 nm beside the gate, do not move. */
static void test_before_gate(void) {
  for (int32_t top = 10; top < 100; top += 20) {
    g_autoptr(opc_module) m = drc_make("{}");
    chip c = {0};
    add_poly(&c, 0, 0, 900, 100);
    add_poly(&c, 0, 196, 900, 296);
    c.box[0] = (eda_box){300, 0, 600, top};
    c.space[0] = c.space[1] = 500;
    c.extension[0] = c.extension[1] = INFINITY;
    c.gates.count = 1;
    c.gates.box = c.box;
    c.gates.axis = c.axis;
    c.gates.space = c.space;
    chip_begin(&c);
    for (int i = 0; i < 12; i++) {
      chip_print(&c, close_bars);
      chip_judge(m, &c);
    }
    for (int32_t x = 281; x < 620; x += 26)
      g_assert_cmpint(cutout_depth(&c, x, 100, 1), ==, 0);
    g_assert_cmpint(cutout_depth(&c, 640, 100, 1), >, 0);
    g_assert_cmpint(cutout_depth(&c, 260, 100, 1), >, 0);
    g_assert_cmpint(cutout_depth(&c, 450, 196, 0), >=, 24);
    chip_end(&c);
  }
}

/* y of the middle of a waist, a part only 20 nm wide, in the line of a gate. */
static double waist;
static double waisted(const chip *c, double x, double y) {
  double half = fabs(y - waist) < 36 ? 10 : 32.5;
  return fmin(fmin(half - fabs(x - 32.5), 300 + c->extension[1] - y), y + 400);
}

/* A gate is measured separately and does not count as a line that is too
   narrow. */
static void test_waist(void) {
  static const struct {
    double at;
    int found;
  } cases[] = {{-150, 1}, {160, 0}, {200, 0}, {240, 0}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    g_autoptr(opc_module) m = drc_make("{ min_width: 40 nm }");
    eda_violation v[MOST];
    chip c = {0};
    int found = 0;
    add_end(&c, 600);
    for (int i = 0; i < 2; i++) /* the waist begins further down */
      c.points[i].y = c.fragments[i].from.y = -400;
    chip_begin(&c);
    c.extension[1] = 100;
    waist = cases[k].at;
    chip_print(&c, waisted);
    chip_judge(m, &c);
    size_t n = drc_violations(m, &c, v, MOST);
    for (size_t i = 0; i < MIN(n, MOST); i++)
      found |= g_str_has_prefix(v[i].rule, "pinching") && v[i].y < 390;
    g_assert_cmpint(found, ==, cases[k].found);
    chip_end(&c);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/response", test_response);
  g_test_add_func("/regulator/follows", test_follows);
  g_test_add_func("/regulator/end-before-contact", test_end_before_contact);
  g_test_add_func("/regulator/head-beside", test_head_beside);
  g_test_add_func("/regulator/corners", test_corners);
  g_test_add_func("/regulator/added-beside", test_added_beside);
  g_test_add_func("/regulator/before-gate", test_before_gate);
  g_test_add_func("/regulator/waist", test_waist);
  return g_test_run();
}
