/* SPDX-License-Identifier: BSD-3-Clause */
/* Nearest words by edit distance (Levenshtein). */
#include <eda/words.h>
#include <glib.h>
#include <string.h>

/* Return the number of letters to add, drop or change to turn `a` into `b`. */
static unsigned distance(const char *a, const char *b) {
  enum { LONGEST = 64 };
  unsigned row[LONGEST + 1];
  size_t n = strnlen(b, LONGEST);
  for (size_t j = 0; j <= n; j++) row[j] = (unsigned)j;
  for (size_t i = 0; a[i]; i++) {
    unsigned corner = row[0]++;
    for (size_t j = 0; j < n; j++) {
      unsigned change = corner + (a[i] != b[j]);
      corner = row[j + 1];
      row[j + 1] = MIN(change, MIN(row[j], corner) + 1);
    }
  }
  return row[n];
}

const char *eda_nearest(const char *word, const char *const *known) {
  unsigned nearest = MAX(1, (unsigned)strlen(word) / 3) + 1;
  const char *best = NULL;
  for (size_t i = 0; known[i]; i++) {
    unsigned d = distance(word, known[i]);
    if (d >= nearest || d >= strlen(known[i])) continue;
    nearest = d;
    best = known[i];
  }
  return best;
}
