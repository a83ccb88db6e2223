/* SPDX-License-Identifier: BSD-3-Clause */
/* State shared by the phases of a correction by classes. Lengths are in grid
   steps unless stated otherwise. */
#pragma once

#include <eda/chip.h>
#include <eda/print.h>
#include <eda/regulator.h>
#include <eda/rules.h>
#include <glib.h>
#include <math.h>
#include <opcflow/pieces.h>
#include <opcflow/step.h>

#include <correct/classes.h>

#include "cover.h"
#include "environment.h"
#include "sheet.h"

/* A transistor found by the scan. The records are stored as bytes in the
   results store. */
typedef struct found {
  eda_box box;
  uint8_t type, axis, unused; /* unused: explicit padding */
  environment around;
  uint32_t kind; /* cells_kind */
} found;

/* Figures of a transistor as printed from the drawn mask. */
typedef struct drawn_print {
  eda_figures figures;
  uint32_t flags, unused; /* EDA_PRINT_*; unused: explicit padding */
} drawn_print;

/* Result of the simulation of a transistor, shared by all transistors with the
   same mask shapes in their optical environment. */
typedef struct class_result {
  eda_figures design, before, after; /* of the drawn shapes; of the contours of
                                        the drawn and of the corrected mask */
  double length, width;              /* drawn L and W, nm */
  double extension[2];               /* of the printed line ends, nm */
  uint32_t flags_before, flags;      /* EDA_PRINT_* */
  uint32_t violations;               /* number of violated design rules */
} class_result;

/* Figures of a mask in the cell for which it was made. `known`: 0: the mask was
   made in the layout. `seen`: ln(Ion of a fast simulation / Ion of an accurate
   one), as in eda_moved. */
typedef struct alone {
  class_result result;
  double seen;
  uint32_t known, unused; /* unused: explicit padding */
} alone;

/* Rule violations (faults.c). */
typedef struct faults faults;

/* State of the correction. */
struct division {
  const opc_host *host;
  const correct_settings *with;
  int32_t margin; /* range of optical interaction */
  /* Radius of a drawn environment, within which neighbours of a representative
     are corrected, too; side of a window; distance of clips on a sheet. */
  int32_t radius, window, gap;
  int orientations; /* number of equivalent orientations: 1, 4 or 8 */
  int sample;       /* as in classes_request */
  int64_t rounds;
  size_t round; /* round of verification */
  classes_cells cells;
  eda_chip *chip;  /* the output of the step */
  int32_t tallest; /* largest height of a transistor's box */

  /* Classes of drawn environments. chip->mask has one mask for each class,
     followed by the masks of refinements. `first`: [classes], the
     representative, which is corrected. */
  uint32_t *first;
  size_t classes, mask_capacity, part_capacity, box_capacity;
  drawn_print *before; /* [masks], figures with all edges as drawn */
  alone *alone;        /* [masks], NULL without cells */
  uint32_t *kind;      /* [classes], cells_kind of the representative */
  /* [classes], number of members while representatives are chosen; else NULL */
  const uint32_t *members;

  /* Classes of equal masked environments, called prints. */
  class_result *print;   /* [chip->prints] */
  GHashTable *prints;    /* maps a checksum to the print number + 1 */
  GPtrArray *sums;       /* owner of the checksums */
  uint32_t *print_first; /* [prints], the simulated transistor */
  size_t print_capacity;
  uint8_t *tried; /* [prints], 1: was corrected individually */

  faults *faults; /* violations of all prints */

  /* Counts for the report. */
  size_t windows, sheets, refined, iterations, simulations, fine_simulations;
  double worst;       /* largest |Ion deviation| so far, % */
  double share, done; /* progress: share of this phase; sum of the shares of
                         earlier phases */
};
/* Name of the state in this folder. */
typedef struct division work;

/* Find all transistors window by window and group them into classes. Fill
   chip->gate and `first`. (scan.c) */
int scan_all(work *work, opc_error *error);
/* Compute the extent of the layers with transistors. */
int scan_extent(eda_chip *chip, opc_error *error);

/* Make the member with the most frequent wider environment the representative
   of each class. Among several such members, choose the lowest, then the
   leftmost. (representatives.c) */
void representatives_choose(work *work);

