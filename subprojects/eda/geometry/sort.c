/* SPDX-License-Identifier: BSD-3-Clause */
/* Sorting events by their coordinates, digit by digit. */
#include <glib.h>
#include <string.h>

#include "geometry/scan.h"

enum { DIGIT = 11, BUCKETS = 1 << DIGIT };

/* One pass over a digit of the key; 0 if the digit is the same in all, and so
   nothing was moved. */
static int pass(const eda_event *from, eda_event *to, size_t n, int minor,
                unsigned shift) {
  size_t place[BUCKETS] = {0};
  for (size_t i = 0; i < n; i++) {
    uint32_t key = minor ? from[i].minor : from[i].major;
    place[(key >> shift) & (BUCKETS - 1)]++;
  }
  size_t sum = 0;
  for (size_t d = 0; d < BUCKETS; d++) {
    size_t here = place[d];
    if (here == n) return 0;
    place[d] = sum;
    sum += here;
  }
  for (size_t i = 0; i < n; i++) {
    uint32_t key = minor ? from[i].minor : from[i].major;
    to[place[(key >> shift) & (BUCKETS - 1)]++] = from[i];
  }
  return 1;
}

static void sort(eda_event *events, eda_event *scratch, size_t n, int minor) {
  eda_event *from = events, *to = scratch;
  for (unsigned shift = 0; shift < 32 && n > 1; shift += DIGIT) {
    if (!pass(from, to, n, minor, shift)) continue;
    eda_event *swap = from;
    from = to;
    to = swap;
  }
  if (from != events) memcpy(events, from, n * sizeof *events);
}

void eda_sort_major(eda_event *events, eda_event *scratch, size_t n) {
  sort(events, scratch, n, 0);
}

void eda_sort_minor(eda_event *events, eda_event *scratch, size_t n) {
  sort(events, scratch, n, 1);
}

uint32_t *eda_rank_minor(eda_event *events, eda_event *scratch, size_t n,
                         uint32_t *ranks) {
  sort(events, scratch, n, 1);
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
