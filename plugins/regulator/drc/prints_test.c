/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests rules of printed images, and repairs, on synthetic images. */
#include "boxes_test.h"

#include <eda/rules.h>
#include <stdlib.h>

/* A contact in a pad whose right side prints 4 nm past the contact; 10 nm are
   required. A repair shape displaces the entire side until the printed side
   satisfies the rule. */
static void test_enclosure(void) {
  g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm }");
  chip c = {0};
  eda_violation v;
  add_box(&c.drawn[EDA_POLY], 0, 0, 106, 140);
  add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
  add_box(&c.printed[EDA_POLY], -10, -10, 104, 150);
  chip_show(&c);
  chip_judge(m, &c);
  g_assert_cmpuint(c.ruling.added[EDA_ACTIVE].count, ==, 0);
  g_assert_cmpuint(c.ruling.added[EDA_POLY].count, ==, 1);
  eda_box added = c.ruling.added[EDA_POLY].box[0];
  g_assert_cmpint(added.y0, ==, 0);
  g_assert_cmpint(added.y1, ==, 140);
  g_assert_cmpint(added.x1, >=, 112);
  g_assert_cmpint(added.x1, <=, 116);
  g_assert_cmpuint(drc_violations(m, &c.p, &v, 1), ==, 1);
  g_assert_cmpstr(v.rule, ==, "enclosure: could still move");
  g_assert_cmpfloat(fabs(v.value - 4), <, 0.5);
  g_assert_cmpfloat(v.limit, ==, 10);
  g_assert_cmpfloat(v.x, ==, 60);
  c.printed[EDA_POLY].points[1].x = c.printed[EDA_POLY].points[2].x = 111;
  chip_show(&c);
  chip_judge(m, &c);
  g_assert_cmpuint(c.ruling.added[EDA_POLY].count, ==, 1); /* the shape is
                                                              unchanged */
  g_assert_cmpint(c.ruling.added[EDA_POLY].box[0].x1, ==, added.x1);
  g_assert_cmpuint(drc_violations(m, &c.p, &v, 1), ==, 0);
  chip_end(&c);
}

/* The same contact with a neighbour 46 nm away: the side can move by 3 nm; then
   the adjacent sides are displaced to extend its corners. */
static void test_near_neighbour(void) {
  g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm, min_space: 40 nm }");
  chip c = {0};
  eda_violation v;
  add_box(&c.drawn[EDA_ACTIVE], 0, 0, 106, 140);
  add_box(&c.drawn[EDA_ACTIVE], 152, 0, 400, 140);
  add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
  add_box(&c.printed[EDA_ACTIVE], -10, -10, 104, 150);
  chip_show(&c);
  chip_judge(m, &c);
  g_assert_cmpuint(c.ruling.added[EDA_ACTIVE].count, ==, 1);
  g_assert_cmpint(c.ruling.added[EDA_ACTIVE].box[0].x1, ==, 109);
  chip_judge(m, &c);
  g_assert_cmpuint(c.ruling.added[EDA_ACTIVE].count, ==, 3);
  drc_violations(m, &c.p, &v, 1);
  g_assert_cmpstr(v.rule, ==, "enclosure: could still move");
  for (int i = 0; i < 12; i++) chip_judge(m, &c);
  for (size_t i = 0; i < 3; i++)
    g_assert_cmpint(c.ruling.added[EDA_ACTIVE].box[i].x1, ==, 109);
  g_assert_cmpuint(drc_violations(m, &c.p, &v, 1), ==, 1);
  g_assert_cmpstr(v.rule, ==, "enclosure; too near a neighbour");
  chip_end(&c);
}

/* Beside a shape of another layer that needs no repair, a repair shape ends at
   min_space: the drawn spacing of 46 nm less 40 nm allows 6 nm. */
static void test_near_other_layer(void) {
  for (int layer = EDA_POLY; layer <= EDA_ACTIVE; layer++) {
    g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm, min_space: 40 nm }");
    chip c = {0};
    add_box(&c.drawn[layer], 0, 0, 106, 140);
    add_box(&c.drawn[!layer], 152, 0, 400, 140);
    add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
    add_box(&c.printed[layer], -10, -10, 104, 150);
    add_box(&c.printed[!layer], 152, 0, 400, 140);
    chip_show(&c);
    for (int i = 0; i < 12; i++) chip_judge(m, &c);
    int32_t right = 0;
    for (size_t i = 0; i < c.ruling.added[layer].count; i++)
      if (c.ruling.added[layer].box[i].x1 > right)
        right = c.ruling.added[layer].box[i].x1;
    g_assert_cmpint(right, ==, 112);
    chip_end(&c);
  }
}

