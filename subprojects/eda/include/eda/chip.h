/* SPDX-License-Identifier: BSD-3-Clause */
/* The corrected mask of a layout that is never flattened as a whole: the edge
   displacements of each transistor, from which the mask of any window can be
   computed. Data kind "chip" (eda_chip). */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>
#include <eda/segment.h>

OPC_C_BEGIN

/* A transistor in its own coordinates: l along L and w along W, both from the
   low end of its box, or from the high end where `flip` is set. In these
   coordinates one mask fits all eight orientations of a cell. */
typedef struct eda_chip_gate {
  eda_box box;          /* drawn gate, on the grid */
  uint32_t mask, print; /* index in eda_chip.mask and in eda_chip.print */
  uint8_t type, axis;   /* EDA_NMOS ..., EDA_X ... */
  uint8_t flip;         /* EDA_FLIP_* bits */
} eda_chip_gate;

/* Displacements of a transistor's mask from the drawn one, as in eda_moved, in
   the transistor's own coordinates. */
typedef struct eda_chip_mask {
  int32_t w, aside, l, jog, end[2];
  uint32_t part, parts; /* range in eda_chip.part */
  uint32_t box, boxes;  /* range in eda_chip.box */
} eda_chip_mask;

/* A rectangle that is added to a layer of the mask, or cut out of it
   afterwards; in own coordinates, l as x and w as y. */
typedef struct eda_chip_box {
  eda_box box;
  uint16_t layer;
  uint16_t cutout;
} eda_chip_box;

/* A transistor that was simulated among its neighbours, all with their masks.
   It represents all transistors whose masked environment is the same. */
typedef struct eda_chip_print {
  eda_figures design, before, after; /* figures as drawn, by the drawn mask, by
                                        the corrected mask */
  uint32_t flags_before, flags;      /* EDA_PRINT_* */
  uint32_t violations;               /* violated design rules */
} eda_chip_print;

typedef struct eda_chip {
  const eda_layout *layout; /* outlives the chip */
  int32_t top;
  eda_segment_settings segment; /* settings for segmenting its windows; their
                                   texts belong to the maker and outlive the
                                   chip */
  double grid;                  /* nm */
  eda_box extent;               /* bounding box of all drawn shapes */
  size_t layers;                /* number of layers, as in eda_gates */
  char **layer;                 /* names; freed with free() */
  uint8_t *corrected;           /* 1 for corrected layers; this array and all
                                   others are freed with free() */
  size_t count;
  eda_chip_gate *gate; /* ordered by lowest, then leftmost corner */
  size_t masks, prints, parts, boxes;
  eda_chip_mask *mask;
  eda_chip_print *print;
  eda_part *part;
  eda_chip_box *box;
} eda_chip;

/* Free a chip (NULL: nothing); check that all indices of a chip are valid.
   Release and check functions of an output of this data kind. eda_chip_check
   returns OPC_OK, or OPC_FAILED and *error. [any] */
OPC_EXPORT void eda_chip_free(void *chip);
OPC_EXPORT int eda_chip_check(const void *chip, opc_error *error);

/* Return the number of the transistor with this box, or SIZE_MAX. [any] */
OPC_EXPORT size_t eda_chip_find(const eda_chip *chip, eda_box box);

/* Return the displacements of the gates of a window of the chip's layout, on
   the same grid and with the same layers; free with eda_moved_free. A gate that
   is not in the chip, for example because the window cuts its active area,
   stays as drawn. [any] */
OPC_EXPORT eda_moved *eda_chip_moved(const eda_chip *chip,
                                     const eda_gates *window);

/* Copy the displacements of one transistor of the chip to gate i of `to`, whose
   box `at` has the same size. [any] */
OPC_EXPORT void eda_chip_move(const eda_chip *chip, size_t gate, eda_box at,
                              eda_moved *to, size_t i);

/* Transform a box from the coordinates of a gate to those of the layout, and
   back. [any] */
OPC_EXPORT eda_box eda_chip_place(eda_box gate, uint8_t axis, uint8_t flip,
                                  eda_box own);
OPC_EXPORT eda_box eda_chip_own(eda_box gate, uint8_t axis, uint8_t flip,
                                eda_box placed);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_CHIP(port)                                \
  {                                                        \
    .name = port, .kind = "chip", .check = eda_chip_check, \
    .release = eda_chip_free                               \
  }

OPC_C_END
