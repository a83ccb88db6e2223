/* SPDX-License-Identifier: BSD-3-Clause */
/* Flattening of a layer: the shapes or texts of the layer in coordinates of the
   top cell, either all or those that touch a window. For a window, only cells
   and array members that may touch the window are traversed (reach.c). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layout/derive.h"
#include "layout/reach.h"

#define MAX_SHAPES ((uint64_t)1 << 28)
/* Limit of traversed placements: STEPS_A_SHAPE for each shape plus STEPS_MORE.
   A hostile file may nest a thousand cells with one placement each; real
   layouts nest only a few cells. */
#define STEPS_A_SHAPE 8
#define STEPS_MORE ((uint64_t)1 << 19)
#define MAX_POINTS ((uint64_t)1 << 30)
#define MAX_COORDINATE 1073741824.0 /* 2^30 */

/* Tolerance in grid units. x * unit / grid has a relative error of a few 2^-53,
   at most 1e-6 for the allowed coordinates. A value less than EPSILON below a
   half is rounded up; a value within EPSILON of an integer does not count as
   moved. */
#define EPSILON 1e-6

#define BEYOND "'%s': a coordinate of layer '%s' is beyond 2^30 units of %g nm"

/* ---- output ---- */

/* A placement on the current path of the traversal. The instances to traverse
   are useful[first], useful[first + 1] and so on, up to UINT32_MAX;
   useful[next] is the current instance. In each row of an array, only members
   in `columns` are traversed. */
typedef struct frame {
  transform at;
  transform child; /* transform of the current instance, without translation */
  extent window;   /* window in coordinates of the cell */
  int32_t cell;
  uint32_t number;
  size_t first, next;
  bool begun; /* traversal of the current instance has begun */
  span rows, columns;
} frame;

typedef struct flattener {
  const eda_layout *layout;
  int32_t layer;
  double ratio, grid;
  const eda_box *window; /* NULL: flatten the whole layer */
  const reach *reach;    /* extents of cells, if there is a window */
  /* Numbers of shapes, points and placements to traverse in each cell and all
     cells below; not computed for a window. */
  uint64_t *shapes, *points, *steps;
  uint32_t *useful; /* instances that contain shapes or texts of the layer */
  size_t n_useful, useful_capacity;
  size_t *first; /* index in `useful` of each cell's first instance */
  eda_flat *out;
  eda_flat_texts *texts; /* NULL: flatten shapes */
  uint32_t n_shapes, n_points;
  size_t start_capacity, placement_capacity, point_capacity, text_capacity,
      depth_capacity;
  uint64_t taken; /* number of traversed placements */
  double worst2;  /* largest squared displacement by snapping, grid units */
  bool outside, too_many;
} flattener;

static double grid_snap(double v, double *off) {
  double r = floor(v + (0.5 + EPSILON));
  *off = v - r;
  return r;
}

static void put_point(flattener *f, const transform *t, int32_t px,
                      int32_t py) {
  double ex, ey;
  double x = grid_snap((t->xx * px + t->xy * py + t->dx) * f->ratio, &ex);
  double y = grid_snap((t->yx * px + t->yy * py + t->dy) * f->ratio, &ey);
  if (!(fabs(x) <= MAX_COORDINATE && fabs(y) <= MAX_COORDINATE)) {
    f->outside = true;
    x = y = 0;
  }
  f->out->shapes.points[f->n_points++] = (eda_point){(int32_t)x, (int32_t)y};
  if (fabs(ex) > EPSILON || fabs(ey) > EPSILON) {
    f->out->moved++;
    f->worst2 = fmax(f->worst2, ex * ex + ey * ey);
  }
}

static void put_shape_end(flattener *f, uint32_t placement) {
  f->out->placement[f->n_shapes++] = placement;
  f->out->shapes.start[f->n_shapes] = f->n_points;
}

static void put_text(flattener *f, const frame *at, const label *l,
                     uint32_t depth) {
  f->texts->text[f->n_shapes] = f->layout->strings + l->text;
  f->texts->depth[f->n_shapes] = depth;
  put_point(f, &at->at, l->at.x, l->at.y);
  put_shape_end(f, at->number);
}

