/* SPDX-License-Identifier: BSD-3-Clause */
#include "reference.h"

#include <math.h>
#include <stdlib.h>

#include "../../extract/csv.h"

enum { TYPE, WIDTH, LENGTH, ION_GIVEN, IOFF_GIVEN, COLUMNS,
       REQUIRED = IOFF_GIVEN, MOST_LENGTHS = 10000 };
static const char *const names[COLUMNS] = {"type", "width", "length", "ion",
                                           "ioff"};
static const char *const units[COLUMNS] = {NULL, "nm", "nm", "A", "A"};

/* One length, or several with ; between them. */
static int read_lengths(const csv *c, guint row, transistor *t,
                        opc_error *error) {
  g_auto(GStrv) words = g_strsplit(csv_text(c, row, LENGTH), ";", -1);
  size_t n = g_strv_length(words);
  if (!n) return csv_fail(c, row, LENGTH, "no length:", error);
  if (n > MOST_LENGTHS)
    return csv_fail(c, row, LENGTH, "more than 10000 lengths:", error);
  t->length = calloc(n, sizeof *t->length);
  if (!t->length)
    return c->host->fail(c->host, error, OPC_FAILED, NULL, "out of memory");
  for (t->lengths = 0; t->lengths < n; t->lengths++) {
    char *text = g_strstrip(words[t->lengths]), *end;
    double l = t->length[t->lengths] = g_ascii_strtod(text, &end);
    if (end == text || *end || !isfinite(l) || !(l > 0))
      return csv_fail(c, row, LENGTH, "a length that is none in", error);
  }
  return OPC_OK;
}

static int read_row(const csv *c, guint row, transistor *t, opc_error *error) {
  int code = csv_type(c, row, TYPE, &t->type, error);
  if (!code) code = csv_number(c, row, WIDTH, 0, &t->width, error);
  if (!code) code = read_lengths(c, row, t, error);
  for (int k = 0; k < CURRENTS; k++) {
    int column = k == ION ? ION_GIVEN : IOFF_GIVEN;
    t->current[k] = NAN;
    if (!code && csv_has(c, column) && *csv_text(c, row, column))
      code = csv_number(c, row, column, 0, &t->current[k], error);
  }
  return code;
}

static double length_at(const transistor *t, double place) {
  double x = place * (double)(t->lengths - 1);
  size_t i = (size_t)x;
  if (i + 1 >= t->lengths) return t->length[t->lengths - 1];
  return t->length[i] + (x - (double)i) * (t->length[i + 1] - t->length[i]);
}

/* Slices get thinner towards both edges. */
static void slice(transistor *t, const curves *table) {
  for (int i = 0; i < REFERENCE_NODES; i++) {
    double s = (i + 0.5) / REFERENCE_NODES, place = s * s * (3 - 2 * s);
    double width = t->width * 6 * s * (1 - s) / REFERENCE_NODES;
    t->edge[i] = t->width * fmin(place, 1 - place);
    for (int k = 0; k < CURRENTS; k++)
      t->part[k][i] =
          width * exp(curves_at(table, t->type, k, length_at(t, place)));
  }
}

int reference_read(const opc_host *host, const char *path, const curves *table,
                   reference *out, opc_error *error) {
  csv c = {.host = host, .path = path, .parameter = "reference",
           .columns = COLUMNS, .names = names, .units = units};
  int code = csv_read(&c, REQUIRED, error);
  if (!code) {
    out->transistor = calloc(c.rows->len, sizeof *out->transistor);
    if (!out->transistor)
      code = host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  }
  for (guint row = 0; !code && row < c.rows->len; row++) {
    transistor *t = &out->transistor[out->count++];
    code = read_row(&c, row, t, error);
    if (!code) slice(t, table);
  }
  csv_clear(&c);
  return code;
}

void reference_clear(reference *r) {
  for (size_t i = 0; i < r->count; i++) free(r->transistor[i].length);
  free(r->transistor);
  *r = (reference){0};
}
