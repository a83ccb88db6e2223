/* SPDX-License-Identifier: BSD-3-Clause */
/* Correction of a layout by classes: transistors in equivalent optical
   environments form a class and get the same mask. The environment of a
   transistor is the shapes within the range of optical interaction. The result
   is a mask by classes (eda/gates.h). All functions are for the main thread. */
#pragma once

#include <eda/chip.h>

#include <correct/settings.h>

/* Masks of cells, corrected alone, as the first masks of the classes. */
typedef struct classes_cells {
  int used;             /* 1: start from the masks of cells */
  int verify;           /* 0: keep these masks and their figures in the cells */
  const char *boundary; /* layer of the boxes in which cells abut: each cell is
                           corrected among copies of itself; NULL: alone */
  double max_diff; /* largest |Ion deviation| beyond that in the cell, %, for
                      which a transistor keeps its mask (thesis eq. 4.1); NAN:
                      as without cells */
} classes_cells;

/* A layout and the settings of its correction. Texts and settings must outlive
   the mask. */
typedef struct classes_request {
  const opc_host *host;
  const eda_layout *layout;
  const char *
      top; /* name of the cell; NULL: the only cell that no other cell places */
  eda_segment_settings segment;
  const correct_settings *with;
  double radius;  /* nm, within which equal shapes get equal masks; NAN: default
                   */
  double margin;  /* nm, range of optical interaction */
  double window;  /* side of the squares in which the layout is read, nm */
  int64_t rounds; /* largest number of rounds in which classes are split */
  int sample;     /* 1: find the transistors of at most 15 windows, spread over
                     the layout, to estimate the number of classes; 0: of all
                     windows */
  classes_cells cells;
} classes_request;

/* Models of later simulations of the mask; must outlive the mask. */
typedef struct classes_source {
  const opc_host *host;
  const correct_settings *with;
  double margin; /* nm */
} classes_source;

/* Return the range of optical interaction, nm: `margin`, or the default for the
   accuracy of `with` if it is NAN. */
OPC_EXPORT double correct_classes_margin(const correct_settings *with,
                                         double margin);

/* A layout, divided into classes. */
typedef struct division division;

/* Find all transistors of the layout, or of a sample of windows, and their
   classes of equal drawn environments. Prepare the models, except for a sample,
   which cannot be corrected. The caller frees *out with correct_classes_free,
   also after an error. Return OPC_OK, or another code and *error; OPC_INVALID
   if the whole layout has no transistors. */
OPC_EXPORT int correct_classes_find(const classes_request *request,
                                    division **out, opc_error *error);
/* Free a divided layout. */
OPC_EXPORT void correct_classes_free(division *division);

/* Return the number of classes, and in *transistors the number of transistors.
 */
OPC_EXPORT size_t correct_classes_count(const division *division,
                                        size_t *transistors);

/* Correct all classes, verify all transistors, and publish tables, metrics and
   findings. *mask receives the mask. */
OPC_EXPORT int correct_classes_correct(division *division,
                                       const classes_source *source,
                                       void **mask, opc_error *error);

/* correct_classes_sketch: make a mask by classes without transistors, for
   opc_step.sketch. correct_classes_restore: read a mask that correct_save_mask
   wrote, for opc_step.restore. */
OPC_EXPORT int correct_classes_sketch(const classes_request *request,
                                      const classes_source *source, void **mask,
                                      opc_error *error);
OPC_EXPORT int correct_classes_restore(const classes_request *request,
                                       const classes_source *source,
                                       const char *folder, void **mask,
                                       opc_error *error);

/* Set eda_mask.access of a mask by classes. */
OPC_EXPORT void correct_classes_access(eda_mask *mask,
                                       const classes_source *source);
