/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/layout/layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells with more sheets than this find them by a hash table. */
enum { FEW_SHEETS = 16 };

bool opc_grow(void *array, size_t *room, size_t need, size_t size) {
  if (need <= *room) return true;
  size_t wanted = MAX(need, *room + *room / 2 + 4);
  if (wanted < need || wanted > SIZE_MAX / 2 / size) return false;
  void *memory = realloc(*(void **)array, wanted * size);
  if (!memory) return false;
  *(void **)array = memory;
  *room = wanted;
  return true;
}

static int no_memory(opc_error *error) {
  return opc_fail(error, OPC_FAILED, NULL, "out of memory for the layout");
}

/* ---- life ---- */

static opc_layout *layout_create(const opc_host *host, double unit,
                                 opc_error *error) {
  (void)host;
  if (!(unit > 0) || !isfinite(unit)) {
    opc_fail(error, OPC_INVALID, NULL, "a unit of %g nm is not possible", unit);
    return NULL;
  }
  opc_layout *layout = calloc(1, sizeof *layout);
  if (!layout) {
    no_memory(error);
    return NULL;
  }
  layout->unit = unit;
  layout->cell_of = g_hash_table_new(g_str_hash, g_str_equal);
  layout->layer_of = g_hash_table_new(g_str_hash, g_str_equal);
  g_mutex_init(&layout->lock);
  return layout;
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

static void layout_destroy(opc_layout *layout) {
  if (!layout) return;
  for (size_t i = 0; i < layout->n_cells; i++) cell_clear(&layout->cells[i]);
  free(layout->cells);
  for (size_t i = 0; i < layout->n_layers; i++) free(layout->layers[i]);
  free(layout->layers);
  g_hash_table_destroy(layout->cell_of);
  g_hash_table_destroy(layout->layer_of);
  free(layout->strings);
  free(layout->order);
  g_mutex_clear(&layout->lock);
  free(layout);
}

static void changed(opc_layout *layout) {
  layout->numbered = 0;
  layout->ordered = 0;
}

/* ---- names ---- */

static int32_t find(GHashTable *numbers, const char *name) {
  return GPOINTER_TO_INT(g_hash_table_lookup(numbers, name)) - 1;
}

static int32_t layout_cell(opc_layout *layout, const char *name,
                           opc_error *error) {
  int32_t known = find(layout->cell_of, name);
  if (known >= 0) return known;
  char *copy = strdup(name);
  if (!copy || layout->n_cells >= INT32_MAX - 1 ||
      !opc_grow(&layout->cells, &layout->room_cells, layout->n_cells + 1,
                sizeof(cell))) {
    free(copy);
    no_memory(error);
    return -1;
  }
  int32_t number = (int32_t)layout->n_cells++;
  layout->cells[number] = (cell){.name = copy};
  g_hash_table_insert(layout->cell_of, copy, GINT_TO_POINTER(number + 1));
  changed(layout);
  return number;
}

static int32_t layout_layer(opc_layout *layout, const char *name,
                            opc_error *error) {
  int32_t known = find(layout->layer_of, name);
  if (known >= 0) return known;
  char *copy = strdup(name);
  if (!copy || layout->n_layers >= INT32_MAX - 1 ||
      !opc_grow(&layout->layers, &layout->room_layers, layout->n_layers + 1,
                sizeof(char *))) {
    free(copy);
    no_memory(error);
    return -1;
  }
  int32_t number = (int32_t)layout->n_layers++;
  layout->layers[number] = copy;
  g_hash_table_insert(layout->layer_of, copy, GINT_TO_POINTER(number + 1));
  return number;
}

static int32_t layout_find_cell(const opc_layout *layout, const char *name) {
  return find(layout->cell_of, name);
}

static int32_t layout_find_layer(const opc_layout *layout, const char *name) {
  return find(layout->layer_of, name);
}

static bool is_cell(const opc_layout *layout, int32_t number) {
  return number >= 0 && (size_t)number < layout->n_cells;
}

static int check(const opc_layout *layout, int32_t number, int32_t layer,
                 opc_error *error) {
  if (!is_cell(layout, number))
    return opc_fail(error, OPC_INVALID, NULL, "there is no cell %d", number);
  if (layer < 0 || (size_t)layer >= layout->n_layers)
    return opc_fail(error, OPC_INVALID, NULL, "there is no layer %d", layer);
  return OPC_OK;
}

/* A string kept by the layout: its offset, 0 if there is no memory. */
static uint32_t keep_string(opc_layout *layout, const char *text) {
  size_t n = strlen(text) + 1, start = MAX(layout->n_strings, 1);
  if (start + n > UINT32_MAX ||
      !opc_grow(&layout->strings, &layout->room_strings, start + n, 1))
    return 0;
  memcpy(layout->strings + start, text, n);
  layout->n_strings = start + n;
  return (uint32_t)start;
}

/* ---- shapes ---- */

sheet *opc_layout_sheet(const cell *c, int32_t layer) {
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
  sheet *s = opc_layout_sheet(c, layer);
  if (!s) {
    if (!opc_grow(&c->sheets, &c->room_sheets, c->n_sheets + 1, sizeof *s))
      return NULL;
    s = &c->sheets[c->n_sheets++];
    *s = (sheet){.layer = layer};
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

static bool put_box(sheet *s, opc_box box) {
  int64_t width = (int64_t)box.x1 - box.x0, height = (int64_t)box.y1 - box.y0;
  if (width <= UINT16_MAX && height <= UINT16_MAX) {
    if (!opc_grow(&s->small, &s->room_small, s->n_small + 1, sizeof *s->small))
      return false;
    s->small[s->n_small++] =
        (small_box){box.x0, box.y0, (uint16_t)width, (uint16_t)height};
    return true;
  }
  if (!opc_grow(&s->boxes, &s->room_boxes, s->n_boxes + 1, sizeof box))
    return false;
  s->boxes[s->n_boxes++] = box;
  return true;
}

static int layout_add_box(opc_layout *layout, int32_t number, int32_t layer,
                          opc_box box, opc_error *error) {
  if (check(layout, number, layer, error)) return error->code;
  if (box.x0 > box.x1 || box.y0 > box.y1)
    return opc_fail(error, OPC_INVALID, NULL, "a box is empty");
  sheet *s = sheet_for(&layout->cells[number], layer);
  if (!s || !put_box(s, box)) return no_memory(error);
  changed(layout);
  return OPC_OK;
}

static bool is_box(const opc_point *p, size_t n) {
  return n == 4 && ((p[0].x == p[1].x && p[1].y == p[2].y && p[2].x == p[3].x &&
                     p[3].y == p[0].y) ||
                    (p[0].y == p[1].y && p[1].x == p[2].x && p[2].y == p[3].y &&
                     p[3].x == p[0].x));
}

static int layout_add_polygon(opc_layout *layout, int32_t number, int32_t layer,
                              const opc_point *points, size_t n,
                              opc_error *error) {
  if (is_box(points, n)) {
    const opc_point *a = &points[0], *b = &points[2];
    opc_box box = {MIN(a->x, b->x), MIN(a->y, b->y), MAX(a->x, b->x),
                   MAX(a->y, b->y)};
    return layout_add_box(layout, number, layer, box, error);
  }
  if (check(layout, number, layer, error)) return error->code;
  if (n < 3)
    return opc_fail(error, OPC_INVALID, NULL, "a polygon has %zu points", n);
  sheet *s = sheet_for(&layout->cells[number], layer);
  if (!s || n > UINT32_MAX - s->n_points ||
      !opc_grow(&s->points, &s->room_points, s->n_points + n, sizeof *points) ||
      !opc_grow(&s->end, &s->room_polygons, s->n_polygons + 1, sizeof *s->end))
    return no_memory(error);
  memcpy(s->points + s->n_points, points, n * sizeof *points);
  s->n_points += n;
  s->end[s->n_polygons++] = (uint32_t)s->n_points;
  changed(layout);
  return OPC_OK;
}

static int layout_add_path(opc_layout *layout, int32_t number, int32_t layer,
                           const opc_point *points, size_t n, int32_t width,
                           int ends, int32_t begin, int32_t end,
                           opc_error *error) {
  if (check(layout, number, layer, error)) return error->code;
  opc_point *outline = NULL;
  size_t n_outline = 0;
  int code = opc_path_outline(points, n, width, ends, begin, end, &outline,
                              &n_outline, error);
  if (!code && n_outline)
    code = layout_add_polygon(layout, number, layer, outline, n_outline, error);
  free(outline);
  return code;
}

static int layout_add_text(opc_layout *layout, int32_t number, int32_t layer,
                           opc_point at, const char *text, opc_error *error) {
  if (check(layout, number, layer, error)) return error->code;
  cell *c = &layout->cells[number];
  uint32_t kept = keep_string(layout, text);
  if (!kept || !opc_grow(&c->labels, &c->room_labels, c->n_labels + 1,
                         sizeof *c->labels))
    return no_memory(error);
  c->labels[c->n_labels++] = (label){at, layer, kept};
  return OPC_OK;
}

static int layout_add_instance(opc_layout *layout, int32_t number,
                               int32_t child, const opc_placement *placement,
                               const char *name, opc_error *error) {
  if (!is_cell(layout, number) || !is_cell(layout, child))
    return opc_fail(error, OPC_INVALID, NULL, "there is no cell %d",
                    is_cell(layout, number) ? child : number);
  const opc_placement *p = placement;
  if (!(p->magnification > 0) || !isfinite(p->magnification) ||
      !isfinite(p->angle) || p->columns == 0 || p->rows == 0)
    return opc_fail(error, OPC_INVALID, NULL,
                    "a placement of '%s' in '%s' is not possible: "
                    "magnification %g, angle %g, %u columns, %u rows",
                    layout->cells[child].name, layout->cells[number].name,
                    p->magnification, p->angle, p->columns, p->rows);
  cell *c = &layout->cells[number];
  uint32_t kept = name ? keep_string(layout, name) : 0;
  if ((name && !kept) || !opc_grow(&c->instances, &c->room_instances,
                                   c->n_instances + 1, sizeof *c->instances))
    return no_memory(error);
  c->instances[c->n_instances++] = (instance){*placement, child, kept};
  changed(layout);
  return OPC_OK;
}

/* ---- getters ---- */

static double layout_unit(const opc_layout *layout) { return layout->unit; }

static size_t layout_cells(const opc_layout *layout) { return layout->n_cells; }

static size_t layout_layers(const opc_layout *layout) {
  return layout->n_layers;
}

static const char *layout_cell_name(const opc_layout *layout, int32_t number) {
  return layout->cells[number].name;
}

static const char *layout_layer_name(const opc_layout *layout, int32_t layer) {
  return layout->layers[layer];
}

/* Number the polygons of all cells, sheet by sheet. */
static void number_polygons(const opc_layout *layout) {
  opc_layout *writable = (opc_layout *)layout;
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

static size_t layout_polygons(const opc_layout *layout, int32_t number) {
  number_polygons(layout);
  return layout->cells[number].polygons;
}

static const opc_point *layout_polygon(const opc_layout *layout, int32_t number,
                                       size_t i, size_t *n, int32_t *layer) {
  static __thread opc_point corners[4];
  number_polygons(layout);
  const cell *c = &layout->cells[number];
  size_t low = 0, high = c->n_sheets; /* the last sheet with first <= i */
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
    opc_box b = sheet_box(s, i);
    corners[0] = (opc_point){b.x0, b.y0};
    corners[1] = (opc_point){b.x1, b.y0};
    corners[2] = (opc_point){b.x1, b.y1};
    corners[3] = (opc_point){b.x0, b.y1};
    *n = 4;
    return corners;
  }
  i -= boxes;
  size_t start = i ? s->end[i - 1] : 0;
  *n = s->end[i] - start;
  return s->points + start;
}

static size_t layout_texts(const opc_layout *layout, int32_t number) {
  return layout->cells[number].n_labels;
}

static const char *layout_text(const opc_layout *layout, int32_t number,
                               size_t i, opc_point *at, int32_t *layer) {
  const label *l = &layout->cells[number].labels[i];
  *at = l->at;
  *layer = l->layer;
  return layout->strings + l->text;
}

static size_t layout_instances(const opc_layout *layout, int32_t number) {
  return layout->cells[number].n_instances;
}

static const char *layout_instance(const opc_layout *layout, int32_t number,
                                   size_t i, int32_t *child,
                                   opc_placement *placement) {
  const instance *in = &layout->cells[number].instances[i];
  *child = in->child;
  *placement = in->placement;
  return in->name ? layout->strings + in->name : NULL;
}

/* ---- dropping cells ---- */

/* Mark the cells that `top` leads to, itself too. */
static bool mark_below(const opc_layout *layout, int32_t top, uint8_t *marked) {
  int32_t *todo = malloc(layout->n_cells * sizeof *todo);
  if (!todo) return false;
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
  return true;
}

static int layout_keep(opc_layout *layout, int32_t top, opc_error *error) {
  if (!is_cell(layout, top))
    return opc_fail(error, OPC_INVALID, NULL, "there is no cell %d", top);
  uint8_t *marked = calloc(layout->n_cells, 1);
  int32_t *number = malloc(layout->n_cells * sizeof *number);
  if (!marked || !number || !mark_below(layout, top, marked)) {
    free(marked);
    free(number);
    return no_memory(error);
  }
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
  changed(layout);
  free(marked);
  free(number);
  return OPC_OK;
}

const opc_layout_service opc_layout_functions = {
    .size = sizeof(opc_layout_service),
    .create = layout_create,
    .destroy = layout_destroy,
    .cell = layout_cell,
    .layer = layout_layer,
    .add_polygon = layout_add_polygon,
    .add_box = layout_add_box,
    .add_path = layout_add_path,
    .add_text = layout_add_text,
    .add_instance = layout_add_instance,
    .unit = layout_unit,
    .cells = layout_cells,
    .layers = layout_layers,
    .cell_name = layout_cell_name,
    .layer_name = layout_layer_name,
    .find_cell = layout_find_cell,
    .find_layer = layout_find_layer,
    .top = opc_layout_top,
    .polygons = layout_polygons,
    .polygon = layout_polygon,
    .texts = layout_texts,
    .text = layout_text,
    .instances = layout_instances,
    .instance = layout_instance,
    .flatten = opc_layout_flatten,
    .release = opc_layout_release,
    .path = opc_layout_path,
    .keep = layout_keep,
    .flatten_texts = opc_layout_flatten_texts,
    .release_texts = opc_layout_release_texts,
};
