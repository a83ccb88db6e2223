/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of read.gds: reading files, and making them record by record. */
#pragma once

#include <eda/gds.h>
#include <eda/layout.h>
#include <string.h>

#include "../hostile_test.h"

/* Return the layout of a file read with the parameters `more`, or NULL and
 *error. */
static inline eda_layout *read_more(const char *path, const char *more,
                                    opc_error *error) {
  return read_by("read.gds", path, more, error);
}

static inline eda_layout *read_good(const char *path, const char *more) {
  opc_error e = {0};
  eda_layout *layout = read_more(path, more, &e);
  if (!layout) g_error("%s: %s", path, e.message);
  return layout;
}

/* ---- files made here ---- */

static inline void record_put(GByteArray *file, uint32_t type, uint32_t kind,
                              const void *data, size_t n) {
  uint8_t head[4];
  eda_gds_put_u16(head, (uint32_t)n + 4);
  head[2] = (uint8_t)type;
  head[3] = (uint8_t)kind;
  g_byte_array_append(file, head, 4);
  if (n) g_byte_array_append(file, data, (guint)n);
}

static inline void put_text(GByteArray *file, uint32_t type, const char *text) {
  size_t n = strlen(text);
  char padded[256] = "";
  memcpy(padded, text, n);
  record_put(file, type, EDA_GDS_ASCII, padded, n + n % 2);
}

static inline void put_u16s(GByteArray *file, uint32_t type, size_t n,
                            const uint32_t *v) {
  uint8_t data[64];
  for (size_t i = 0; i < n; i++) eda_gds_put_u16(data + 2 * i, v[i]);
  record_put(file, type, EDA_GDS_INT2, data, 2 * n);
}

static inline void put_u16(GByteArray *file, uint32_t type, uint32_t v) {
  put_u16s(file, type, 1, &v);
}

static inline void put_i32s(GByteArray *file, uint32_t type, size_t n,
                            const int32_t *v) {
  uint8_t data[128];
  for (size_t i = 0; i < n; i++) eda_gds_put_i32(data + 4 * i, v[i]);
  record_put(file, type, EDA_GDS_INT4, data, 4 * n);
}

static inline void put_cell(GByteArray *file, const char *name) {
  uint32_t date[12] = {0};
  put_u16s(file, EDA_GDS_BGNSTR, 12, date);
  put_text(file, EDA_GDS_STRNAME, name);
}

static inline void put_empty(GByteArray *file, uint32_t type) {
  record_put(file, type, EDA_GDS_NOTHING, NULL, 0);
}

static inline GByteArray *new_file(void) {
  GByteArray *file = g_byte_array_new();
  uint32_t date[12] = {0};
  uint8_t units[16];
  put_u16(file, EDA_GDS_HEADER, 600);
  put_u16s(file, EDA_GDS_BGNLIB, 12, date);
  put_text(file, EDA_GDS_LIBNAME, "TEST");
  eda_gds_put_real(units, 1e-3);
  eda_gds_put_real(units + 8, 1e-9);
  record_put(file, EDA_GDS_UNITS, EDA_GDS_REAL8, units, 16);
  return file;
}

static inline void put_box(GByteArray *file, uint32_t layer,
                           uint32_t datatype) {
  put_empty(file, EDA_GDS_BOUNDARY);
  put_u16(file, EDA_GDS_LAYER, layer);
  put_u16(file, EDA_GDS_DATATYPE, datatype);
  put_i32s(file, EDA_GDS_XY, 10, (int32_t[]){0, 0, 10, 0, 10, 20, 0, 20, 0, 0});
  put_empty(file, EDA_GDS_ENDEL);
}

static inline void put_leaf(GByteArray *file) {
  put_cell(file, "LEAF");
  put_box(file, 9, 0);
  put_empty(file, EDA_GDS_ENDSTR);
}

static inline char *file_save(GByteArray *file) {
  char *path = g_build_filename(opc_test_folder(), "made.gds", NULL);
  g_assert_true(g_file_set_contents(path, (const char *)file->data,
                                    (gssize)file->len, NULL));
  return path;
}

static inline char *file_finish(GByteArray *file) {
  put_empty(file, EDA_GDS_ENDSTR);
  put_empty(file, EDA_GDS_ENDLIB);
  char *path = file_save(file);
  g_byte_array_free(file, TRUE);
  return path;
}

static inline void assert_refused(const char *path, const char *more, int code,
                                  const char *why) {
  opc_error e = {0};
  g_assert_null(read_more(path, more, &e));
  if (!strstr(e.message, why)) g_error("%s", e.message);
  g_assert_cmpint(e.code, ==, code);
}
