/* SPDX-License-Identifier: BSD-3-Clause */
/* Construction of layouts, and access to the contents of cells. */
#include "layout/layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layout/derive.h"

/* Cells with more sheets (layout.h) have a hash table from layer to sheet. */
enum { FEW_SHEETS = 16 };

static int too_many(const char *what, opc_error *error) {
  return opc_fail(error, OPC_FAILED, NULL, "the layout has too many %s", what);
}

/* ---- creation and release ---- */

eda_layout *eda_layout_new(double unit, opc_error *error) {
  if (!(unit > 0) || !isfinite(unit)) {
    opc_fail(error, OPC_INVALID, NULL, "a unit of %g nm is not possible", unit);
    return NULL;
  }
  eda_layout *layout = eda_alloc(1, sizeof *layout);
  layout->unit = unit;
  layout->cell_of = g_hash_table_new(g_str_hash, g_str_equal);
  layout->layer_of = g_hash_table_new(g_str_hash, g_str_equal);
  layout->file_layer = g_hash_table_new_full(NULL, NULL, NULL, g_free);
  g_mutex_init(&layout->lock);
  return layout;
}

static void drop_reach(eda_layout *layout) {
  for (int k = 0; k < 2; k++)
    if (layout->reach[k]) {
      g_hash_table_destroy(layout->reach[k]);
      layout->reach[k] = NULL;
    }
}

static void cell_clear(cell *c) {
  for (size_t i = 0; i < c->n_sheets; i++) {
    free(c->sheets[i].small);
    free(c->sheets[i].boxes);
    free(c->sheets[i].end);
    free(c->sheets[i].points);
  }
  free(c->sheets);
  if (c->sheet_of) g_hash_table_destroy(c->sheet_of);
  free(c->labels);
  free(c->instances);
  free(c->before);
  free(c->name);
}

void eda_layout_free(void *object) {
  eda_layout *layout = object;
  if (!layout) return;
  for (size_t i = 0; i < layout->n_cells; i++) cell_clear(&layout->cells[i]);
  free(layout->cells);
  for (size_t i = 0; i < layout->n_layers; i++) free(layout->layers[i]);
  free(layout->layers);
  g_hash_table_destroy(layout->cell_of);
  g_hash_table_destroy(layout->layer_of);
  g_hash_table_destroy(layout->file_layer);
  g_clear_pointer(&layout->derived, g_hash_table_destroy);
  free(layout->strings);
  free(layout->order);
  drop_reach(layout);
  g_mutex_clear(&layout->lock);
  free(layout);
}

static void layout_changed(eda_layout *layout) {
  layout->numbered = 0;
  layout->ordered = 0;
  drop_reach(layout);
}

/* ---- names ---- */

static int32_t number_find(GHashTable *numbers, const char *name) {
  return GPOINTER_TO_INT(g_hash_table_lookup(numbers, name)) - 1;
}

/* Register the n-th name. Return the number n - 1. */
static int32_t keep_number(GHashTable *numbers, char *name, size_t n) {
  g_hash_table_insert(numbers, name, GSIZE_TO_POINTER(n));
  return (int32_t)n - 1;
}

int32_t eda_layout_cell(eda_layout *layout, const char *name,
                        opc_error *error) {
  int32_t known = number_find(layout->cell_of, name);
  if (known >= 0) return known;
  if (layout->n_cells >= INT32_MAX - 1) {
    too_many("cells", error);
    return -1;
  }
  cell new = {.name = g_strdup(name)};
  EDA_PUSH(layout->cells, layout->n_cells, layout->capacity_cells, new);
  layout_changed(layout);
  return keep_number(layout->cell_of, new.name, layout->n_cells);
}

int32_t eda_layout_layer(eda_layout *layout, const char *name,
                         opc_error *error) {
  int32_t known = number_find(layout->layer_of, name);
  if (known >= 0) return known;
  if (layout->n_layers >= INT32_MAX - 1) {
    too_many("layers", error);
    return -1;
  }
  char *copy = g_strdup(name);
  EDA_PUSH(layout->layers, layout->n_layers, layout->capacity_layers, copy);
  return keep_number(layout->layer_of, copy, layout->n_layers);
}

int32_t eda_layout_find_cell(const eda_layout *layout, const char *name) {
  return number_find(layout->cell_of, name);
}

