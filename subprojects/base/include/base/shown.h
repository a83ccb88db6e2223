/* SPDX-License-Identifier: BSD-3-Clause */
/* Printable copies of foreign texts, such as messages of plugins and names of
   files: valid UTF-8 without control characters. All functions are [any]. */
#pragma once

#include <stddef.h>

/* Return a printable copy (g_free). An invalid byte becomes "\xNN". A line
   break becomes a backslash and n, a tab a backslash and t, and any other
   unprintable character "\u{NNNN}". Characters in `keep` are not replaced. */
char *opc_shown(const char *text, const char *keep);

/* Return a printable copy of a JSON document with the escapes of JSON
   (g_free). */
char *opc_shown_json(const char *json);

/* Truncate a text in a buffer of `size` bytes, which may lack the terminating
   NUL, before the first invalid UTF-8 byte. Replace line breaks, tabs and
   escape characters by blanks. */
void opc_show_in_place(char *text, size_t size);
