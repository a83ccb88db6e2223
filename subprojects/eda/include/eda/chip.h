/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistors of a mask by classes: classes and edge displacements of all
   transistors of a hierarchical layout. A class is a set of transistors whose
   masks are equal within the range of optical interaction (eda_mask, gates.h).
   The mask of any window (a rectangle of the layout) follows from the
   displacements, so the whole layout need not be flattened. [any]: see
   opcflow/plugin.h. */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>
#include <eda/segment.h>

OPC_C_BEGIN

/* A transistor. The coordinates of its mask are l along L and w along W,
   counted from the low end of `box`, or from the high end where `flip` is set.
   In these coordinates, the "own coordinates" of a transistor, the mask of a
   cell is equal in all eight orientations. */
typedef struct eda_chip_gate {
  eda_box box;        /* drawn gate in the layout, grid units */
  uint32_t mask;      /* index in eda_chip.mask */
  uint32_t print;     /* class: index in the gates of the eda_mask */
  uint8_t type, axis; /* EDA_NMOS ..., EDA_X ... */
  uint8_t flip;       /* EDA_FLIP_* bits */
} eda_chip_gate;

/* Edge displacements of a transistor's mask from the drawn position, in its own
   coordinates; fields as in eda_moved (gates.h). */
typedef struct eda_chip_mask {
  int32_t w, aside, l, jog, end[2];
  uint32_t part, parts; /* parts of the gate: first index in eda_chip.part, and
                           number */
  uint32_t box, boxes;  /* added shapes and cut-outs: first index in
                           eda_chip.box, and number */
} eda_chip_mask;

/* A rectangle added to a layer of the mask, or cut out after all additions
   (`cutout` = 1); own coordinates with l as x, w as y. */
typedef struct eda_chip_box {
  eda_box box;
  uint16_t layer;
  uint16_t cutout;
} eda_chip_box;

/* All transistors of a layout. */
typedef struct eda_chip {
  const eda_layout *layout; /* must outlive the chip */
  int32_t top;              /* number of the top cell */
  eda_segment_settings
      segment; /* settings for the segmentation of windows; the texts belong to
                  the creator and must outlive the chip */
  double grid; /* mask grid, nm */
  eda_box extent;      /* bounding box of all drawn shapes, grid units */
  size_t layers;       /* number of layers, as in eda_gates */
  char **layer;        /* names; freed with free() */
  uint8_t *corrected;  /* 1: corrected layer; eda_chip_free frees this and all
                          further arrays by free(), except `gate` in a file */
  size_t count;        /* number of transistors */
  eda_chip_gate *gate; /* ordered by lowest, then leftmost corner; made
                          by eda_chip_reserve, or by eda_alloc where
                          `capacity` is 0 */
  size_t masks;        /* elements of `mask` */
  size_t prints;       /* number of classes */
  size_t parts, boxes; /* elements of `part`, and of `box` */
  /* Arrays of the lengths `masks`, `parts` and `boxes`; several transistors may
     share a mask. */
  eda_chip_mask *mask;
  eda_part *part;
  eda_chip_box *box;
  /* Shapes of the mask [0] and drawn shapes [1] as cells and arrays, for
     eda_mask_access; NULL: not made. Freed by eda_chip_free. */
  eda_layout *hierarchy[2];
  /* Gates of the whole layout, for eda_mask_flat; NULL: not made. Freed by
     eda_chip_free. */
  eda_gates *flat;
  /* 1: masks are those of cells alone, whose drawn edges can be rounded to the
     grid differently than in the layout. */
  int placed;
  /* Capacity of the file of `gate`, transistors (0: no file), and descriptor of
     the file; set by eda_chip_reserve. */
  size_t capacity;
  int file;
} eda_chip;

/* eda_chip_free: free a chip (NULL: do nothing). eda_chip_check: check the
   order of the transistors and all indices; return OPC_OK, or OPC_FAILED and
   *error. [any] */
OPC_EXPORT void eda_chip_free(eda_chip *chip);
OPC_EXPORT int eda_chip_check(const eda_chip *chip, opc_error *error);

/* Set the capacity of `gate` to at least `count` transistors. `gate` is NULL or
   made by this function. The records are in an unnamed file in the folder
   TMPDIR (environment; if not set: /var/tmp), which is mapped into memory.
   Memory does not limit the number of records, because the system reads and
   writes the records in use. Existing records remain, also after an error;
   `gate` may move; new records are zeroed. eda_chip_free closes the file.
   Return OPC_OK, or OPC_IO and *error if the folder cannot be written or has no
   space. [main] */
OPC_EXPORT int eda_chip_reserve(eda_chip *chip, size_t count, opc_error *error);

/* Make a mask by classes, which owns the chip. The mask has a gate for each
   class: box, type and axis are those of the first transistor of the class, L
   and W those of the box. The name of the gate is TOP CELL:NUMBER; NUMBER
   counts the transistors of the chip from 1. Set eda_mask.count. Figures and
   flags are zeroed. The gates also have the layers of the chip. [main] */
OPC_EXPORT eda_mask *eda_chip_mask_new(eda_chip *chip);

/* Read a mask by classes that eda_mask_save wrote. The chip has layout, grid,
   extent and layers, but no transistors. On success the mask owns the chip.
   *mask must be NULL before the call. If *mask is still NULL after a failure,
   the chip was freed; otherwise *mask owns the chip, and the caller frees
   *mask. Errors as of eda_mask_restore. [main] */
OPC_EXPORT int eda_chip_mask_restore(eda_chip *chip, const char *folder,
                                     void **mask, opc_error *error);

/* Return the index of the transistor with this drawn box, or SIZE_MAX. [any] */
OPC_EXPORT size_t eda_chip_find(const eda_chip *chip, eda_box box);

/* Return the displacements of the gates of a window of the layout; the window
   has the grid and the layers of the chip. The caller frees the displacements
   with eda_moved_free. Displacements are 0 for a gate that the chip lacks, for
   example one that the window cuts. [any] */
OPC_EXPORT eda_moved *eda_chip_moved(const eda_chip *chip,
                                     const eda_gates *window);

/* Copy the displacements of a transistor of the chip to gate i of `to`. The box
   `at` of gate i has the size of the transistor's box. [any] */
OPC_EXPORT void eda_chip_move(const eda_chip *chip, size_t gate, eda_box at,
                              eda_moved *to, size_t i);

/* eda_chip_place: transform the box `own` from the own coordinates of the gate
   with the box `gate` to layout coordinates. eda_chip_own: transform the box
   `placed` from layout coordinates to own coordinates. [any] */
OPC_EXPORT eda_box eda_chip_place(eda_box gate, uint8_t axis, uint8_t flip,
                                  eda_box own);
OPC_EXPORT eda_box eda_chip_own(eda_box gate, uint8_t axis, uint8_t flip,
                                eda_box placed);

OPC_C_END
