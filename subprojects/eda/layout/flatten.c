/* SPDX-License-Identifier: BSD-3-Clause */
/* Everything that goes down the hierarchy: the order of the cells, the number
   of every placement, and the shapes or texts of a layer made flat.

   Placements are numbered depth first, a cell before those in it, instances in
   their order, array members row by row. Cells under which nothing is drawn
   count for nothing, so that no work is ever spent on them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layout/layout.h"

#define MAX_SHAPES ((uint64_t)1 << 28)
/* Placements that may be gone through for each shape, and so many more: cells
   that only place one other lie a few deep in layouts, and in a hostile file a
   thousand. Twice of it are 0.7 s more for such a file under a sanitizer. */
#define STEPS_A_SHAPE 8
#define STEPS_MORE ((uint64_t)1 << 19)
#define MAX_POINTS ((uint64_t)1 << 30)
#define MAX_COORDINATE 1073741824.0 /* 2^30 */

/* Of a grid unit. x * unit / grid carries an error of a few 2^-53 of itself,
   at most 1e-6 for the coordinates allowed: what comes so near below a half
   is a half, and what comes so near a whole number has not moved. */
#define EPSILON 1e-6

/* a + b * c, at most `limit` */
static uint64_t add_product(uint64_t a, uint64_t b, uint64_t c,
                            uint64_t limit) {
  uint64_t product;
  if (__builtin_mul_overflow(b, c, &product) || product > limit) return limit;
  return MIN(a + product, limit);
}

static uint64_t members(const instance *in) {
  return (uint64_t)in->placement.columns * in->placement.rows;
}

/* ---- order of the cells, numbers of the placements ---- */

static uint64_t drawn(const cell *c) {
  uint64_t n = c->n_labels;
  for (size_t i = 0; i < c->n_sheets; i++)
    n += sheet_boxes(&c->sheets[i]) + c->sheets[i].n_polygons;
  return n;
}

/* All cells below it are done: count its placements. */
static void number_placements(eda_layout *layout, cell *c) {
  uint64_t next = 1;
  for (size_t i = 0; i < c->n_instances; i++) {
    const cell *child = &layout->cells[c->instances[i].child];
    c->before[i] = (uint32_t)MIN(next, UINT32_MAX);
    next = add_product(next, members(&c->instances[i]), child->placements,
                       EDA_MANY);
  }
  c->placements = next == 1 && !drawn(c) ? 0 : next;
}

typedef struct visit {
  int32_t cell;
  size_t next; /* instance */
} visit;

enum { NEW = 0, OPEN = 1, DONE = 2 };

/* Depth first from `root`, with a stack of its own. An edge to an open cell
   closes a circle. */
static void order_below(eda_layout *layout, int32_t root, uint8_t *state,
                        visit *stack, size_t *done) {
  size_t depth = 0;
  stack[depth++] = (visit){root, 0};
  state[root] = OPEN;
  while (depth) {
    visit *top = &stack[depth - 1];
    cell *c = &layout->cells[top->cell];
    if (top->next == c->n_instances) {
      number_placements(layout, c);
      state[top->cell] = DONE;
      layout->order[(*done)++] = top->cell;
      depth--;
      if (depth && c->circular)
        layout->cells[stack[depth - 1].cell].circular = true;
      continue;
    }
    int32_t child = c->instances[top->next++].child;
    if (state[child] == OPEN || layout->cells[child].circular)
      c->circular = true;
    if (state[child] != NEW) continue;
    state[child] = OPEN;
    stack[depth++] = (visit){child, 0};
  }
}

static void order_cells(eda_layout *layout) {
  size_t n = layout->n_cells, done = 0;
  uint8_t *state = eda_alloc(n, 1);
  visit *stack = eda_alloc(n, sizeof *stack);
  free(layout->order);
  layout->order = eda_alloc(n, sizeof *layout->order);
  for (size_t i = 0; i < n; i++) {
    cell *c = &layout->cells[i];
    free(c->before);
    c->before = eda_alloc(c->n_instances, sizeof *c->before);
    c->placements = 0;
    c->circular = false;
  }
  for (size_t i = 0; i < n; i++)
    if (state[i] == NEW) order_below(layout, (int32_t)i, state, stack, &done);
  free(state);
  free(stack);
}

void eda_layout_order(const eda_layout *layout) {
  eda_layout *writable = (eda_layout *)layout;
  if (g_atomic_int_get(&writable->ordered)) return;
  g_mutex_lock(&writable->lock);
  if (!writable->ordered) order_cells(writable);
  g_atomic_int_set(&writable->ordered, 1);
  g_mutex_unlock(&writable->lock);
}

