/* SPDX-License-Identifier: BSD-3-Clause */
/* The instance of each gate, the cell that draws it, and its number there. */
#include <stdlib.h>
#include <string.h>

#include "segment.h"

/* Longer paths are cut. */
enum { LONGEST_PATH = 1 << 16 };

char *segment_path(const segment *s, uint32_t placement, int32_t *cell) {
  for (size_t room = 256;; room *= 4) {
    char *path = s->host->alloc(s->host, room, 1);
    if (!path) return NULL;
    *cell = s->host->layout->path(s->layout, s->top, placement, path, room);
    if (strlen(path) + 1 < room || room >= LONGEST_PATH) return path;
    s->host->free(s->host, path);
  }
}

typedef struct member {
  uint32_t placement, gate;
} member;

static int by_placement(const void *a, const void *b) {
  const member *p = a, *q = b;
  if (p->placement != q->placement) return p->placement < q->placement ? -1 : 1;
  return (p->gate > q->gate) - (p->gate < q->gate);
}

/* A growing array of characters. */
typedef struct pool {
  char *text;
  size_t used, room;
} pool;

static int append(segment *s, pool *p, const char *text) {
  size_t n = strlen(text) + 1;
  if (n > p->room - p->used) {
    size_t room = 2 * p->room + n;
    char *more = s->host->alloc(s->host, room, 1);
    if (!more) return segment_no_memory(s);
    if (p->used) memcpy(more, p->text, p->used);
    s->host->free(s->host, p->text);
    p->text = more;
    p->room = room;
  }
  memcpy(p->text + p->used, text, n);
  p->used += n;
  return OPC_OK;
}

/* Gates of one placement share a path; where[gate] is its place in the pool. */
static int name_members(segment *s, const member *members, pool *p,
                        size_t *where) {
  opc_gates *g = s->gates;
  const char *cell = NULL;
  uint32_t number = 0;
  size_t at = 0;
  for (size_t k = 0; k < g->count; k++) {
    const member *m = &members[k];
    if (k == 0 || m->placement != members[k - 1].placement) {
      int32_t drawn_by;
      char *path = segment_path(s, m->placement, &drawn_by);
      if (!path) return segment_no_memory(s);
      cell =
          drawn_by < 0 ? "" : s->host->layout->cell_name(s->layout, drawn_by);
      at = p->used;
      int code = append(s, p, path);
      s->host->free(s->host, path);
      if (code) return code;
      number = 0;
    }
    where[m->gate] = at;
    g->cell[m->gate] = cell;
    g->number[m->gate] = ++number;
  }
  return OPC_OK;
}

int segment_name(segment *s) {
  size_t n = s->gates->count;
  member *members = s->host->alloc(s->host, n, sizeof *members);
  size_t *where = s->host->alloc(s->host, n, sizeof *where);
  int code = members && where ? OPC_OK : segment_no_memory(s);
  pool p = {0};
  if (!code) {
    for (size_t i = 0; i < n; i++)
      members[i] = (member){s->placement[i], (uint32_t)i};
    qsort(members, n, sizeof *members, by_placement);
    code = name_members(s, members, &p, where);
  }
  for (size_t i = 0; !code && i < n; i++)
    s->gates->instance[i] = p.text + where[i];
  s->owned->names = p.text;
  s->host->free(s->host, members);
  s->host->free(s->host, where);
  return code;
}
