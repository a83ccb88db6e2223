/* SPDX-License-Identifier: BSD-3-Clause */
/* Edit distances and suggestions. */
#include <base/suggest.h>
#include <string.h>

enum { LONGEST = 64 };

unsigned opc_edit_distance(const char *a, const char *b) {
  size_t m = strnlen(a, LONGEST), n = strnlen(b, LONGEST);
  /* Three rows of the table: a swap refers to the row before the last. */
  unsigned rows[3][LONGEST + 1];
  for (size_t j = 0; j <= n; j++) rows[0][j] = (unsigned)j;
  for (size_t i = 1; i <= m; i++) {
    unsigned *now = rows[i % 3];
    const unsigned *last = rows[(i + 2) % 3], *before = rows[(i + 1) % 3];
    now[0] = (unsigned)i;
    for (size_t j = 1; j <= n; j++) {
      unsigned best = last[j - 1] + (a[i - 1] != b[j - 1]);
      best = MIN(best, last[j] + 1);
      best = MIN(best, now[j - 1] + 1);
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        best = MIN(best, before[j - 2] + 1);
      now[j] = best;
    }
  }
  return rows[m % 3][n];
}

const char *opc_nearest(const char *word, const GPtrArray *words) {
  unsigned limit = MAX(1, (unsigned)strnlen(word, LONGEST) / 3);
  const char *nearest = NULL;
  g_autofree char *low = g_ascii_strdown(word, -1);
  for (guint i = 0; i < words->len; i++) {
    g_autofree char *its = g_ascii_strdown(words->pdata[i], -1);
    unsigned distance = opc_edit_distance(low, its);
    /* If the distance is the word's length, no letter is common. */
    if (distance > limit || distance >= strnlen(words->pdata[i], LONGEST))
      continue;
    limit = distance ? distance - 1 : 0;
    nearest = words->pdata[i];
    if (!distance) break;
  }
  return nearest;
}

char *opc_suggestion(const char *word, const GPtrArray *words) {
  const char *nearest = opc_nearest(word, words);
  return nearest ? g_strdup_printf(", did you mean '%s'?", nearest)
                 : g_strdup("");
}

char *opc_suggestion_of(const char *word, char *const *words) {
  g_autoptr(GPtrArray) list = g_ptr_array_new();
  for (; *words; words++) g_ptr_array_add(list, *words);
  return opc_suggestion(word, list);
}

/* Suggest an id that is near the word, else an id whose last word is near. */
static char *suggestion_of_word(const char *word, const GPtrArray *ids) {
  g_autoptr(GPtrArray) lasts = g_ptr_array_new();
  const char *nearest = opc_nearest(word, ids);
  for (guint i = 0; i < ids->len && !nearest; i++) {
    const char *id = ids->pdata[i], *dot = id ? strrchr(id, '.') : NULL;
    g_ptr_array_add(lasts, (char *)(dot ? dot + 1 : id));
  }
  const char *last = nearest ? NULL : opc_nearest(word, lasts);
  guint i;
  if (last && g_ptr_array_find(lasts, last, &i)) nearest = ids->pdata[i];
  return nearest ? g_strdup_printf(", did you mean '%s'?", nearest)
                 : g_strdup("");
}

char *opc_suggestion_of_id(const char *id, const GPtrArray *ids) {
  const char *dot = strchr(id, '.'), *best = NULL;
  unsigned least = G_MAXUINT;
  if (!dot) return suggestion_of_word(id, ids);
  g_autofree char *turned =
      g_strdup_printf("%s.%.*s", dot + 1, (int)(dot - id), id);
  for (guint i = 0; i < ids->len && least; i++) {
    const char *other = ids->pdata[i], *its = strchr(other, '.');
    gboolean same = !strcmp(other, turned);
    if (!same && (!its || strcmp(its, dot) != 0)) continue;
    unsigned distance = same ? 0 : opc_edit_distance(id, other);
    if (distance >= least) continue;
    least = distance;
    best = other;
  }
  return best ? g_strdup_printf(", did you mean '%s'?", best)
              : opc_suggestion(id, ids);
}
