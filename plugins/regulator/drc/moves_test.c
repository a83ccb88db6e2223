/* SPDX-License-Identifier: BSD-3-Clause */
/* What the regulator takes away and adds beyond a contact: lines that print as
   one, heads of line ends, jogs too near each other, on a 1 nm grid. The truth
   is a print that follows the mask by a rule of its own, and the mask itself.
 */
#include <eda/eda.h>

#include <math.h>
#include <string.h>

#include "core/plugin/host.h"
#include "core/testing/testing.h"

enum { STEP = 8, N = 250, MOST = 8 };

/* Poly, active and contacts, of which the last are not corrected. */
enum { CONTACT = 2, LAYERS = 3 };
static char *names[] = {"poly", "active", "contact"};
static uint8_t corrected[] = {1, 1, 0};

typedef struct chip {
  eda_point points[4 * MOST], moved[4 * MOST];
  uint32_t start[MOST + 1];
  eda_fragment fragments[4 * MOST];
  eda_point contact[4];
  eda_gates gates;
  eda_shapes shapes[LAYERS];
  eda_edges edges[LAYERS];
  eda_box box[1];
  uint8_t axis[1];
  double space[2], drawn[2], extension[2];
  uint32_t flags[1], veto[1];
  int32_t l[1], w[1], end[2];
  eda_field print[LAYERS];
  eda_shapes mask[LAYERS];
  eda_boxes patches[LAYERS], bites[LAYERS];
  eda_printed p;
  eda_ruling ruling;
} chip;

static void box_points(eda_point *p, int32_t x0, int32_t y0, int32_t x1,
                       int32_t y1) {
  p[0] = (eda_point){x0, y0};
  p[1] = (eda_point){x1, y0};
  p[2] = (eda_point){x1, y1};
  p[3] = (eda_point){x0, y1};
}

static void add_poly(chip *c, int32_t x0, int32_t y0, int32_t x1, int32_t y1) {
  size_t n = c->shapes[EDA_POLY].count++;
  box_points(c->points + 4 * n, x0, y0, x1, y1);
  for (size_t i = 4 * n; i < 4 * n + 4; i++)
    c->fragments[i] = (eda_fragment){.from = c->points[i], .gate = -1};
  c->start[n + 1] = 4 * (uint32_t)(n + 1);
}

static void add_contact(chip *c, int32_t x0, int32_t y0, int32_t x1,
                        int32_t y1) {
  static const uint32_t one[] = {0, 4};
  box_points(c->contact, x0, y0, x1, y1);
  c->shapes[CONTACT] = (eda_shapes){1, (uint32_t *)one, c->contact, NULL};
}

static void begin(chip *c) {
  eda_gates *g = &c->gates;
  g->grid = 1;
  g->extent = (eda_box){-500, -500, 1500, 1500};
  g->layers = LAYERS;
  g->layer = names;
  g->corrected = corrected;
  g->drawn = c->shapes;
  g->edges = c->edges;
  c->shapes[EDA_POLY].start = c->start;
  c->shapes[EDA_POLY].points = c->points;
  c->edges[EDA_POLY] =
      (eda_edges){c->shapes[EDA_POLY].count, c->start, c->fragments};
  c->mask[EDA_POLY] = c->shapes[EDA_POLY];
  c->p = (eda_printed){.gates = g,
                       .flags = c->flags,
                       .l = c->l,
                       .w = c->w,
                       .extension = c->extension,
                       .shapes = c->mask,
                       .print = c->print};
  c->ruling = (eda_ruling){.patches = c->patches, .bites = c->bites};
}

