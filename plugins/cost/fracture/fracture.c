/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `cost.fracture`: the cost of writing a mask, as
   rectangles, shots of a variable shaped beam writer, vertices and file
   sizes. */
#include <eda/check.h>
#include <eda/layout.h>
#include <eda/memory.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
#include "mebes.h"
#include "partition.h"

/* ---- state ---- */

enum { MOST_COPIES = 100000, MOST_SEGMENTS = 100000 };

typedef struct counter {
  const opc_host *host;
  const eda_mask *mask;
  double max_shot, sliver, magnification, space;
  opc_reals array;
} counter;

enum { RECTANGLES, SHOTS, SLIVERS, VERTICES, GDSII, OASIS, MEBES, FIGURES };

/* Cost of a layer, of the drawn shapes or of the mask. */
typedef struct cost {
  int64_t figure[FIGURES];
  double area; /* um^2 */
} cost;

typedef struct row {
  const char *layer;
  cost drawn, now;
} row;

/* Settings common to all layers. */
typedef struct ruler {
  double grid;
  eda_box extent; /* extent of the drawn shapes */
  mebes_array array;
} ruler;

/* ---- work: the array ---- */

static int64_t step_of(const counter *c, int64_t size, double grid) {
  int64_t step = size + (int64_t)ceil(c->space / grid - 1e-9);
  return step > 1 ? step : 1;
}

static int make_ruler(const counter *c, const eda_gates *g, ruler *r,
                      opc_error *error) {
  const double *n = c->array.values;
  eda_box e = g->extent;
  if (e.x0 > e.x1 || e.y0 > e.y1) e = (eda_box){0, 0, 0, 0};
  *r = (ruler){.grid = g->grid,
               .extent = e,
               .array = {.columns = (int64_t)n[0],
                         .rows = (int64_t)n[1],
                         .step_x = step_of(c, (int64_t)e.x1 - e.x0, g->grid),
                         .step_y = step_of(c, (int64_t)e.y1 - e.y0, g->grid)}};
  if (mebes_segments(e, &r->array) > MOST_SEGMENTS)
    return opc_fail(error, OPC_INVALID, "array",
                    "the array is wider than %d segments of %d grid steps",
                    MOST_SEGMENTS, MEBES_SEGMENT);
  return OPC_OK;
}

/* Return OPC_INVALID if copies of the array touch, because touching copies do
   not have the cost of separate ones. */
static int check_copies(const ruler *r, const eda_box *boxes, size_t n,
                        opc_error *error) {
  eda_box all = n ? boxes[0] : (eda_box){0};
  for (size_t i = 1; i < n; i++) {
    if (boxes[i].x0 < all.x0) all.x0 = boxes[i].x0;
    if (boxes[i].y0 < all.y0) all.y0 = boxes[i].y0;
    if (boxes[i].x1 > all.x1) all.x1 = boxes[i].x1;
    if (boxes[i].y1 > all.y1) all.y1 = boxes[i].y1;
  }
  const mebes_array *a = &r->array;
  if ((a->columns > 1 && (int64_t)all.x1 - all.x0 >= a->step_x) ||
      (a->rows > 1 && (int64_t)all.y1 - all.y0 >= a->step_y))
    return opc_fail(error, OPC_INVALID, "array_space",
                    "copies of the mask in the array touch each other");
  return OPC_OK;
}

/* ---- work: a layer ---- */

static int count_shots(const counter *c, const ruler *r, const eda_box *boxes,
                       size_t n, int64_t *shots, int64_t *slivers,
                       opc_error *error) {
  double plate = r->grid * c->magnification;
  double all = 0, narrow = 0;
  for (size_t i = 0; i < n; i++) {
    double w = ((double)boxes[i].x1 - boxes[i].x0) * plate;
    double h = ((double)boxes[i].y1 - boxes[i].y0) * plate;
    /* A shape may exceed the size of a shot by the rounding error. */
    double columns = ceil(w / c->max_shot - 1e-9);
    double rows = ceil(h / c->max_shot - 1e-9);
    all += columns * rows;
    if (fmin(w / columns, h / rows) < c->sliver - 1e-9)
      narrow += columns * rows;
  }
  if (all * (double)(r->array.columns * r->array.rows) > 9e15)
    return opc_fail(error, OPC_INVALID, "max_shot",
                    "the number of shots, %g, is too large to count", all);
  *shots = (int64_t)all;
  *slivers = (int64_t)narrow;
  return OPC_OK;
}

/* Count the shots, which are cut with few slivers, and the smallest number of
   rectangles, which files contain. */
