/* SPDX-License-Identifier: BSD-3-Clause */
/* A row of isolated evaluation transistors of one size (thesis figure 3.5),
   simulated and measured together. */
#pragma once

#include <eda/extractor.h>
#include <eda/resist.h>

/* Layers of a transistor: EDA_POLY and EDA_ACTIVE. */
enum { ROW_LAYERS = 2 };

/* Properties common to all rows. Lengths are in nm. */
typedef struct row_rules {
  const opc_context *context;
  const opc_module *litho, *resist, *extractor; /* prepared modules */
  double grid;                                  /* of the mask */
  double extension; /* of the poly past the active, at each line end */
  double enclosure; /* of the gate by the active, on each side */
  double margin;    /* clear field around each transistor */
  uint8_t type;     /* EDA_NMOS, EDA_PMOS */
} row_rules;

/* A row. */
typedef struct row {
  const row_rules *rules;
  double length, width; /* drawn */
  size_t count;         /* number of transistors */
  int32_t *l, *w;       /* biases of each transistor, in grid steps */
  double design;        /* Ion as drawn, A */
  double *ion; /* Ion as printed, A; 0 for transistors that do not print */
  eda_field print[ROW_LAYERS]; /* level sets */
  size_t slices;               /* number of slices of each transistor */
  double *slice; /* widths of the slices of all transistors, then all lengths,
                    then all distances from the nearer end of the gate */
  double *own;   /* positions and widths of the slices of one transistor */
  uint8_t *type;
  double *other; /* extracted figures other than Ion */
} row;

/* Initialize a row as drawn. The caller frees it with row_clear, also after
   failure. Return OPC_OK or an error. [any] */
int row_init(row *out, const row_rules *rules, double length, double width,
             size_t count, opc_error *error);

/* Simulate the layers whose flag is set and compute Ion from the printed
   images. Return OPC_OK or an error. [any] */
int row_print(row *r, const int layers[ROW_LAYERS], opc_error *error);

/* Free the arrays of a row. */
void row_clear(row *r);