/* Print by a function that is positive where poly is. */
static void print(chip *c, double (*poly)(const chip *c, double x, double y)) {
  const opc_host *host = opc_test_host();
  for (int layer = 0; layer <= EDA_ACTIVE; layer++) {
    eda_field *f = &c->print[layer];
    eda_field_clear(f);
    *f = (eda_field){
        .frame = {-500, -500, STEP * N, STEP * N}, .nx = N, .ny = N};
    f->coefficients = eda_alloc(N * N, sizeof(float));
    for (int j = 0; j < N; j++)
      for (int i = 0; i < N; i++)
        f->coefficients[j * N + i] =
            layer == EDA_ACTIVE
                ? -60
                : (float)fmin(
                      fmax(poly(c, -500 + STEP * i, -500 + STEP * j), -60), 60);
    eda_field_from_samples(host->context, f);
  }
}

static void judge(opc_module *m, chip *c) {
  const eda_regulator *r = m->functions;
  opc_error error;
  c->ruling.vetoes = c->veto;
  c->ruling.end = c->end;
  c->veto[0] = 0;
  g_assert_cmpint(r->rule(m->self, &c->p, &c->ruling, &error), ==, OPC_OK);
}

static size_t violations(opc_module *m, chip *c, eda_violation *v,
                         size_t room) {
  const eda_regulator *r = m->functions;
  opc_error error;
  size_t n = 0;
  g_assert_cmpint(r->violations(m->self, &c->p, v, room, &n, &error), ==,
                  OPC_OK);
  return n;
}

static opc_module *make(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("regulator.drc", parameters, &error);
  g_assert_nonnull(m);
  return m;
}

static void end(chip *c) {
  for (int layer = 0; layer <= EDA_ACTIVE; layer++)
    eda_field_clear(&c->print[layer]);
}

/* ---- lines that print as one ---- */

/* How deep bites go from the edge y towards `down` at x. */
static int32_t bitten(const chip *c, double x, int32_t y, int down) {
  int32_t depth = 0;
  for (size_t i = 0; i < c->ruling.bites[EDA_POLY].count; i++) {
    eda_box b = c->ruling.bites[EDA_POLY].box[i];
    if (x < b.x0 || x > b.x1) continue;
    if (down ? b.y0 < y && b.y1 >= y : b.y1 > y && b.y0 <= y)
      depth = MAX(depth, down ? y - b.y0 : b.y1 - y);
  }
  return depth;
}

/* Two bars, y 0..100 and 196..296, which print as one while the mask leaves
   less than 120 nm between them. */
static double two_bars(const chip *c, double x, double y) {
  int32_t low = 100 - bitten(c, x, 100, 1), high = 196 + bitten(c, x, 196, 0);
  double bars = fmax(fmin(y, 100 - y), fmin(y - 196, 296 - y));
  if (x < 0 || x > 900) return -60;
  return high - low < 120 ? fmin(y, 296 - y) : bars;
}

/* Bars that print as one go back until they do not, but not over a contact, and
   not further than a mask may be narrow. Nothing that patches put before an
   edge stays there without it: each takes its half of the gap. */
static void test_trims(void) {
  static const struct {
    const char *parameters, *rule;
    int contact;
  } cases[] = {
      {"{}", NULL, 0},
      {"{ overlay: 5 nm, min_mask_width: 60 nm }",
       "bridging: poly; drawn too near for its edges to go back", 1},
      {"{ min_mask_width: 90 nm }",
       "bridging: poly; drawn too near for its edges to go back", 0},
  };
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    g_autoptr(opc_module) m = make(cases[k].parameters);
    chip c = {0};
    eda_violation v[40];
    int rounds = 0;
    add_poly(&c, 0, 0, 900, 100);
    add_poly(&c, 0, 196, 900, 296);
    if (cases[k].contact) add_contact(&c, 410, 10, 490, 94);
    begin(&c);
    for (; rounds < 20; rounds++) {
      size_t n = c.ruling.bites[EDA_POLY].count;
      int32_t before = bitten(&c, 200, 100, 1) + bitten(&c, 200, 196, 0);
      print(&c, two_bars);
      judge(m, &c);
      if (n == c.ruling.bites[EDA_POLY].count &&
          before == bitten(&c, 200, 100, 1) + bitten(&c, 200, 196, 0))
        break;
    }
    g_assert_cmpint(rounds, <, 8);
    size_t n = violations(m, &c, v, 40);
    if (!cases[k].rule) {
      g_assert_cmpuint(n, ==, 0);
      g_assert_cmpint(bitten(&c, 200, 100, 1), >=, 12);
      g_assert_cmpint(bitten(&c, 200, 100, 1), <=, 17);
    }
    for (size_t i = 0; i < n; i++) {
      g_assert_cmpstr(v[i].rule, ==, cases[k].rule);
      g_assert_true(!cases[k].contact || (v[i].x > 380 && v[i].x < 520));
    }
    if (cases[k].rule) g_assert_cmpuint(n, >, 0);
    for (size_t i = 0; i < c.ruling.bites[EDA_POLY].count; i++) {
      eda_box b = c.ruling.bites[EDA_POLY].box[i];
      g_assert_true(!cases[k].contact || b.y0 >= 148 || b.x1 <= 410 ||
                    b.x0 >= 490);
      g_assert_true(b.y0 == 148 || b.y1 == 148);
      if (k == 2) g_assert_cmpint(b.y1 - b.y0, <=, 48 + 5);
    }
    end(&c);
  }
}

