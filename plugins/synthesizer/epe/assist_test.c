/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests assist features beside edges: places, widths and spaces. */
#include "trial_test.h"

/* ---- assist features ---- */

static eda_shapes as_shapes(GArray *boxes, int32_t grown, uint32_t **start,
                            eda_point **points) {
  *start = g_new0(uint32_t, boxes->len + 1);
  *points = g_new(eda_point, 4 * boxes->len + 1);
  for (guint i = 0; i < boxes->len; i++) {
    eda_box b = g_array_index(boxes, eda_box, i);
    eda_point p[] = {{b.x0 - grown, b.y0 - grown},
                     {b.x1 + grown, b.y0 - grown},
                     {b.x1 + grown, b.y1 + grown},
                     {b.x0 - grown, b.y1 + grown}};
    memcpy(*points + (size_t)4 * i, p, sizeof p);
    (*start)[i + 1] = 4 * i + 4;
  }
  return (eda_shapes){boxes->len, *start, *points, NULL};
}

/* Return the area of the grown assist features within `in`. */
static int64_t covered_area(GArray *srafs, int32_t grown,
                            const eda_shapes *in) {
  g_autofree uint32_t *start = NULL;
  g_autofree eda_point *points = NULL;
  eda_shapes b = as_shapes(srafs, grown, &start, &points), both;
  opc_error error;
  g_assert_cmpint(eda_boolean(EDA_AND, &b, in, &both, &error), ==, 0);
  int64_t area = eda_area2(&both) / 2;
  eda_shapes_clear(&both);
  return area;
}

static GArray *srafs_of(const trial *t) {
  GArray *srafs = g_array_new(FALSE, FALSE, sizeof(eda_box));
  if (t->cuts.assists.count)
    g_array_append_vals(srafs, t->cuts.assists.box,
                        (guint)t->cuts.assists.count);
  return srafs;
}

static int has_sraf(const trial *t, int32_t x0, int32_t y0, int32_t x1,
                    int32_t y1) {
  for (size_t i = 0; i < t->cuts.assists.count; i++) {
    eda_box b = t->cuts.assists.box[i];
    if (b.x0 == x0 && b.y0 == y0 && b.x1 == x1 && b.y1 == y1) return 1;
  }
  return 0;
}

#define BARS                                                            \
  "assist_width: 40 nm, assist_distance: 110 nm, assist_space: 60 nm, " \
  "assist_min_length: 60 nm, iterations: 0"

/* A line with assist features beside the sides and the ends; the longer
   features are placed first. With `assist: 2` there is a second row. A space
   that is too narrow has no feature. */
static void test_assists(void) {
  const eda_box boxes[] = {{0, 0, 65, 1000}, {0, 0, 65, 1000}};
  g_autoptr(shapes) s = make_shapes(boxes, 1);
  trial t = trial_correct("{ assist: 1, assist_overhang: 0 nm, " BARS " }",
                          &s->gates, straight);
  g_assert_cmpuint(t.cuts.assists.count, ==, 4);
  g_assert_true(has_sraf(&t, -150, 0, -110, 1000));
  g_assert_true(has_sraf(&t, 175, 0, 215, 1000));
  g_assert_true(has_sraf(&t, 0, -150, 65, -110));
  g_assert_true(has_sraf(&t, 0, 1110, 65, 1150));
  trial_clear(&t);
  t = trial_correct("{ assist: 2, assist_overhang: 150 nm, " BARS " }",
                    &s->gates, straight);
  g_assert_cmpuint(t.cuts.assists.count, ==, 8);
  g_assert_true(has_sraf(&t, -150, -150, -110, 1150));
  g_assert_true(has_sraf(&t, -250, -150, -210, 1150));
  g_assert_true(has_sraf(&t, -50, -150, 115, -110));
  g_assert_true(has_sraf(&t, -50, -250, 115, -210) ||
                has_sraf(&t, -150, -250, 215, -210));
  trial_clear(&t);
  t = trial_correct("{ " BARS " }", &s->gates, straight);
  g_assert_cmpuint(t.cuts.assists.count, ==, 0);
  trial_clear(&t);
  /* The second line is 259 nm away, then 260 nm. */
  for (int more = 0; more < 2; more++) {
    const eda_box two[] = {{0, 0, 65, 1000}, {324 + more, 0, 400 + more, 1000}};
    g_autoptr(shapes) pair = make_shapes(two, 2);
    t = trial_correct("{ assist: 1, assist_overhang: 0 nm, " BARS " }",
                      &pair->gates, straight);
    g_assert_cmpint(has_sraf(&t, 175, 0, 215, 1000), ==, more);
    g_assert_cmpuint(t.cuts.assists.count, ==, 6 + (size_t)more);
    trial_clear(&t);
  }
}

/* Assist features keep their distance to drawn shapes and to each other.
   Shifted edges keep min_space to assist features, even with random feedback.
 */
static void test_assists_apart(void) {
  int found = 0, pressed = 0;
  for (uint32_t seed = 1; seed < 9; seed++) {
    g_autoptr(shapes) s = messy(seed);
    trial t = trial_correct(
        "{ assist: 2, assist_distance: 80 nm, assist_width: 30 nm, "
        "assist_space: 50 nm, assist_overhang: 70 nm, "
        "assist_min_length: 50 nm, min_space: 40 nm, iterations: 8 }",
        &s->gates, nonsense);
    g_autoptr(GArray) srafs = srafs_of(&t);
    found += (int)srafs->len;
    g_assert_cmpint(covered_area(srafs, 80, s->drawn), ==, 0);
    eda_shapes moved = moved_of(&t, &s->gates);
    g_assert_cmpint(covered_area(srafs, 40, &moved), ==, 0);
    pressed += covered_area(srafs, 42, &moved) > 0;
    eda_shapes_clear(&moved);
    for (guint i = 0; i < srafs->len; i++) {
      eda_box b = g_array_index(srafs, eda_box, i);
      int w = b.x1 - b.x0, h = b.y1 - b.y0;
      g_assert_cmpint(MIN(w, h), ==, 30);
      g_assert_cmpint(MAX(w, h), >=, 50);
      for (guint k = 0; k < i; k++) {
        eda_box c = g_array_index(srafs, eda_box, k);
        g_assert_true(b.x0 - c.x1 >= 50 || c.x0 - b.x1 >= 50 ||
                      b.y0 - c.y1 >= 50 || c.y0 - b.y1 >= 50);
      }
    }
    trial_clear(&t);
  }
  g_assert_cmpint(found, >, 50);
  g_assert_cmpint(pressed, >, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/epe/assists", test_assists);
  g_test_add_func("/epe/assists_apart", test_assists_apart);
  return g_test_run();
}
