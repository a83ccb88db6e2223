/* SPDX-License-Identifier: BSD-3-Clause */
#include "strings.h"

#include <stdlib.h>
#include <string.h>

static size_t slot_of(const strings *s, const char *text) {
  uint64_t h = 14695981039346656037u; /* FNV-1a */
  for (const char *c = text; *c; c++) h = (h ^ (uint8_t)*c) * 1099511628211u;
  size_t i = (size_t)(h ^ h >> 32) & (s->n_slots - 1);
  while (s->slots[i] && strcmp(s->text[s->slots[i] - 1], text) != 0)
    i = (i + 1) & (s->n_slots - 1);
  return i;
}

static int enlarge(strings *s) {
  size_t room = s->room ? 2 * s->room : 64;
  const char **text = realloc(s->text, room * sizeof *text);
  if (!text) return 0;
  s->text = text;
  uint32_t *slots = calloc(2 * room, sizeof *slots);
  if (!slots || room > UINT32_MAX / 2) {
    free(slots);
    return 0;
  }
  free(s->slots);
  s->slots = slots;
  s->n_slots = 2 * room;
  s->room = room;
  for (size_t i = 0; i < s->n; i++)
    s->slots[slot_of(s, s->text[i])] = (uint32_t)(i + 1);
  return 1;
}

int64_t strings_number(strings *s, const char *text) {
  if (s->n == s->room && !enlarge(s)) return -1;
  size_t slot = slot_of(s, text);
  if (!s->slots[slot]) {
    s->text[s->n++] = text;
    s->slots[slot] = (uint32_t)s->n;
  }
  return (int64_t)s->slots[slot] - 1;
}

void strings_clear(strings *s) {
  free(s->text);
  free(s->slots);
  *s = (strings){0};
}