/* ---- the top cell ---- */

/* The names of the cells that `wanted` marks, as many as a message takes. */
static void list_cells(const eda_layout *layout, const uint8_t *wanted,
                       GString *out) {
  size_t left = 0;
  for (size_t i = 0; i < layout->n_cells; i++) {
    if (!wanted[i]) continue;
    if (out->len > 600)
      left++;
    else
      g_string_append_printf(out, "%s'%.100s'", out->len ? ", " : "",
                             layout->cells[i].name);
  }
  if (left) g_string_append_printf(out, " and %zu more", left);
}

int32_t eda_layout_top(const eda_layout *layout, opc_error *error) {
  eda_layout_order(layout);
  uint8_t *mark = eda_alloc(layout->n_cells, 1);
  size_t tops = 0, circular = 0;
  int32_t top = -1;
  for (size_t i = 0; i < layout->n_cells; i++)
    circular += layout->cells[i].circular;
  if (circular) {
    for (size_t i = 0; i < layout->n_cells; i++)
      mark[i] = layout->cells[i].circular;
  } else {
    memset(mark, 1, layout->n_cells);
    for (size_t i = 0; i < layout->n_cells; i++)
      for (size_t j = 0; j < layout->cells[i].n_instances; j++)
        mark[layout->cells[i].instances[j].child] = 0;
    for (size_t i = 0; i < layout->n_cells; i++)
      if (mark[i]) {
        top = (int32_t)i;
        tops++;
      }
  }
  if (tops != 1) {
    g_autoptr(GString) names = g_string_new(NULL);
    list_cells(layout, mark, names);
    if (circular)
      opc_fail(error, OPC_INVALID, NULL, "cells lead to a circle: %s",
               names->str);
    else if (tops)
      opc_fail(error, OPC_INVALID, NULL, "there are %zu top cells: %s", tops,
               names->str);
    else
      opc_fail(error, OPC_INVALID, NULL, "the layout has no cells");
    top = -1;
  }
  free(mark);
  return top;
}

/* ---- transforms ---- */

/* (x, y) -> (xx x + xy y + dx, yx x + yy y + dy). For turns by right angles
   all of it are integers, far below 2^53, and so exact. */
typedef struct transform {
  double xx, xy, yx, yy, dx, dy;
} transform;

/* The cosine and sine of `angle` degrees; right angles exactly, and also what
   is off by what a division does to it. */
