/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads transistors with known currents, and computes the current of each slice
   as if all weights gamma were 1. */
#include <eda/csv.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

#include "fit.h"

enum { TYPE, WIDTH, LENGTH, CURRENT, COLUMNS = CURRENT + EDA_CURRENTS };
enum { MOST_LENGTHS = 10000 };
static const eda_csv_column columns[COLUMNS] = {
    [TYPE] = {"type", NULL, 0},
    [WIDTH] = {"width", "nm", 0},
    [LENGTH] = {"length", "nm", 0},
    [CURRENT + EDA_ION] = {"ion", "A", 0},
    [CURRENT + EDA_IOFF] = {"ioff", "A", 1}};

/* Read one length, or several separated by semicolons. */
static int read_lengths(const eda_csv *c, size_t row, transistor *t,
                        opc_error *error) {
  g_auto(GStrv) words = g_strsplit(eda_csv_text(c, row, LENGTH), ";", -1);
  size_t n = g_strv_length(words);
  if (!n) return eda_csv_fail(c, row, LENGTH, "no length:", error);
  if (n > MOST_LENGTHS)
    return eda_csv_fail(c, row, LENGTH, "more than 10000 lengths:", error);
  t->length = eda_alloc(n, sizeof *t->length);
  for (t->lengths = 0; t->lengths < n; t->lengths++) {
    char *text = g_strstrip(words[t->lengths]), *end;
    double l = t->length[t->lengths] = g_ascii_strtod(text, &end);
    if (end == text || *end || !isfinite(l) || !(l > 0))
      return eda_csv_fail(c, row, LENGTH, "a length is not a number above 0 in",
                          error);
  }
  return OPC_OK;
}

static int read_row(const eda_csv *c, size_t row, transistor *t,
                    opc_error *error) {
  int code = eda_csv_type(c, row, TYPE, &t->type, error);
  if (!code) code = eda_csv_number(c, row, WIDTH, 0, &t->width, error);
  if (!code) code = read_lengths(c, row, t, error);
  for (int k = 0; k < EDA_CURRENTS; k++) {
    t->current[k] = NAN;
    if (!code && *eda_csv_text(c, row, CURRENT + k))
      code = eda_csv_number(c, row, CURRENT + k, 0, &t->current[k], error);
  }
  return code;
}

static double length_at(const transistor *t, double place) {
  double x = place * (double)(t->lengths - 1);
  size_t i = (size_t)x;
  if (i + 1 >= t->lengths) return t->length[t->lengths - 1];
  return t->length[i] + (x - (double)i) * (t->length[i + 1] - t->length[i]);
}

/* Divide a transistor into slices, which become thinner towards both edges. */
static void transistor_slice(transistor *t, const eda_curves *table) {
  for (int i = 0; i < REFERENCE_NODES; i++) {
    double s = (i + 0.5) / REFERENCE_NODES, place = s * s * (3 - 2 * s);
    double width = t->width * 6 * s * (1 - s) / REFERENCE_NODES;
    t->edge[i] = t->width * fmin(place, 1 - place);
    for (int k = 0; k < EDA_CURRENTS; k++)
      t->part[k][i] =
          width * exp(eda_curves_at(table, t->type, k, length_at(t, place)));
  }
}

/* Add the transistors of a device table, one for each type, width and length:
   rectangles with the currents of the table. */
static int read_table(const char *path, const eda_curves *table, reference *out,
                      opc_error *error) {
  eda_devices *d = eda_devices_read(path, error);
  if (!d) return error->code;
  size_t widths = d->narrow + 1;
  out->transistor = eda_alloc(2 * widths * d->count, sizeof *out->transistor);
  for (int type = 0; type < 2; type++)
    for (size_t k = 0; k < widths; k++)
      for (size_t i = 0; i < d->count; i++) {
        transistor *t = &out->transistor[out->count++];
        int narrow = k < d->narrow;
        size_t at = k * d->count + i;
        t->type = type;
        t->width = narrow ? d->narrow_width[k] : d->width;
        t->lengths = 1;
        t->length = eda_alloc(1, sizeof *t->length);
        t->length[0] = d->length[i];
        t->current[EDA_ION] =
            t->width * (narrow ? d->narrow_ion[type][at] : d->ion[type][i]);
        t->current[EDA_IOFF] =
            t->width * (narrow ? d->narrow_ioff[type][at] : d->ioff[type][i]);
        transistor_slice(t, table);
      }
  eda_devices_free(d);
  return OPC_OK;
}

/* Read the transistors of a CSV file. */
static int read_rows(const char *path, const eda_curves *table, reference *out,
                     opc_error *error) {
  eda_csv *c = eda_csv_read(path, "reference", columns, COLUMNS, 0, error);
  if (!c) return error->code;
  int code = OPC_OK;
  out->transistor = eda_alloc(eda_csv_rows(c), sizeof *out->transistor);
  for (size_t row = 0; !code && row < eda_csv_rows(c); row++) {
    transistor *t = &out->transistor[out->count++];
    code = read_row(c, row, t, error);
    if (!code) transistor_slice(t, table);
  }
  eda_csv_free(c);
  return code;
}

/* Remove the transistors whose mean length is not within the bounds. */
static void reference_keep(reference *r, double from, double to) {
  size_t n = 0;
  for (size_t i = 0; i < r->count; i++) {
    transistor *t = &r->transistor[i];
    double sum = 0;
    for (int k = 0; k < REFERENCE_NODES; k++)
      sum += length_at(t, (k + 0.5) / REFERENCE_NODES) / REFERENCE_NODES;
    if (sum >= from && sum <= to)
      r->transistor[n++] = *t;
    else
      free(t->length);
  }
  r->count = n;
}

int reference_read(const char *path, const eda_curves *table, double from,
                   double to, reference *out, opc_error *error) {
  int code = g_str_has_suffix(path, ".yaml")
                 ? read_table(path, table, out, error)
                 : read_rows(path, table, out, error);
  if (!code) reference_keep(out, from, to);
  return code;
}

void reference_clear(reference *r) {
  for (size_t i = 0; i < r->count; i++) free(r->transistor[i].length);
  free(r->transistor);
  *r = (reference){0};
}
