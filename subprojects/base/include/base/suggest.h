/* SPDX-License-Identifier: BSD-3-Clause */
/* Suggestions for mistyped words. */
#pragma once

#include <glib.h>

/* Return the edit distance of two words (restricted Damerau-Levenshtein): the
   number of insertions, deletions, replacements of a byte, and swaps of
   adjacent bytes. Words are truncated to 64 bytes. */
unsigned opc_edit_distance(const char *a, const char *b);

/* Return the first of the nearest `words` (const char *) by edit distance;
   words that differ only in case are equal. NULL if the distance exceeds a
   third of the word's length (1 for words of fewer than six bytes), or if no
   letter is common. The returned word is an element of `words`, not a copy. */
const char *opc_nearest(const char *word, const GPtrArray *words);

/* Return ", did you mean 'x'?" or "" (g_free) for an id. For an id with a dot,
   x is the id with both parts swapped; else the id with the same text after the
   first dot and the smallest edit distance, of any size; else the id that
   opc_nearest returns. For a word without a dot, x is the id that opc_nearest
   returns, else the first id whose last word is the one that opc_nearest
   returns. */
char *opc_suggestion_of_id(const char *id, const GPtrArray *ids);

/* Return ", did you mean 'x'?" (g_free), x being the word that opc_nearest
   returns; "" if there is none. */
char *opc_suggestion(const char *word, const GPtrArray *words);
/* Return the same as opc_suggestion, for a NULL-terminated list of words. */
char *opc_suggestion_of(const char *word, char *const *words);
