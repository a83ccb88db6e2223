/* SPDX-License-Identifier: BSD-3-Clause */
/* Suggestions for mistyped words from NULL-terminated lists. */
#include <eda/words.h>

#include <base/suggest.h>

const char *eda_nearest(const char *word, const char *const *known) {
  g_autoptr(GPtrArray) words = g_ptr_array_new();
  for (; *known; known++) g_ptr_array_add(words, (void *)*known);
  return opc_nearest(word, words);
}
