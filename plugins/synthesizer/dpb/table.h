/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of first corrections over L and W, as characterize.init_adjust
   makes it: a CSV file with the columns l, w and init_adjust in nm, others
   ignored. */
#ifndef SYNTHESIZER_DPB_TABLE_H
#define SYNTHESIZER_DPB_TABLE_H

#include <opcflow/base.h>

typedef struct first_correction {
  double length, width, adjust; /* nm */
} first_correction;

typedef struct first_table {
  first_correction *row;
  size_t count;
} first_table;

/* Read a file. What it has wrong is an error with its line and column. */
int first_table_read(const char *path, first_table *out, opc_error *error);
void first_table_clear(first_table *table);

/* That of the nearest length of the table, and of the width that is nearest to
   this by its ratio among those of that length, nm. */
double first_table_look(const first_table *table, double length, double width);

#endif