static void put_shape(flattener *f, const frame *at, const sheet *s, size_t i) {
  const transform *t = &at->at;
  if (i < sheet_boxes(s)) {
    eda_box b = sheet_box(s, i);
    put_point(f, t, b.x0, b.y0);
    put_point(f, t, b.x1, b.y0);
    put_point(f, t, b.x1, b.y1);
    put_point(f, t, b.x0, b.y1);
  } else {
    i -= sheet_boxes(s);
    for (size_t j = i ? s->end[i - 1] : 0; j < s->end[i]; j++)
      put_point(f, t, s->points[j].x, s->points[j].y);
  }
  put_shape_end(f, at->number);
}

/* If shapes are flattened, return the number of shapes of the layer in the cell
   itself, without the cells below, and set *s to the shapes. If texts are
   flattened, return the number of the cell's texts on all layers, and set *s to
   NULL. */
static size_t own_items(const flattener *f, const cell *c, const sheet **s) {
  *s = f->texts ? NULL : eda_layout_sheet(c, f->layer);
  if (f->texts) return c->n_labels;
  return *s ? sheet_boxes(*s) + (*s)->n_polygons : 0;
}

static void put_all(flattener *f, const frame *at, uint32_t depth) {
  const cell *c = &f->layout->cells[at->cell];
  const sheet *s;
  size_t n = own_items(f, c, &s);
  for (size_t i = 0; i < n; i++)
    if (s)
      put_shape(f, at, s, i);
    else if (c->labels[i].layer == f->layer)
      put_text(f, at, &c->labels[i], depth);
}

/* ---- windows ---- */

static void frame_push(flattener *f, uint32_t i) {
  EDA_PUSH(f->useful, f->n_useful, f->useful_capacity, i);
}

/* Push the numbers of items of an index that touch the window, in increasing
   order. */
static void push_found(flattener *f, const eda_index *index, extent window) {
  size_t from = f->n_useful;
  eda_finder finder = eda_index_find(index, extent_box(window));
  for (uint32_t i; eda_index_next(&finder, &i);) frame_push(f, i);
  if (f->n_useful > from)
    qsort(f->useful + from, f->n_useful - from, sizeof *f->useful,
          eda_uint32s_rise);
}

/* List the instances that may touch the window in `useful`. */
static void list_instances(flattener *f, frame *at) {
  const cell *c = &f->layout->cells[at->cell];
  at->first = at->next = f->n_useful;
  if (f->reach->instances[at->cell])
    push_found(f, f->reach->instances[at->cell], at->window);
  else
    for (size_t i = 0; i < c->n_instances; i++)
      if (extents_touch(extent_of_all(f->reach, &c->instances[i]), at->window))
        frame_push(f, (uint32_t)i);
  frame_push(f, UINT32_MAX);
}

/* Reserve memory for a shape of n points. Return false if there are too many
   shapes or points. */
static bool flattener_reserve(flattener *f, size_t n) {
  eda_flat *out = f->out;
  size_t points = f->n_points + n, shapes = (size_t)f->n_shapes + 1;
  f->too_many = f->too_many || shapes > MAX_SHAPES || points > MAX_POINTS;
  if (f->too_many) return false;
  eda_grow(&out->shapes.points, &f->point_capacity, points,
           sizeof *out->shapes.points);
  eda_grow(&out->shapes.start, &f->start_capacity, shapes + 1,
           sizeof *out->shapes.start);
  eda_grow(&out->placement, &f->placement_capacity, shapes,
           sizeof *out->placement);
  out->shapes.start[0] = 0;
  if (!f->texts) return true;
  eda_grow(&f->texts->text, &f->text_capacity, shapes, sizeof *f->texts->text);
  eda_grow(&f->texts->depth, &f->depth_capacity, shapes,
           sizeof *f->texts->depth);
  return true;
}

/* Remove the last shape if the shape, snapped to the grid, does not touch the
   window. `before` and `moved`: the state, and f->out->moved, before the shape
   was added. */