static void turn(double angle, double *cosine, double *sine) {
  static const double right[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  double quarters = nearbyint(angle / 90);
  if (fabs(angle - 90 * quarters) < 1e-9) {
    int q = ((int)fmod(quarters, 4) + 4) % 4;
    *cosine = right[q][0];
    *sine = right[q][1];
  } else {
    double radians = fmod(angle, 360) * (G_PI / 180);
    *cosine = cos(radians);
    *sine = sin(radians);
  }
}

/* What a placement does to its cell, before it is moved. */
static transform placed(const eda_placement *p) {
  double c, s, flip = p->mirror ? -1 : 1;
  turn(p->angle, &c, &s);
  c *= p->magnification;
  s *= p->magnification;
  return (transform){c, -s * flip, s, c * flip, 0, 0};
}

/* First `in`, moved by (x, y), then `out`. */
static transform compose(const transform *out, const transform *in, double x,
                         double y) {
  return (transform){
      out->xx * in->xx + out->xy * in->yx, out->xx * in->xy + out->xy * in->yy,
      out->yx * in->xx + out->yy * in->yx, out->yx * in->xy + out->yy * in->yy,
      out->xx * x + out->xy * y + out->dx, out->yx * x + out->yy * y + out->dy};
}

/* ---- flattening ---- */

/* A placement on the way down. Its instances that draw on the layer are
   useful[next] up to that of its cell. */
typedef struct frame {
  transform at;
  transform child; /* the matrix of the current instance */
  int32_t cell;
  uint32_t number;
  size_t next;
  uint64_t member, members; /* of the current instance */
} frame;

typedef struct flattener {
  const eda_layout *layout;
  int32_t layer;
  double ratio, grid;
  /* Of each cell, with those below; steps are placements gone through. */
  uint64_t *shapes, *points, *steps;
  uint32_t *useful; /* instances that draw on the layer */
  size_t *first;    /* of each cell: its place in useful */
  eda_flat *out;
  eda_flat_texts *texts; /* NULL: shapes are wanted */
  uint32_t n_shapes, n_points;
  double worst2; /* squared, in grid units */
  bool outside;
} flattener;

static double snap(double v, double *off) {
  double r = floor(v + (0.5 + EPSILON));
  *off = v - r;
  return r;
}

static void put_point(flattener *f, const transform *t, int32_t px,
                      int32_t py) {
  double ex, ey;
  double x = snap((t->xx * px + t->xy * py + t->dx) * f->ratio, &ex);
  double y = snap((t->yx * px + t->yy * py + t->dy) * f->ratio, &ey);
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

static void put_texts(flattener *f, const frame *at, uint32_t depth) {
  const cell *c = &f->layout->cells[at->cell];
  for (size_t i = 0; i < c->n_labels; i++) {
    const label *l = &c->labels[i];
    if (l->layer != f->layer) continue;
    f->texts->text[f->n_shapes] = f->layout->strings + l->text;
    f->texts->depth[f->n_shapes] = depth;
    put_point(f, &at->at, l->at.x, l->at.y);
    put_shape_end(f, at->number);
  }
}

static void put_shapes(flattener *f, const frame *at) {
  const sheet *s = eda_layout_sheet(&f->layout->cells[at->cell], f->layer);
  if (!s) return;
  const transform *t = &at->at;
  for (size_t i = 0; i < sheet_boxes(s); i++) {
    eda_box b = sheet_box(s, i);
    put_point(f, t, b.x0, b.y0);
    put_point(f, t, b.x1, b.y0);
    put_point(f, t, b.x1, b.y1);
    put_point(f, t, b.x0, b.y1);
    put_shape_end(f, at->number);
  }
  for (size_t i = 0, j = 0; i < s->n_polygons; i++) {
    for (; j < s->end[i]; j++) put_point(f, t, s->points[j].x, s->points[j].y);
    put_shape_end(f, at->number);
  }
}

/* What a cell itself has to be put. */
static void count_own(const flattener *f, const cell *c, uint64_t *shapes,
                      uint64_t *points) {
  *shapes = *points = 0;
  const sheet *s = f->texts ? NULL : eda_layout_sheet(c, f->layer);
  if (s) {
    *shapes = sheet_boxes(s) + s->n_polygons;
    *points = 4 * sheet_boxes(s) + s->n_points;
  }
  for (size_t i = 0; f->texts && i < c->n_labels; i++)
    *points = *shapes += c->labels[i].layer == f->layer;
}

/* Count the shapes and points of every cell, and list the instances that
   lead to some. */
static void count(flattener *f) {
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
    f->useful[n_useful++] = UINT32_MAX; /* the end of its list */
    f->shapes[number] = shapes;
    f->points[number] = points;
    f->steps[number] = steps;
  }
}

static int allocate(flattener *f, int32_t top, opc_error *error) {
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

/* The next member of the current or a further instance: the frame to go down
   to. False if the placement is done. */
static bool next_child(const flattener *f, frame *up, frame *down) {
  const cell *c = &f->layout->cells[up->cell];
  uint32_t i = f->useful[up->next];
  if (i == UINT32_MAX) return false;
  const instance *in = &c->instances[i];
  const eda_placement *p = &in->placement;
  if (up->member == 0) {
    up->members = members(in);
    up->child = placed(p);
  }
  uint64_t column = up->member % p->columns, row = up->member / p->columns;
  double x = p->origin.x + (double)column * p->column_step.x +
             (double)row * p->row_step.x;
  double y = p->origin.y + (double)column * p->column_step.y +
             (double)row * p->row_step.y;
  uint64_t size = f->layout->cells[in->child].placements;
  *down = (frame){
      .at = compose(&up->at, &up->child, x, y),
      .cell = in->child,
      .number = (uint32_t)(up->number + c->before[i] + up->member * size),
      .next = f->first[in->child]};
  if (++up->member == up->members) {
    up->member = 0;
    up->next++;
  }
  return true;
}

static void walk(flattener *f, int32_t top) {
  size_t depth = 0, room = 0;
  frame *stack = NULL;
  frame down = {.at = {1, 0, 0, 1, 0, 0}, .cell = top, .next = f->first[top]};
  for (;;) {
    eda_grow(&stack, &room, depth + 1, sizeof *stack);
    if (f->texts)
      put_texts(f, &down, (uint32_t)depth);
    else
      put_shapes(f, &down);
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
  count(f);
}

static void clear(flattener *f) {
  free(f->shapes);
  free(f->points);
  free(f->steps);
  free(f->first);
  free(f->useful);
}

static int run(flattener *f, int32_t top, opc_error *error) {
  count_all(f);
  int code = allocate(f, top, error);
  if (code || !f->out->shapes.count) return code;
  walk(f, top);
  if (f->outside)
    code = opc_fail(error, OPC_INVALID, NULL,
                    "'%s': a coordinate of layer '%s' lies beyond 2^30 units "
                    "of %g nm",
                    f->layout->cells[top].name, f->layout->layers[f->layer],
                    f->grid);
  f->out->vertices = f->n_points;
  f->out->worst = sqrt(f->worst2) * f->grid;
  return code;
}

static int flatten(const eda_layout *layout, int32_t top, int32_t layer,
                   double grid, eda_flat *out, eda_flat_texts *texts,
                   opc_error *error) {
  if (top < 0 || (size_t)top >= layout->n_cells)
    return opc_fail(error, OPC_INVALID, NULL, "there is no cell %d", top);
  if (layer < 0 || (size_t)layer >= layout->n_layers)
    return opc_fail(error, OPC_INVALID, NULL, "there is no layer %d", layer);
  if (!(grid > 0) || !isfinite(grid))
    return opc_fail(error, OPC_INVALID, NULL, "a grid of %g nm is not possible",
                    grid);
  eda_layout_order(layout);
  if (layout->cells[top].circular)
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s': leads to cells that place each other in a circle",
                    layout->cells[top].name);
  flattener f = {.layout = layout,
                 .layer = layer,
                 .ratio = layout->unit / grid,
                 .grid = grid,
                 .out = out,
                 .texts = texts};
  int code = run(&f, top, error);
  clear(&f);
  return code;
}

double eda_layout_flat_bytes(const eda_layout *layout, int32_t top,
                             int32_t layer) {
  flattener f = {.layout = layout, .layer = layer};
  eda_layout_order(layout);
  for (size_t i = 0; i < layout->n_cells; i++)
    if (layout->cells[i].circular) return 0;
  count_all(&f);
  double shapes = (double)f.shapes[top], points = (double)f.points[top];
  clear(&f);
  return shapes * (sizeof *f.out->shapes.start + sizeof *f.out->placement) +
         points * sizeof *f.out->shapes.points;
}

int eda_layout_flatten(const eda_layout *layout, int32_t top, int32_t layer,
                       double grid, eda_flat *out, opc_error *error) {
  *out = (eda_flat){0};
  int code = flatten(layout, top, layer, grid, out, NULL, error);
  if (code) eda_flat_clear(out);
  return code;
}

int eda_layout_flatten_texts(const eda_layout *layout, int32_t top,
                             int32_t layer, double grid, eda_flat_texts *out,
                             opc_error *error) {
  *out = (eda_flat_texts){0};
  int code = flatten(layout, top, layer, grid, &out->at, out, error);
  if (code) eda_flat_texts_clear(out);
  return code;
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

/* ---- paths ---- */

/* The instance of a cell that holds its placement p > 0: the last one that
   begins at or before p. */
static size_t instance_with(const cell *c, uint32_t p) {
  size_t low = 0, high = c->n_instances;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (c->before[middle] <= p)
      low = middle;
    else
      high = middle;
  }
  return low;
}

int32_t eda_layout_path(const eda_layout *layout, int32_t top, uint32_t p,
                        char *buffer, size_t room) {
  if (room) buffer[0] = '\0';
  if (top < 0 || (size_t)top >= layout->n_cells) return -1;
  eda_layout_order(layout);
  const cell *c = &layout->cells[top];
  if (c->circular || c->placements >= EDA_MANY || p >= MAX(c->placements, 1))
    return -1;
  int32_t number = top;
  size_t used = 0;
  while (p > 0) {
    size_t i = instance_with(c, p);
    const instance *in = &c->instances[i];
    const cell *child = &layout->cells[in->child];
    uint64_t member = (p - c->before[i]) / child->placements;
    p = (uint32_t)((p - c->before[i]) % child->placements);
    char name[64] = "", at[32] = "";
    if (!in->name) g_snprintf(name, sizeof name, "#%zu", i);
    if (members(in) > 1)
      g_snprintf(at, sizeof at, "[%u,%u]",
                 (unsigned)(member % in->placement.columns),
                 (unsigned)(member / in->placement.columns));
    if (used < room)
      used += (size_t)g_snprintf(
          buffer + used, room - used, "%s%s%s%s", used ? "/" : "",
          in->name ? layout->strings + in->name : child->name, name, at);
    number = in->child;
    c = child;
  }
  return number;
}
