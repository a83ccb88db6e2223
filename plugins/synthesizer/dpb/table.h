/* SPDX-License-Identifier: BSD-3-Clause */
/* Table of first corrections by L and W. characterize.init_adjust writes the
   table as a CSV file with the columns l, w and init_adjust, nm. All other
   columns are ignored. */
#pragma once

#include <opcflow/base.h>

/* A row of the table. */
typedef struct first_correction {
  double length, width, adjust; /* nm */
} first_correction;

/* The table. */
typedef struct first_table {
  first_correction *row;
  size_t count;
} first_table;

/* Read a CSV file into `out`. Return OPC_OK, or an error that states line and
   column. */
int first_table_read(const char *path, first_table *out, opc_error *error);
/* Free the rows. */
void first_table_clear(first_table *table);

/* Return the first correction, nm, of the row with the nearest length and,
   among rows of that length, with the width nearest to `width` by ratio. */
double first_table_find(const first_table *table, double length, double width);
