/* SPDX-License-Identifier: BSD-3-Clause */
/* Common parts of the sweep line algorithms: events and sorting of events,
   ordered sets of ranks, and vertical edges of merged shapes. */
#pragma once

#include <eda/geometry.h>

#define EDA_COORDINATE_LIMIT (INT32_C(1) << 30)

/* Return a coordinate as an unsigned number; the order of coordinates is
   preserved. */
static inline uint32_t eda_bias(int32_t c) {
  return (uint32_t)c + (uint32_t)EDA_COORDINATE_LIMIT;
}
static inline int32_t eda_unbias(uint32_t u) {
  return (int32_t)(u - (uint32_t)EDA_COORDINATE_LIMIT);
}

/* ---- sort.c ---- */

/* A point of a sweep: two coordinates as sort keys (eda_bias), and data of the
   algorithm. */
typedef struct eda_event {
  uint32_t major, minor, payload;
} eda_event;

/* Sort events by the major or minor key, in O(n). The sort is stable. */
enum { EDA_MAJOR, EDA_MINOR };
void eda_sort(eda_event *events, size_t n, int key);

/* Sort the events by minor key, set *ranks to the number of different keys, and
   replace each minor key by its rank, from 0. Return an array with the key of
   each rank; free the array with g_free. */
uint32_t *eda_rank_minor(eda_event *events, size_t n, uint32_t *ranks);

/* ---- rankset.c ---- */

/* A set of numbers below n, stored as levels of bits. Each bit of a level marks
   a non-zero word of the level below. Operations take O(log n) with base 64. */
typedef struct eda_rankset {
  unsigned levels;
  uint64_t *level[6];
} eda_rankset;

#define EDA_NO_RANK UINT32_MAX

/* Initialise an empty set of numbers below n; n < EDA_NO_RANK. */
void eda_rankset_init(eda_rankset *set, uint32_t n);
/* Free the set; return whether r is in it; add r; remove r. */
void eda_rankset_clear(eda_rankset *set);
int eda_rankset_has(const eda_rankset *set, uint32_t r);
void eda_rankset_add(eda_rankset *set, uint32_t r);
void eda_rankset_remove(eda_rankset *set, uint32_t r);
/* eda_rankset_after: return the smallest member > r. eda_rankset_before: return
   the largest member < r. Return EDA_NO_RANK if the set has no such member. */
uint32_t eda_rankset_after(const eda_rankset *set, uint32_t r);
uint32_t eda_rankset_before(const eda_rankset *set, uint32_t r);

/* ---- checks, geometry.c ---- */

/* Return OPC_INVALID and *error for shapes that no function in this folder
   accepts: slanted edges, coordinates beyond the limit, more than 2^31 - 1
   points. NULL is valid. */
int eda_shapes_check(const eda_shapes *shapes, opc_error *error);

/* ---- trace.c ---- */

/* A vertical edge of merged shapes. */
typedef struct eda_wall {
  int32_t x, y0, y1; /* y0 < y1 */
  int32_t left; /* 1: left border, the interior is to the right of the wall;
                   0: right border */
} eda_wall;

/* Connect n walls of merged shapes to outlines and holes in *out. The walls
   must be sorted by x, then y0. Collinear walls that touch must be joined. */
void eda_trace(const eda_wall *walls, size_t n, eda_shapes *out);
