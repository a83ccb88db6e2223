/* SPDX-License-Identifier: BSD-3-Clause */
/* A row of evaluation transistors (thesis figure 3.5) of one size, far enough
   apart to be alone, printed and measured together. */
#ifndef SYNTHESIZER_INIT_ADJUST_ROW_H
#define SYNTHESIZER_INIT_ADJUST_ROW_H

#include <eda/extractor.h>
#include <eda/resist.h>

/* The layers that make a transistor: EDA_POLY and EDA_ACTIVE. */
enum { ROW_LAYERS = 2 };

/* What all rows share. Lengths in nm; `grid` is the mask's. */
typedef struct row_rules {
  const opc_context *context;
  const opc_module *litho, *resist, *extractor; /* prepared */
  double grid, extension, enclosure, margin;
  uint8_t type; /* EDA_NMOS, EDA_PMOS */
} row_rules;

typedef struct row {
  const row_rules *rules;
  double length, width; /* drawn */
  size_t count;
  int32_t *l, *w; /* biases of each, in grid steps */
  double design;  /* Ion as drawn, A */
  double *ion;    /* as printed; 0 where nothing prints */
  eda_field print[ROW_LAYERS];
  size_t slices;
  double *slice; /* widths, lengths, edge distances */
  double *own;   /* where and how wide one transistor's slices are */
  uint8_t *type;
  double *other; /* what is extracted beside Ion */
} row;

/* A row as drawn. Cleared with row_clear, also on failure. [any] */
int row_init(row *out, const row_rules *rules, double length, double width,
             size_t count, opc_error *error);

/* Print the layers whose flag is set and take Ion from the prints. [any] */
int row_print(row *r, const int layers[ROW_LAYERS], opc_error *error);

void row_clear(row *r);

#endif