/* Set the mask of poly to the drawn shapes, the added shapes and `more`,
   merged. The caller frees the mask. Return the number of edges below 20 nm. */
static size_t mask_with(chip *c, eda_box more) {
  boxes added = {0};
  add_box(&added, more.x0, more.y0, more.x1, more.y1);
  eda_rule_fault *fault;
  opc_error error;
  for (size_t i = 0; i < c->ruling.added[EDA_POLY].count; i++) {
    eda_box b = c->ruling.added[EDA_POLY].box[i];
    add_box(&added, b.x0, b.y0, b.x1, b.y1);
  }
  g_assert_cmpint(eda_boolean(EDA_OR, &c->shapes[EDA_POLY], &added.shapes,
                              &c->mask[EDA_POLY], &error),
                  ==, OPC_OK);
  const double limit[EDA_RULES] = {[EDA_RULE_EDGE] = 20};
  size_t n = eda_rules_check(&c->mask[EDA_POLY], 1, limit, &fault);
  free(fault);
  return n;
}

static size_t mask_follow(chip *c) {
  return mask_with(c, c->ruling.added[EDA_POLY].box[0]);
}

/* The right edge of a line is displaced beside a contact, but not over its
   whole length, because of a neighbour. A synthesizer sets a jog above or below
   the shape. If the edge between the shape and the jog is below min_edge, the
   shape extends to the jog. */
static void test_jog_near_shape(void) {
  /* The line with its pad, and the neighbour. */
  static const eda_point drawn[] = {
      {0, -200}, {65, -200}, {65, 400},  {0, 400},   {0, 97},    {-85, 97},
      {-85, 0},  {0, 0},     {100, 250}, {300, 250}, {300, 400}, {100, 400}};
  for (int k = 0; k < 4; k++) {
    g_autoptr(opc_module) m =
        drc_make("{ overlay: 10 nm, min_edge: 20 nm, min_space: 40 nm }");
    chip c = {0};
    boxes *poly = &c.drawn[EDA_POLY];
    memcpy(poly->points, drawn, sizeof drawn);
    poly->start[1] = 8;
    poly->start[2] = G_N_ELEMENTS(drawn);
    poly->shapes = (eda_shapes){2, poly->start, poly->points, NULL};
    add_box(&c.drawn[CONTACT], -25, 7, 59, 91);
    add_box(&c.printed[EDA_POLY], -95, -200, 65, 400);
    chip_show(&c);
    chip_judge(m, &c);
    g_assert_cmpuint(c.ruling.added[EDA_POLY].count, ==, 1);
    eda_box b = c.ruling.added[EDA_POLY].box[0];
    g_assert_cmpint(b.y0, >, -150);
    g_assert_cmpint(b.y1, <, 200);
    int32_t away = k & 1 ? 30 : 9;
    eda_box jog = k & 2 ? (eda_box){40, -200, 66, b.y0 - away}
                        : (eda_box){40, b.y1 + away, 66, 400};
    g_assert_cmpuint(mask_with(&c, jog), ==, !(k & 1));
    chip_judge(m, &c);
    eda_shapes_clear(&c.mask[EDA_POLY]);
    eda_box to = c.ruling.added[EDA_POLY].box[0];
    g_assert_cmpint(to.y0, ==, k == 2 ? jog.y1 : b.y0);
    g_assert_cmpint(to.y1, ==, k == 0 ? jog.y0 : b.y1);
    g_assert_cmpuint(mask_with(&c, jog), ==, 0);
    eda_shapes_clear(&c.mask[EDA_POLY]);
    chip_end(&c);
  }
}

/* A pad at the right of a line, and a contact that extends over the concave
   corner into the line. The two edges of the corner are equally near to the
   contact. For any first point of the polygon, the shapes below and at the
   right of the contact leave no edge below min_edge on the mask. */
