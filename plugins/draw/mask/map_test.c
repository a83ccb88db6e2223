/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the map of a mask by classes made by hand: colours at known positions,
   and a bounded size. */
#include <cairo.h>
#include <eda/chip.h>
#include <eda/drawing.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

#include "tools/devel/testing.h"

static eda_layout *layout;

/* Return a mask with n transistors in each direction, 1 um apart. All
   transistors print as drawn, except the second (current 10 % too high) and the
   last (does not print). */
static eda_mask *mask_new(size_t n) {
  eda_chip *c = eda_alloc(1, sizeof *c);
  int32_t far = (int32_t)n * 1000;
  *c = (eda_chip){.layout = layout,
                  .grid = 1,
                  .extent = {0, 0, far, far},
                  .count = n * n,
                  .masks = 2,
                  .prints = 3};
  c->gate = eda_alloc(n * n, sizeof *c->gate);
  c->mask = eda_alloc(2, sizeof *c->mask);
  for (size_t i = 0; i < n * n; i++) {
    int32_t x = (int32_t)(i % n) * 1000, y = (int32_t)(i / n) * 1000;
    c->gate[i].box = (eda_box){x, y, x + 800, y + 800};
    c->gate[i].print = i == 1 ? 1 : i == n * n - 1 ? 2 : 0;
    c->gate[i].mask = i == 1;
  }
  eda_mask *m = eda_chip_mask_new(c);
  for (int i = 0; i < 3; i++) {
    m->design.ion[i] = m->before.ion[i] = 1e-3;
    m->after.ion[i] = i == 1 ? 1.1e-3 : 1e-3;
  }
  m->flags[2] = EDA_PRINT_OPEN;
  return m;
}

static cairo_surface_t *draw_sample(eda_mask *mask, const char *map) {
  opc_error e;
  opc_module *m = opc_test_module("draw.mask", map, &e);
  if (!m) g_error("%s", e.message);
  opc_test_input(m, "mask", mask);
  if (opc_test_run(m, NULL, &e)) g_error("%s", e.message);
  opc_test_module_free(m);
  g_autofree char *path = g_build_filename(opc_test_folder(), "mask.png", NULL);
  cairo_surface_t *s = cairo_image_surface_create_from_png(path);
  g_assert_cmpint(cairo_surface_status(s), ==, CAIRO_STATUS_SUCCESS);
  return s;
}

/* Count the pixels of a colour below the legend. */
static int count_pixels(cairo_surface_t *s, uint32_t colour) {
  int width = cairo_image_surface_get_width(s);
  int height = cairo_image_surface_get_height(s), n = 0;
  const unsigned char *data = cairo_image_surface_get_data(s);
  for (int y = height - width + 9; y < height; y++)
    for (int x = 0; x < width; x++) {
      const uint32_t *p =
          (const uint32_t
               *)(const void *)(data +
                                (size_t)y *
                                    (size_t)cairo_image_surface_get_stride(s));
      n += (p[x] & 0xffffff) == colour;
    }
  return n;
}

static uint32_t rgb(eda_colour c) {
  return (uint32_t)(255 * c.r + 0.5) << 16 | (uint32_t)(255 * c.g + 0.5) << 8 |
         (uint32_t)(255 * c.b + 0.5);
}

static void assert_near(int a, double b) {
  g_assert_cmpfloat(a, >, 0.9 * b);
  g_assert_cmpfloat(a, <, 1.1 * b);
}

static void test_colours(void) {
  eda_mask *c = mask_new(4);
  /* 400 pixels less a margin of 9 on each side show 4 um */
  double gate = 0.8 * 382 / 4 * 0.8 * 382 / 4;
  cairo_surface_t *s = draw_sample(c, "{ width: 400 }");
  assert_near(count_pixels(s, rgb(eda_diverging(1))), gate);
  assert_near(count_pixels(s, rgb(eda_ink)), gate);
  /* equal to the colour of the paper */
  int white = count_pixels(s, rgb(eda_diverging(0.5)));
  cairo_surface_destroy(s);
  s = draw_sample(c, "{ width: 400, state: before }");
  assert_near(count_pixels(s, rgb(eda_diverging(0.5))) - white, 2 * gate);
  cairo_surface_destroy(s);
  s = draw_sample(c, "{ width: 400, state: classes }");
  assert_near(count_pixels(s, rgb(eda_sequential(0))), gate);
  assert_near(count_pixels(s, rgb(eda_sequential(log2(15) / 4))), 15 * gate);
  cairo_surface_destroy(s);
  eda_mask_free(c);
}

/* For a quarter of a million transistors, the size of the picture is equal, and
   the worst transistor is visible. */
static void test_many(void) {
  eda_mask *few = mask_new(4), *many = mask_new(500);
  cairo_surface_t *a = draw_sample(few, "{ width: 300 }");
  cairo_surface_t *b = draw_sample(many, "{ width: 300 }");
  g_assert_cmpint(cairo_image_surface_get_height(a), ==,
                  cairo_image_surface_get_height(b));
  g_assert_cmpint(count_pixels(b, rgb(eda_diverging(1))), >, 0);
  g_assert_cmpint(count_pixels(b, rgb(eda_ink)), >, 0);
  cairo_surface_destroy(a);
  cairo_surface_destroy(b);
  eda_mask_free(few);
  eda_mask_free(many);
}

int main(int argc, char **argv) {
  opc_error error;
  g_test_init(&argc, &argv, NULL);
  layout = eda_layout_new(1, &error);
  eda_layout_cell(layout, "TOP", &error);
  g_test_add_func("/map/colours", test_colours);
  g_test_add_func("/map/many", test_many);
  int code = g_test_run();
  eda_layout_free(layout);
  return code;
}