static void keep_touching(flattener *f, const flattener *before, size_t moved) {
  /* flattener_run reports coordinates beyond the limit. */
  if (f->outside) return;
  const eda_point *p = f->out->shapes.points + before->n_points;
  eda_box b = eda_bounds(p, f->n_points - before->n_points);
  if (eda_boxes_touch(b, *f->window)) return;
  f->n_shapes = before->n_shapes;
  f->n_points = before->n_points;
  f->worst2 = before->worst2;
  f->out->moved = moved;
}

static void put_touching(flattener *f, const frame *at, const sheet *s,
                         size_t i, uint32_t depth) {
  const cell *c = &f->layout->cells[at->cell];
  const label *l = s ? NULL : &c->labels[i];
  if (l && l->layer != f->layer) return;
  extent e =
      s ? extent_of_shape(s, i) : (extent){l->at.x, l->at.y, l->at.x, l->at.y};
  if (!extents_touch(e, at->window)) return;
  size_t boxes = s ? sheet_boxes(s) : 0, n = s ? 4 : 1;
  if (s && i >= boxes)
    n = s->end[i - boxes] - (i > boxes ? s->end[i - boxes - 1] : 0);
  if (!flattener_reserve(f, n)) return;
  flattener before = *f;
  size_t moved = f->out->moved;
  if (s)
    put_shape(f, at, s, i);
  else
    put_text(f, at, l, depth);
  keep_touching(f, &before, moved);
}

static void put_window(flattener *f, const frame *at, uint32_t depth) {
  const sheet *s;
  size_t n = own_items(f, &f->layout->cells[at->cell], &s);
  const eda_index *index = f->reach->own[at->cell];
  if (!n) return;
  if (!index) {
    for (size_t i = 0; i < n; i++) put_touching(f, at, s, i, depth);
    return;
  }
  size_t from = f->n_useful;
  push_found(f, index, at->window);
  for (size_t k = from; k < f->n_useful; k++)
    put_touching(f, at, s, f->useful[k], depth);
  f->n_useful = from;
}

/* Count a traversed placement. Return false if the limit for the shapes found
   so far is exceeded. */
static bool flattener_bounded(flattener *f) {
  if (++f->taken > (uint64_t)f->n_shapes * STEPS_A_SHAPE + STEPS_MORE)
    f->too_many = true;
  return !f->too_many;
}

/* ---- whole layer ---- */

/* Count the shapes and points of the cell itself, without the cells below. */
static void count_own(const flattener *f, const cell *c, uint64_t *shapes,
                      uint64_t *points) {
  const sheet *s;
  *shapes = *points = own_items(f, c, &s);
  if (s) *points = 4 * sheet_boxes(s) + s->n_points;
  for (size_t i = 0; f->texts && i < c->n_labels; i++)
    *points = *shapes -= c->labels[i].layer != f->layer;
}

/* Count the shapes (or texts) and points of the layer in each cell with all
   cells below. List the instances in which any are found. */
static void flattener_count(flattener *f) {
  size_t n_useful = 0;
  for (size_t k = 0; k < f->layout->n_cells; k++) {
    int32_t number = f->layout->order[k];
    const cell *c = &f->layout->cells[number];
    uint64_t shapes, points, steps = 1;
    count_own(f, c, &shapes, &points);
    f->first[number] = n_useful;
    for (size_t i = 0; i < c->n_instances; i++) {
      const instance *in = &c->instances[i];
      if (!f->shapes[in->child]) continue;
      f->useful[n_useful++] = (uint32_t)i;
      shapes = add_product(shapes, members(in), f->shapes[in->child],
                           UINT64_MAX / 2);
      points = add_product(points, members(in), f->points[in->child],
                           UINT64_MAX / 2);
      steps =
          add_product(steps, members(in), f->steps[in->child], UINT64_MAX / 2);
    }
    f->useful[n_useful++] = UINT32_MAX; /* end of the list of instances */
    f->shapes[number] = shapes;
    f->points[number] = points;
    f->steps[number] = steps;
  }
}