static int count_figures(const counter *c, const ruler *r,
                         const eda_shapes *shapes, int64_t f[FIGURES],
                         opc_error *error) {
  double sliver = ceil(c->sliver / (r->grid * c->magnification) - 1e-9);
  eda_box *few = NULL, *wide = NULL;
  size_t n = 0, n_wide = 0;
  int code = partition(shapes, 0, &few, &n, error);
  if (!code) code = check_copies(r, few, n, error);
  if (!code)
    code = partition(shapes, (int32_t)fmin(sliver, INT32_MAX), &wide, &n_wide,
                     error);
  if (!code)
    code = count_shots(c, r, wide, n_wide, &f[SHOTS], &f[SLIVERS], error);
  if (!code) {
    f[RECTANGLES] = (int64_t)n;
    f[MEBES] = mebes_bytes(few, n, r->extent, &r->array);
  }
  free(few);
  free(wide);
  return code;
}

/* Compute the cost of a layer; `number` is the layer's number in a file. */
static int count_layer(const counter *c, const ruler *r,
                       const eda_shapes *shapes, uint32_t number, cost *out,
                       opc_error *error) {
  int64_t copies = r->array.columns * r->array.rows, *f = out->figure;
  if (count_figures(c, r, shapes, f, error) ||
      gdsii_bytes(shapes, &f[GDSII], error) ||
      oasis_bytes(shapes, number, &f[OASIS], error))
    return error->code;
  f[VERTICES] = shapes->count ? shapes->start[shapes->count] : 0;
  double um = r->grid * 1e-3;
  out->area = (double)copies * (double)eda_area2(shapes) / 2 * um * um;
  for (int i = 0; i <= VERTICES; i++) f[i] *= copies;
  return OPC_OK;
}

/* ---- work: tables ---- */

/* `flat`: 0 for a mask by classes, which has no figures of MEBES. */
static int publish_tables(const opc_host *host, const row *rows, size_t n,
                          int flat, opc_error *error) {
  const int64_t *before = rows->drawn.figure, *after = rows->now.figure;
  const opc_column figures[] = {
      {"layer", NULL, OPC_TEXT, 0, &rows->layer},
      {"rectangles_drawn", NULL, OPC_INT, 0, &before[RECTANGLES]},
      {"rectangles", NULL, OPC_INT, 0, &after[RECTANGLES]},
      {"shots_drawn", NULL, OPC_INT, 0, &before[SHOTS]},
      {"shots", NULL, OPC_INT, 0, &after[SHOTS]},
      {"slivers_drawn", NULL, OPC_INT, 0, &before[SLIVERS]},
      {"slivers", NULL, OPC_INT, 0, &after[SLIVERS]},
      {"vertices_drawn", NULL, OPC_INT, 0, &before[VERTICES]},
      {"vertices", NULL, OPC_INT, 0, &after[VERTICES]},
      {"area_drawn", "um^2", OPC_REAL, 4, &rows->drawn.area},
      {"area", "um^2", OPC_REAL, 4, &rows->now.area},
  };
  const opc_column files[] = {
      {"layer", NULL, OPC_TEXT, 0, &rows->layer},
      {"gdsii_drawn", NULL, OPC_INT, 0, &before[GDSII]},
      {"gdsii", NULL, OPC_INT, 0, &after[GDSII]},
      {"oasis_drawn", NULL, OPC_INT, 0, &before[OASIS]},
      {"oasis", NULL, OPC_INT, 0, &after[OASIS]},
      {"mebes_drawn", NULL, OPC_INT, 0, &before[MEBES]},
      {"mebes", NULL, OPC_INT, 0, &after[MEBES]},
  };
  int code = opc_put_rows(host, "cost", OPC_TABLE_PRINT, n, sizeof *rows,
                          OPC_ARRAY(figures), error);
  return code ? code
              : opc_put_rows(
                    host, "cost_bytes", OPC_TABLE_PRINT, n, sizeof *rows, files,
                    sizeof files / sizeof *files - (flat ? 0 : 2), error);
}

static int publish_metrics(const opc_host *host, const row *rows, size_t n,
                           int flat, opc_error *error) {
  double drawn[FIGURES] = {0}, now[FIGURES] = {0};
  for (size_t k = 0; k < n; k++)
    for (int i = 0; i < FIGURES; i++) {
      drawn[i] += (double)rows[k].drawn.figure[i];
      now[i] += (double)rows[k].now.figure[i];
    }
  const opc_metric_value values[] = {
      {"rectangles", now[RECTANGLES]},
      {"rectangles_drawn", drawn[RECTANGLES]},
      {"shots", now[SHOTS]},
      {"shots_drawn", drawn[SHOTS]},
      {"slivers", now[SLIVERS]},
      {"vertices", now[VERTICES]},
      {"gdsii_bytes", now[GDSII]},
      {"oasis_bytes", now[OASIS]},
      {flat ? "mebes_bytes" : NULL, now[MEBES]},
      {flat ? "mebes_bytes_drawn" : NULL, drawn[MEBES]},
  };
  return opc_put_metrics(host, OPC_ARRAY(values), error);
}