static void test_concave_corner(void) {
  static const eda_point drawn[] = {{0, -200}, {65, -200}, {65, 0},   {150, 0},
                                    {150, 97}, {65, 97},   {65, 400}, {0, 400}};
  enum { POINTS = G_N_ELEMENTS(drawn) };
  size_t before = 0;
  for (size_t first = 0; first < POINTS; first++) {
    g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm, min_edge: 20 nm }");
    chip c = {0};
    boxes *poly = &c.drawn[EDA_POLY];
    for (size_t i = 0; i < POINTS; i++)
      poly->points[i] = drawn[(first + i) % POINTS];
    poly->start[1] = POINTS;
    poly->shapes = (eda_shapes){1, poly->start, poly->points, NULL};
    add_box(&c.drawn[CONTACT], 59, 7, 143, 91);
    add_box(&c.printed[EDA_POLY], 0, -200, 65, 400);
    add_box(&c.printed[EDA_POLY], 50, 3, 147, 107);
    chip_show(&c);
    chip_judge(m, &c);
    g_assert_cmpuint(c.ruling.added[EDA_POLY].count, ==, 2);
    c.printed[EDA_POLY].points[4] = (eda_point){50, -5};
    c.printed[EDA_POLY].points[6].x = 155;
    chip_show(&c);
    before += mask_follow(&c);
    chip_judge(m, &c);
    eda_shapes_clear(&c.mask[EDA_POLY]);
    g_test_message("first point %zu", first);
    g_assert_cmpuint(mask_follow(&c), ==, 0);
    eda_shapes_clear(&c.mask[EDA_POLY]);
    chip_end(&c);
  }
  g_assert_cmpuint(before, >, 0);
}

/* Draw an active whose lower and upper edges are the ends of a gate width. */
static void width_chip(chip *c) {
  static uint32_t start[] = {0, 4};
  static eda_fragment active[] = {{{0, 0}, 0, EDA_W_LOW},
                                  {{106, 0}, -1, EDA_FIXED},
                                  {{106, 140}, 0, EDA_W_HIGH},
                                  {{0, 140}, -1, EDA_FIXED}};
  *c = (chip){.edges[EDA_ACTIVE] = {1, start, active}};
  add_box(&c->drawn[EDA_ACTIVE], 0, 0, 106, 140);
}

/* The lower and upper edges of an active are the ends of a gate width. The
   repair shape on the right side ends with these edges at any shift, and
   vanishes where the edges meet. */
static void test_width(void) {
  static const struct {
    int32_t w, aside, low, high;
  } cases[] = {{0, 0, 0, 140},    {9, 0, -4, 145},   {9, 4, 0, 149},
               {8, -7, -11, 137}, {-139, 0, 70, 71}, {-140, 0, 0, 0},
               {-150, 0, 75, 65}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm }");
    chip c;
    width_chip(&c);
    add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
    add_box(&c.printed[EDA_ACTIVE], -10, -10, 104, 150);
    chip_show(&c);
    c.p.w = &cases[i].w;
    c.p.aside = &cases[i].aside;
    chip_judge(m, &c);
    size_t n = cases[i].low < cases[i].high;
    g_assert_cmpuint(c.ruling.added[EDA_ACTIVE].count, ==, n);
    eda_box b = n ? c.ruling.added[EDA_ACTIVE].box[0] : (eda_box){0};
    g_assert_cmpint(b.y0, ==, n ? cases[i].low : 0);
    g_assert_cmpint(b.y1, ==, n ? cases[i].high : 0);
    chip_end(&c);
  }
}

/* Poly in front of an active edge prevents its repair. If a narrower gate has
   displaced that edge inwards, the regulator vetoes a narrower gate; not if the
   edge is as drawn, and not if the other edge has moved. */
static void test_width_veto(void) {
  static const struct {
    int32_t w, aside, poly;
    uint32_t veto;
  } cases[] = {{-6, 0, 150, EDA_VETO_NARROWER},
               {0, 0, 150, 0},
               {-6, 3, 150, 0},
               {6, 0, 150, 0},
               {2, -3, 150, EDA_VETO_NARROWER},
               {-6, 0, 400, 0}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm, min_space: 40 nm }");
    chip c;
    width_chip(&c);
    add_box(&c.drawn[EDA_POLY], 0, cases[i].poly, 106, 500);
    add_box(&c.drawn[CONTACT], 20, 30, 80, 110);
    add_box(&c.printed[EDA_ACTIVE], -10, -10, 104, 115);
    add_box(&c.printed[EDA_POLY], 0, cases[i].poly, 106, 500);
    chip_show(&c);
    c.p.w = &cases[i].w;
    c.p.aside = &cases[i].aside;
    chip_judge(m, &c);
    g_assert_cmpuint(c.veto[0], ==, cases[i].veto);
    chip_end(&c);
  }
}

