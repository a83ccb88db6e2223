/* SPDX-License-Identifier: BSD-3-Clause */
/* Reading back a picture, for the tests of draw.*. */
#pragma once

#include <cairo.h>
#include <string.h>

#include "tools/devel/testing.h"

typedef struct picture {
  cairo_surface_t *surface;
  int width, height;
  int left, top, right, bottom; /* first and last pixel of the window */
} picture;

static inline uint32_t pixel(const picture *p, int x, int y) {
  const unsigned char *data = cairo_image_surface_get_data(p->surface);
  size_t stride = (size_t)cairo_image_surface_get_stride(p->surface);
  g_assert_true(x >= 0 && y >= 0 && x < p->width && y < p->height);
  uint32_t value;
  memcpy(&value, data + (size_t)y * stride + 4 * (size_t)x, 4);
  return value & 0xffffff;
}

/* Read a picture from the folder of the test. At this fraction of the height,
   the window must have a border of one colour and blank paper beside it. */
static inline picture load_picture(const char *name, double part) {
  g_autofree char *path = g_build_filename(opc_test_folder(), name, NULL);
  picture p = {.surface = cairo_image_surface_create_from_png(path)};
  g_assert_cmpint(cairo_surface_status(p.surface), ==, CAIRO_STATUS_SUCCESS);
  p.width = cairo_image_surface_get_width(p.surface);
  p.height = cairo_image_surface_get_height(p.surface);
  int x = 0, y = (int)(p.height * part);
  while (pixel(&p, x, y) == 0xffffff) x++;
  p.left = x + 1;
  uint32_t border = pixel(&p, x, y);
  for (p.top = y; pixel(&p, x, p.top - 1) == border;) p.top--;
  for (p.bottom = y; pixel(&p, x, p.bottom + 1) == border;) p.bottom++;
  p.top++;
  p.bottom--;
  for (p.right = p.width - 1; pixel(&p, p.right, y) == 0xffffff;) p.right--;
  p.right--;
  return p;
}
