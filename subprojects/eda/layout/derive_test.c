/* SPDX-License-Identifier: BSD-3-Clause */
/* Derived layers: random expressions of random layers, compared with operations
   on single pixels; windows; placements; faults in texts. */
#include <eda/layout.h>
#include <string.h>

#include "geometry/bitmap_test.h"
#include "layout/layout.h"

enum { LAYERS = 3, MARGIN = 4, WIDE = SIZE + 2 * MARGIN };

typedef struct picture {
  uint8_t at[WIDE][WIDE];
} picture;

static int lit(const picture *p, int x, int y) {
  return x >= 0 && y >= 0 && x < WIDE && y < WIDE && p->at[y][x];
}

static void picture_fill(picture *p, eda_box b) {
  for (int y = MAX(b.y0 + MARGIN, 0); y < MIN(b.y1 + MARGIN, WIDE); y++)
    for (int x = MAX(b.x0 + MARGIN, 0); x < MIN(b.x1 + MARGIN, WIDE); x++)
      p->at[y][x] = 1;
}

static picture picture_of_flat(const eda_flat *flat) {
  picture p = {0};
  for (size_t i = 0; i < flat->shapes.count; i++) {
    uint32_t from = flat->shapes.start[i];
    g_assert_cmpuint(flat->shapes.start[i + 1] - from, ==, 4);
    picture_fill(&p, eda_bounds(flat->shapes.points + from, 4));
  }
  return p;
}

static picture grown(const picture *p, int by) {
  picture out;
  for (int y = 0; y < WIDE; y++)
    for (int x = 0; x < WIDE; x++) {
      int any = 0, all = 1, r = ABS(by);
      for (int v = y - r; v <= y + r; v++)
        for (int u = x - r; u <= x + r; u++) {
          any |= lit(p, u, v);
          all &= lit(p, u, v);
        }
      out.at[y][x] = (uint8_t)(by > 0 ? any : all);
    }
  return out;
}

/* Make a random expression: append its text and compute its picture. */
static picture expression_random(GRand *r, int depth, const picture *layers,
                                 GString *text) {
  int kind = depth ? g_rand_int_range(r, 0, 7) : 0;
  if (kind < 2) {
    int k = g_rand_int_range(r, 0, LAYERS);
    g_string_append_printf(text, "%d/0", k);
    return layers[k];
  }
  if (kind == 2) {
    int by = g_rand_boolean(r) ? 2 : -1;
    g_string_append(text, by > 0 ? "grow(" : "shrink( ");
    picture a = expression_random(r, depth - 1, layers, text);
    g_string_append(text, by > 0 ? ", 4 nm)" : ",.002um )");
    return grown(&a, by);
  }
  g_string_append(text, "(");
  picture a = expression_random(r, depth - 1, layers, text);
  g_string_append_printf(text, ") %c (", "+-&^"[kind - 3]);
  picture b = expression_random(r, depth - 1, layers, text), out;
  g_string_append(text, ")");
  for (int y = 0; y < WIDE; y++)
    for (int x = 0; x < WIDE; x++) {
      int u = a.at[y][x], v = b.at[y][x];
      int all[] = {u | v, u & !v, u & v, u ^ v};
      out.at[y][x] = (uint8_t)all[kind - 3];
    }
  return out;
}

/* Build a layout with boxes in a cell that is placed twice, once rotated, and
   in the top cell. Its unit and grid are 2 nm. */
