/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of repetitions that end at the limits of coordinates, or one unit
   beyond, against the places of all members computed one by one. Also a file
   larger than the reader's window. */
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

/* Put n rectangles, number i at (3 i, 7 i); the first one sets the layer. */
static void put_rectangles(GByteArray *f, long first, long n) {
  for (long i = first; i < first + n; i++) {
    values_put(f, "bb", EDA_OASIS_RECTANGLE, i == first ? 0x7b : 0x78);
    if (i == first) values_put(f, "uu", 1ul, 2ul);
    values_put(f, "uuss", (unsigned long)(i % 300), 5ul, 3 * i, 7 * i);
  }
}

/* Put a compressed block. */
static void put_block(GByteArray *f, const GByteArray *content) {
  uLong capacity = compressBound(content->len) + 64;
  g_autofree uint8_t *out = g_malloc(capacity);
  z_stream z = {.next_in = content->data,
                .avail_in = content->len,
                .next_out = out,
                .avail_out = (uInt)capacity};
  deflateInit2(&z, 0, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  g_assert_cmpint(deflate(&z, Z_FINISH), ==, Z_STREAM_END);
  values_put(f, "bbuu", EDA_OASIS_CBLOCK, 0, (unsigned long)content->len,
             z.total_out);
  g_byte_array_append(f, out, (guint)z.total_out);
  deflateEnd(&z);
}

/* Test a file larger than the reader's window: a name that is defined at the
   end, a compressed block as large, a checksum over everything, and a wrong
   checksum. */
static void test_large(void) {
  enum { EACH = 100000 };
  for (int scheme = 0; scheme < 3; scheme++)
    for (uint32_t wrong = 0; wrong <= (scheme > 0); wrong++) {
      GByteArray *f = new_file(), *block = g_byte_array_new();
      values_put(f, "bu", EDA_OASIS_CELL_NUMBER, 0ul);
      put_rectangles(f, 0, EACH);
      put_rectangles(block, EACH, EACH);
      put_block(f, block);
      put_rectangles(f, 2l * EACH, EACH);
      values_put(f, "bt", EDA_OASIS_CELLNAME, "LAST");
      g_assert_cmpuint(f->len, >, 3 << 20);
      g_byte_array_free(block, TRUE);
      char *path = finish_sum(f, scheme, wrong);
      if (wrong) {
        assert_refused(path, OPC_IO, "expected");
        continue;
      }
      eda_layout *layout = read_made(path);
      const int32_t top = eda_layout_find_cell(layout, "LAST");
      g_assert_cmpint(top, >=, 0);
      g_assert_cmpuint(eda_layout_polygons(layout, top), ==, 3 * EACH);
      for (int32_t i = 0; i < 3 * EACH; i++) {
        size_t n;
        int32_t layer;
        const eda_point *p =
            eda_layout_polygon(layout, top, (size_t)i, &n, &layer);
        g_assert_true(p[0].x == 3 * i && p[0].y == 7 * i &&
                      p[2].x == 3 * i + i % 300 && p[2].y == 7 * i + 5);
      }
      eda_layout_free(layout);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/read-oasis-limits/edges", test_edges);
  g_test_add_func("/read-oasis-limits/large", test_large);
  return g_test_run();
}
