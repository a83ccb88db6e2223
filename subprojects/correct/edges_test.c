/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests displaced edges against polygons drawn by hand and against their
   areas. */
#include <correct/edges.h>

#include <glib.h>

/* A poly line with one transistor in its upper part, on an odd-shaped
   polygon:        3_______2'
                    |     |        fragments: the gate owns both flanks from
                    |     |        y = 100 up, and the line end at y = 300.
                   5|     |1
                    |_____|
   x 0..60, y 0..300; the box of the gate is y 120..280. */
static const eda_fragment line[] = {
    {{0, 0}, -1, EDA_FIXED},    {{60, 0}, -1, EDA_FIXED},
    {{60, 100}, 0, EDA_L_HIGH}, {{60, 300}, 0, EDA_END_HIGH},
    {{0, 300}, 0, EDA_L_LOW},   {{0, 100}, -1, EDA_FIXED},
};
enum { N = G_N_ELEMENTS(line) };

typedef struct moves {
  int32_t l, low, high, jog;
  eda_part part[EDA_PARTS];
} moves;

/* Return the line after its displacements. `across`: 1: x and y are exchanged,
   and the order is reversed to keep the inside on the left. */
static eda_shapes moved(moves m, int across) {
  eda_fragment laid[N];
  for (int i = 0; i < N; i++) { /* the order is reversed: each fragment begins
                                   at the end of its mirror image */
    laid[i] = line[N - 1 - i];
    eda_point from = line[(N - i) % N].from;
    laid[i].from = (eda_point){from.y, from.x};
  }
  uint32_t start[] = {0, N};
  eda_box box =
      across ? (eda_box){120, 0, 280, 60} : (eda_box){0, 120, 60, 280};
  uint8_t axis = across ? EDA_Y : EDA_X;
  eda_edges edges = {1, start, across ? laid : (eda_fragment *)line};
  eda_gates gates = {.grid = 1,
                     .layers = 1,
                     .edges = &edges,
                     .count = 1,
                     .box = &box,
                     .axis = &axis};
  int32_t none = 0, end[2] = {m.low, m.high};
  biases by = {.w = &none,
               .aside = &none,
               .l = &m.l,
               .jog = &m.jog,
               .end = end,
               .part = m.part};
  pieces p;
  eda_shapes out;
  correct_pieces_of_edges(&edges, 0, &p);
  correct_pieces_alloc(&p, &out);
  correct_pieces_follow(&gates, EDA_POLY, &by, &p);
  correct_pieces_build(&p, &out);
  g_assert_cmpuint(out.count, ==, 1);
  correct_pieces_clear(&p);
  return out;
}

static char *corners(const eda_shapes *s) {
  GString *text = g_string_new(NULL);
  for (uint32_t i = 0; i < s->start[s->count]; i++)
    g_string_append_printf(text, "%d,%d ", s->points[i].x, s->points[i].y);
  return g_string_free(text, FALSE);
}

static void test_biases(void) {
  const struct {
    moves m;
    const char *want;
  } cases[] = {
      {{0, 0, 0, 0, {{0}}}, "0,0 60,0 60,300 0,300 "},
      {{4, 0, 0, 0, {{0}}},
       "0,0 60,0 60,100 62,100 62,300 -2,300 -2,100 0,100 "},
      {{-3, 0, 0, 0, {{0}}},
       "0,0 60,0 60,100 59,100 59,300 2,300 2,100 0,100 "},
      {{1, 7, 12, 0, {{0}}}, "0,0 60,0 60,100 61,100 61,312 0,312 "},
      /* Jogs: on the high side, on the low side, over the full length, none. */
      {{0, 0, 0, 50, {{0}}},
       "0,0 60,0 60,100 61,100 61,150 60,150 60,300 0,300 "},
      {{-2, 0, 0, 159, {{0}}},
       "0,0 60,0 60,259 59,259 59,300 1,300 1,100 0,100 "},
      {{1, 0, 0, 50, {{0}}},
       "0,0 60,0 60,100 61,100 61,300 0,300 0,150 -1,150 -1,100 0,100 "},
      {{0, 0, 0, 200, {{0}}}, "0,0 60,0 60,100 61,100 61,300 0,300 "},
      {{1, 0, 0, 900, {{0}}},
       "0,0 60,0 60,100 61,100 61,300 -1,300 -1,100 0,100 "},
      {{0, 0, 0, -7, {{0}}}, "0,0 60,0 60,300 0,300 "},
      /* The line end is moved inwards to the start of the gate, and past it. */
      {{4, 0, -200, 0, {{0}}}, "0,0 60,0 60,100 0,100 "},
      {{0, 0, -300, 0, {{0}}}, ""},
      /* Displacements of parts, counted from the gate's LOW end at y = 120:
         both sides, one side, up to the end of the side, and with a jog, which
         stays in its side. */
      {{.part = {{20, 60, 2}}},
       "0,0 60,0 60,140 61,140 61,180 60,180 60,300 0,300 0,180 -1,180 -1,140 "
       "0,140 "},
      {{.l = 1, .part = {{20, 60, -1}, {60, 999, 1}}},
       "0,0 60,0 60,100 61,100 61,140 60,140 60,180 61,180 61,300 -1,300 "
       "-1,180 0,180 "},
      {{.part = {{-99, 0, 3}, {0, 0, 9}, {5, 6, 9}}},
       "0,0 60,0 60,100 62,100 62,120 60,120 60,300 0,300 0,120 -1,120 -1,100 "
       "0,100 "},
      {{.jog = 50, .part = {{20, 60, 1}}},
       "0,0 60,0 60,100 61,100 61,140 62,140 62,150 61,150 61,180 60,180 "
       "60,300 0,300 "},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    eda_shapes s = moved(cases[i].m, 0);
    g_autofree char *got = corners(&s);
    g_assert_cmpstr(got, ==, cases[i].want);
    eda_shapes_clear(&s);
  }
}