/* A contact in active, 6 nm away from printed poly. */
static void test_contact(void) {
  g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm }");
  chip c = {0};
  eda_violation v;
  add_box(&c.drawn[EDA_ACTIVE], -100, -100, 300, 300);
  add_box(&c.drawn[EDA_POLY], 0, -200, 65, 400);
  add_box(&c.drawn[CONTACT], 110, 60, 190, 140);
  add_box(&c.printed[EDA_ACTIVE], -100, -100, 300, 300);
  add_box(&c.printed[EDA_POLY], 0, -200, 104, 400);
  chip_show(&c);
  chip_judge(m, &c);
  g_assert_cmpuint(drc_violations(m, &c.p, &v, 1), ==, 1);
  g_assert_cmpstr(v.rule, ==, "bridging: contact");
  g_assert_cmpfloat(fabs(v.value - 6), <, 0.5);
  c.printed[EDA_POLY].points[1].x = c.printed[EDA_POLY].points[2].x = 99;
  chip_show(&c);
  chip_judge(m, &c);
  g_assert_cmpuint(drc_violations(m, &c.p, &v, 1), ==, 0);
  chip_end(&c);
}

/* A line of 60 nm with a neck of 24 nm: repair shapes widen the neck on both
   sides, and nowhere else. */
static void test_neck(void) {
  g_autoptr(opc_module) m = drc_make("{ min_width: 40 nm }");
  chip c = {0};
  eda_violation v[4];
  add_box(&c.drawn[EDA_POLY], 0, 0, 60, 1000);
  add_box(&c.printed[EDA_POLY], 0, 0, 60, 450);
  add_box(&c.printed[EDA_POLY], 18, 400, 42, 600);
  add_box(&c.printed[EDA_POLY], 0, 550, 60, 1000);
  chip_show(&c);
  chip_judge(m, &c);
  size_t n = drc_violations(m, &c.p, v, 4);
  g_assert_cmpuint(n, >=, 1);
  g_assert_cmpuint(n, <=, 2);
  for (size_t i = 0; i < n; i++) {
    g_assert_cmpstr(v[i].rule, ==, "pinching: could still move");
    g_assert_cmpfloat(fabs(v[i].value - 24), <, 1);
    g_assert_cmpfloat(fabs(v[i].y - 500), <=, 60);
    g_assert_cmpfloat(v[i].x, ==, 30);
  }
  g_assert_cmpuint(c.ruling.added[EDA_POLY].count, ==, 2 * n);
  for (size_t i = 0; i < 2 * n; i++) {
    eda_box b = c.ruling.added[EDA_POLY].box[i];
    g_assert_cmpint(b.y0, >, 380);
    g_assert_cmpint(b.y1, <, 620);
    g_assert_true((b.x1 >= 69 && b.x1 <= 75) || (b.x0 <= -9 && b.x0 >= -15));
  }
  /* A line that is wide enough but displaced from the drawn centre is no
     violation. */
  c.printed[EDA_POLY].points[5].x = c.printed[EDA_POLY].points[6].x = 60;
  chip_show(&c);
  g_assert_cmpuint(drc_violations(m, &c.p, v, 4), ==, 0);
  /* The line vanishes. */
  c.printed[EDA_POLY].shapes.count = 1;
  chip_show(&c);
  g_assert_cmpuint(drc_violations(m, &c.p, v, 4), >=, 4);
  g_assert_cmpfloat(v[3].value, ==, 0);
  chip_end(&c);
}

/* The repair does not widen the printed neck: the repair shapes end at
   max_growth or, with a neighbour at a distance of 46 nm on one or both sides,
   at min_space. */
static void test_stuck_neck(void) {
  for (int k = 0; k < 4; k++) {
    g_autoptr(opc_module) m =
        drc_make("{ min_width: 40 nm, min_space: 40 nm, max_growth: 15 nm }");
    chip c = {0};
    eda_violation v[4];
    boxes *both[] = {&c.drawn[EDA_POLY], &c.printed[EDA_POLY]};
    for (int i = 0; i < 2; i++) {
      if (k & 1) add_box(both[i], -106, 0, -46, 1000);
      if (k & 2) add_box(both[i], 106, 0, 166, 1000);
    }
    add_box(&c.drawn[EDA_POLY], 0, 0, 60, 1000);
    add_box(&c.printed[EDA_POLY], 0, 0, 60, 450);
    add_box(&c.printed[EDA_POLY], 18, 400, 42, 600);
    add_box(&c.printed[EDA_POLY], 0, 550, 60, 1000);
    chip_show(&c);
    for (int i = 0; i < 12; i++) chip_judge(m, &c);
    size_t n = drc_violations(m, &c.p, v, 4);
    g_assert_true(n >= 1 && n <= 2);
    for (size_t i = 0; i < n; i++)
      g_assert_cmpstr(v[i].rule, ==,
                      k ? "pinching; too near a neighbour"
                        : "pinching; max_growth reached");
    chip_end(&c);
  }
}

