/* SPDX-License-Identifier: BSD-3-Clause */
/* Composition of a circuit's mask from the masks of its cells. */
#pragma once

#include <eda/index.h>

#include <correct/entry.h>
#include <correct/units.h>

/* Displacements of a circuit's transistors, and the figures of the transistors
   in the cells. */
typedef struct stitch {
  const eda_gates *gates;
  double unit; /* database unit of the layout, nm */
  eda_moved *moved;
  uint8_t *known;       /* [gates], 1: has the mask of a cell */
  eda_performance cell; /* figures of known transistors in the cell alone */
  eda_index *index;     /* index of the transistors' boxes */
} stitch;

void stitch_init(stitch *stitch, const eda_gates *gates, double unit);
void stitch_clear(stitch *stitch);

/* Place a cell. Each transistor of the circuit that matches a transistor of the
   cell in position, type, flavour and size receives the displacements of that
   transistor. Returns the number of the cell's transistors without a match. */
size_t stitch_place(stitch *stitch, const entry *cell, const turn *at);