/* ---- work: run ---- */

/* Costs of the rows, computed in parallel: two for each row, of the drawn
   shapes and of the mask. */
typedef struct counting {
  const counter *counter;
  ruler ruler;
  row *rows;
  size_t *layer; /* [rows] */
} counting;

static int count_one(void *data, size_t i, opc_error *error) {
  const counting *all = data;
  const eda_mask *mask = all->counter->mask;
  size_t k = all->layer[i / 2];
  row *to = &all->rows[i / 2];
  return count_layer(all->counter, &all->ruler,
                     i % 2 ? &mask->shapes[k] : &mask->gates->drawn[k],
                     eda_gates_number(mask->gates, k),
                     i % 2 ? &to->now : &to->drawn, error);
}

static int count_all(const counter *c, row *rows, opc_error *error) {
  const eda_gates *g = c->mask->gates;
  counting all = {.counter = c, .rows = rows};
  size_t n = 0;
  if (make_ruler(c, g, &all.ruler, error)) return error->code;
  all.layer = eda_alloc(g->layers, sizeof *all.layer);
  for (size_t k = 0; k < g->layers; k++) {
    if (!g->corrected[k]) continue;
    rows[n].layer = g->layer[k];
    all.layer[n++] = k;
  }
  int code = eda_try_all(c->host->context, 2 * n, count_one, &all, error);
  free(all.layer);
  if (!code) code = publish_tables(c->host, rows, n, 1, error);
  return code ? code : publish_metrics(c->host, rows, n, 1, error);
}

/* ---- work: a mask by classes ---- */

/* Add the polygons of a layer of a cell, as merged shapes. */
static int cell_shapes(const eda_layout *from, int32_t cell, int32_t layer,
                       eda_shapes *out, opc_error *error) {
  size_t all = eda_layout_polygons(from, cell), points = 0, count = 0, n;
  int32_t its;
  for (size_t i = 0; i < all; i++) {
    (void)eda_layout_polygon(from, cell, i, &n, &its);
    count += its == layer;
    points += its == layer ? n : 0;
  }
  eda_shapes s = {.count = count,
                  .start = eda_alloc(count + 1, sizeof *s.start),
                  .points = eda_alloc(points, sizeof *s.points)};
  for (size_t i = 0, k = 0; i < all; i++) {
    const eda_point *p = eda_layout_polygon(from, cell, i, &n, &its);
    if (its != layer) continue;
    memcpy(s.points + s.start[k], p, n * sizeof *p);
    s.start[k + 1] = s.start[k] + (uint32_t)n;
    k++;
  }
  int code = eda_boolean(EDA_OR, &s, NULL, out, error);
  eda_shapes_clear(&s);
  return code;
}

/* Count how often the top cell places each cell. */
static int64_t *count_copies(const eda_layout *from, int32_t top) {
  int64_t *copies = eda_alloc(eda_layout_cells(from), sizeof *copies);
  copies[top] = 1;
  for (size_t i = 0; i < eda_layout_instances(from, top); i++) {
    eda_placement p;
    int32_t child;
    eda_layout_instance(from, top, i, &child, &p);
    copies[child] += (int64_t)p.columns * p.rows;
  }
  return copies;
}

/* Add the cost of all cells of a layer. GDSII and OASIS bytes count once for
   each cell; MEBES, which has no cells, is not modelled. */
static int count_cells(const counter *c, const ruler *r, const eda_layout *from,
                       size_t layer, cost *out, opc_error *error) {
  const eda_gates *g = c->mask->gates;
  int32_t top = eda_layout_top(from, error);
  int32_t number = eda_layout_find_layer(from, g->layer[layer]);
  if (top < 0) return error->code;
  int64_t *copies = count_copies(from, top);
  int code = OPC_OK;
  for (size_t i = 0; i < eda_layout_cells(from) && !code; i++) {
    eda_shapes shapes = {0};
    cost one = {{0}, 0};
    code = cell_shapes(from, (int32_t)i, number, &shapes, error);
    if (!code && shapes.count)
      code =
          count_layer(c, r, &shapes, eda_gates_number(g, layer), &one, error);
    for (int k = 0; k < FIGURES; k++)
      out->figure[k] += one.figure[k] * (k <= VERTICES ? copies[i] : 1);
    out->area += one.area * (double)copies[i];
    eda_shapes_clear(&shapes);
  }
  free(copies);
  return code;
}