/* The same bars, of which the lower one is gone where it loses more than 7
   nm. */
static double weak_bars(const chip *c, double x, double y) {
  if (x >= 0 && x <= 900 && bitten(c, x, 100, 1) > 7)
    return fmin(y - 196, 296 - y);
  return two_bars(c, x, y);
}

/* A line that is pinched where its edge went back gets that again, and the
   other side of the gap makes the room. */
static void test_pinched(void) {
  g_autoptr(opc_module) m = make("{}");
  chip c = {0};
  eda_violation v[1];
  add_poly(&c, 0, 0, 900, 100);
  add_poly(&c, 0, 196, 900, 296);
  begin(&c);
  for (int i = 0; i < 12; i++) {
    print(&c, weak_bars);
    judge(m, &c);
  }
  g_assert_cmpint(bitten(&c, 450, 100, 1), ==, 5);
  g_assert_cmpint(bitten(&c, 450, 196, 0), ==, 20);
  g_assert_cmpuint(violations(m, &c, v, 1), ==, 0);
  end(&c);
}

/* ---- patches ---- */

/* How far patches go beyond the right edge at x, at a height. */
static int32_t grown(const chip *c, int32_t x, double y) {
  int32_t by = 0;
  for (size_t i = 0; i < c->ruling.patches[EDA_POLY].count; i++) {
    eda_box b = c->ruling.patches[EDA_POLY].box[i];
    if (y >= b.y0 && y <= b.y1) by = MAX(by, b.x1 - x);
  }
  return by;
}

/* Two bars side by side that face each other above y 300, and join there where
   the left one grows. The contact is below. */
static double beside(const chip *c, double x, double y) {
  double left =
      fmin(fmin(x + 20, 104 + grown(c, 106, y) - x), fmin(y + 20, 620 - y));
  double right = fmin(fmin(x - 310, 500 - x), fmin(y - 300, 600 - y));
  double bridge = fmin(fmin(x, 500 - x), fmin(y - 350, 450 - y));
  double bars = fmax(left, right);
  return grown(c, 106, 400) > 0 ? fmax(bars, bridge) : bars;
}

/* An edge that closes a gap as a whole goes out only beside its contact. */
static void test_piece(void) {
  g_autoptr(opc_module) m = make("{}");
  chip c = {0};
  eda_violation v[1];
  add_poly(&c, 0, 0, 106, 600);
  add_poly(&c, 310, 300, 500, 600);
  add_contact(&c, 20, 30, 100, 110);
  begin(&c);
  print(&c, beside);
  judge(m, &c);
  g_assert_cmpint(grown(&c, 106, 400), >, 0); /* all of it, which is no jog */
  for (int i = 0; i < 6; i++) {
    print(&c, beside);
    judge(m, &c);
  }
  g_assert_cmpint(grown(&c, 106, 70), >=, 6);
  g_assert_cmpint(grown(&c, 106, 200), ==, 0);
  g_assert_cmpuint(violations(m, &c, v, 1), ==, 0);
  end(&c);
}

