/* SPDX-License-Identifier: BSD-3-Clause */
/* A circuit's mask from those of its cells. */
#ifndef CORRECT_LIBRARY_STITCH_H
#define CORRECT_LIBRARY_STITCH_H

#include <eda/index.h>

#include <correct/entry.h>
#include <correct/units.h>

/* The moves of a circuit's transistors, and what their cells promise of them.
 */
typedef struct stitch {
  const eda_gates *gates;
  double unit; /* nm, of the layout */
  eda_moved *moved;
  uint8_t *known;       /* 1: that transistor has one of a cell's */
  eda_performance cell; /* of the cell alone, where it is known */
  eda_index *index;     /* the transistors' boxes */
} stitch;

void stitch_init(stitch *stitch, const eda_gates *gates, double unit);
void stitch_clear(stitch *stitch);

/* Place a cell: the transistors of the circuit that are one of its, by place,
   type, flavour and size, get its moves. How many of the cell's found none. */
size_t stitch_place(stitch *stitch, const entry *cell, const turn *at);

#endif
