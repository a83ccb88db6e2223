/* SPDX-License-Identifier: BSD-3-Clause */
/* Filter of decks, private to the library. */
#pragma once

#include <opcflow/base.h>

/* Return a copy of the deck (free()) in which includes are replaced by the
   included statements. The copy contains only statements that the filter
   accepts (deck.c). If the deck has another statement, return NULL and
   OPC_INVALID in *error with FILE:LINE:COLUMN, where FILE is "deck" for the
   deck itself. A statement `.osdi FILE` (at most one, before the statements
   that need it) is removed, and FILE is written to *osdi (g_free; NULL if
   absent). `osdi` may be NULL. [any] */
char *deck_write(const char *deck, char **osdi, opc_error *error);