/* A bar that prints 5 nm short of what its contact needs on its left side and
   below, and follows the patches there. */
static double short_bar(const chip *c, double x, double y) {
  int32_t left = 0, below = 0;
  for (size_t i = 0; i < c->ruling.patches[EDA_POLY].count; i++) {
    eda_box b = c->ruling.patches[EDA_POLY].box[i];
    if (b.x1 < 100) left = MAX(left, -b.x0);
    if (b.x1 > 100) below = MAX(below, -b.y0);
  }
  double bar =
      fmin(fmin(x - 55 + left, 320 - x), fmin(y - 15 + below, 160 - y));
  return fmax(bar, fmin(fmin(x + 80, 15 - x), fmin(y + 85, -45 - y)));
}

/* The piece below ends before the corner, as a neighbour is there: what is on
   the left does not go out for it. */
static void test_corner(void) {
  g_autoptr(opc_module) m = make("{}");
  chip c = {0};
  int left = 0, below = 0;
  add_poly(&c, 0, 0, 300, 140);
  add_poly(&c, -80, -85, 15, -45);
  add_contact(&c, 60, 20, 140, 120);
  begin(&c);
  for (int i = 0; i < 4; i++) {
    print(&c, short_bar);
    judge(m, &c);
  }
  for (size_t i = 0; i < c.ruling.patches[EDA_POLY].count; i++) {
    eda_box b = c.ruling.patches[EDA_POLY].box[i];
    left += b.x0 < 0;
    below += b.y0 < 0;
    g_assert_false(b.x0 < 0 && b.y0 < 0);
  }
  g_assert_cmpint(left, ==, 1);
  g_assert_cmpint(below, ==, 1);
  end(&c);
}

/* A pad beside a line, printed 4 nm over its contact, or as far as a patch
   goes. */
static double pad(const chip *c, double x, double y) {
  int32_t top = 0;
  for (size_t i = 0; i < c->ruling.patches[EDA_POLY].count; i++)
    top = MAX(top, c->ruling.patches[EDA_POLY].box[i].y1 - 140);
  double box = fmin(fmin(x + 20, 171 - x), fmin(y + 20, 138 + top - y));
  return fmax(box, fmin(fmin(x - 100, 180 - x), fmin(y + 320, 520 - y)));
}

/* An edge that ends in a concave corner is no nearer to a neighbour for that:
   its patch fills the corner, and reaches into the line, which may have become
   narrower. */
static void test_concave(void) {
  static const int32_t xy[8][2] = {{0, 0},      {106, 0},   {106, -300},
                                   {171, -300}, {171, 500}, {106, 500},
                                   {106, 140},  {0, 140}};
  g_autoptr(opc_module) m = make("{}");
  chip c = {0};
  for (int i = 0; i < 8; i++) {
    c.points[i] = (eda_point){xy[i][0], xy[i][1]};
    c.fragments[i] = (eda_fragment){.from = c.points[i], .gate = -1};
  }
  c.start[1] = 8;
  c.shapes[EDA_POLY].count = 1;
  add_contact(&c, 20, 30, 96, 134);
  begin(&c);
  for (int i = 0; i < 3; i++) {
    print(&c, pad);
    judge(m, &c);
  }
  g_assert_cmpuint(c.ruling.patches[EDA_POLY].count, ==, 1);
  eda_box b = c.ruling.patches[EDA_POLY].box[0];
  g_assert_cmpint(b.y1, >=, 146);
  g_assert_cmpint(b.x0, ==, 0);
  g_assert_cmpint(b.x1, >, 106);
  g_assert_cmpint(b.x1, <, 171);
  end(&c);
}

