/* SPDX-License-Identifier: BSD-3-Clause */
/* Radix sort of events by their coordinates. */
#include <glib.h>
#include <string.h>

#include "geometry/scan.h"

/* Bits of a digit, and values of a digit. Up to FEW events are sorted by
   insertion, which is then faster. */
enum { DIGIT = 11, BUCKETS = 1 << DIGIT, FEW = 96 };

static uint32_t key_of(const eda_event *e, int key) {
  return key == EDA_MINOR ? e->minor : e->major;
}

/* Sort by one digit of the key. Return 0 and write nothing if all events have
   the same digit. */
static int sort_digit(const eda_event *from, eda_event *to, size_t n, int key,
                      unsigned shift) {
  size_t place[BUCKETS] = {0};
  for (size_t i = 0; i < n; i++)
    place[(key_of(&from[i], key) >> shift) & (BUCKETS - 1)]++;
  size_t sum = 0;
  for (size_t d = 0; d < BUCKETS; d++) {
    size_t here = place[d];
    if (here == n) return 0;
    place[d] = sum;
    sum += here;
  }
  for (size_t i = 0; i < n; i++)
    to[place[(key_of(&from[i], key) >> shift) & (BUCKETS - 1)]++] = from[i];
  return 1;
}

/* Sort events by insertion. The sort is stable, as the radix sort is. */
static void sort_insertion(eda_event *events, size_t n, int key) {
  for (size_t i = 1; i < n; i++) {
    eda_event e = events[i];
    size_t at = i;
    for (; at && key_of(&events[at - 1], key) > key_of(&e, key); at--)
      events[at] = events[at - 1];
    events[at] = e;
  }
}

void eda_sort(eda_event *events, size_t n, int key) {
  if (n <= FEW) {
    sort_insertion(events, n, key);
    return;
  }
  eda_event *scratch = g_new(eda_event, n), *from = events, *to = scratch;
  for (unsigned shift = 0; shift < 32; shift += DIGIT) {
    if (!sort_digit(from, to, n, key, shift)) continue;
    eda_event *swap = from;
    from = to;
    to = swap;
  }
  if (from != events) memcpy(events, from, n * sizeof *events);
  g_free(scratch);
}

uint32_t *eda_rank_minor(eda_event *events, size_t n, uint32_t *ranks) {
  eda_sort(events, n, EDA_MINOR);
  uint32_t count = 0;
  for (size_t i = 0; i < n; i++)
    count += i == 0 || events[i].minor != events[i - 1].minor;
  uint32_t *keys = g_new(uint32_t, (gsize)count + 1);
  count = 0;
  for (size_t i = 0; i < n; i++) {
    if (count == 0 || events[i].minor != keys[count - 1])
      keys[count++] = events[i].minor;
    events[i].minor = count - 1;
  }
  *ranks = count;
  return keys;
}
