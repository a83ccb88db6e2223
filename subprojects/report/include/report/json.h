/* SPDX-License-Identifier: BSD-3-Clause */
/* JSON output that is safe inside an HTML page, with packed arrays. */
#pragma once

#include <glib.h>
#include <stdint.h>

/* Append a quoted text. `<`, `>` and `&` are written as \u003c and so on, so
   that a text cannot close an HTML element. Invalid UTF-8 becomes U+FFFD; NULL
   becomes null. */
void json_text(GString *out, const char *text);

/* Append a number in its shortest form with `digits` significant digits; null
   if not finite. */
void json_number(GString *out, double x, int digits);

/* Append n integers as a text: base64 of the zlib format (RFC 1950) of their
   differences, 32 bits each, lowest byte first. Number i is difference i plus
   number i - stride. */
void json_packed(GString *out, const int32_t *numbers, size_t n, size_t stride);

/* Append n bytes as a text: base64 of their zlib format. */
void json_bytes(GString *out, const void *bytes, size_t n);
