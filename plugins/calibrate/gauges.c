/* SPDX-License-Identifier: BSD-3-Clause */
/* Gauges: measured widths from a CSV file, or the drawn sizes of transistors.
 */
#include <eda/csv.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calibrate.h"

enum { LAYER, X, Y, AXIS, WIDTH, SD, FEATURE, GROUP, MASK, COLUMNS };
static const eda_csv_column columns[COLUMNS] = {
    [LAYER] = {.name = "layer"},
    [X] = {.name = "x", .unit = "nm"},
    [Y] = {.name = "y", .unit = "nm"},
    [AXIS] = {.name = "axis"},
    [WIDTH] = {.name = "width", .unit = "nm"},
    [SD] = {.name = "sd", .unit = "nm", .optional = 1},
    [FEATURE] = {.name = "feature", .optional = 1},
    [GROUP] = {.name = "group", .optional = 1},
    [MASK] = {.name = "mask", .optional = 1}};

/* Read one of two words; return its index in *value. */
static int word_read(const eda_csv *c, size_t row, int column, const char *one,
                     const char *two, int32_t *value, opc_error *error) {
  const char *text = eda_csv_text(c, row, column);
  g_autofree char *what = g_strdup_printf("expected '%s' or '%s':", one, two);
  *value = !strcmp(text, two);
  if (*value || !strcmp(text, one)) return OPC_OK;
  return eda_csv_fail(c, row, column, what, error);
}

/* Read the number of the mask, from 1. */
static int mask_read(const eda_csv *c, size_t row, size_t n_masks,
                     int32_t *mask, opc_error *error) {
  double number = 1;
  int code = eda_csv_has(c, MASK)
                 ? eda_csv_number(c, row, MASK, 0, &number, error)
                 : OPC_OK;
  if (code) return code;
  *mask = (int32_t)fmin(number, MASKS) - 1;
  if (*mask + 1 == number && *mask < (int32_t)n_masks) return OPC_OK;
  return eda_csv_fail(c, row, MASK, "the step has no mask of the number",
                      error);
}

static int gauge_read(const eda_csv *c, size_t row,
                      const eda_mask *const *masks, size_t n_masks, gauge *g,
                      opc_error *error) {
  static const double any = -1e300;
  int code = mask_read(c, row, n_masks, &g->mask, error);
  if (code) return code;
  g->layer =
      eda_gates_layer(masks[g->mask]->gates, eda_csv_text(c, row, LAYER));
  if (g->layer < 0)
    return eda_csv_fail(c, row, LAYER, "the mask has no layer", error);
  code = eda_csv_number(c, row, X, any, &g->x, error);
  if (!code) code = eda_csv_number(c, row, Y, any, &g->y, error);
  if (!code) code = word_read(c, row, AXIS, "x", "y", &g->axis, error);
  if (!code) code = eda_csv_number(c, row, WIDTH, 0, &g->width, error);
  g->sd = 1;
  if (!code && eda_csv_has(c, SD))
    code = eda_csv_number(c, row, SD, 0, &g->sd, error);
  if (!code && eda_csv_has(c, FEATURE))
    code = word_read(c, row, FEATURE, "line", "space", &g->space, error);
  return code;
}

/* Number the groups in the order of their first gauge; without the column,
   each gauge is a group. */
static void gauges_group(const eda_csv *c, gauge *g, size_t n) {
  GHashTable *seen = g_hash_table_new(g_str_hash, g_str_equal);
  for (size_t i = 0; i < n; i++) {
    g[i].group = i;
    if (!eda_csv_has(c, GROUP)) continue;
    const char *name = eda_csv_text(c, i, GROUP);
    void *known = g_hash_table_lookup(seen, name);
    g[i].group = known ? GPOINTER_TO_SIZE(known) - 1 : g_hash_table_size(seen);
    if (!known)
      g_hash_table_insert(seen, (void *)name, GSIZE_TO_POINTER(g[i].group + 1));
  }
  g_hash_table_destroy(seen);
}

int gauges_read(const char *path, const eda_mask *const *masks, size_t n_masks,
                gauge **out, size_t *count, opc_error *error) {
  eda_csv *c = eda_csv_read(path, "gauges", columns, COLUMNS, 0, error);
  if (!c) return error->code;
  size_t n = eda_csv_rows(c);
  int code = OPC_OK;
  *out = eda_alloc(n, sizeof **out);
  *count = n;
  for (size_t i = 0; i < n && !code; i++)
    code = gauge_read(c, i, masks, n_masks, &(*out)[i], error);
  if (!code) gauges_group(c, *out, n);
  eda_csv_free(c);
  return code;
}

/* Make the gauge of the length (`across` 0) or width (1) of a gate. */
static gauge gauge_of_gate(const eda_gates *gates, size_t k, int across) {
  eda_box b = gates->box[k];
  return (gauge){.layer = across ? EDA_ACTIVE : EDA_POLY,
                 .axis = across ? !gates->axis[k] : gates->axis[k],
                 .x = ((double)b.x0 + b.x1) / 2 * gates->grid,
                 .y = ((double)b.y0 + b.y1) / 2 * gates->grid,
                 .width = across ? gates->width[k] : gates->length[k],
                 .sd = 1};
}

void gauges_of_gates(const eda_mask *const *masks, size_t n_masks, int drawn,
                     gauge **out, size_t *count) {
  size_t each = drawn == DRAWN_BOTH ? 2 : 1;
  *count = 0;
  for (size_t m = 0; m < n_masks; m++) *count += each * masks[m]->gates->count;
  *out = eda_alloc(*count, sizeof **out);
  gauge *g = *out;
  for (size_t m = 0; m < n_masks; m++)
    for (size_t i = 0; i < each * masks[m]->gates->count; i++, g++) {
      int across = drawn == DRAWN_BOTH ? i % 2 : drawn == DRAWN_WIDTHS;
      *g = gauge_of_gate(masks[m]->gates, i / each, across);
      g->mask = (int32_t)m;
      g->group = (size_t)(g - *out) / each;
    }
}
