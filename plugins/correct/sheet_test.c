/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests covering by clips, placement on sheets, and the symmetry of the
   optics. */
#include <environments/sheet.c>

#include <correct/symmetry.h>
#include "tools/devel/testing.h"

#define maker halver /* both included files define a type of this name */
#include <environments/align.c>
#include <environments/cover.c>
#undef maker

enum { PLACES = 9 };

static uint32_t state = 5;

static int32_t by_lot(int32_t low, int32_t high) {
  state = state * 1664525u + 1013904223u;
  return low + (int32_t)((state >> 8) % (uint32_t)(high - low + 1));
}

/* ---- cover ---- */

/* Return the box of places, extended by `reach`. */
static eda_box box_of(const eda_box *places, unsigned set, int32_t reach) {
  eda_box b = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (unsigned k = 0; k < PLACES; k++) {
    if (!(set >> k & 1)) continue;
    b.x0 = MIN(b.x0, places[k].x0 - reach);
    b.y0 = MIN(b.y0, places[k].y0 - reach);
    b.x1 = MAX(b.x1, places[k].x1 + reach);
    b.y1 = MAX(b.y1, places[k].y1 + reach);
  }
  return b;
}

/* Return the smaller of two areas: that of one clip around a set of places, and
   that of the clips after a bisection of the set across its longer side. */
static double least_area(const eda_box *places, unsigned set, int32_t reach,
                         int32_t most) {
  eda_box b = box_of(places, set, reach);
  int32_t w = b.x1 - b.x0, h = b.y1 - b.y0;
  unsigned low = 0;
  for (unsigned k = 0; k < PLACES; k++) {
    eda_box p = places[k];
    if (set >> k & 1 &&
        (w >= h ? p.x0 + p.x1 < b.x0 + b.x1 : p.y0 + p.y1 < b.y0 + b.y1))
      low |= 1u << k;
  }
  double whole = w <= most && h <= most ? (double)w * h : INFINITY;
  if (!low || low == set) return (double)w * h;
  return fmin(whole, least_area(places, low, reach, most) +
                         least_area(places, set & ~low, reach, most));
}

static void test_cover(void) {
  size_t clips = 0;
  for (int n = 0; n < 200; n++) {
    eda_box places[PLACES];
    int32_t reach = by_lot(0, 60), most = by_lot(150, 1100);
    for (int k = 0; k < PLACES; k++) {
      int32_t x = by_lot(-500, 500), y = by_lot(-300, 300);
      places[k] = (eda_box){x, y, x + by_lot(1, 90), y + by_lot(1, 90)};
    }
    cover c;
    cover_make(places, PLACES, reach, most, &c);
    unsigned all = 0;
    double area = 0;
    for (size_t i = 0; i < c.count; i++) {
      unsigned set = 0;
      for (size_t k = 0; k < c.clip[i].count; k++)
        set |= 1u << c.place[c.clip[i].first + k];
      g_assert_cmpuint(all & set, ==, 0);
      all |= set;
      eda_box want = box_of(places, set, reach);
      g_assert_cmpmem(&c.clip[i].box, sizeof want, &want, sizeof want);
      area += area_of(want);
      if (set & (set - 1)) {
        g_assert_cmpint(want.x1 - want.x0, <=, most);
        g_assert_cmpint(want.y1 - want.y0, <=, most);
      }
    }
    g_assert_cmpuint(all, ==, (1u << PLACES) - 1);
    g_assert_cmpfloat(area, ==,
                      least_area(places, (1u << PLACES) - 1, reach, most));
    clips += c.count;
    cover_clear(&c);
  }
  g_assert_cmpuint(clips, >, 400);
  g_assert_cmpuint(clips, <, 1750);
}

/* ---- sheets ---- */

static void test_pages(void) {
  enum { CLIPS = 40, MOST = 1000, GAP = 30 };
  for (int n = 0; n < 50; n++) {
    clip clips[CLIPS] = {{{0}, 0, 0}};
    cover c = {.clip = clips, .count = CLIPS};
    double area[CLIPS] = {0}, all = 0;
    for (int i = 0; i < CLIPS; i++) {
      eda_box b = {by_lot(-900, 900), by_lot(-900, 900), 0, 0};
      b.x1 = b.x0 + by_lot(50, i ? 600 : 1300);
      b.y1 = b.y0 + by_lot(50, i == 1 ? 1300 : 600);
      clips[i].box = b;
      all += area_of(b);
    }
    pages p;
    pages_make(&c, MOST, GAP, &p);
    eda_box at[CLIPS];
    for (int i = 0; i < CLIPS; i++) {
      eda_box b = clips[i].box;
      eda_point o = p.corner[i];
      g_assert_cmpuint(p.page[i], <, p.count);
      at[i] = (eda_box){o.x, o.y, o.x + b.x1 - b.x0, o.y + b.y1 - b.y0};
      g_assert_true(!o.x || at[i].x1 <= MOST);
      g_assert_true(!o.y || at[i].y1 <= MOST);
      g_assert_true(o.x >= 0 && o.y >= 0);
      area[p.page[i]] += area_of(b);
      for (int k = 0; k < i; k++)
        g_assert_true(p.page[i] != p.page[k] || at[i].x0 >= at[k].x1 + GAP ||
                      at[k].x0 >= at[i].x1 + GAP ||
                      at[i].y0 >= at[k].y1 + GAP || at[k].y0 >= at[i].y1 + GAP);
    }
    for (size_t k = 0; k < p.count; k++)
      g_assert_cmpfloat(p.area[k], ==, area[k]);
    /* Clips cover at least a third of each sheet except the last one. */
    g_assert_cmpfloat((double)(p.count - 1) * MOST * MOST / 3, <, all);
    pages_clear(&p);
  }
}

/* ---- orientations ---- */

static void test_orientations(void) {
  static const struct {
    const char *points;
    int orientations;
  } cases[] = {{"0, 0, 1", 8},
               {"0.5, 0, 1, -0.5, 0, 1, 0, 0.5, 1, 0, -0.5, 1", 8},
               {"0.5, 0, 1, -0.5, 0, 1", 4},
               {"0.4, 0.2, 1, -0.4, 0.2, 1, 0.4, -0.2, 1, -0.4, -0.2, 1", 4},
               {"0.5, 0.5, 1, -0.5, -0.5, 1", 1},
               /* In focus, opposite source points have the same effect. */
               {"0.5, 0, 1, -0.5, 0, 1, 0, 0.5, 1", 4}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error;
    g_autofree char *p =
        g_strdup_printf("{ source: points, points: [%s] }", cases[i].points);
    g_autoptr(opc_module) m = opc_test_module("litho.abbe", p, &error);
    if (!m) g_error("%s", error.message);
    const eda_litho *litho = m->functions;
    int orientations = 0;
    g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
    g_assert_cmpint(correct_symmetry_find(opc_test_host()->context, m,
                                          &orientations, &error),
                    ==, OPC_OK);
    g_assert_cmpint(orientations, ==, cases[i].orientations);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/pieces/cover", test_cover);
  g_test_add_func("/pieces/pages", test_pages);
  g_test_add_func("/pieces/ways", test_orientations);
  return g_test_run();
}
