/* SPDX-License-Identifier: BSD-3-Clause */
/* Copies of cells into another layout. */
#include <stdlib.h>
#include <string.h>

#include "layout/derive.h"

typedef struct importer {
  eda_layout *to;
  const eda_layout *from;
  int32_t *cell;  /* number in `to` of each cell of `from`; -1: not copied */
  int32_t *layer; /* number in `to` of each layer of `from`; -1: not yet used */
  opc_error *error;
} importer;

/* Return the layer of the same name in `to`. */
static int32_t import_layer(importer *m, int32_t layer) {
  int32_t *to = &m->layer[layer];
  if (*to >= 0) return *to;
  *to =
      eda_layout_layer(m->to, eda_layout_layer_name(m->from, layer), m->error);
  if (*to >= 0 &&
      !g_hash_table_contains(m->to->file_layer, GINT_TO_POINTER(*to)))
    eda_layout_set_file_layer(m->to, *to,
                              eda_layout_file_layer(m->from, layer));
  return *to;
}

static bool layer_has_shapes(const eda_layout *layout, int32_t layer) {
  for (size_t i = 0; i < layout->n_cells; i++)
    if (eda_layout_sheet(&layout->cells[i], layer)) return true;
  return false;
}

/* Define the derived layers of `from` in `to`. Fail if a layer of the same name
   has another definition. */
static int import_derived(importer *m) {
  int code = OPC_OK;
  for (size_t k = 0; k < m->from->n_layers && !code; k++)
    if (import_layer(m, (int32_t)k) < 0) return m->error->code;
  for (size_t k = 0; k < m->from->n_layers && !code; k++) {
    const char *name = m->from->layers[k];
    const char *text = derived_text(m->from, (int32_t)k);
    const char *known = derived_text(m->to, m->layer[k]);
    if (!g_strcmp0(text, known)) continue;
    if (!known && !layer_has_shapes(m->to, m->layer[k]))
      code = eda_layout_derive(m->to, name, text, m->error);
    else
      code = opc_fail(m->error, OPC_INVALID, NULL,
                      "layer '%.200s' has different definitions in the layouts",
                      name);
  }
  return code;
}

/* Create a cell in `to` with the name of a cell of `from`, or with the first
   free of the names NAME$2, NAME$3 and so on. */
static int32_t import_name(importer *m, int32_t number) {
  const char *name = eda_layout_cell_name(m->from, number);
  g_autofree char *free_name = g_strdup(name);
  for (int k = 2; eda_layout_find_cell(m->to, free_name) >= 0; k++) {
    g_free(free_name);
    free_name = g_strdup_printf("%s$%d", name, k);
  }
  return eda_layout_cell(m->to, free_name, m->error);
}

static int import_shapes(importer *m, int32_t number) {
  int32_t to = m->cell[number], layer;
  size_t n = eda_layout_polygons(m->from, number), points;
  int code = OPC_OK;
  for (size_t i = 0; i < n && !code; i++) {
    const eda_point *p =
        eda_layout_polygon(m->from, number, i, &points, &layer);
    int32_t into = import_layer(m, layer);
    code = into < 0
               ? m->error->code
               : eda_layout_add_polygon(m->to, to, into, p, points, m->error);
  }
  n = eda_layout_texts(m->from, number);
  for (size_t i = 0; i < n && !code; i++) {
    eda_point at;
    const char *text = eda_layout_text(m->from, number, i, &at, &layer);
    int32_t into = import_layer(m, layer);
    code = into < 0 ? m->error->code
                    : eda_layout_add_text(m->to, to, into, at, text, m->error);
  }
  return code;
}

static int import_instances(importer *m, int32_t number) {
  size_t n = eda_layout_instances(m->from, number);
  int code = OPC_OK;
  for (size_t i = 0; i < n && !code; i++) {
    int32_t child;
    eda_placement p;
    const char *name = eda_layout_instance(m->from, number, i, &child, &p);
    code = eda_layout_add_instance(m->to, m->cell[number], m->cell[child], &p,
                                   name, m->error);
  }
  return code;
}

/* Create empty cells for `top` and all cells below, then copy the contents. */
static int import_cells(importer *m, int32_t top) {
  const eda_layout *from = m->from;
  size_t n = from->n_cells;
  uint8_t *used = eda_alloc(n, 1);
  int code = OPC_OK;
  eda_layout_mark(from, top, used);
  for (size_t i = 0; i < n && !code; i++) {
    m->cell[i] = used[i] ? import_name(m, (int32_t)i) : -1;
    if (used[i] && m->cell[i] < 0) code = m->error->code;
  }
  for (size_t i = 0; i < n && !code; i++) {
    if (!used[i]) continue;
    code = import_shapes(m, (int32_t)i);
    if (!code) code = import_instances(m, (int32_t)i);
  }
  free(used);
  return code;
}

int32_t eda_layout_import(eda_layout *to, const eda_layout *from,
                          int32_t number, opc_error *error) {
  if (to->unit != from->unit) {
    opc_fail(error, OPC_INVALID, NULL,
             "the layouts have units of %g and %g nm, expected equal units",
             to->unit, from->unit);
    return -1;
  }
  importer m = {.to = to, .from = from, .error = error};
  m.cell = eda_alloc(from->n_cells, sizeof *m.cell);
  m.layer = eda_alloc(from->n_layers, sizeof *m.layer);
  for (size_t k = 0; k < from->n_layers; k++) m.layer[k] = -1;
  int code = import_derived(&m);
  if (!code) code = import_cells(&m, number);
  int32_t copy = code ? -1 : m.cell[number];
  free(m.cell);
  free(m.layer);
  return copy;
}
