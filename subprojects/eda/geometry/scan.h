/* SPDX-License-Identifier: BSD-3-Clause */
/* Common parts of the scanline algorithms of this folder: events and their
   sorting, an ordered set of ranks, and the vertical edges of merged shapes. */
#pragma once

#include <eda/geometry.h>

#define EDA_COORDINATE_LIMIT (INT32_C(1) << 30)

/* Return a coordinate as an unsigned number of the same order. */
static inline uint32_t eda_bias(int32_t c) {
  return (uint32_t)c + (uint32_t)EDA_COORDINATE_LIMIT;
}
static inline int32_t eda_unbias(uint32_t u) {
  return (int32_t)(u - (uint32_t)EDA_COORDINATE_LIMIT);
}

/* ---- sort.c ---- */

typedef struct eda_event {
  uint32_t major, minor, payload;
} eda_event;

/* Sort events by one of the two keys, in O(n); the sort is stable. */
enum { EDA_MAJOR, EDA_MINOR };
void eda_sort(eda_event *events, size_t n, int key);

/* Replace the minor keys by their ranks 0 .. ranks-1 and sort the events by
   them. Return the key of each rank (g_free). */
uint32_t *eda_rank_minor(eda_event *events, size_t n, uint32_t *ranks);

/* ---- rankset.c ---- */

/* A set of numbers below n as levels of bits: a bit of one level marks a
   non-zero word of the level below. Each operation takes O(log n) to base
   64. */
typedef struct eda_rankset {
  unsigned levels;
  uint64_t *level[6];
} eda_rankset;

#define EDA_NO_RANK UINT32_MAX

/* Initialise an empty set of numbers below n; n < EDA_NO_RANK. */
void eda_rankset_init(eda_rankset *set, uint32_t n);
void eda_rankset_clear(eda_rankset *set);
int eda_rankset_has(const eda_rankset *set, uint32_t r);
void eda_rankset_add(eda_rankset *set, uint32_t r);
void eda_rankset_remove(eda_rankset *set, uint32_t r);
/* Return the smallest member > r, or the largest member < r; EDA_NO_RANK if
   none exists. */
uint32_t eda_rankset_after(const eda_rankset *set, uint32_t r);
uint32_t eda_rankset_before(const eda_rankset *set, uint32_t r);

/* ---- checks, geometry.c ---- */

/* Return OPC_INVALID and *error for shapes that no function here accepts:
   slanted edges, coordinates out of bounds, more than 2^31 - 1 points. NULL is
   valid. */
int eda_shapes_check(const eda_shapes *shapes, opc_error *error);

/* ---- trace.c ---- */

/* A vertical edge of merged shapes. */
typedef struct eda_wall {
  int32_t x, y0, y1; /* y0 < y1 */
  int32_t left;      /* 1: the interior is to its right */
} eda_wall;

/* Join n walls to outlines and holes in *out. The walls belong to merged
   shapes, are sorted by x, then y0, and are as long as possible. */
void eda_trace(const eda_wall *walls, size_t n, eda_shapes *out);