static double plain_bar(const chip *c, double x, double y) {
  double bar =
      fmin(fmin(x + 20, 104 + grown(c, 106, y) - x), fmin(y + 20, 160 - y));
  return fmax(bar, fmin(fmin(x - 160, 300 - x), fmin(y - 145, 300 - y)));
}

/* A patch whose corner came too near to another one in the mask that printed
   leaves what its contact does not need. */
static void test_too_near(void) {
  g_autoptr(opc_module) m = make("{}");
  chip c = {0};
  add_poly(&c, 0, 0, 106, 140);
  add_poly(&c, 160, 145, 300, 300);
  add_contact(&c, 20, 30, 100, 110);
  begin(&c);
  print(&c, plain_bar);
  judge(m, &c);
  g_assert_cmpint(grown(&c, 106, 135), ==, 7); /* half of 54 - 40 */
  judge(m, &c);
  g_assert_cmpint(grown(&c, 106, 135), ==, 7);
  memcpy(c.moved, c.points, sizeof c.moved);
  c.moved[1].x = c.moved[2].x = 125; /* 35 nm from the other's corner */
  c.mask[EDA_POLY].points = c.moved;
  judge(m, &c);
  g_assert_cmpint(grown(&c, 106, 135), ==, 0);
  g_assert_cmpint(grown(&c, 106, 70), ==, 7);
  end(&c);
}

/* Two bars as above, whose lower one needs a patch for a contact, while that
   makes it print as one with the upper one. */
static double two_pads(const chip *c, double x, double y) {
  int32_t up = 0;
  for (size_t i = 0; i < c->ruling.patches[EDA_POLY].count; i++) {
    eda_box b = c->ruling.patches[EDA_POLY].box[i];
    if (x >= b.x0 && x <= b.x1) up = MAX(up, b.y1 - 100);
  }
  int32_t low = 100 + up - bitten(c, x, 100, 1);
  int32_t high = 196 + bitten(c, x, 196, 0);
  double bars = fmax(fmin(y + 30, low - 3 - y), fmin(y - high, 326 - y));
  if (x < 0 || x > 900) return -60;
  return high - low < 120 ? fmin(y + 30, 326 - y) : bars;
}

/* A patch that its contact wants again after it went back does so by less each
   time, and then edges go back that the contact does not need: the rule that is
   broken in the end is the contact's, and it has its reason. */
static void test_contested(void) {
  g_autoptr(opc_module) m = make("{}");
  chip c = {0};
  eda_violation v[10];
  add_poly(&c, 0, 0, 900, 100);
  add_poly(&c, 0, 196, 900, 296);
  add_contact(&c, 400, 14, 480, 94);
  begin(&c);
  for (int i = 0; i < 20; i++) {
    print(&c, two_pads);
    judge(m, &c);
  }
  print(&c, two_pads);
  size_t n = violations(m, &c, v, 10);
  g_assert_cmpuint(n, ==, 1);
  g_assert_cmpstr(v[0].rule, ==, "enclosure; too near a neighbour");
  g_assert_cmpint(bitten(&c, 440, 196, 0), >=, 20);
  g_assert_cmpint(bitten(&c, 440, 100, 1), ==, 0);
  end(&c);
}

/* ---- heads ---- */

/* A vertical line x 0..65, y 0..400, with a gate at y 100..300 and its line end
   at 400; another line's end `gap` above. */
static void add_end(chip *c, int32_t gap) {
  add_poly(c, 0, 0, 65, 400);
  add_poly(c, 0, 400 + gap, 65, 1200);
  c->fragments[2].gate = 0;
  c->fragments[2].role = EDA_END_HIGH;
  c->box[0] = (eda_box){0, 100, 65, 300};
  c->space[0] = c->space[1] = 500;
  c->drawn[0] = INFINITY;
  c->drawn[1] = 100;
  c->gates.count = 1;
  c->gates.box = c->box;
  c->gates.axis = c->axis;
  c->gates.space = c->space;
  c->gates.extension = c->drawn;
}

