/* SPDX-License-Identifier: BSD-3-Clause */
/* Printable forms of foreign texts, such as messages of plugins and names of
   files: valid UTF-8 without effect on a terminal. [any] */
#pragma once

#include <stddef.h>

/* Return a printable copy (g_free). An invalid byte becomes "\xNN"; an
   unprintable character becomes "\n", "\t" or "\u{NNNN}" unless listed in
   `keep`. Without "\n" in `keep`, the result is a single line. */
char *opc_shown(const char *text, const char *keep);

/* Return a printable copy of a JSON document with the escapes of JSON
   (g_free). */
char *opc_shown_json(const char *json);

/* End a text of at most `size` bytes before the first invalid UTF-8 byte, and
   replace characters that move a cursor by blanks. */
void opc_show_in_place(char *text, size_t size);
