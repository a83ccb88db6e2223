/* SPDX-License-Identifier: BSD-3-Clause */
/* Printable copies of foreign texts, such as messages of plugins and names of
   files: valid UTF-8 without control characters. All functions are [any]. */
#pragma once

#include <stddef.h>

/* Return a printable copy (g_free). An invalid byte becomes "\xNN"; an
unprintable character becomes the escape "
", "\t" or "\u{NNNN}" unless listed in `keep`. If `keep` has no line break, the
result is a single line. */
char *opc_shown(const char *text, const char *keep);

/* Return a printable copy of a JSON document with the escapes of JSON
   (g_free). */
char *opc_shown_json(const char *json);

/* Truncate a text of at most `size` bytes before the first invalid UTF-8 byte,
   and replace control characters by blanks. */
void opc_show_in_place(char *text, size_t size);