int32_t eda_layout_find_layer(const eda_layout *layout, const char *name) {
  opc_error ignored;
  int32_t layer = number_find(layout->layer_of, name);
  return layer < 0 && eda_layer_is_expression(name)
             ? eda_layout_select(layout, name, &ignored)
             : layer;
}

void eda_layout_set_file_layer(eda_layout *layout, int32_t layer,
                               const char *name) {
  g_hash_table_insert(layout->file_layer, GINT_TO_POINTER(layer),
                      g_strdup(name));
}

const char *eda_layout_file_layer(const eda_layout *layout, int32_t layer) {
  const char *name =
      g_hash_table_lookup(layout->file_layer, GINT_TO_POINTER(layer));
  return name ? name : eda_layout_layer_name(layout, layer);
}

static bool is_cell(const eda_layout *layout, int32_t number) {
  return number >= 0 && (size_t)number < layout->n_cells;
}

static int layout_check(const eda_layout *layout, int32_t number, int32_t layer,
                        opc_error *error) {
  if (!is_cell(layout, number))
    return opc_fail(error, OPC_INVALID, NULL, "cell %d does not exist", number);
  if (layer < 0 || (size_t)layer >= layout->n_layers)
    return opc_fail(error, OPC_INVALID, NULL, "layer %d does not exist", layer);
  return OPC_OK;
}

/* Copy a string into the layout. Return the offset of the copy; 0 if the
   strings exceed 4 GB. */
static uint32_t keep_string(eda_layout *layout, const char *text) {
  size_t n = strlen(text) + 1, start = MAX(layout->n_strings, 1);
  if (start + n > UINT32_MAX) return 0;
  eda_grow(&layout->strings, &layout->capacity_strings, start + n, 1);
  memcpy(layout->strings + start, text, n);
  layout->n_strings = start + n;
  return (uint32_t)start;
}

/* ---- shapes ---- */

sheet *eda_layout_sheet(const cell *c, int32_t layer) {
  if (c->sheet_of) {
    int i = GPOINTER_TO_INT(
        g_hash_table_lookup(c->sheet_of, GINT_TO_POINTER(layer)));
    return i ? &c->sheets[i - 1] : NULL;
  }
  for (size_t i = 0; i < c->n_sheets; i++)
    if (c->sheets[i].layer == layer) return &c->sheets[i];
  return NULL;
}

static sheet *sheet_for(cell *c, int32_t layer) {
  if (c->n_sheets && c->sheets[c->last_sheet].layer == layer)
    return &c->sheets[c->last_sheet];
  sheet *s = eda_layout_sheet(c, layer);
  if (!s) {
    EDA_PUSH(c->sheets, c->n_sheets, c->capacity_sheets,
             (sheet){.layer = layer});
    s = &c->sheets[c->n_sheets - 1];
    if (c->n_sheets > FEW_SHEETS && !c->sheet_of) {
      c->sheet_of = g_hash_table_new(NULL, NULL);
      for (size_t i = 0; i < c->n_sheets; i++)
        g_hash_table_insert(c->sheet_of, GINT_TO_POINTER(c->sheets[i].layer),
                            GSIZE_TO_POINTER(i + 1));
    } else if (c->sheet_of) {
      g_hash_table_insert(c->sheet_of, GINT_TO_POINTER(layer),
                          GSIZE_TO_POINTER(c->n_sheets));
    }
  }
  c->last_sheet = (size_t)(s - c->sheets);
  return s;
}

static void put_box(sheet *s, eda_box box) {
  int64_t width = (int64_t)box.x1 - box.x0, height = (int64_t)box.y1 - box.y0;
  if (width <= UINT16_MAX && height <= UINT16_MAX) {
    small_box small = {box.x0, box.y0, (uint16_t)width, (uint16_t)height};
    EDA_PUSH(s->small, s->n_small, s->capacity_small, small);
  } else {
    EDA_PUSH(s->boxes, s->n_boxes, s->capacity_boxes, box);
  }
}

int eda_layout_add_box(eda_layout *layout, int32_t number, int32_t layer,
                       eda_box box, opc_error *error) {
  if (layout_check(layout, number, layer, error)) return error->code;
  if (box.x0 > box.x1 || box.y0 > box.y1)
    return opc_fail(error, OPC_INVALID, NULL, "a box is empty");
  put_box(sheet_for(&layout->cells[number], layer), box);
  layout_changed(layout);
  return OPC_OK;
}