/* An active of 200 x 100 with a gate in its middle: both ends of the gate's
   width move by half of w, and towards HIGH by `aside`. */
static void test_aside(void) {
  static const eda_fragment active[] = {
      {{0, 0}, -1, EDA_FIXED},     {{60, 0}, 0, EDA_W_LOW},
      {{140, 0}, -1, EDA_FIXED},   {{200, 0}, -1, EDA_FIXED},
      {{200, 100}, -1, EDA_FIXED}, {{140, 100}, 0, EDA_W_HIGH},
      {{60, 100}, -1, EDA_FIXED},  {{0, 100}, -1, EDA_FIXED},
  };
  static const struct {
    int32_t w, aside, low, high;
  } cases[] = {{4, 0, -2, 102},  {5, 0, -2, 103}, {4, 2, 0, 104},
               {5, -3, -5, 100}, {0, -7, -7, 93}, {-4, 2, 4, 100}};
  uint32_t start[] = {0, G_N_ELEMENTS(active)};
  eda_box box = {60, 0, 140, 100};
  uint8_t axis = EDA_X;
  eda_edges edges[] = {{0}, {1, start, (eda_fragment *)active}};
  eda_gates gates = {.grid = 1,
                     .layers = 2,
                     .edges = edges,
                     .count = 1,
                     .box = &box,
                     .axis = &axis};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    int32_t w = cases[i].w, aside = cases[i].aside;
    biases by = {.w = &w, .aside = &aside};
    pieces p;
    correct_pieces_of_edges(&edges[EDA_ACTIVE], 0, &p);
    correct_pieces_follow(&gates, EDA_ACTIVE, &by, &p);
    g_assert_cmpint(-p.by[1], ==, cases[i].low);
    g_assert_cmpint(100 + p.by[5], ==, cases[i].high);
    for (uint32_t k = 0; k < p.start[1]; k++)
      g_assert_true(k == 1 || k == 5 || p.by[k] == 0);
    correct_pieces_clear(&p);
  }
}

/* A polygon that vanished can be merged with others. */
static void test_nothing(void) {
  eda_shapes s = moved((moves){.high = -300}, 0), merged;
  opc_error error;
  g_assert_cmpint(eda_boolean(EDA_OR, &s, NULL, &merged, &error), ==, OPC_OK);
  g_assert_cmpuint(merged.count, ==, 0);
  eda_shapes_clear(&merged);
  eda_shapes_clear(&s);
}

/* Check that all points are corners and none is repeated. */
static void check_corners(const eda_shapes *s) {
  uint32_t n = s->start[1];
  for (uint32_t i = 0; i < n; i++) {
    eda_point a = s->points[i], b = s->points[(i + 1) % n],
              c = s->points[(i + 2) % n];
    g_assert_true((a.x == b.x) != (a.y == b.y));
    g_assert_true((a.x == b.x) != (b.x == c.x));
  }
}

/* Compare areas in both orientations of the line with a sum of rectangles. */
static void test_areas(void) {
  for (int32_t l = -5; l <= 5; l++)
    for (int32_t jog = -1; jog <= 201; jog++)
      for (int32_t high = -20; high <= 10; high += 15) {
        if (jog > 200 + high && jog < 200)
          continue; /* the jog would end beyond
                       the line end */
        int32_t long_for = jog >= 200 ? 200 + high : jog > 0 ? jog : 0;
        int64_t want = 60 * (300 + high) + l * (200 + high) + long_for;
        for (int across = 0; across < 2; across++) {
          eda_shapes s = moved((moves){l, 0, high, jog, {{0}}}, across);
          check_corners(&s);
          g_assert_cmpint(eda_area2(&s), ==, 2 * want);
          eda_shapes_clear(&s);
        }
      }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/edges/biases", test_biases);
  g_test_add_func("/edges/aside", test_aside);
  g_test_add_func("/edges/nothing", test_nothing);
  g_test_add_func("/edges/areas", test_areas);
  return g_test_run();
}