static int flattener_allocate(flattener *f, int32_t top, opc_error *error) {
  eda_flat *out = f->out;
  uint64_t n = f->shapes[top];
  if (n == 0) return OPC_OK;
  const char *cell_name = f->layout->cells[top].name;
  const char *layer_name = f->layout->layers[f->layer];
  if (n > MAX_SHAPES || f->points[top] > MAX_POINTS ||
      f->layout->cells[top].placements >= EDA_MANY ||
      f->steps[top] > n * STEPS_A_SHAPE + STEPS_MORE)
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s': too large to flatten: %" G_GUINT64_FORMAT
                    " shapes, %" G_GUINT64_FORMAT
                    " points on layer '%s', %" G_GUINT64_FORMAT " placements",
                    cell_name, n, f->points[top], layer_name,
                    f->layout->cells[top].placements);
  out->shapes.start = eda_alloc(n + 1, sizeof *out->shapes.start);
  out->shapes.points = eda_alloc(f->points[top], sizeof *out->shapes.points);
  out->placement = eda_alloc(n, sizeof *out->placement);
  if (f->texts) {
    f->texts->text = eda_alloc(n, sizeof *f->texts->text);
    f->texts->depth = eda_alloc(n, sizeof *f->texts->depth);
  }
  out->shapes.count = n;
  return OPC_OK;
}

/* ---- traversal ---- */

static frame frame_enter(flattener *f, int32_t to, uint32_t number,
                         const transform *at) {
  frame down = {.at = *at, .cell = to, .number = number};
  if (f->window) {
    /* Enlarge the window by half a grid unit for snapping and half a unit for
       rounding errors. */
    const eda_box *w = f->window;
    extent e = {(w->x0 - 1.0) / f->ratio, (w->y0 - 1.0) / f->ratio,
                (w->x1 + 1.0) / f->ratio, (w->y1 + 1.0) / f->ratio};
    down.window = extent_back(at, e);
    list_instances(f, &down);
  } else {
    down.first = down.next = f->first[to];
  }
  return down;
}

/* Begin the traversal of the members of an instance that may touch the
   window. */
static void frame_begin(const flattener *f, frame *up, const instance *in) {
  const eda_placement *p = &in->placement;
  up->begun = true;
  up->child = transform_of(p);
  up->columns = (span){0, 0};
  up->rows = f->window
                 ? extent_rows(p, extent_of_first(f->reach, in), up->window)
                 : (span){0, p->rows};
}

/* Advance to the next member, at column columns.from and row rows.from - 1.
   Return false after the last member. */
static bool next_member(flattener *f, frame *up, const instance *in) {
  const eda_placement *p = &in->placement;
  while (up->columns.from == up->columns.to) {
    if (up->rows.from == up->rows.to || (f->window && !flattener_bounded(f)))
      return false;
    uint32_t row = up->rows.from++;
    up->columns = f->window ? extent_columns(p, extent_of_first(f->reach, in),
                                             up->window, row)
                            : (span){0, p->columns};
  }
  return !f->window || flattener_bounded(f);
}

/* Advance to the next member of the current instance or to the first member of
   a later instance. Write the member's frame to *down. Return false if no
   member remains. */
static bool next_child(flattener *f, frame *up, frame *down) {
  const cell *c = &f->layout->cells[up->cell];
  for (uint32_t i; (i = f->useful[up->next]) != UINT32_MAX; up->next++) {
    const instance *in = &c->instances[i];
    const eda_placement *p = &in->placement;
    if (!up->begun) frame_begin(f, up, in);
    if (!next_member(f, up, in)) {
      up->begun = false;
      continue;
    }
    uint32_t column = up->columns.from++, row = up->rows.from - 1;
    double x = p->origin.x + (double)column * p->column_step.x +
               (double)row * p->row_step.x;
    double y = p->origin.y + (double)column * p->column_step.y +
               (double)row * p->row_step.y;
    uint64_t size = f->layout->cells[in->child].placements;
    uint64_t member = (uint64_t)row * p->columns + column;
    transform at = transform_compose(&up->at, &up->child, x, y);
    *down =
        frame_enter(f, in->child,
                    (uint32_t)(up->number + c->before[i] + member * size), &at);
    return true;
  }
  if (f->window) f->n_useful = up->first;
  return false;
}