static double line_ends(const chip *c, double x, double y) {
  double low = fmin(fmin(x, 65 - x), 300 + c->extension[1] - y);
  return fmax(fmin(low, y), fmin(fmin(x, 65 - x), y - 520));
}

/* The mask as the last ruling sent the line end. */
static void follow(chip *c) {
  memcpy(c->moved, c->points, sizeof c->moved);
  c->moved[2].y = c->moved[3].y += c->end[1];
  c->mask[EDA_POLY].points = c->moved;
}

/* How much further a head goes out than the line, on each side; 0 for none. */
static int32_t head(const chip *c) {
  if (!c->ruling.patches[EDA_POLY].count) return 0;
  g_assert_cmpuint(c->ruling.patches[EDA_POLY].count, ==, 1);
  eda_box b = c->ruling.patches[EDA_POLY].box[0];
  g_assert_cmpint(-b.x0, ==, b.x1 - 65);
  g_assert_cmpint(b.y0, ==, 320); /* twice the overlay past the active */
  g_assert_cmpint(b.y1, ==, 400 + c->end[1]);
  return -b.x0;
}

/* A line end that prints by 0.7 of its own length, and by 3 nm for each nm of
   its head: length first, of the 40 nm that there are as much as thirds give,
and as much width as is then missing. */
static void test_heads(void) {
  static const struct {
    const char *parameters;
    int32_t gap, length;
    int widens;
  } cases[] = {
      {"{ min_extension: 20 nm, want_extension: 40 nm, max_head: 10 nm }", 80,
       40, 1},
      {"{ min_extension: 20 nm, want_extension: 40 nm }", 80, 40, 0},
      {"{ min_extension: 20 nm, want_extension: 30 nm, max_head: 10 nm }", 120,
       0, 0},
      {"{ min_extension: 38 nm, max_head: 10 nm }", 80, 40, 1},
  };
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    g_autoptr(opc_module) m = make(cases[k].parameters);
    chip c = {0};
    add_end(&c, cases[k].gap);
    begin(&c);
    for (int i = 0; i < 16; i++) {
      c.extension[0] = INFINITY;
      c.extension[1] = 2 + 0.7 * c.end[1] + 3 * head(&c);
      print(&c, line_ends);
      follow(&c);
      judge(m, &c);
    }
    if (cases[k].length) {
      g_assert_cmpint(c.end[1], >=, cases[k].length - 2);
      g_assert_cmpint(c.end[1], <=, cases[k].length);
    }
    g_assert_cmpint(head(&c) > 0, ==, cases[k].widens);
    if (cases[k].widens) {
      g_assert_cmpfloat(c.extension[1], >=, 38);
      g_assert_cmpint(head(&c), <=, 6);
    }
    g_assert_cmpuint(c.veto[0], ==, 0);
    end(&c);
  }
}

/* What the synthesizer asks for is given at any time: length, and a head where
   there is no length; but not more than it asks for. */
static void test_asked(void) {
  for (int k = 0; k < 3; k++) {
    g_autoptr(opc_module) m = make("{ min_extension: 20 nm }");
    const double want[2] = {0, 38}, wide[2] = {0, k == 2 ? 2 : 10};
    chip c = {0};
    add_end(&c, 80);
    begin(&c);
    if (k) c.p.want_extension = want, c.p.want_head = wide;
    for (int i = 0; i < 20; i++) {
      c.p.iteration = 10 + (uint32_t)i;
      c.extension[0] = INFINITY;
      c.extension[1] = 2 + 0.7 * c.end[1] + 3 * head(&c);
      print(&c, line_ends);
      follow(&c);
      judge(m, &c);
    }
    if (k)
      g_assert_cmpint(c.end[1], >=, 38);
    else
      g_assert_cmpfloat(c.extension[1], <, 25);
    if (k == 1) g_assert_cmpfloat(c.extension[1], >=, 38);
    g_assert_cmpint(head(&c), <=, k ? k == 2 ? 2 : 6 : 0);
    g_assert_cmpint(head(&c) > 0, ==, k > 0);
    end(&c);
  }
}

