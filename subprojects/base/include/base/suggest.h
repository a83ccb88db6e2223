/* SPDX-License-Identifier: BSD-3-Clause */
/* Suggestions for mistyped words. */
#pragma once

#include <glib.h>

/* Return the edit distance of two words: insert, remove or replace a byte, swap
   two neighbours (Damerau-Levenshtein, restricted). Words are cut at 64
   bytes. */
unsigned opc_edit_distance(const char *a, const char *b);

/* Return the first nearest of `words` (const char *), NULL if none is near: at
   most a third of the letters of the word, but at least one, may differ. Upper
   and lower case are equal. */
const char *opc_nearest(const char *word, const GPtrArray *words);

/* Return a suggestion, as opc_suggestion, for names of two words with a dot
   between. Prefer the name with both words swapped, then the nearest name with
   the same last word. For one word without a dot, prefer a near id, then an id
   with a near last word. */
char *opc_suggestion_of_id(const char *id, const GPtrArray *ids);

/* Return ", did you mean 'x'?" or "" (g_free). */
char *opc_suggestion(const char *word, const GPtrArray *words);
/* Return the same for words that end with NULL. */
char *opc_suggestion_of(const char *word, char *const *words);