static void flattener_traverse(flattener *f, int32_t top) {
  static const transform none = {1, 0, 0, 1, 0, 0};
  size_t depth = 0, capacity = 0;
  frame *stack = NULL;
  frame down = frame_enter(f, top, 0, &none);
  for (;;) {
    eda_grow(&stack, &capacity, depth + 1, sizeof *stack);
    if (f->window)
      put_window(f, &down, (uint32_t)depth);
    else
      put_all(f, &down, (uint32_t)depth);
    stack[depth++] = down;
    while (depth && !next_child(f, &stack[depth - 1], &down)) depth--;
    if (!depth) break;
  }
  free(stack);
}

static void count_all(flattener *f) {
  size_t n = f->layout->n_cells, edges = n;
  for (size_t i = 0; i < n; i++) edges += f->layout->cells[i].n_instances;
  f->shapes = eda_alloc(n, sizeof *f->shapes);
  f->points = eda_alloc(n, sizeof *f->points);
  f->steps = eda_alloc(n, sizeof *f->steps);
  f->first = eda_alloc(n, sizeof *f->first);
  f->useful = eda_alloc(edges, sizeof *f->useful);
  flattener_count(f);
}

static void flattener_clear(flattener *f) {
  free(f->shapes);
  free(f->points);
  free(f->steps);
  free(f->first);
  free(f->useful);
}

/* For a whole layer, count shapes and points and allocate memory for the
   result. For a window, get the extents of the layer in all cells; memory grows
   during the traversal. */
static int flattener_prepare(flattener *f, int32_t top, opc_error *error) {
  if (!f->window) {
    count_all(f);
    return flattener_allocate(f, top, error);
  }
  f->reach = eda_layout_reach(f->layout, f->layer, f->texts != NULL);
  if (f->layout->cells[top].placements < EDA_MANY) return OPC_OK;
  return opc_fail(error, OPC_INVALID, NULL,
                  "'%s': too large: more than 2^32 placements",
                  f->layout->cells[top].name);
}

static int flattener_run(flattener *f, int32_t top, opc_error *error) {
  const char *cell_name = f->layout->cells[top].name;
  const char *layer_name = f->layout->layers[f->layer];
  int code = flattener_prepare(f, top, error);
  if (code || !(f->window || f->out->shapes.count)) return code;
  flattener_traverse(f, top);
  if (f->too_many)
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s': too large to flatten: in a window more than %u "
                    "shapes on layer '%s' in %" G_GUINT64_FORMAT " placements",
                    cell_name, f->n_shapes, layer_name, f->taken);
  if (f->outside)
    return opc_fail(error, OPC_INVALID, NULL, BEYOND, cell_name, layer_name,
                    f->grid);
  if (!f->n_shapes) eda_flat_clear(f->out); /* all found shapes were removed */
  f->out->shapes.count = f->n_shapes;
  f->out->vertices = f->n_points;
  f->out->worst = sqrt(f->worst2) * f->grid;
  return OPC_OK;
}

static int flatten_check(const eda_layout *layout, int32_t top, int32_t layer,
                         double grid, opc_error *error) {
  if (top < 0 || (size_t)top >= layout->n_cells)
    return opc_fail(error, OPC_INVALID, NULL, "cell %d does not exist", top);
  if (layer < 0 || (size_t)layer >= layout->n_layers)
    return opc_fail(error, OPC_INVALID, NULL, "layer %d does not exist", layer);
  if (!(grid > 0) || !isfinite(grid))
    return opc_fail(error, OPC_INVALID, NULL, "a grid of %g nm is not possible",
                    grid);
  eda_layout_order(layout);
  if (layout->cells[top].circular)
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s': cells place each other in a cycle",
                    layout->cells[top].name);
  return OPC_OK;
}

