/* SPDX-License-Identifier: BSD-3-Clause */
/* The corrected mask of a layout that is never flat as a whole: what is moved
   of each transistor, by which any window of the mask can be made. Data kind
   "chip" (eda_chip). */
#ifndef EDA_CHIP_H
#define EDA_CHIP_H

#include <eda/gates.h>
#include <eda/layout.h>
#include <eda/segment.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A transistor has coordinates of its own: l along L and w along W, both from
   the LOW end of its box, or from its HIGH end where `flip` says so. In these
   a mask fits all eight ways in which a cell can lie. */
typedef struct eda_chip_gate {
  eda_box box;          /* the drawn gate, on the grid */
  uint32_t mask, print; /* of eda_chip.mask and .print */
  uint8_t type, axis;   /* EDA_NMOS ..., EDA_X ... */
  uint8_t flip;         /* EDA_FLIP_* */
} eda_chip_gate;

/* How the mask of a transistor was moved from where it is drawn, as eda_moved
   has it, in its own coordinates. */
typedef struct eda_chip_mask {
  int32_t w, aside, l, jog, end[2];
  uint32_t part, parts; /* from eda_chip.part[part] on, that many */
  uint32_t box, boxes;  /* from eda_chip.box[box] on */
} eda_chip_mask;

/* A rectangle of a layer that is added to the mask (a patch) or taken away
   after that (a bite): in own coordinates, l as x and w as y. */
typedef struct eda_chip_box {
  eda_box box;
  uint16_t layer;
  uint16_t bite;
} eda_chip_box;

/* A transistor that was printed among its neighbours, all with their masks; it
   stands for all whose surroundings are masked alike. */
typedef struct eda_chip_print {
  eda_figures design, before, after; /* drawn; drawn mask's; the mask's */
  uint32_t flags_before, flags;      /* EDA_PRINT_* */
  uint32_t violations;               /* rules that it does not keep */
} eda_chip_print;

typedef struct eda_chip {
  const eda_layout *layout; /* outlives it */
  int32_t top;
  eda_segment_settings segment; /* by which its windows are segmented; texts are
                                   the maker's, who outlives it */
  double grid;                  /* nm */
  eda_box extent;               /* of all drawn shapes */
  size_t layers;                /* as of eda_gates, */
  char **layer;                 /* freed with free(), */
  uint8_t *corrected;           /* as are all other arrays */
  size_t count;
  eda_chip_gate *gate; /* by lowest, then leftmost corner */
  size_t masks, prints, parts, boxes;
  eda_chip_mask *mask;
  eda_chip_print *print;
  eda_part *part;
  eda_chip_box *box;
} eda_chip;

/* NULL: nothing; OPC_OK if all numbers are of something that is there, else
   OPC_FAILED and *error: the release and the check of a port. [any] */
OPC_EXPORT void eda_chip_free(void *chip);
OPC_EXPORT int eda_chip_check(const void *chip, opc_error *error);

/* The number of the transistor with that box, SIZE_MAX if there is none. [any]
 */
OPC_EXPORT size_t eda_chip_find(const eda_chip *chip, eda_box box);

/* How the gates of a window of the chip's layout are moved, on the same grid
   and with the same layers; to be freed with eda_moved_free. A gate that is
   none of the chip's, as one whose active the window's edge has cut, stays as
   drawn. [any] */
OPC_EXPORT eda_moved *eda_chip_moved(const eda_chip *chip,
                                     const eda_gates *window);

/* The moves of one transistor of the chip as those of gate i of `to`, whose box
   stands at `at`: there or, as large, elsewhere. [any] */
OPC_EXPORT void eda_chip_move(const eda_chip *chip, size_t gate, eda_box at,
                              eda_moved *to, size_t i);

/* From own coordinates of a gate with that box to those of the layout, and
   back. [any] */
OPC_EXPORT eda_box eda_chip_place(eda_box gate, uint8_t axis, uint8_t flip,
                                  eda_box own);
OPC_EXPORT eda_box eda_chip_own(eda_box gate, uint8_t axis, uint8_t flip,
                                eda_box placed);

/* For the initialiser of an opc_port (opcflow/step.h). */
#define EDA_PORT_CHIP(port)                                \
  {                                                        \
    .name = port, .kind = "chip", .check = eda_chip_check, \
    .release = eda_chip_free                               \
  }

#ifdef __cplusplus
}
#endif
#endif