int eda_layout_add_polygon(eda_layout *layout, int32_t number, int32_t layer,
                           const eda_point *points, size_t n,
                           opc_error *error) {
  if (eda_is_box(points, n)) {
    const eda_point *a = &points[0], *b = &points[2];
    eda_box box = {MIN(a->x, b->x), MIN(a->y, b->y), MAX(a->x, b->x),
                   MAX(a->y, b->y)};
    return eda_layout_add_box(layout, number, layer, box, error);
  }
  if (layout_check(layout, number, layer, error)) return error->code;
  if (n < 3)
    return opc_fail(error, OPC_INVALID, NULL, "a polygon has %zu points", n);
  sheet *s = sheet_for(&layout->cells[number], layer);
  if (n > UINT32_MAX - s->n_points) return too_many("points", error);
  eda_grow(&s->points, &s->capacity_points, s->n_points + n, sizeof *points);
  memcpy(s->points + s->n_points, points, n * sizeof *points);
  s->n_points += n;
  EDA_PUSH(s->end, s->n_polygons, s->capacity_polygons, (uint32_t)s->n_points);
  layout_changed(layout);
  return OPC_OK;
}

int eda_layout_add_path(eda_layout *layout, int32_t number, int32_t layer,
                        const eda_point *points, size_t n, int32_t width,
                        int ends, int32_t begin, int32_t end,
                        opc_error *error) {
  if (layout_check(layout, number, layer, error)) return error->code;
  eda_point *outline = NULL;
  size_t n_outline = 0;
  int code = eda_path_outline(points, n, width, ends, begin, end, &outline,
                              &n_outline, error);
  if (!code && n_outline)
    code = eda_layout_add_polygon(layout, number, layer, outline, n_outline,
                                  error);
  free(outline);
  return code;
}

int eda_layout_add_text(eda_layout *layout, int32_t number, int32_t layer,
                        eda_point at, const char *text, opc_error *error) {
  if (layout_check(layout, number, layer, error)) return error->code;
  cell *c = &layout->cells[number];
  uint32_t kept = keep_string(layout, text);
  if (!kept) return too_many("texts", error);
  EDA_PUSH(c->labels, c->n_labels, c->capacity_labels,
           (label){at, layer, kept});
  layout_changed(layout);
  return OPC_OK;
}

int eda_layout_add_instance(eda_layout *layout, int32_t number, int32_t child,
                            const eda_placement *placement, const char *name,
                            opc_error *error) {
  if (!is_cell(layout, number) || !is_cell(layout, child))
    return opc_fail(error, OPC_INVALID, NULL, "cell %d does not exist",
                    is_cell(layout, number) ? child : number);
  const eda_placement *p = placement;
  if (!(p->magnification > 0) || !isfinite(p->magnification) ||
      !isfinite(p->angle) || p->columns == 0 || p->rows == 0)
    return opc_fail(error, OPC_INVALID, NULL,
                    "a placement of '%s' in '%s' is not possible: "
                    "magnification %g, angle %g, %u columns, %u rows",
                    layout->cells[child].name, layout->cells[number].name,
                    p->magnification, p->angle, p->columns, p->rows);
  cell *c = &layout->cells[number];
  uint32_t kept = name ? keep_string(layout, name) : 0;
  if (name && !kept) return too_many("names", error);
  EDA_PUSH(c->instances, c->n_instances, c->capacity_instances,
           (instance){*placement, child, kept});
  layout_changed(layout);
  return OPC_OK;
}

/* ---- queries ---- */

double eda_layout_unit(const eda_layout *layout) { return layout->unit; }

size_t eda_layout_cells(const eda_layout *layout) { return layout->n_cells; }

size_t eda_layout_layers(const eda_layout *layout) { return layout->n_layers; }

const char *eda_layout_cell_name(const eda_layout *layout, int32_t number) {
  return layout->cells[number].name;
}

const char *eda_layout_layer_name(const eda_layout *layout, int32_t layer) {
  return layer < EDA_SELECTED ? layout->layers[layer]
                              : derived_text(layout, layer);
}

/* Number the polygons of all cells, sheet by sheet. */
static void number_polygons(const eda_layout *layout) {
  eda_layout *writable = (eda_layout *)layout;
  if (g_atomic_int_get(&writable->numbered)) return;
  g_mutex_lock(&writable->lock);
  for (size_t i = 0; i < layout->n_cells; i++) {
    cell *c = &layout->cells[i];
    c->polygons = 0;
    for (size_t j = 0; j < c->n_sheets; j++) {
      c->sheets[j].first = c->polygons;
      c->polygons += sheet_boxes(&c->sheets[j]) + c->sheets[j].n_polygons;
    }
  }
  g_atomic_int_set(&writable->numbered, 1);
  g_mutex_unlock(&writable->lock);
}

