/* SPDX-License-Identifier: BSD-3-Clause */
/* GDSII files of rectangles. */
#pragma once

#include <eda/gds.h>
#include <glib.h>
#include <stdint.h>

static inline void record_put(GByteArray *to, uint32_t type, uint32_t kind,
                              const void *data, size_t n) {
  uint8_t head[4];
  eda_gds_put_u16(head, (uint32_t)n + 4);
  head[2] = (uint8_t)type;
  head[3] = (uint8_t)kind;
  g_byte_array_append(to, head, 4);
  g_byte_array_append(to, data, (guint)n);
}

static inline void put_number(GByteArray *to, uint32_t type, uint32_t number) {
  uint8_t data[2];
  eda_gds_put_u16(data, number);
  record_put(to, type, EDA_GDS_INT2, data, 2);
}

static inline GByteArray *file_begin(double unit) {
  GByteArray *to = g_byte_array_new();
  uint8_t units[16];
  eda_gds_put_real(units, unit * 1e-3);
  eda_gds_put_real(units + 8, unit * 1e-9);
  put_number(to, EDA_GDS_HEADER, 600);
  record_put(to, EDA_GDS_UNITS, EDA_GDS_REAL8, units, 16);
  record_put(to, EDA_GDS_BGNSTR, EDA_GDS_INT2, units, 0);
  return to;
}

static inline void put_box(GByteArray *to, uint32_t layer, int x0, int y0,
                           int x1, int y1) {
  const int xy[10] = {x0, y0, x1, y0, x1, y1, x0, y1, x0, y0};
  uint8_t data[40];
  for (int i = 0; i < 10; i++) eda_gds_put_i32(data + 4 * i, xy[i]);
  record_put(to, EDA_GDS_BOUNDARY, EDA_GDS_NOTHING, data, 0);
  put_number(to, EDA_GDS_LAYER, layer);
  put_number(to, EDA_GDS_DATATYPE, 0);
  record_put(to, EDA_GDS_XY, EDA_GDS_INT4, data, 40);
  record_put(to, EDA_GDS_ENDEL, EDA_GDS_NOTHING, data, 0);
}
