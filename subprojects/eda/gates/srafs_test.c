/* SPDX-License-Identifier: BSD-3-Clause */
/* Scatter bars beside random rectangles: positions beside a single rectangle,
   and distances from each other and from drawn shapes. */
#include <eda/memory.h>
#include <eda/srafs.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

static const eda_sraf_rule rule = {.rows = 2,
                                   .width = 40,
                                   .distance = 150,
                                   .space = 80,
                                   .min_length = 100,
                                   .overhang = 60};

static eda_shapes shapes_of(const eda_box *b, size_t n) {
  eda_shapes all = {.count = n}, merged;
  opc_error error;
  all.start = eda_alloc(n + 1, sizeof *all.start);
  all.points = eda_alloc(n, 4 * sizeof *all.points);
  for (size_t i = 0; i < n; i++) {
    const eda_point p[] = {{b[i].x0, b[i].y0},
                           {b[i].x1, b[i].y0},
                           {b[i].x1, b[i].y1},
                           {b[i].x0, b[i].y1}};
    for (size_t k = 0; k < 4; k++) all.points[4 * i + k] = p[k];
    all.start[i + 1] = (uint32_t)(4 * i + 4);
  }
  g_assert_false(eda_boolean(EDA_OR, &all, NULL, &merged, &error));
  eda_shapes_clear(&all);
  return merged;
}

/* Return the left, right, lower and upper edge of a box. */
static void edges_of(eda_box b, eda_sraf_edge out[4]) {
  out[0] = (eda_sraf_edge){1, -1, b.x0, b.y0, b.y1};
  out[1] = (eda_sraf_edge){1, 1, b.x1, b.y0, b.y1};
  out[2] = (eda_sraf_edge){0, -1, b.y0, b.x0, b.x1};
  out[3] = (eda_sraf_edge){0, 1, b.y1, b.x0, b.x1};
}

static int nearer(eda_box a, eda_box b, int32_t by) {
  return a.x0 < b.x1 + by && b.x0 < a.x1 + by && a.y0 < b.y1 + by &&
         b.y0 < a.y1 + by;
}

/* The first row is beside the long sides and the ends of a line; the second row
   is one width and one space further from the line. */
static void test_single(void) {
  const eda_box line = {0, 0, 60, 1000};
  const eda_box want[] = {{-190, -60, -150, 1060}, {210, -60, 250, 1060},
                          {-60, -190, 120, -150},  {-60, 1150, 120, 1190},
                          {-310, -60, -270, 1060}, {330, -60, 370, 1060}};
  eda_shapes drawn = shapes_of(&line, 1);
  eda_sraf_edge edges[4];
  eda_box_list srafs = {0};
  opc_error error;
  edges_of(line, edges);
  g_assert_false(eda_srafs_place(edges, 4, &rule, &drawn, &srafs, &error));
  g_assert_cmpuint(srafs.count, ==, 8);
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++) {
    int found = 0;
    for (size_t k = 0; k < srafs.count; k++)
      found |= !memcmp(&srafs.box[k], &want[i], sizeof want[i]);
    g_assert_true(found);
  }
  free(srafs.box);
  eda_shapes_clear(&drawn);
}

static void test_random(void) {
  enum { N = 12, ROUNDS = 300 };
  GRand *r = g_rand_new_with_seed(3);
  size_t all = 0;
  for (int round = 0; round < ROUNDS; round++) {
    eda_box box[N];
    eda_sraf_edge edges[4 * N];
    for (int i = 0; i < N; i++) {
      int x = g_rand_int_range(r, 0, 3000), y = g_rand_int_range(r, 0, 3000);
      box[i] = (eda_box){x, y, x + g_rand_int_range(r, 50, 600),
                         y + g_rand_int_range(r, 50, 600)};
      edges_of(box[i], edges + 4 * i);
    }
    eda_shapes drawn = shapes_of(box, N);
    eda_box_list srafs = {0};
    opc_error error;
    g_assert_false(
        eda_srafs_place(edges, 4 * N, &rule, &drawn, &srafs, &error));
    for (size_t i = 0; i < srafs.count; i++) {
      eda_box b = srafs.box[i];
      int w = b.x1 - b.x0, h = b.y1 - b.y0;
      g_assert_cmpint(MIN(w, h), ==, 40);
      g_assert_cmpint(MAX(w, h), >=, 100);
      for (int k = 0; k < N; k++) g_assert_false(nearer(b, box[k], 150));
      for (size_t k = 0; k < i; k++)
        g_assert_false(nearer(b, srafs.box[k], 80));
    }
    all += srafs.count;
    free(srafs.box);
    eda_shapes_clear(&drawn);
  }
  g_assert_cmpuint(all, >, 5 * ROUNDS);
  g_rand_free(r);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/srafs/single", test_single);
  g_test_add_func("/srafs/random", test_random);
  return g_test_run();
}