/* Two lines that bridge over half of their length. */
static void test_gap(void) {
  g_autoptr(opc_module) m = drc_make("{}");
  chip c = {0};
  eda_violation v[10];
  add_box(&c.drawn[EDA_POLY], 0, 0, 60, 600);
  add_box(&c.drawn[EDA_POLY], 180, 0, 240, 600);
  add_box(&c.printed[EDA_POLY], 0, 0, 60, 600);
  add_box(&c.printed[EDA_POLY], 180, 0, 240, 600);
  chip_show(&c);
  g_assert_cmpuint(drc_violations(m, &c.p, v, 10), ==, 0);
  add_box(&c.printed[EDA_POLY], 0, 0, 240, 300);
  chip_show(&c);
  size_t n = drc_violations(m, &c.p, v, 10);
  g_assert_cmpuint(n, ==, 5); /* one site per 60 nm */
  for (size_t i = 0; i < n; i++) {
    g_assert_cmpstr(v[i].rule, ==, "bridging: poly: could still move");
    g_assert_cmpfloat(v[i].x, ==, 120);
    g_assert_cmpfloat(v[i].y, <, 300);
  }
  chip_end(&c);
}

/* The same on a layer after active, where coverage of a contact by only 4 nm is
   no violation. */
static void test_metal(void) {
  g_autoptr(opc_module) m = drc_make("{ overlay: 10 nm }");
  chip c = {0};
  eda_violation v[20];
  add_box(&c.drawn[METAL], 0, 0, 106, 600);
  add_box(&c.drawn[METAL], 230, 0, 300, 600);
  add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
  add_box(&c.printed[METAL], -10, 0, 104, 600);
  add_box(&c.printed[METAL], 230, 0, 300, 600);
  add_box(&c.printed[METAL], 50, 300, 260, 500);
  chip_show(&c);
  chip_judge(m, &c);
  g_assert_cmpuint(c.ruling.added[EDA_POLY].count, ==, 0);
  g_assert_cmpuint(c.ruling.added[METAL].count, ==, 0);
  size_t n = drc_violations(m, &c.p, v, 20);
  g_assert_cmpuint(n, ==, 3); /* one site per 60 nm */
  for (size_t i = 0; i < n; i++) {
    g_assert_cmpstr(v[i].rule, ==, "bridging: metal1");
    g_assert_cmpfloat(v[i].x, ==, 168);
    g_assert_cmpfloat(fabs(v[i].y - 400), <, 100);
  }
  chip_end(&c);
}

/* Without a printed image only gates and line ends are checked. */
static void test_no_print(void) {
  g_autoptr(opc_module) m = drc_make("{}");
  chip c = {0};
  eda_violation v;
  add_box(&c.drawn[EDA_POLY], 0, 0, 106, 140);
  add_box(&c.drawn[CONTACT], 20, 30, 100, 110);
  chip_show(&c);
  c.p.shapes = NULL;
  c.p.print = NULL;
  chip_judge(m, &c);
  g_assert_cmpuint(c.ruling.added[EDA_POLY].count, ==, 0);
  g_assert_cmpuint(drc_violations(m, &c.p, &v, 1), ==, 0);
  chip_end(&c);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/enclosure", test_enclosure);
  g_test_add_func("/regulator/concave-corner", test_concave_corner);
  g_test_add_func("/regulator/jog-near-shape", test_jog_near_shape);
  g_test_add_func("/regulator/width", test_width);
  g_test_add_func("/regulator/width-veto", test_width_veto);
  g_test_add_func("/regulator/near_neighbour", test_near_neighbour);
  g_test_add_func("/regulator/near-other-layer", test_near_other_layer);
  g_test_add_func("/regulator/contact", test_contact);
  g_test_add_func("/regulator/neck", test_neck);
  g_test_add_func("/regulator/stuck-neck", test_stuck_neck);
  g_test_add_func("/regulator/gap", test_gap);
  g_test_add_func("/regulator/metal", test_metal);
  g_test_add_func("/regulator/no_print", test_no_print);
  return g_test_run();
}
