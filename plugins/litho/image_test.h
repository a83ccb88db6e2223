/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of litho models: images of shapes, and values of images. */
#pragma once

#include <eda/gates.h>
#include <eda/litho.h>
#include <string.h>

#include "tools/devel/testing.h"

/* Return a prepared model with these parameters. */
static inline opc_module *prepared(const char *id, const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module(id, parameters, &error);
  if (!m) g_error("%s", error.message);
  const eda_litho *litho = m->functions;
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
  return m;
}

/* Return the image of shapes on a grid of `grid` nm at `defocus` nm. */
static inline eda_field image_shapes(opc_module *m, int layer, double defocus,
                                     const eda_shapes *shapes, double grid,
                                     eda_frame f) {
  const eda_litho *litho = m->functions;
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  g_assert_cmpint(eda_litho_spectrum(opc_test_host()->context, m, shapes, grid,
                                     f, &mask, &error),
                  ==, OPC_OK);
  int code = defocus != 0 ? litho->image_at(m->self, layer, &mask, defocus,
                                            &field, &error)
                          : litho->image(m->self, layer, &mask, &field, &error);
  if (code) g_error("%s", error.message);
  eda_spectrum_clear(&mask);
  return field;
}

/* Return the image of up to four boxes on a grid of 0.1 nm. */
static inline eda_field image_boxes(opc_module *m, int layer, double defocus,
                                    const eda_box *boxes, size_t n,
                                    eda_frame f) {
  eda_point points[16];
  uint32_t start[5];
  g_assert_cmpuint(n, <=, 4);
  for (size_t i = 0; i < n; i++) {
    eda_box b = boxes[i];
    eda_point corners[] = {
        {b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
    memcpy(points + 4 * i, corners, sizeof corners);
  }
  for (size_t i = 0; i <= n; i++) start[i] = (uint32_t)(4 * i);
  eda_shapes shapes = {n, start, points, NULL};
  return image_shapes(m, layer, defocus, &shapes, 0.1, f);
}

static inline double value_at(const eda_field *f, double x, double y) {
  double v;
  eda_field_sample(f, &x, &y, 1, &v);
  return v;
}