static eda_layout *layout_random(GRand *r, picture *layers) {
  opc_error e;
  eda_layout *layout = eda_layout_new(2, &e);
  int32_t top = eda_layout_cell(layout, "TOP", &e);
  int32_t child = eda_layout_cell(layout, "CHILD", &e);
  memset(layers, 0, LAYERS * sizeof *layers);
  for (int k = 0; k < LAYERS; k++) {
    char name[8];
    g_snprintf(name, sizeof name, "%d/0", k);
    int32_t layer = eda_layout_layer(layout, name, &e);
    for (int i = 0; i < 6; i++) {
      int x = g_rand_int_range(r, 0, 9), y = g_rand_int_range(r, 0, 9);
      eda_box b = {x, y, x + g_rand_int_range(r, 1, 4),
                   y + g_rand_int_range(r, 1, 4)};
      eda_layout_add_box(layout, i % 2 ? top : child, layer, b, &e);
      if (i % 2) {
        picture_fill(&layers[k], b);
        continue;
      }
      picture_fill(&layers[k], (eda_box){b.x0 + 3, b.y0, b.x1 + 3, b.y1});
      picture_fill(&layers[k],
                   (eda_box){20 - b.y1, b.x0 + 2, 20 - b.y0, b.x1 + 2});
    }
  }
  eda_placement p = {{3, 0}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}};
  eda_layout_add_instance(layout, top, child, &p, "A", &e);
  p = (eda_placement){{20, 2}, 1, 90, 0, 1, 1, {0, 0}, {0, 0}};
  eda_layout_add_instance(layout, top, child, &p, "B", &e);
  return layout;
}

/* Compare the flat shapes with the wanted pixels, in the window. */
static void assert_window(const eda_layout *layout, int32_t layer,
                          const picture *want, const eda_box *window) {
  opc_error e;
  eda_flat flat;
  eda_box w = window
                  ? *window
                  : (eda_box){-MARGIN, -MARGIN, SIZE + MARGIN, SIZE + MARGIN};
  g_assert_cmpint(
      eda_layout_flatten_window(layout, 0, layer, 2, window, &flat, &e), ==, 0);
  picture got = picture_of_flat(&flat);
  for (int y = w.y0; y < w.y1; y++)
    for (int x = w.x0; x < w.x1; x++)
      g_assert_cmpint(lit(&got, x + MARGIN, y + MARGIN), ==,
                      lit(want, x + MARGIN, y + MARGIN));
  eda_flat_clear(&flat);
}

static void test_random(void) {
  GRand *r = g_rand_new_with_seed(3);
  for (int i = 0; i < 400; i++) {
    opc_error e;
    picture layers[LAYERS];
    eda_layout *layout = layout_random(r, layers);
    g_autoptr(GString) text = g_string_new("( ");
    picture want = expression_random(r, 3, layers, text);
    g_string_append(text, " )");
    int32_t layer = eda_layout_select(layout, text->str, &e);
    g_assert_cmpint(layer, >=, 0);
    g_assert_cmpint(layer, ==, eda_layout_select(layout, text->str, &e));
    g_assert_cmpstr(eda_layout_layer_name(layout, layer), ==, text->str);
    assert_window(layout, layer, &want, NULL);
    int x = g_rand_int_range(r, 0, 15), y = g_rand_int_range(r, 0, 15);
    eda_box window = {x, y, x + 6, y + 5}, bounds;
    assert_window(layout, layer, &want, &window);
    g_assert_cmpint(eda_layout_bounds(layout, 0, layer, 2, &bounds, &e), ==, 0);
    for (int v = 0; v < WIDE; v++)
      for (int u = 0; u < WIDE; u++)
        g_assert_true(!want.at[v][u] ||
                      (u - MARGIN >= bounds.x0 && u - MARGIN < bounds.x1 &&
                       v - MARGIN >= bounds.y0 && v - MARGIN < bounds.y1));
    eda_layout_free(layout);
  }
  g_rand_free(r);
}

/* Boxes have the placement of the shape that covers them, on a layer that is
   not subtracted. */
