/* SPDX-License-Identifier: BSD-3-Clause */
/* Writing JSON that may stand in a page: what is packed, and texts of which no
   character ends a script. */
#ifndef OPCFLOW_REPORT_JSON_H
#define OPCFLOW_REPORT_JSON_H

#include <glib.h>
#include <stdint.h>

/* A text in quotes. `<`, `>` and `&` are written as \u003c and so on, so that
   no text closes the element around it or opens another. What is no UTF-8
   becomes U+FFFD. NULL: null. */
void json_text(GString *out, const char *text);

/* A number in its shortest form that gives `digits` significant ones; null for
   what is none. */
void json_number(GString *out, double x, int digits);

/* n integers, as a text: base64 of zlib's form (RFC 1950) of their differences,
   32 bits each, the lowest byte first. Number i is the sum of difference i and
   number i - stride. */
void json_packed(GString *out, const int32_t *numbers, size_t n, size_t stride);

/* n bytes, as a text: base64 of zlib's form of them. */
void json_bytes(GString *out, const void *bytes, size_t n);

#endif