/* More than `min_extension` is not striven for where a neighbour prints within
   30 nm, and not once the synthesizer has moved its lengths. */
static void test_wishes(void) {
  for (int k = 0; k < 3; k++) {
    g_autoptr(opc_module) m = make(
        "{ min_extension: 20 nm, want_extension: 40 nm, max_head: 10 nm }");
    chip c = {0};
    add_end(&c, 300);
    begin(&c);
    c.extension[0] = INFINITY;
    c.extension[1] = k == 1 ? 195 : 25; /* 25 nm before the other's print */
    if (k == 1) c.extension[1] = 39.5, c.drawn[1] = 100;
    print(&c, line_ends);
    if (k == 1) { /* the other's print comes near */
      c.extension[1] = 195;
      print(&c, line_ends);
      c.extension[1] = 39.5;
    }
    c.p.iteration = k == 2 ? 3 : 0;
    judge(m, &c);
    g_assert_cmpint(c.end[1] > 0, ==, k == 0);
    end(&c);
  }
}

/* ---- jogs ---- */

static double wide_line(const chip *c, double x, double y) {
  (void)c, (void)y;
  return fmin(x + 5, 70 - x);
}

/* The mask of the ruling, made of `base` by booleans. */
static eda_shapes applied(const eda_shapes *base, const eda_ruling *r) {
  opc_error error;
  eda_shapes now, next;
  g_assert_cmpint(eda_boolean(EDA_OR, base, NULL, &now, &error), ==, OPC_OK);
  for (int k = 0; k < 2; k++) {
    const eda_boxes *b = k ? &r->bites[EDA_POLY] : &r->patches[EDA_POLY];
    for (size_t i = 0; i < b->count; i++) {
      eda_point q[4];
      uint32_t start[] = {0, 4};
      eda_shapes one = {1, start, q, NULL};
      box_points(q, b->box[i].x0, b->box[i].y0, b->box[i].x1, b->box[i].y1);
      g_assert_cmpint(
          eda_boolean(k ? EDA_NOT : EDA_OR, &now, &one, &next, &error), ==,
          OPC_OK);
      eda_shapes_clear(&now);
      now = next;
    }
  }
  return now;
}

/* Lines with random jogs of 1 to 3 nm: after a few prints the mask keeps its
   own rules, differs by little from what was asked for, and stays as it is. */
static void test_jogs(void) {
  for (uint32_t seed = 1; seed <= 30; seed++) {
    g_autoptr(opc_module) m = make("{}");
    g_autoptr(GRand) rand = g_rand_new_with_seed(seed);
    enum { JOGS = 12 };
    eda_point q[2 * JOGS + 2];
    uint32_t start[] = {0, 2 * JOGS + 2};
    chip c = {0};
    eda_violation v[10];
    int32_t y = 0, x = 65;
    size_t n = 0, settled = 0;
    q[n++] = (eda_point){0, 0};
    for (int i = 0; i < JOGS; i++) {
      q[n++] = (eda_point){x, y};
      y += g_rand_int_range(rand, 20, 90);
      q[n++] = (eda_point){x, y};
      x += g_rand_int_range(rand, 1, 4) * (g_rand_boolean(rand) ? 1 : -1);
    }
    q[n++] = (eda_point){0, y};
    eda_shapes base = {1, start, q, NULL};
    add_poly(&c, 0, 0, 65, y);
    begin(&c);
    print(&c, wide_line);
    eda_shapes mask = applied(&base, &c.ruling);
    for (int i = 0; i < 12 && settled < 2; i++) {
      c.mask[EDA_POLY] = mask;
      judge(m, &c);
      eda_shapes next = applied(&base, &c.ruling), differ;
      opc_error error;
      g_assert_cmpint(eda_boolean(EDA_XOR, &mask, &next, &differ, &error), ==,
                      OPC_OK);
      settled = differ.count ? 0 : settled + 1;
      eda_shapes_clear(&differ);
      eda_shapes_clear(&mask);
      mask = next;
    }
    g_assert_cmpuint(settled, ==, 2);
    c.mask[EDA_POLY] = mask;
    size_t all = violations(m, &c, v, 10);
    for (size_t i = 0; i < MIN(all, 10); i++) {
      g_test_message("seed %u: %s at %g, %g: %g", seed, v[i].rule, v[i].x,
                     v[i].y, v[i].value);
      g_assert_false(g_str_has_prefix(v[i].rule, "mask"));
    }
    gint64 more = eda_area2(&mask) - eda_area2(&base);
    g_assert_cmpint(ABS(more), <, 2 * 3 * 40 * JOGS);
    /* The jogs go, and with them what was mended. */
    eda_shapes plain = c.shapes[EDA_POLY];
    for (int i = 0; i < 4; i++) {
      eda_shapes_clear(&mask);
      mask = applied(&plain, &c.ruling);
      c.mask[EDA_POLY] = mask;
      judge(m, &c);
    }
    g_assert_cmpint(eda_area2(&mask), ==, eda_area2(&plain));
    eda_shapes_clear(&mask);
    end(&c);
  }
}

