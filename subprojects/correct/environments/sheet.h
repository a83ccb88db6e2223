/* SPDX-License-Identifier: BSD-3-Clause */
/* Sheets: clips of a layout placed side by side, to correct and simulate their
   transistors together. */
#pragma once

#include <eda/chip.h>

#include "cover.h"

/* Positions of the clips of a cover on sheets. */
typedef struct pages {
  size_t count;      /* number of sheets */
  uint32_t *page;    /* [clips], sheet number */
  eda_point *corner; /* [clips], position of the lower left corner */
  double *area;      /* [sheets], area of the clips, square grid steps */
} pages;

/* Place clips in rows, in the order of decreasing height, on sheets of about
   `most` by `most` grid steps. Clips are `gap` grid steps apart. Callable from
   any thread. */
void pages_make(const cover *cover, int32_t most, int32_t gap, pages *out);
/* Free the arrays. */
void pages_clear(pages *pages);

/* A sheet. */
typedef struct sheet {
  eda_gates *gates;
  uint32_t *of;    /* [gates], number in the chip */
  uint32_t *place; /* [gates], index in cover.place; UINT32_MAX: not selected */
} sheet;

/* Make sheet `page` with all shapes of its clips. A transistor becomes a gate
   if its box is at least `rim` grid steps inside the clip. `number` maps each
   place to a transistor of the chip. Returns OPC_FAILED if a transistor of the
   layout is not in the chip. Uses all threads; call on the main thread. */
int sheet_make(const opc_context *context, const eda_chip *chip,
               const cover *from, const uint32_t *number, const pages *to,
               size_t page, int32_t rim, sheet *out, opc_error *error);
/* Free the gates and the arrays of a sheet. */
void sheet_clear(sheet *sheet);

/* Make the mask of a sheet without figures. The caller frees *out, also after
   an error, before the sheet. Callable from any thread. */
int sheet_mask(const eda_chip *chip, const sheet *sheet, eda_mask **out,
               opc_error *error);
