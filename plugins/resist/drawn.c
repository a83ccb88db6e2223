/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the length of the shortest gates of a layout, and their pitch. */
#include "drawn.h"

#include <eda/index.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

/* Largest space between neighbours, nm; equal to `isolation` of calibrate.c. */
static const double reach = 4000;

/* Assumed ratio of pitch to line if all gates are isolated. Line and pitch of
   the processes in flows/processes: 130 and 310 nm (ratio 2.4), 150 and 430 nm
   (2.9), 65 and 250 nm (3.8), 50 and 190 nm (3.8). */
static const double lines_in_pitch = 3;

/* Return the box of a gate, transposed so that its length is along x. */
static eda_box gate_turned(const eda_gates *g, size_t i) {
  eda_box b = g->box[i];
  return g->axis[i] == EDA_X ? b : (eda_box){b.y0, b.x0, b.y1, b.x1};
}

/* Return twice the distance, in grid steps, between the centres of gate i and
   of the nearest gate on its HIGH side along L. A centre may be between two
   grid points, hence twice. Only gates of the same axis, at least partly beside
   gate i, count. Return 0 if there is none within `reach`, or if the nearest
   gate is longer than `most` nm. */
static int64_t pitch_of(const eda_gates *g, const eda_index *index, size_t i,
                        double most) {
  eda_box own = gate_turned(g, i), window = own;
  int64_t best = 0;
  size_t next = i;
  window.x1 = (int32_t)fmin(own.x1 + ceil(reach / g->grid), INT32_MAX);
  if (g->axis[i] != EDA_X)
    window = (eda_box){window.y0, window.x0, window.y1, window.x1};
  eda_finder f = eda_index_find(index, window);
  for (uint32_t j; eda_index_next(&f, &j);) {
    if (g->axis[j] != g->axis[i]) continue;
    eda_box b = gate_turned(g, j);
    int64_t by = (int64_t)b.x0 + b.x1 - own.x0 - own.x1;
    if (b.x0 < own.x1 || b.y0 >= own.y1 || b.y1 <= own.y0) continue;
    if (best && by >= best) continue;
    best = by;
    next = j;
  }
  return g->length[next] <= most ? best : 0;
}

/* Sort n > 0 numbers and return the most frequent number, the smallest of
   equally frequent numbers. *times receives the number of its occurrences. */
static int64_t most_frequent(int64_t *all, size_t n, size_t *times) {
  int64_t best = 0;
  *times = 0;
  qsort(all, n, sizeof *all, eda_int64s_rise);
  for (size_t from = 0, to; from < n; from = to) {
    for (to = from; to < n && all[to] == all[from];) to++;
    if (to - from <= *times) continue;
    *times = to - from;
    best = all[from];
  }
  return best;
}

int resist_drawn_of(const eda_gates *g, resist_drawn *out) {
  *out = (resist_drawn){.line = INFINITY};
  if (!g->count) return 0;
  for (size_t i = 0; i < g->count; i++)
    out->line = fmin(out->line, g->length[i]);
  double most = out->line + g->grid / 2; /* lengths within half a grid step are
                                            equal */
  int64_t *pitch = eda_alloc(g->count, sizeof *pitch);
  eda_index *index = eda_index_new(g->box, g->count,
                                   (int32_t)fmin(reach / g->grid, INT32_MAX));
  for (size_t i = 0; i < g->count; i++) {
    if (g->length[i] > most) continue;
    out->gates++;
    int64_t twice = pitch_of(g, index, i, most);
    if (twice) pitch[out->pitches++] = twice;
  }
  out->pitch = out->pitches
                   ? (double)most_frequent(pitch, out->pitches, &out->equal) *
                         g->grid / 2
                   : lines_in_pitch * out->line;
  eda_index_free(index);
  free(pitch);
  return 1;
}
