/* SPDX-License-Identifier: BSD-3-Clause */
/* cost.fracture: what a mask costs to write: rectangles, the shots of a writer
   with a variable shaped beam, vertices, and the bytes of its files. */
#include <math.h>

#include <opcflow/opcflow.h>

#include "bytes.h"
#include "mebes.h"
#include "partition.h"

/* ---- state ---- */

enum { MASK, MAX_SHOT, SLIVER, MAGNIFICATION, ARRAY, SPACE, PARAMETERS };

enum { MOST_COPIES = 100000, MOST_SEGMENTS = 100000 };

typedef struct counter {
  const opc_host *host;
  const opc_value *values;
} counter;

/* The cost of a layer, as an array of each figure has it: [layer]. */
typedef struct cost {
  int64_t rectangles[OPC_MASKS], shots[OPC_MASKS], slivers[OPC_MASKS];
  int64_t vertices[OPC_MASKS];
  int64_t gdsii[OPC_MASKS], oasis[OPC_MASKS], mebes[OPC_MASKS];
  double area[OPC_MASKS]; /* um^2 */
} cost;

/* What all layers are counted with. */
typedef struct ruler {
  double grid;
  opc_box extent; /* of the drawn shapes */
  mebes_array array;
} ruler;

/* ---- work: the array ---- */

static int64_t step_of(const counter *c, int64_t size, double grid) {
  int64_t step = size + (int64_t)ceil(c->values[SPACE].real / grid - 1e-9);
  return step > 1 ? step : 1;
}

static int make_ruler(const counter *c, const opc_gates *g, ruler *r,
                      opc_error *error) {
  const double *n = c->values[ARRAY].reals;
  opc_box e = g->extent;
  if (e.x0 > e.x1 || e.y0 > e.y1) e = (opc_box){0, 0, 0, 0};
  *r = (ruler){
      .grid = g->grid,
      .extent = e,
      .array = {.columns = (int64_t)n[0],
                .rows = (int64_t)n[1],
                .step_x = step_of(c, (int64_t)e.x1 - e.x0, g->grid),
                .step_y = step_of(c, (int64_t)e.y1 - e.y0, g->grid)}};
  if (mebes_segments(e, &r->array) > MOST_SEGMENTS)
    return c->host->fail(c->host, error, OPC_INVALID, "array",
                         "the array is wider than %d segments of %d grid steps",
                         MOST_SEGMENTS, MEBES_SEGMENT);
  return OPC_OK;
}

/* Copies of the array must not touch, or they would not cost what they do
   alone. */
static int check_copies(const counter *c, const ruler *r, const opc_box *boxes,
                        size_t n, opc_error *error) {
  opc_box all = n ? boxes[0] : (opc_box){0};
  for (size_t i = 1; i < n; i++) {
    if (boxes[i].x0 < all.x0) all.x0 = boxes[i].x0;
    if (boxes[i].y0 < all.y0) all.y0 = boxes[i].y0;
    if (boxes[i].x1 > all.x1) all.x1 = boxes[i].x1;
    if (boxes[i].y1 > all.y1) all.y1 = boxes[i].y1;
  }
  const mebes_array *a = &r->array;
  if ((a->columns > 1 && (int64_t)all.x1 - all.x0 >= a->step_x) ||
      (a->rows > 1 && (int64_t)all.y1 - all.y0 >= a->step_y))
    return c->host->fail(c->host, error, OPC_INVALID, "array_space",
                         "copies of the mask touch each other");
  return OPC_OK;
}

/* ---- work: a layer ---- */

static int count_shots(const counter *c, const ruler *r, const opc_box *boxes,
                       size_t n, int64_t *shots, int64_t *slivers,
                       opc_error *error) {
  double plate = r->grid * c->values[MAGNIFICATION].real;
  double most = c->values[MAX_SHOT].real, least = c->values[SLIVER].real;
  double all = 0, narrow = 0;
  for (size_t i = 0; i < n; i++) {
    double w = ((double)boxes[i].x1 - boxes[i].x0) * plate;
    double h = ((double)boxes[i].y1 - boxes[i].y0) * plate;
    /* What is as large as a shot, but for rounding, is one. */
    double columns = ceil(w / most - 1e-9), rows = ceil(h / most - 1e-9);
    all += columns * rows;
    if (fmin(w / columns, h / rows) < least - 1e-9) narrow += columns * rows;
  }
  if (all * (double)(r->array.columns * r->array.rows) > 9e15)
    return c->host->fail(c->host, error, OPC_INVALID, "max_shot",
                         "more shots than can be counted: %g", all);
  *shots = (int64_t)all;
  *slivers = (int64_t)narrow;
  return OPC_OK;
}