static double bar(const chip *c, double x, double y) {
  (void)c;
  return 5 + fmin(fmin(x, 400 - x), fmin(y, 200 - y));
}

/* A bar with a notch (or a bump) of 30 nm, `depth` deep, in its upper edge. */
static void notched(eda_point q[8], int bump, int32_t depth) {
  int32_t bottom = 200 + (bump ? depth : -depth);
  const eda_point all[] = {{0, 0},        {400, 0},      {400, 200}, {230, 200},
                           {230, bottom}, {200, bottom}, {200, 200}, {0, 200}};
  memcpy(q, all, sizeof all);
}

/* What is mended stays so while the edge within the notch moves on, by what a
   synthesizer moves at a time: no slit opens behind it, no sliver is left. As
   deep as it may be wide it is one, deeper it has a meaning. */
static void test_moving_jogs(void) {
  for (int bump = 0; bump < 2; bump++)
    for (int32_t depth = 5; depth <= 46; depth++) {
      g_autoptr(opc_module) m = make("{ min_space: 40 nm }");
      uint32_t start[] = {0, 8};
      eda_point q[8];
      eda_shapes base = {1, start, q, NULL};
      chip c = {0};
      eda_violation v[10];
      add_poly(&c, 0, 0, 400, 200);
      begin(&c);
      print(&c, bar);
      notched(q, bump, depth);
      c.mask[EDA_POLY] = base;
      judge(m, &c);
      for (int i = 1; i < 3; i++) {
        notched(q, bump, depth + 9 * i);
        eda_shapes mask = applied(&base, &c.ruling);
        c.mask[EDA_POLY] = mask;
        size_t n = violations(m, &c, v, 10), wrong = 0;
        for (size_t k = 0; k < MIN(n, 10); k++)
          wrong += g_str_has_prefix(v[k].rule, "mask");
        g_assert_cmpint(!wrong, ==, depth <= 40);
        if (!wrong) g_assert_cmpint(eda_area2(&mask), ==, 2 * 400 * 200);
        judge(m, &c);
        eda_shapes_clear(&mask);
      }
      end(&c);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/trims", test_trims);
  g_test_add_func("/regulator/pinched", test_pinched);
  g_test_add_func("/regulator/piece", test_piece);
  g_test_add_func("/regulator/corner", test_corner);
  g_test_add_func("/regulator/concave", test_concave);
  g_test_add_func("/regulator/too-near", test_too_near);
  g_test_add_func("/regulator/contested", test_contested);
  g_test_add_func("/regulator/heads", test_heads);
  g_test_add_func("/regulator/asked", test_asked);
  g_test_add_func("/regulator/wishes", test_wishes);
  g_test_add_func("/regulator/jogs", test_jogs);
  g_test_add_func("/regulator/moving-jogs", test_moving_jogs);
  return g_test_run();
}