/* Correct the representative of each class in place. (correction.c) */
int correct_classes(work *work, opc_error *error);
/* Give each class the mask that its representative has in its cell alone.
   mask[k] receives the number of the mask of class k. Classes whose
   representative is not in a cell are not changed. (library.c) */
int cells_correct(work *work, uint32_t *mask, opc_error *error);
/* Correct the transistors of n prints individually, with the masks of all other
   transistors fixed. A better mask replaces the mask of all transistors of the
   print. (correction.c) */
int correct_prints(work *work, const uint32_t *prints, size_t n,
                   opc_error *error);

/* Set the print of each transistor according to its masked environment within
   `margin`. New prints have no figures yet. With `members`, the only member of
   a class gets no print. (verification.c) */
void prints_find(work *work);
/* Remove all prints and their figures. */
void prints_clear(work *work);
/* Simulate one transistor of each new masked environment. Fill work.print and
   the `print` of each transistor. */
int verify_all(work *work, opc_error *error);
/* Return the |Ion deviation| of a transistor, or of a print, %; INFINITY if the
   transistor does not print. `flags`: EDA_PRINT_*. */
static inline double ion_deviation(uint32_t flags, double ion, double drawn) {
  return eda_print_failed(flags) ? INFINITY : fabs(eda_deviation(ion, drawn));
}
double print_deviation(const class_result *print);
/* Return the |Ion deviation|, %, below which a new mask replaces the mask of a
   transistor; NAN: the mask is not refined. A print is refined if it violates a
   rule, or if it deviates by more than mask_limit. */
double print_beyond(const work *work, const eda_chip_gate *gate);
/* Return the |Ion deviation|, %, beyond which a mask is refined: `ion_limit` or
   a part of it. With `max_diff`, the limit is the deviation in the cell plus
   `max_diff` (thesis eq. 4.1). */
double mask_limit(const work *work, uint32_t mask);
/* Return 1 if a refinement with `max_diff` starts from the present masks, so
   that only transistors beyond their limits get another mask. */
int work_continues(const work *work);
/* Return 1 if the masks are simulated by the fast model, and the results
   corrected by the ratio of the models in the cells. */
int work_is_fast(const work *work);

/* Return a new hash table that maps checksums (SUM_SIZE bytes, not owned) to
   numbers. */
GHashTable *work_sums(void);

/* Create a collection of rule violations. Each violation belongs to the nearest
   transistor. (faults.c) */
faults *faults_new(void);
/* Free the collection. */
void faults_free(faults *faults);
/* Append the violations of a sheet's mask and printed image to `out`. Call on
   the main thread. */
int faults_find(const work *work, const sheet *sheet,
                const eda_printed *printed, opc_bytes *out, opc_error *error);
/* Store the violations that faults_find wrote to the bytes from `bytes` to
   `end`. A violation contains the place of its transistor, its number among
   the transistors of the sheet; `first`: the print of place 0. */
void faults_take(work *work, size_t first, const char *bytes, const char *end);
/* Change the numbers of prints to number[print]; drop the violations of those
   with UINT32_MAX. */
void faults_renumber(faults *faults, const uint32_t *number);
/* Store the violations of the regulator's rules in a mask, at the transistor of
   the class. */
void faults_put(const work *work, eda_mask *mask);
/* Write tables, findings and metrics of the violations of all present masks,
   one row for each rule. */
int faults_report(const work *work, opc_error *error);

/* Set the number of each class that has transistors, in the order of their
   first transistors, and return the mask, which takes the chip. (report.c) */
eda_mask *report_mask(work *work);
/* Write all tables, findings and metrics of a mask made by report_mask. */
int report_all(const work *work, eda_mask *mask, opc_error *error);

/* Sheets of clips around selected transistors. The data of their work units
   begin with this structure. */
typedef struct sheets {
  work *work;
  const uint32_t *number; /* [count], numbers of the transistors in the chip */
  size_t count, done;     /* numbers of transistors and of finished sheets */
  cover cover;
  pages pages;
  char *key;
} sheets;

/* Make sheets that extend by `reach` beyond the transistors, and run a work
   unit for each sheet (jobs.name, work and take). Call on the main thread. */
int work_sheets(sheets *sheets, int32_t reach, opc_pieces jobs,
                opc_error *error);

/* Report the progress of this phase. `part`: finished part, 0 to 1. */
void work_progress(const work *work, double part);
