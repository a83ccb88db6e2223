/* SPDX-License-Identifier: BSD-3-Clause */
/* Filter of decks, private to the library. */
#pragma once

#include <opcflow/base.h>

/* Return a copy of the deck with all included statements, restricted to
   harmless ones (free()). NULL and OPC_INVALID in *error with FILE:LINE:COLUMN
   if any other statement occurs. Messages call the deck "deck". `.osdi FILE` is
   removed; the deck may have one before the statements that need it. *osdi
   receives that file (free()) or NULL; `osdi` may be NULL. [any] */
char *deck_write(const char *deck, char **osdi, opc_error *error);
