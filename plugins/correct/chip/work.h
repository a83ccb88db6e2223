/* SPDX-License-Identifier: BSD-3-Clause */
/* What the phases of correct.chip share. Lengths in grid steps, unless nm is
   said. */
#ifndef CORRECT_CHIP_WORK_H
#define CORRECT_CHIP_WORK_H

#include <eda/chip.h>
#include <eda/regulator.h>
#include <eda/rules.h>
#include <glib.h>
#include <opcflow/pieces.h>
#include <opcflow/step.h>

#include <correct/settings.h>

#include "cover.h"
#include "sheet.h"
#include "surround.h"

/* A transistor as the scan finds it. */
typedef struct found {
  eda_box box;
  uint8_t type, axis, unused; /* no byte is left out: it is kept as it is */
  surround around;
} found;

/* Rules that are not kept (faults.c). */
typedef struct faults faults;

typedef struct work {
  const opc_host *host;
  const correct_settings *with;
  int32_t margin; /* how far light counts */
  int32_t radius, along, window, gap;
  int ways; /* in which a transistor may lie, 1, 4 or 8 */
  int64_t rounds;
  size_t round;   /* of proofs */
  eda_chip *chip; /* what becomes the result */

  /* Of the scan: all transistors, in the order of the chip's. */
  found *found;
  size_t room;

  /* Classes by what is drawn: chip->mask has one mask for each, and refined
     ones after these. `first` is the transistor that a mask was made for. */
  uint32_t *first;
  size_t classes, mask_room, part_room, box_room;
  eda_figures *before; /* of each mask: with all edges as drawn */
  uint32_t *flags_before;

  /* Classes by what is masked: `print_first` of each print. */
  GHashTable *prints; /* from a sum to the number of its print + 1 */
  GPtrArray *sums;    /* what it points to */
  uint32_t *print_first;
  size_t print_room;
  uint8_t *tried; /* of each print: it was refined already */
  size_t tried_room;

  faults *faults; /* of all prints */

  /* What was done, for the report. */
  size_t windows, sheets, refined, simulations, fine_simulations;
  eda_gates *last;    /* of the sheet before */
  double worst;       /* |Ion deviation| so far, % */
  double share, done; /* of the progress: of all, and before this phase */
} work;

void work_clear(work *work);

/* scan.c: all transistors of the layout, window by window, and their classes.
   Fills chip->gate and `first`. */
int scan_all(work *work, opc_error *error);

/* mend.c: a mask for the first transistor of each class, corrected where it
   stands. */
int mend_classes(work *work, opc_error *error);
/* Another mask for those of n prints, all others still, where that is better;
   all transistors of these prints take it. */
int mend_prints(work *work, const uint32_t *prints, size_t n, opc_error *error);

/* prove.c: print all that is masked as nothing that was printed before.
   chip->print and the `print` of each transistor. */
int prove_all(work *work, opc_error *error);
/* |Ion deviation| of a print, %; INFINITY if it is no transistor. */
double prove_off(const eda_chip_print *print);

/* A table of sums (SUM_SIZE bytes, whose owner keeps them) to numbers. */
GHashTable *work_sums(void);

/* faults.c: rules that are not kept, by the transistor that is nearest. */
faults *faults_new(void);
void faults_free(faults *faults);
/* Those of a sheet's mask and its print, as bytes. [main] */
int faults_find(const work *work, const sheet *sheet,
                const eda_printed *printed, opc_bytes *out, opc_error *error);
/* These bytes, of places from the print `first` on. */
void faults_take(work *work, size_t first, const char *bytes, const char *end);
/* Tables, findings and metrics of what is left: as many rows as there are
   rules. */
int faults_tell(const work *work, opc_error *error);

/* tell.c */
int tell_all(const work *work, opc_error *error);

/* Sheets of clips that show chosen transistors. The first field of the data
   that the functions of their pieces get. */
typedef struct sheets {
  work *work;
  const uint32_t *number; /* of each transistor, in the chip */
  size_t count, done;     /* transistors; sheets */
  cover cover;
  pages pages;
  char *key;
} sheets;

/* Make sheets that show `reach` around the transistors, and do each as a piece
   of work (jobs.name, work and take). [main] */
int work_sheets(sheets *sheets, int32_t reach, opc_pieces jobs,
                opc_error *error);

/* "done of total", of this phase. */
void work_progress(const work *work, double part);

#endif
