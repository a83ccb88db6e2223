/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements JSON texts, numbers and packed numbers. */
#include <report/json.h>

#include <math.h>
#include <stdint.h>
#include <string.h>
#include <zlib.h>

/* Compression level of zlib. Higher levels take three times as long and save 5
   % of the bytes (masks and contours of 7858 transistors). */
enum { LEVEL = 4 };

void json_text(GString *out, const char *text) {
  if (!text) {
    g_string_append(out, "null");
    return;
  }
  g_autofree char *valid = g_utf8_make_valid(text, -1);
  g_string_append_c(out, '"');
  for (const char *c = valid; *c; c++)
    if (*c == '"' || *c == '\\')
      g_string_append_printf(out, "\\%c", *c);
    else if ((unsigned char)*c < ' ' || strchr("<>&\x7f", *c))
      g_string_append_printf(out, "\\u%04x", (unsigned)*c);
    else
      g_string_append_c(out, *c);
  g_string_append_c(out, '"');
}

void json_number(GString *out, double x, int digits) {
  char text[40];
  if (!isfinite(x)) {
    g_string_append(out, "null");
    return;
  }
  g_snprintf(text, sizeof text, "%%.%dg", digits);
  g_autofree char *format = g_strdup(text);
  g_string_append(out, g_ascii_formatd(text, sizeof text, format, x));
}

void json_bytes(GString *out, const void *bytes, size_t n) {
  uLongf size = compressBound((uLong)n);
  g_autofree Bytef *packed = g_malloc(size);
  if (compress2(packed, &size, bytes, (uLong)n, LEVEL) != Z_OK)
    g_error("zlib has no memory");
  g_autofree char *text = g_base64_encode(packed, size);
  g_string_append_printf(out, "\"%s\"", text);
}

void json_packed(GString *out, const int32_t *numbers, size_t n,
                 size_t stride) {
  g_autofree uint32_t *delta = g_new(uint32_t, n + 1);
  for (size_t i = 0; i < n; i++) {
    uint32_t before = i < stride ? 0 : (uint32_t)numbers[i - stride];
    delta[i] = GUINT32_TO_LE((uint32_t)numbers[i] - before);
  }
  json_bytes(out, delta, n * sizeof *delta);
}
