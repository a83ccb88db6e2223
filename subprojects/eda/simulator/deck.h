/* SPDX-License-Identifier: BSD-3-Clause */
/* What a deck and the files that it names come to. Inside the library only. */
#pragma once

#include <opcflow/base.h>

/* The deck written anew: of what it says and of what it includes, the
   statements that are known to be harmless. To be freed with free(); NULL and
   *error, OPC_INVALID with FILE:LINE:COLUMN, if there is any other. The deck
   itself is called "deck". `.osdi FILE`, of the deck's own and before what
   needs it, is taken out: *osdi, unless it is NULL, is that file, to be freed,
   or NULL. [any] */
char *deck_write(const char *deck, char **osdi, opc_error *error);
