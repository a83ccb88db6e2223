/* SPDX-License-Identifier: BSD-3-Clause */
/* What the scanline algorithms of this folder share: events and their sorting,
   an ordered set of ranks, and the vertical edges of merged shapes. */
#ifndef OPCFLOW_CORE_GEOMETRY_SCAN_H
#define OPCFLOW_CORE_GEOMETRY_SCAN_H

#include "core/plugin/host.h"

#define OPC_COORDINATE_LIMIT (INT32_C(1) << 30)

/* Coordinates as unsigned numbers of the same order. */
static inline uint32_t opc_bias(int32_t c) {
  return (uint32_t)c + (uint32_t)OPC_COORDINATE_LIMIT;
}
static inline int32_t opc_unbias(uint32_t u) {
  return (int32_t)(u - (uint32_t)OPC_COORDINATE_LIMIT);
}

/* ---- sort.c ---- */

typedef struct opc_event {
  uint32_t major, minor, payload;
} opc_event;

/* Sort by one of the two keys; equal ones keep their order. `scratch` has room
   for n as well. Linear in n. */
void opc_sort_major(opc_event *events, opc_event *scratch, size_t n);
void opc_sort_minor(opc_event *events, opc_event *scratch, size_t n);

/* Replace the minor keys by their ranks 0 .. ranks-1. Leaves the events sorted
   by it. Returns the ranks' keys (g_free), NULL if there is no memory. */
uint32_t *opc_rank_minor(opc_event *events, opc_event *scratch, size_t n,
                         uint32_t *ranks);

/* ---- rankset.c ---- */

/* A set of numbers below n: bits, and above them bits that tell which words
   are not zero, and so on; every operation is O(log n) to base 64. */
typedef struct opc_rankset {
  unsigned levels;
  uint64_t *level[6];
  uint64_t *memory;
} opc_rankset;

#define OPC_NO_RANK UINT32_MAX

/* 0 if there is no memory. n < OPC_NO_RANK. */
int opc_rankset_init(opc_rankset *set, uint32_t n);
void opc_rankset_clear(opc_rankset *set);
int opc_rankset_has(const opc_rankset *set, uint32_t r);
void opc_rankset_add(opc_rankset *set, uint32_t r);
void opc_rankset_remove(opc_rankset *set, uint32_t r);
/* The smallest member > r, the largest < r; OPC_NO_RANK if there is none. */
uint32_t opc_rankset_after(const opc_rankset *set, uint32_t r);
uint32_t opc_rankset_before(const opc_rankset *set, uint32_t r);

/* ---- checks, geometry.c ---- */

/* Refuse what the services do not take: slanted edges, coordinates out of
   bounds, more than 2^31 - 1 points. NULL is good. */
int opc_shapes_check(const opc_shapes *shapes, opc_error *error);
static inline int opc_no_memory(opc_error *error) {
  opc_fail(error, OPC_FAILED, NULL, "out of memory");
  return OPC_FAILED;
}

/* ---- boolean.c, trace.c, fracture.c ---- */

/* A vertical edge of merged shapes. */
typedef struct opc_wall {
  int32_t x, y0, y1; /* y0 < y1 */
  int32_t left;      /* 1: the interior is to its right */
} opc_wall;

/* Join the n walls of merged shapes, sorted by x, then y0, and none that could
   be joined to the next, to outlines. */
int opc_trace(const opc_wall *walls, size_t n, opc_shapes *out,
              opc_error *error);

int opc_boolean(const opc_host *host, int op, const opc_shapes *a,
                const opc_shapes *b, opc_shapes *out, opc_error *error);
int opc_fracture(const opc_host *host, const opc_shapes *shapes,
                 opc_box **boxes, size_t *count, opc_error *error);

#endif