static int count_figures(const counter *c, const ruler *r,
                         const opc_shapes *shapes, int layer, cost *out,
                         opc_error *error) {
  opc_box *boxes = NULL;
  size_t n = 0;
  int code = partition(c->host, shapes, &boxes, &n, error);
  if (!code) code = check_copies(c, r, boxes, n, error);
  if (!code)
    code = count_shots(c, r, boxes, n, &out->shots[layer],
                       &out->slivers[layer], error);
  if (!code) {
    out->rectangles[layer] = (int64_t)n;
    out->mebes[layer] = mebes_bytes(boxes, n, r->extent, &r->array);
  }
  c->host->free(c->host, boxes);
  return code;
}

static int count_layer(const counter *c, const ruler *r,
                       const opc_shapes *shapes, int layer, cost *out,
                       opc_error *error) {
  static const uint32_t number[OPC_MASKS] = {[OPC_POLY] = 9, [OPC_ACTIVE] = 1};
  int64_t copies = r->array.columns * r->array.rows;
  if (count_figures(c, r, shapes, layer, out, error) ||
      gdsii_bytes(c->host, shapes, &out->gdsii[layer], error) ||
      oasis_bytes(c->host, shapes, number[layer], &out->oasis[layer], error))
    return error->code;
  double um = r->grid * 1e-3;
  out->area[layer] = (double)copies *
                     (double)c->host->geometry->area2(shapes) / 2 * um * um;
  out->vertices[layer] =
      copies * (shapes->count ? shapes->start[shapes->count] : 0);
  out->rectangles[layer] *= copies;
  out->shots[layer] *= copies;
  out->slivers[layer] *= copies;
  return OPC_OK;
}

static int count_all(const counter *c, const ruler *r,
                     const opc_shapes *shapes, cost *out, opc_error *error) {
  int code = OPC_OK;
  for (int layer = 0; layer < OPC_MASKS && !code; layer++)
    code = count_layer(c, r, &shapes[layer], layer, out, error);
  return code;
}

/* ---- work: tables ---- */

static const char *const names[OPC_MASKS] = {[OPC_POLY] = "poly",
                                             [OPC_ACTIVE] = "active"};

static int publish_tables(const opc_host *host, const cost *drawn,
                          const cost *now, opc_error *error) {
  const opc_column figures[] = {
      {"layer", NULL, OPC_TEXT, 0, names},
      {"rectangles_drawn", NULL, OPC_INT, 0, drawn->rectangles},
      {"rectangles", NULL, OPC_INT, 0, now->rectangles},
      {"shots_drawn", NULL, OPC_INT, 0, drawn->shots},
      {"shots", NULL, OPC_INT, 0, now->shots},
      {"slivers_drawn", NULL, OPC_INT, 0, drawn->slivers},
      {"slivers", NULL, OPC_INT, 0, now->slivers},
      {"vertices_drawn", NULL, OPC_INT, 0, drawn->vertices},
      {"vertices", NULL, OPC_INT, 0, now->vertices},
      {"area_drawn", "um^2", OPC_REAL, 4, drawn->area},
      {"area", "um^2", OPC_REAL, 4, now->area},
  };
  const opc_column files[] = {
      {"layer", NULL, OPC_TEXT, 0, names},
      {"gdsii_drawn", NULL, OPC_INT, 0, drawn->gdsii},
      {"gdsii", NULL, OPC_INT, 0, now->gdsii},
      {"oasis_drawn", NULL, OPC_INT, 0, drawn->oasis},
      {"oasis", NULL, OPC_INT, 0, now->oasis},
      {"mebes_drawn", NULL, OPC_INT, 0, drawn->mebes},
      {"mebes", NULL, OPC_INT, 0, now->mebes},
  };
  int code = host->table(host, "cost", OPC_TABLE_PRINT, OPC_MASKS, figures,
                         sizeof figures / sizeof figures[0], error);
  return code ? code
              : host->table(host, "cost_bytes", OPC_TABLE_PRINT, OPC_MASKS,
                            files, sizeof files / sizeof files[0], error);
}

