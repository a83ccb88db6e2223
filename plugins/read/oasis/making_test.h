/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers: OASIS files made by hand. */
#pragma once

#include <glib.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include <eda/layout.h>
#include <eda/oasis.h>
#include "../hostile_test.h"

static void put_uint(GByteArray *f, uint64_t v) {
  for (; v >= 0x80; v >>= 7)
    g_byte_array_append(f, (const uint8_t[]){(uint8_t)(v | 0x80)}, 1);
  g_byte_array_append(f, (const uint8_t[]){(uint8_t)v}, 1);
}

/* Write values: u, an unsigned integer (unsigned long); s, a signed one (long);
   b, a byte (int); r, an integer as real (int); t, a string. */
static void values_put(GByteArray *f, const char *format, ...) {
  va_list list;
  va_start(list, format);
  for (const char *c = format; *c; c++) {
    if (*c == 'u') {
      put_uint(f, va_arg(list, unsigned long));
    } else if (*c == 's') {
      long v = va_arg(list, long);
      put_uint(f, v < 0 ? (uint64_t)-v << 1 | 1 : (uint64_t)v << 1);
    } else if (*c == 'b') {
      uint8_t byte = (uint8_t)va_arg(list, int);
      g_byte_array_append(f, &byte, 1);
    } else if (*c == 'r') {
      put_uint(f, 0);
      put_uint(f, (uint64_t)va_arg(list, int));
    } else {
      const char *text = va_arg(list, const char *);
      put_uint(f, strlen(text));
      g_byte_array_append(f, (const uint8_t *)text, (guint)strlen(text));
    }
  }
  va_end(list);
}

/* Return a file without cells. The tables are listed in END. */
static GByteArray *new_file(void) {
  GByteArray *f = g_byte_array_new();
  g_byte_array_append(f, (const uint8_t *)EDA_OASIS_MAGIC, 13);
  values_put(f, "btrb", EDA_OASIS_START, "1.0", 1000, 1);
  return f;
}

static GByteArray *new_cell(void) {
  GByteArray *f = new_file();
  values_put(f, "bt", EDA_OASIS_CELL, "TOP");
  return f;
}

static char *file_save(const GByteArray *f) {
  char *path = g_build_filename(opc_test_folder(), "made.oas", NULL);
  remove(path);
  FILE *file = fopen(path, "wb");
  g_assert_nonnull(file);
  g_assert_cmpuint(fwrite(f->data, 1, f->len, file), ==, f->len);
  fclose(file);
  return path;
}

/* Write END with a validation scheme, and add `wrong` to the checksum. Return
   the path. */
static char *finish_sum(GByteArray *f, int scheme, uint32_t wrong) {
  guint start = f->len;
  values_put(f, "b", EDA_OASIS_END);
  for (int i = 0; i < 12; i++) values_put(f, "b", 0);
  guint length = 256 - 1 - 12 - 2 - 1 - (scheme ? 4 : 0);
  values_put(f, "u", (unsigned long)length);
  for (guint i = 0; i < length; i++) values_put(f, "b", 'x');
  values_put(f, "b", scheme);
  uint32_t sum = wrong;
  if (scheme == EDA_OASIS_CRC32) sum += (uint32_t)crc32(0, f->data, f->len);
  for (guint i = 0; i < f->len && scheme == EDA_OASIS_SUM32; i++)
    sum += f->data[i];
  for (int i = 0; i < 4 && scheme; i++) values_put(f, "b", sum >> 8 * i & 0xff);
  g_assert_cmpuint(f->len, ==, start + 256);
  char *path = file_save(f);
  g_byte_array_free(f, TRUE);
  return path;
}

static char *file_finish(GByteArray *f) {
  return finish_sum(f, EDA_OASIS_NO_CHECK, 0);
}

static inline eda_layout *read_more(const char *path, const char *more,
                                    opc_error *error) {
  return read_by("read.oasis", path, more, error);
}

/* Read a file and free the path. */
static eda_layout *read_made(char *path) {
  opc_error e = {0};
  eda_layout *layout = read_more(path, "", &e);
  if (!layout) g_error("%s", e.message);
  g_free(path);
  return layout;
}

/* Assert that a file is rejected with a message; free the path. */
static void assert_refused(char *path, int code, const char *why) {
  opc_error e = {0};
  g_assert_null(read_more(path, "", &e));
  if (!strstr(e.message, why) || e.code != code)
    g_error("%d, %s; not %s", e.code, e.message, why);
  g_free(path);
}
