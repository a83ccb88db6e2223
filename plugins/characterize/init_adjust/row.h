/* SPDX-License-Identifier: BSD-3-Clause */
/* A row of evaluation transistors (thesis figure 3.5) of one size, far enough
   apart to be alone, printed and measured together. */
#ifndef OPCFLOW_INIT_ADJUST_ROW_H
#define OPCFLOW_INIT_ADJUST_ROW_H

#include <opcflow/extract.h>
#include <opcflow/litho.h>

/* What all rows share. Lengths in nm; `grid` is the mask's. */
typedef struct row_rules {
  const opc_host *host;
  const opc_module *litho, *resist, *extract;   /* prepared */
  double grid, extension, enclosure, margin;
  uint8_t type;              /* OPC_NMOS, OPC_PMOS */
} row_rules;

typedef struct row {
  const row_rules *rules;
  double length, width;      /* drawn */
  size_t count;
  int32_t *l, *w;            /* biases of each, in grid steps */
  double design;             /* Ion as drawn, A */
  double *ion;               /* as printed; 0 where nothing prints */
  opc_field print[OPC_MASKS];
  size_t slices;
  double *slice;             /* room: widths, lengths, edge distances */
  uint8_t *type;
  double *other;             /* room for what is extracted beside Ion */
} row;

/* Make a row as drawn. [any] */
int row_make(row *out, const row_rules *rules, double length, double width,
             size_t count, opc_error *error);

/* Print the layers whose flag is set and take Ion from the prints. [any] */
int row_print(row *r, const int layers[OPC_MASKS], opc_error *error);

void row_clear(row *r);

#endif
