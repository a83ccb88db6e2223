/* SPDX-License-Identifier: BSD-3-Clause */
/* Suggestions for mistyped words. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Return the first word of the NULL-terminated array `known` with the smallest
   edit distance (letters added, removed, changed or swapped); upper and lower
   case are equal. Return NULL if the distance exceeds max(1, n / 3) for a word
   of n letters, or if no letter is common. Only the first 64 letters count.
   [any]: opcflow/plugin.h. */
OPC_EXPORT const char *eda_nearest(const char *word, const char *const *known);

OPC_C_END