static void test_placements(void) {
  opc_error e;
  eda_flat flat;
  eda_layout *layout = eda_layout_new(1, &e);
  int32_t top = eda_layout_cell(layout, "TOP", &e);
  int32_t child = eda_layout_cell(layout, "CHILD", &e);
  int32_t drawn = eda_layout_layer(layout, "drawn", &e);
  int32_t drop = eda_layout_layer(layout, "drop", &e);
  eda_layout_set_file_layer(layout, drop, "33/42");
  eda_layout_add_box(layout, child, drawn, (eda_box){0, 0, 10, 10}, &e);
  eda_layout_add_box(layout, top, drop, (eda_box){0, 5, 100, 10}, &e);
  eda_placement p = {{0, 0}, 1, 0, 0, 2, 1, {10, 0}, {0, 0}};
  eda_layout_add_instance(layout, top, child, &p, "X", &e);
  g_assert_cmpint(
      eda_layout_derive(layout, "mask", "grow(drawn, 1 nm) - 33/42", &e), ==,
      0);
  int32_t mask = eda_layout_find_layer(layout, "mask");
  g_assert_true(eda_layout_is_derived(layout, mask));
  g_assert_false(eda_layout_is_derived(layout, drawn));
  g_assert_cmpint(eda_layout_flatten(layout, top, mask, 1, &flat, &e), ==, 0);
  int64_t area[2] = {0};
  for (size_t i = 0; i < flat.shapes.count; i++) {
    char path[20];
    eda_layout_path(layout, top, flat.placement[i], path, sizeof path);
    eda_box b = eda_shape_box(&flat.shapes, i);
    g_assert_true(g_str_has_prefix(path, "X["));
    area[path[2] - '0'] += (int64_t)(b.x1 - b.x0) * (b.y1 - b.y0);
  }
  g_assert_cmpint(area[0], ==, 12 * 12 - 11 * 5);
  g_assert_cmpint(area[1], ==, 12 * 12 - 12 * 5);
  eda_flat_clear(&flat);
  eda_layout_free(layout);
}

static void test_faults(void) {
  static const struct {
    const char *text, *message;
  } bad[] = {
      {"(drawn + drop", "')' or an operator at character 14, found the end"},
      {"drawn +", "a layer or '(' at character 8, found the end"},
      {"drawn drop", "an operator or the end at character 7, found 'd'"},
      {"grow(drawn)", "',' and a length at character 11"},
      {"grow(drawn, 10)", "a length above 0 and below 1 mm"},
      {"grow(drawn, 10 V)", "a length above 0 and below 1 mm"},
      {"grow(drawn, -1 nm)", "a length above 0 and below 1 mm"},
      {"drawn - 33/43", "the layout has no layer '33/43'"},
      {"no_such", "the layout has no layer 'no_such'"},
  };
  opc_error e;
  eda_layout *layout = eda_layout_new(1, &e);
  eda_layout_cell(layout, "TOP", &e);
  eda_layout_layer(layout, "drawn", &e);
  eda_layout_layer(layout, "drop", &e);
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_assert_cmpint(eda_layout_select(layout, bad[i].text, &e), ==, -1);
    g_assert_nonnull(strstr(e.message, bad[i].message));
  }
  g_autoptr(GString) deep = g_string_new(NULL);
  for (int i = 0; i < 100000; i++) g_string_append(deep, "(");
  g_assert_cmpint(eda_layer_check(deep->str, &e), ==, OPC_INVALID);
  g_string_assign(deep, "drawn");
  for (int i = 0; i < 100000; i++) g_string_append(deep, "+drawn");
  g_assert_cmpint(eda_layer_check(deep->str, &e), ==, OPC_INVALID);
  g_assert_cmpint(eda_layout_derive(layout, "a", "drawn + drop", &e), ==, 0);
  g_assert_cmpint(eda_layout_derive(layout, "drawn", "a - drop", &e), ==,
                  OPC_INVALID);
  g_assert_nonnull(strstr(e.message, "contains this layer"));
  g_assert_cmpint(eda_layout_select(layout, "grow(a, 1 nm)", &e), >=, 0);
  eda_flat flat;
  int32_t layer = eda_layout_select(layout, "grow(a, 1 nm)", &e);
  g_assert_cmpint(eda_layout_flatten(layout, 0, layer, 2, &flat, &e), ==,
                  OPC_INVALID);
  g_assert_nonnull(strstr(e.message, "not a multiple of the grid of 2 nm"));
  eda_layout_free(layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/derive/random", test_random);
  g_test_add_func("/derive/placements", test_placements);
  g_test_add_func("/derive/faults", test_faults);
  return g_test_run();
}
