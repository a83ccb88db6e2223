/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the table of first corrections: reading and checking of rows, and
   lookup of the nearest row. */
#include "table.h"

#include <eda/csv.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

enum { LENGTH, WIDTH, ADJUST, COLUMNS };
static const eda_csv_column columns[COLUMNS] = {
    {"l", "nm", 0}, {"w", "nm", 0}, {"init_adjust", "nm", 0}};

/* Largest number of rows (limited because rows are compared in pairs), and
   largest |init_adjust|, nm. */
enum { MOST_ROWS = 10000, MOST_NM = 100 };

static int table_read_row(const eda_csv *csv, size_t i, first_table *out,
                          opc_error *error) {
  first_correction *row = &out->row[i];
  if (eda_csv_number(csv, i, LENGTH, 0, &row->length, error) ||
      eda_csv_number(csv, i, WIDTH, 0, &row->width, error) ||
      eda_csv_number(csv, i, ADJUST, -INFINITY, &row->adjust, error))
    return error->code;
  if (fabs(row->adjust) > MOST_NM)
    return eda_csv_fail(csv, i, ADJUST, "beyond +-100 nm:", error);
  if (i >= MOST_ROWS)
    return eda_csv_fail(csv, i, LENGTH, "more than 10000 rows, found row of L",
                        error);
  for (size_t k = 0; k < i; k++)
    if (out->row[k].length == row->length && out->row[k].width == row->width)
      return eda_csv_fail(csv, i, LENGTH, "a second row of this size, of L",
                          error);
  return OPC_OK;
}

int first_table_read(const char *path, first_table *out, opc_error *error) {
  eda_csv *csv = eda_csv_read(path, "init_adjust_table", columns, COLUMNS,
                              EDA_CSV_OTHERS, error);
  if (!csv) return error->code;
  int code = OPC_OK;
  out->count = eda_csv_rows(csv);
  out->row = eda_alloc(out->count, sizeof *out->row);
  for (size_t i = 0; i < out->count && !code; i++)
    code = table_read_row(csv, i, out, error);
  eda_csv_free(csv);
  if (code) first_table_clear(out);
  return code;
}

double first_table_find(const first_table *t, double length, double width) {
  const first_correction *best = NULL;
  for (size_t i = 0; i < t->count; i++) {
    const first_correction *row = &t->row[i];
    double by_l = fabs(row->length - length);
    double by_w = fabs(log(row->width / width));
    if (best) {
      double best_l = fabs(best->length - length);
      if (by_l > best_l) continue;
      if (by_l == best_l && by_w >= fabs(log(best->width / width))) continue;
    }
    best = row;
  }
  return best ? best->adjust : 0;
}

void first_table_clear(first_table *table) {
  free(table->row);
  *table = (first_table){0};
}
