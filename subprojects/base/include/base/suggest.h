/* SPDX-License-Identifier: BSD-3-Clause */
/* "Did you mean": the known word that is nearest to a mistyped one. */
#ifndef OPC_BASE_SUGGEST_H
#define OPC_BASE_SUGGEST_H

#include <glib.h>

/* The edits from one word to the other: insert, remove, replace a byte, swap
   two neighbours (Damerau-Levenshtein, restricted). Words are cut at 64. */
unsigned opc_edit_distance(const char *a, const char *b);

/* The nearest of `words` (const char *), NULL if none is near: at most a third
   of the word's letters may be wrong, and one where it is that short. The first
   of equals. */
const char *opc_nearest(const char *word, const GPtrArray *words);

/* The same for names of two words with a dot between, which may have been
   called otherwise before: one of the words in the other order, else the
   nearest of those with the same last word, comes first. */
char *opc_suggestion_of_id(const char *id, const GPtrArray *ids);

/* ", did you mean 'x'?" or "". */
char *opc_suggestion(const char *word, const GPtrArray *words);
/* The same, of words that end with NULL. */
char *opc_suggestion_of(const char *word, char *const *words);

#endif
