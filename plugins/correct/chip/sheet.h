/* SPDX-License-Identifier: BSD-3-Clause */
/* Clips of a layout side by side, as gates that can be corrected and printed
   at once. */
#ifndef CORRECT_CHIP_SHEET_H
#define CORRECT_CHIP_SHEET_H

#include <eda/chip.h>

#include "cover.h"

/* Which clips of a cover are on which sheet, and where. */
typedef struct pages {
  size_t count;      /* of sheets */
  uint32_t *page;    /* of each clip */
  eda_point *corner; /* where its low-low corner goes */
  double *area;      /* of each sheet's clips, square grid steps */
} pages;

/* In rows, the highest clips first, on sheets of about `most` a side, `gap`
   apart. [any] */
void pages_make(const cover *cover, int32_t most, int32_t gap, pages *out);
void pages_clear(pages *pages);

typedef struct sheet {
  eda_gates *gates;
  uint32_t *of;    /* of each gate: its number in the chip, */
  uint32_t *place; /* and in cover.place; UINT32_MAX: it is none of these */
  eda_point *by;   /* where it stands on the sheet less where in the chip */
} sheet;

/* Sheet number `page`: all that its clips show. Transistors that lie in a clip,
   `rim` grid steps within it, are gates. `number`, of each place, is its
   transistor's in the chip. OPC_FAILED if the layout has other transistors
   there than the chip. By all threads. [main] */
int sheet_make(const opc_context *context, const eda_chip *chip,
               const cover *from, const uint32_t *number, const pages *to,
               size_t page, int32_t rim, sheet *out, opc_error *error);
void sheet_clear(sheet *sheet);

#endif