static int flatten_items(const eda_layout *layout, int32_t top, int32_t layer,
                         double grid, const eda_box *window, eda_flat *out,
                         eda_flat_texts *texts, opc_error *error) {
  int code = flatten_check(layout, top, layer, grid, error);
  if (code) return code;
  flattener f = {.layout = layout,
                 .layer = layer,
                 .ratio = layout->unit / grid,
                 .grid = grid,
                 .window = window,
                 .out = out,
                 .texts = texts};
  code = flattener_run(&f, top, error);
  flattener_clear(&f);
  return code;
}

double eda_layout_flat_bytes(const eda_layout *layout, int32_t top,
                             int32_t layer) {
  if (eda_layout_is_derived(layout, layer))
    return derived_bytes(layout, top, layer);
  flattener f = {.layout = layout, .layer = layer};
  eda_layout_order(layout);
  for (size_t i = 0; i < layout->n_cells; i++)
    if (layout->cells[i].circular) return 0;
  count_all(&f);
  double shapes = (double)f.shapes[top], points = (double)f.points[top];
  flattener_clear(&f);
  return shapes * (sizeof *f.out->shapes.start + sizeof *f.out->placement) +
         points * sizeof *f.out->shapes.points;
}

int eda_layout_flatten_window(const eda_layout *layout, int32_t top,
                              int32_t layer, double grid, const eda_box *window,
                              eda_flat *out, opc_error *error) {
  *out = (eda_flat){0};
  if (eda_layout_is_derived(layout, layer))
    return derived_flatten(layout, top, layer, grid, window, out, error);
  int code = flatten_items(layout, top, layer, grid, window, out, NULL, error);
  if (code) eda_flat_clear(out);
  return code;
}

int eda_layout_flatten(const eda_layout *layout, int32_t top, int32_t layer,
                       double grid, eda_flat *out, opc_error *error) {
  return eda_layout_flatten_window(layout, top, layer, grid, NULL, out, error);
}

int eda_layout_flatten_texts_window(const eda_layout *layout, int32_t top,
                                    int32_t layer, double grid,
                                    const eda_box *window, eda_flat_texts *out,
                                    opc_error *error) {
  *out = (eda_flat_texts){0};
  int code =
      flatten_items(layout, top, layer, grid, window, &out->at, out, error);
  if (code) eda_flat_texts_clear(out);
  return code;
}

int eda_layout_flatten_texts(const eda_layout *layout, int32_t top,
                             int32_t layer, double grid, eda_flat_texts *out,
                             opc_error *error) {
  return eda_layout_flatten_texts_window(layout, top, layer, grid, NULL, out,
                                         error);
}

int eda_layout_bounds(const eda_layout *layout, int32_t top, int32_t layer,
                      double grid, eda_box *box, opc_error *error) {
  *box = (eda_box){0, 0, -1, -1};
  if (eda_layout_is_derived(layout, layer))
    return derived_bounds(layout, top, layer, grid, box, error);
  int code = flatten_check(layout, top, layer, grid, error);
  if (code) return code;
  extent e = eda_layout_reach(layout, layer, false)->below[top];
  if (extent_empty(e)) return OPC_OK;
  double off, ratio = layout->unit / grid;
  double v[4] = {e.x0, e.y0, e.x1, e.y1};
  for (int i = 0; i < 4; i++) {
    v[i] = grid_snap(v[i] * ratio, &off);
    if (!(fabs(v[i]) <= MAX_COORDINATE))
      return opc_fail(error, OPC_INVALID, NULL, BEYOND, layout->cells[top].name,
                      layout->layers[layer], grid);
  }
  *box = (eda_box){(int32_t)v[0], (int32_t)v[1], (int32_t)v[2], (int32_t)v[3]};
  return OPC_OK;
}

void eda_flat_clear(eda_flat *flat) {
  eda_shapes_clear(&flat->shapes);
  free(flat->placement);
  *flat = (eda_flat){0};
}

void eda_flat_texts_clear(eda_flat_texts *texts) {
  eda_flat_clear(&texts->at);
  free(texts->text);
  free(texts->depth);
  *texts = (eda_flat_texts){0};
}