/* Compute the cost of the cells of a mask by classes. */
static int count_classes(const counter *c, row *rows, opc_error *error) {
  const eda_gates *g = c->mask->gates;
  ruler r;
  int code = make_ruler(c, g, &r, error);
  if (!code && r.array.columns * r.array.rows > 1)
    code = opc_fail(error, OPC_INVALID, "array",
                    "a mask by classes has no array, expected [1, 1]");
  size_t n = 0;
  for (int drawn = 1; drawn >= 0 && !code; drawn--) {
    const eda_layout *cells = NULL;
    code = c->mask->access->layout(c->mask, drawn, &cells, error);
    n = 0;
    for (size_t k = 0; k < g->layers && !code; k++) {
      if (!g->corrected[k]) continue;
      rows[n].layer = g->layer[k];
      cost *to = drawn ? &rows[n].drawn : &rows[n].now;
      code = count_cells(c, &r, cells, k, to, error);
      n++;
    }
  }
  if (!code) code = publish_tables(c->host, rows, n, 0, error);
  return code ? code : publish_metrics(c->host, rows, n, 0, error);
}

static int fracture_run(void *self, void **outputs, opc_error *error) {
  const counter *c = self;
  row *rows = eda_alloc(c->mask->gates->layers, sizeof *rows);
  (void)outputs;
  int code =
      c->mask->chip ? count_classes(c, rows, error) : count_all(c, rows, error);
  free(rows);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(counter, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "Mask whose cost is computed"),
    OPC_PARAMETER(counter, max_shot, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "nm", .preset = "1 um", .min = 10,
                  .summary = "Largest side of a shot, on the plate"),
    OPC_PARAMETER(
        counter, sliver, .type = OPC_REAL, .flags = OPC_AT_LEAST, .unit = "nm",
        .preset = "80 nm", .min = 0,
        .summary = "Width on the plate below which a shot is a sliver"),
    OPC_PARAMETER(counter, magnification, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "4", .min = 1,
                  .max = 100,
                  .summary = "Scale of the plate relative to the wafer"),
    OPC_PARAMETER(counter, array, .type = OPC_REALS, .preset = "[1, 1]",
                  .summary = "Columns and rows of copies of the mask"),
    OPC_PARAMETER_NAMED(
        "array_space", counter, space, .type = OPC_REAL,
        .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm", .preset = "200 nm",
        .min = 0, .max = 1e6,
        .summary = "Space between the shapes of adjacent copies"),
};

static const opc_metric metrics[] = {
    {"rectangles", NULL, OPC_LOWER, 0,
     "Rectangles of the corrected mask, all layers"},
    {"rectangles_drawn", NULL, OPC_NEUTRAL, 0,
     "Rectangles of the mask as drawn, all layers"},
    {"shots", NULL, OPC_LOWER, 0,
     "Shots of a variable shaped beam for the corrected mask"},
    {"shots_drawn", NULL, OPC_NEUTRAL, 0,
     "Shots of a variable shaped beam for the mask as drawn"},
    {"slivers", NULL, OPC_LOWER, 0,
     "Shots of the corrected mask narrower than the limit"},
    {"vertices", NULL, OPC_LOWER, 0,
     "Vertices of the corrected mask, all layers"},
    {"gdsii_bytes", NULL, OPC_LOWER, 0,
     "Bytes of the corrected shapes in GDSII, without the array"},
    {"oasis_bytes", NULL, OPC_LOWER, 0,
     "Bytes of the corrected shapes in OASIS, without the array"},
    {"mebes_bytes", NULL, OPC_LOWER, 0,
     "Bytes of the corrected mask in a model of MEBES"},
    {"mebes_bytes_drawn", NULL, OPC_NEUTRAL, 0,
     "Bytes of the mask as drawn in a model of MEBES"},
};

static int fracture_check(void *self, opc_error *error) {
  const opc_reals *array = &((counter *)self)->array;
  int good = array->count == 2;
  for (size_t i = 0; i < array->count && good; i++) {
    double n = array->values[i];
    good = n >= 1 && n <= MOST_COPIES && n == floor(n);
  }
  return good ? OPC_OK
              : opc_fail(error, OPC_INVALID, "array",
                         "must be the numbers of columns and rows, 1 to %d",
                         MOST_COPIES);
}

/* ---- entry ---- */

static const opc_step functions = {.run = fracture_run};

OPC_PLUGIN(
    counter, .id = "cost.fracture", .kind = "step", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary = "Compute the rectangles, shots, vertices and bytes of a mask",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), .check = fracture_check, OPC_FUNCTIONS(functions));
