/* SPDX-License-Identifier: BSD-3-Clause */
/* Texts of others, as they can be shown: messages of plugins, names of files.
   Valid UTF-8 that does nothing to a terminal. [any] */
#ifndef OPC_BASE_SHOWN_H
#define OPC_BASE_SHOWN_H

/* A byte that is no UTF-8 becomes "\xNN"; a character that cannot be printed
   "\n", "\t" or "\u{NNNN}", unless it is one of `keep`: without "\n" there, the
   text cannot pass for several lines. Freed with g_free(). */
char *opc_shown(const char *text, const char *keep);

/* The same of a JSON document, by JSON's own rules. Freed with g_free(). */
char *opc_shown_json(const char *json);

#endif
