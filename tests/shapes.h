/* SPDX-License-Identifier: BSD-3-Clause */
/* Comparison of shapes, for tests. */
#pragma once

#include <eda/eda.h>
#include <glib.h>

/* Return the area that only one of `a` and `b` covers, in grid steps squared.
 */
static inline double shapes_difference(const eda_shapes *a,
                                       const eda_shapes *b) {
  opc_error error = {0};
  eda_shapes x;
  g_assert_false(eda_boolean(EDA_XOR, a, b, &x, &error));
  double area = (double)eda_area2(&x) / 2;
  eda_shapes_clear(&x);
  return area;
}