size_t eda_layout_polygons(const eda_layout *layout, int32_t number) {
  number_polygons(layout);
  return layout->cells[number].polygons;
}

const eda_point *eda_layout_polygon(const eda_layout *layout, int32_t number,
                                    size_t i, size_t *n, int32_t *layer) {
  static __thread eda_point corners[4];
  number_polygons(layout);
  const cell *c = &layout->cells[number];
  /* Find the last sheet whose first polygon has a number <= i. */
  size_t low = 0, high = c->n_sheets;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (c->sheets[middle].first <= i)
      low = middle;
    else
      high = middle;
  }
  const sheet *s = &c->sheets[low];
  i -= s->first;
  *layer = s->layer;
  size_t boxes = sheet_boxes(s);
  if (i < boxes) {
    eda_box b = sheet_box(s, i);
    corners[0] = (eda_point){b.x0, b.y0};
    corners[1] = (eda_point){b.x1, b.y0};
    corners[2] = (eda_point){b.x1, b.y1};
    corners[3] = (eda_point){b.x0, b.y1};
    *n = 4;
    return corners;
  }
  i -= boxes;
  size_t start = i ? s->end[i - 1] : 0;
  *n = s->end[i] - start;
  return s->points + start;
}

size_t eda_layout_texts(const eda_layout *layout, int32_t number) {
  return layout->cells[number].n_labels;
}

const char *eda_layout_text(const eda_layout *layout, int32_t number, size_t i,
                            eda_point *at, int32_t *layer) {
  const label *l = &layout->cells[number].labels[i];
  *at = l->at;
  *layer = l->layer;
  return layout->strings + l->text;
}

size_t eda_layout_instances(const eda_layout *layout, int32_t number) {
  return layout->cells[number].n_instances;
}

const char *eda_layout_instance(const eda_layout *layout, int32_t number,
                                size_t i, int32_t *child,
                                eda_placement *placement) {
  const instance *in = &layout->cells[number].instances[i];
  *child = in->child;
  *placement = in->placement;
  return in->name ? layout->strings + in->name : NULL;
}

/* ---- removal of cells ---- */

void eda_layout_mark(const eda_layout *layout, int32_t top, uint8_t *marked) {
  int32_t *todo = eda_alloc(layout->n_cells, sizeof *todo);
  size_t n = 0;
  marked[top] = 1;
  todo[n++] = top;
  while (n) {
    const cell *c = &layout->cells[todo[--n]];
    for (size_t i = 0; i < c->n_instances; i++) {
      int32_t child = c->instances[i].child;
      if (marked[child]) continue;
      marked[child] = 1;
      todo[n++] = child;
    }
  }
  free(todo);
}

int eda_layout_keep(eda_layout *layout, int32_t top, opc_error *error) {
  if (!is_cell(layout, top))
    return opc_fail(error, OPC_INVALID, NULL, "cell %d does not exist", top);
  uint8_t *marked = eda_alloc(layout->n_cells, 1);
  int32_t *number = eda_alloc(layout->n_cells, sizeof *number);
  eda_layout_mark(layout, top, marked);
  g_hash_table_remove_all(layout->cell_of);
  int32_t n = 0;
  for (size_t i = 0; i < layout->n_cells; i++) {
    cell c = layout->cells[i];
    if (!marked[i]) {
      cell_clear(&c);
      continue;
    }
    layout->cells[n] = c;
    number[i] = n++;
    g_hash_table_insert(layout->cell_of, c.name, GINT_TO_POINTER(n));
  }
  layout->n_cells = (size_t)n;
  for (size_t i = 0; i < layout->n_cells; i++)
    for (size_t j = 0; j < layout->cells[i].n_instances; j++) {
      int32_t *child = &layout->cells[i].instances[j].child;
      *child = number[*child];
    }
  layout_changed(layout);
  free(marked);
  free(number);
  return OPC_OK;
}

int eda_layout_check(const void *layout, opc_error *error) {
  if (layout) return OPC_OK;
  return opc_fail(error, OPC_FAILED, NULL, "the layout is missing");
}