static int publish_metrics(const opc_host *host, const cost *drawn,
                           const cost *now, opc_error *error) {
  const struct {
    const char *name;
    const int64_t *layers;
  } sums[] = {
      {"rectangles", now->rectangles},
      {"rectangles_drawn", drawn->rectangles},
      {"shots", now->shots},
      {"shots_drawn", drawn->shots},
      {"slivers", now->slivers},
      {"vertices", now->vertices},
      {"gdsii_bytes", now->gdsii},
      {"oasis_bytes", now->oasis},
      {"mebes_bytes", now->mebes},
      {"mebes_bytes_drawn", drawn->mebes},
  };
  int code = OPC_OK;
  for (size_t i = 0; i < sizeof sums / sizeof sums[0] && !code; i++) {
    double sum = 0;
    for (int layer = 0; layer < OPC_MASKS; layer++)
      sum += (double)sums[i].layers[layer];
    code = host->metric(host, sums[i].name, sum, error);
  }
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const counter *c = self;
  const opc_mask *mask = c->values[MASK].object;
  ruler r;
  cost drawn, corrected;
  (void)outputs;
  if (make_ruler(c, mask->gates, &r, error) ||
      count_all(c, &r, mask->gates->drawn, &drawn, error) ||
      count_all(c, &r, mask->shapes, &corrected, error) ||
      publish_tables(c->host, &drawn, &corrected, error))
    return error->code;
  return publish_metrics(c->host, &drawn, &corrected, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [MASK] = {.name = "mask",
              .type = OPC_INPUT,
              .flags = OPC_REQUIRED,
              .choices = "mask",
              .summary = "The mask to count"},
    [MAX_SHOT] = {.name = "max_shot",
                  .type = OPC_REAL,
                  .flags = OPC_AT_LEAST,
                  .unit = "nm",
                  .preset = "1 um",
                  .min = 10,
                  .summary = "Largest side of a shot, on the plate"},
    [SLIVER] = {.name = "sliver",
                .type = OPC_REAL,
                .flags = OPC_AT_LEAST,
                .unit = "nm",
                .preset = "80 nm",
                .min = 0,
                .summary = "Shots narrower than this on the plate are slivers"},
    [MAGNIFICATION] = {.name = "magnification",
                       .type = OPC_REAL,
                       .flags = OPC_AT_LEAST | OPC_AT_MOST,
                       .preset = "4",
                       .min = 1,
                       .max = 100,
                       .summary = "Of the plate against the wafer"},
    [ARRAY] = {.name = "array",
               .type = OPC_REALS,
               .preset = "[1, 1]",
               .summary = "Columns and rows of copies of the mask to count"},
    [SPACE] = {.name = "array_space",
               .type = OPC_REAL,
               .flags = OPC_AT_LEAST | OPC_AT_MOST,
               .unit = "nm",
               .preset = "200 nm",
               .min = 0,
               .max = 1e6,
               .summary = "Between what is drawn in one copy and the next"},
};

static const opc_metric metrics[] = {
    {.name = "rectangles",
     .better = OPC_LOWER,
     .summary = "Rectangles of the corrected mask, poly and active"},
    {.name = "rectangles_drawn",
     .better = OPC_NEUTRAL,
     .summary = "Rectangles of the mask as drawn, poly and active"},
    {.name = "shots",
     .better = OPC_LOWER,
     .summary = "Shots of a variable shaped beam for the corrected mask"},
    {.name = "shots_drawn",
     .better = OPC_NEUTRAL,
     .summary = "Shots of a variable shaped beam for the mask as drawn"},
    {.name = "slivers",
     .better = OPC_LOWER,
     .summary = "Shots of the corrected mask that are too narrow"},
    {.name = "vertices",
     .better = OPC_LOWER,
     .summary = "Vertices of the corrected mask, poly and active"},
    {.name = "gdsii_bytes",
     .better = OPC_LOWER,
     .summary = "Bytes of the corrected shapes in GDSII, without the array"},
    {.name = "oasis_bytes",
     .better = OPC_LOWER,
     .summary = "Bytes of the corrected shapes in OASIS, without the array"},
    {.name = "mebes_bytes",
     .better = OPC_LOWER,
     .summary = "Bytes of the corrected mask in a model of MEBES"},
    {.name = "mebes_bytes_drawn",
     .better = OPC_NEUTRAL,
     .summary = "Bytes of the mask as drawn in a model of MEBES"},
};

/* ---- entry ---- */

static void destroy(void *self) {
  counter *c = self;
  c->host->free(c->host, c);
}

static int check_array(const opc_host *host, const opc_value *array,
                       opc_error *error) {
  int good = array->count == 2;
  for (size_t i = 0; i < array->count && good; i++) {
    double n = array->reals[i];
    good = n >= 1 && n <= MOST_COPIES && n == floor(n);
  }
  return good ? OPC_OK
              : host->fail(host, error, OPC_INVALID, "array",
                           "needs the numbers of columns and rows, 1 to %d",
                           MOST_COPIES);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  if (check_array(host, &values[ARRAY], error)) return NULL;
  counter *c = host->alloc(host, 1, sizeof *c);
  if (!c) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  c->host = host;
  c->values = values;
  return c;
}

static const opc_step step = {.size = sizeof step, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "cost.fracture",
    .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary = "Count the rectangles, shots, vertices and bytes of a mask",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
