/* SPDX-License-Identifier: BSD-3-Clause */
/* Instance, cell, and number within the cell of each gate. */
#include <stdlib.h>
#include <string.h>

#include "segment/segment.h"

/* Longest path, bytes; longer paths are truncated. */
enum { LONGEST_PATH = 1 << 16 };

char *segment_path(const segment *s, uint32_t placement, int32_t *cell) {
  for (size_t capacity = 256;; capacity *= 4) {
    char *path = eda_alloc(capacity, 1);
    *cell = eda_layout_path(s->layout, s->top, placement, path, capacity);
    if (strlen(path) + 1 < capacity || capacity >= LONGEST_PATH) return path;
    free(path);
  }
}

typedef struct member {
  uint32_t placement, gate;
} member;

EDA_COMPARE_RISING(by_placement, member, placement, gate);

void segment_name(segment *s) {
  eda_gates *g = s->gates;
  size_t n = g->count;
  if (s->window && !s->settings->paths) {
    char *none = eda_gates_text(g, "");
    for (size_t i = 0; i < n; i++) g->instance[i] = g->cell[i] = none;
    return;
  }
  member *members = eda_alloc(n, sizeof *members);
  for (size_t i = 0; i < n; i++)
    members[i] = (member){s->placement[i], (uint32_t)i};
  qsort(members, n, sizeof *members, by_placement);
  char *instance = NULL, *cell = NULL;
  uint32_t number = 0;
  for (size_t k = 0; k < n; k++) {
    const member *m = &members[k];
    if (k == 0 || m->placement != members[k - 1].placement) {
      int32_t drawn_by;
      char *path = segment_path(s, m->placement, &drawn_by);
      instance = eda_gates_text(g, path);
      cell = eda_gates_text(
          g, drawn_by < 0 ? "" : eda_layout_cell_name(s->layout, drawn_by));
      free(path);
      number = 0;
    }
    g->instance[m->gate] = instance;
    g->cell[m->gate] = cell;
    g->number[m->gate] = s->window ? 0 : ++number;
  }
  free(members);
}
