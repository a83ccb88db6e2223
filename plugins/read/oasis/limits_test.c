/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of repetitions that end at the limits of coordinates, or one unit
   beyond, against the places of all members computed one by one. */
#include <stdlib.h>

#include "making_test.h"

enum { MOST = 5 }; /* members of a row or column */

typedef struct place {
  int64_t x, y;
} place;

/* Return a random step: distances up to 2^26, so that all fit between the
   limits. */
static int64_t random_step(GRand *rand) {
  return g_rand_int_range(rand, -(1 << 26), (1 << 26) + 1);
}

/* Write a step: x as an unsigned integer with two additional bits, y signed. */
static void put_step(GByteArray *f, place d) {
  values_put(f, "us", (unsigned long)llabs(d.x) << 2 | (d.x < 0) << 1 | 1,
             (long)d.y);
}

/* Write a repetition of that type and return the number of its members. */
static size_t put_repetition(GByteArray *f, GRand *rand, int type,
                             place *members) {
  size_t columns = (size_t)g_rand_int_range(rand, 2, MOST + 1),
         rows = (size_t)g_rand_int_range(rand, 2, MOST + 1), n = 0;
  place column = {random_step(rand), random_step(rand)},
        row = {random_step(rand), random_step(rand)};
  if (type <= 3)
    column = (place){llabs(column.x), 0}, row = (place){0, llabs(row.y)};
  if (type == 2 || type == 9) rows = 1;
  if (type == 3) columns = 1;
  values_put(f, "u", (unsigned long)type);
  if (type != 3) values_put(f, "u", (unsigned long)columns - 2);
  if (type == 1 || type == 3 || type == 8)
    values_put(f, "u", (unsigned long)rows - 2);
  if (type == 1 || type == 2) values_put(f, "u", (unsigned long)column.x);
  if (type == 1 || type == 3) values_put(f, "u", (unsigned long)row.y);
  if (type == 8 || type == 9) put_step(f, column);
  if (type == 8) put_step(f, row);
  if (type == 10) rows = 1;
  for (size_t j = 0; j < rows; j++)
    for (size_t i = 0; i < columns; i++, n++) {
      const int64_t c = (int64_t)i, k = (int64_t)j;
      members[n] = (place){c * column.x + k * row.x, c * column.y + k * row.y};
      if (type != 10 || !i) continue;
      const place d = {random_step(rand), random_step(rand)};
      members[n] = (place){members[n - 1].x + d.x, members[n - 1].y + d.y};
      put_step(f, d);
    }
  return n;
}

/* Test a rectangle whose outermost member ends at a limit, or one unit beyond,
   on each of the four sides. */
static void test_edges(void) {
  static const int types[] = {1, 2, 3, 8, 9, 10};
  GRand *rand = g_rand_new_with_seed(6);
  for (int round = 0; round < 600; round++) {
    const int type = types[round % G_N_ELEMENTS(types)], side = round / 6 % 4,
              beyond = round / 24 % 2;
    GByteArray *repetition = g_byte_array_new();
    place members[MOST * MOST], low = {0, 0}, high = {0, 0};
    size_t n = put_repetition(repetition, rand, type, members);
    const int64_t w = 1 + (random_step(rand) & 0xffff),
                  h = 1 + (random_step(rand) & 0xffff);
    for (size_t i = 0; i < n; i++) {
      low = (place){MIN(low.x, members[i].x), MIN(low.y, members[i].y)};
      high = (place){MAX(high.x, members[i].x), MAX(high.y, members[i].y)};
    }
    place at = {0, 0};
    if (side == 0) at.x = INT32_MIN - low.x - beyond;
    if (side == 1) at.x = INT32_MAX - high.x - w + beyond;
    if (side == 2) at.y = INT32_MIN - low.y - beyond;
    if (side == 3) at.y = INT32_MAX - high.y - h + beyond;
    GByteArray *f = new_cell();
    values_put(f, "bbuuuuss", EDA_OASIS_RECTANGLE, 0x7f, 1ul, 2ul,
               (unsigned long)w, (unsigned long)h, (long)at.x, (long)at.y);
    g_byte_array_append(f, repetition->data, repetition->len);
    g_byte_array_free(repetition, TRUE);
    if (beyond) {
      assert_refused(file_finish(f), OPC_IO, "a coordinate beyond 32 bits");
      continue;
    }
    eda_layout *layout = read_made(file_finish(f));
    const int32_t top = eda_layout_find_cell(layout, "TOP");
    g_assert_cmpuint(eda_layout_polygons(layout, top), ==, n);
    for (size_t i = 0; i < n; i++) {
      size_t corners;
      int32_t layer;
      const eda_point *p = eda_layout_polygon(layout, top, i, &corners, &layer);
      g_assert_cmpuint(corners, ==, 4);
      g_assert_cmpint(p[0].x, ==, at.x + members[i].x);
      g_assert_cmpint(p[0].y, ==, at.y + members[i].y);
      g_assert_cmpint(p[2].x, ==, at.x + members[i].x + w);
      g_assert_cmpint(p[2].y, ==, at.y + members[i].y + h);
    }
    eda_layout_free(layout);
  }
  g_rand_free(rand);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/read-oasis-limits/edges", test_edges);
  return g_test_run();
}
