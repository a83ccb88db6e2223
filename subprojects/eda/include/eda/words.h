/* SPDX-License-Identifier: BSD-3-Clause */
/* Suggestions for mistyped words. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Return the first nearest of `known`, which ends with NULL; NULL if none is
   near. Near: at most a third of the letters of the word, but at least one, are
   added, dropped or changed. Known words are cut at 64 bytes. [any] */
OPC_EXPORT const char *eda_nearest(const char *word, const char *const *known);

OPC_C_END
