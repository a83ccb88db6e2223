/* SPDX-License-Identifier: BSD-3-Clause */
/* Layers that are expressions of other layers. The shapes are computed when the
   layer is flattened, from the operands in the window, so that shapes of
   different cells interact. */
#include <eda/index.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layout/derive.h"
#include "layout/expression.h"

/* ---- registration ---- */

static void expression_free_one(void *e) { expression_free(e); }

static void derived_keep(const eda_layout *layout, int32_t layer,
                         expression *e) {
  eda_layout *writable = (eda_layout *)layout;
  if (!writable->derived)
    writable->derived =
        g_hash_table_new_full(NULL, NULL, NULL, expression_free_one);
  g_hash_table_insert(writable->derived, GINT_TO_POINTER(layer), e);
}

static const expression *derived_find(const eda_layout *layout, int32_t layer) {
  eda_layout *writable = (eda_layout *)layout;
  g_mutex_lock(&writable->lock);
  const expression *e =
      layout->derived
          ? g_hash_table_lookup(layout->derived, GINT_TO_POINTER(layer))
          : NULL;
  g_mutex_unlock(&writable->lock);
  return e;
}

int eda_layout_is_derived(const eda_layout *layout, int32_t layer) {
  return derived_find(layout, layer) != NULL;
}

/* Return the layer with the name in the layout, or in its file. */
static int32_t named_layer(const eda_layout *layout, const char *name) {
  int32_t layer =
      GPOINTER_TO_INT(g_hash_table_lookup(layout->layer_of, name)) - 1;
  for (size_t i = 0; layer < 0 && i < layout->n_layers; i++)
    if (!eda_layout_is_derived(layout, (int32_t)i) &&
        !strcmp(eda_layout_file_layer(layout, (int32_t)i), name))
      layer = (int32_t)i;
  return layer;
}

/* Set the numbers of the layers in an expression. `target` is the layer that
   the expression defines; -1 if the expression was passed to eda_layout_select.
   Fail if a layer is missing, or is or depends on `target`. */
static int expression_resolve(const eda_layout *layout, expression *e,
                              int32_t target, opc_error *error) {
  if (e->kind != EXPRESSION_LAYER) {
    int code = expression_resolve(layout, e->a, target, error);
    return code || !e->b ? code
                         : expression_resolve(layout, e->b, target, error);
  }
  e->layer = named_layer(layout, e->name);
  if (e->layer < 0)
    return opc_fail(error, OPC_INVALID, NULL,
                    "the layout has no layer '%.200s'", e->name);
  if (e->layer == target || eda_layout_depends(layout, e->layer, target))
    return opc_fail(error, OPC_INVALID, NULL,
                    "the expression of '%.200s' contains this layer",
                    eda_layout_layer_name(layout, target));
  return OPC_OK;
}

static int expression_depends(const eda_layout *layout, const expression *e,
                              int32_t on) {
  if (!e) return 0;
  if (e->kind == EXPRESSION_LAYER)
    return e->layer == on || eda_layout_depends(layout, e->layer, on);
  return expression_depends(layout, e->a, on) ||
         expression_depends(layout, e->b, on);
}

int eda_layout_depends(const eda_layout *layout, int32_t layer, int32_t on) {
  return expression_depends(layout, derived_find(layout, layer), on);
}

int eda_layout_derive(eda_layout *layout, const char *name, const char *text,
                      opc_error *error) {
  expression *e = expression_parse(text, error);
  if (!e) return error->code;
  int32_t layer = eda_layout_layer(layout, name, error);
  int code =
      layer < 0 ? error->code : expression_resolve(layout, e, layer, error);
  if (code)
    expression_free(e);
  else
    derived_keep(layout, layer, e);
  return code;
}

/* Register an expression that was passed to eda_layout_select, unless an
   expression with the same text is already registered. Return the number of its
   layer. */
static int32_t selected_keep(const eda_layout *layout, expression *e) {
  eda_layout *writable = (eda_layout *)layout;
  g_mutex_lock(&writable->lock);
  int32_t layer = EDA_SELECTED;
  for (const expression *known; layout->derived; layer++) {
    known = g_hash_table_lookup(layout->derived, GINT_TO_POINTER(layer));
    if (!known || !strcmp(known->text, e->text)) break;
  }
  if (layout->derived &&
      g_hash_table_contains(layout->derived, GINT_TO_POINTER(layer)))
    expression_free(e);
  else
    derived_keep(layout, layer, e);
  g_mutex_unlock(&writable->lock);
  return layer;
}

int32_t eda_layout_select(const eda_layout *layout, const char *text,
                          opc_error *error) {
  int32_t layer = named_layer(layout, text);
  if (layer >= 0) return layer;
  if (!eda_layer_is_expression(text)) {
    opc_fail(error, OPC_INVALID, NULL, "the layout has no layer '%.200s'",
             text);
    return -1;
  }
  expression *e = expression_parse(text, error);
  if (!e || expression_resolve(layout, e, -1, error)) {
    expression_free(e);
    return -1;
  }
  return selected_keep(layout, e);
}

const char *derived_text(const eda_layout *layout, int32_t layer) {
  const expression *e = derived_find(layout, layer);
  return e ? e->text : NULL;
}

/* ---- evaluation ---- */

/* An operand layer that contributes shapes to the result and is not subtracted.
   The flat shapes of sources determine the placements of the boxes of the
   result. */
typedef struct source {
  eda_flat flat;
  int32_t grown; /* sum of all growths of the layer in the expression, grid
                    units; 0 if negative */
} source;

typedef struct evaluation {
  const eda_layout *layout;
  int32_t top;
  double grid;
  source *sources;
  size_t n_sources, capacity;
  eda_flat *out;
  opc_error *error;
} evaluation;

static int growth_units(const evaluation *v, const expression *e,
                        int32_t *units) {
  double by = e->length / v->grid;
  *units = (int32_t)lround(by);
  if (fabs(by - *units) < 1e-6) return OPC_OK;
  return opc_fail(v->error, OPC_INVALID, NULL,
                  "a growth by %g nm is not a multiple of the grid of %g nm",
                  e->length, v->grid);
}

/* Flatten a layer and merge its shapes to *out. If `positive` is 1, the layer
   is not subtracted: keep its flat shapes as a source. */
static int evaluate_layer(evaluation *v, const expression *e,
                          const eda_box *window, int32_t grown, int positive,
                          eda_shapes *out) {
  eda_flat flat;
  int code = eda_layout_flatten_window(v->layout, v->top, e->layer, v->grid,
                                       window, &flat, v->error);
  if (code) return code;
  int32_t most = (int32_t)lround(fmax(1, 1 / v->grid));
  v->out->moved += flat.moved + eda_shapes_straighten(&flat.shapes, most);
  v->out->worst = fmax(v->out->worst, flat.worst);
  code = eda_boolean(EDA_OR, &flat.shapes, NULL, out, v->error);
  source from = {flat, MAX(grown, 0)};
  if (positive && !code)
    EDA_PUSH(v->sources, v->n_sources, v->capacity, from);
  else
    eda_flat_clear(&flat);
  return code;
}

static int evaluate_any(evaluation *v, const expression *e,
                        const eda_box *window, int32_t grown, int positive,
                        eda_shapes *out);

static int evaluate_boolean(evaluation *v, const expression *e,
                            const eda_box *window, int32_t grown, int positive,
                            eda_shapes *out) {
  eda_shapes a = {0}, b = {0};
  int code = evaluate_any(v, e->a, window, grown, positive, &a);
  if (!code)
    code =
        evaluate_any(v, e->b, window, grown, positive && e->op != EDA_NOT, &b);
  if (!code) code = eda_boolean(e->op, &a, &b, out, v->error);
  eda_shapes_clear(&a);
  eda_shapes_clear(&b);
  return code;
}

/* Evaluate the operand of a growth in a window that is larger by the growth. */
static int evaluate_growth(evaluation *v, const expression *e,
                           const eda_box *window, int32_t grown, int positive,
                           eda_shapes *out) {
  eda_shapes a = {0};
  int32_t by = 0;
  eda_box wide = {0};
  int code = growth_units(v, e, &by);
  if (window) wide = eda_box_grown(*window, abs(by));
  if (!code)
    code =
        evaluate_any(v, e->a, window ? &wide : NULL, grown + by, positive, &a);
  if (!code) code = eda_shapes_grow(&a, by, out, v->error);
  eda_shapes_clear(&a);
  return code;
}

/* Compute the merged shapes of an expression. Inside the window, they cover the
   same points as the shapes of the whole layout. */
static int evaluate_any(evaluation *v, const expression *e,
                        const eda_box *window, int32_t grown, int positive,
                        eda_shapes *out) {
  *out = (eda_shapes){0};
  if (e->kind == EXPRESSION_LAYER)
    return evaluate_layer(v, e, window, grown, positive, out);
  return (e->kind == EXPRESSION_GROW ? evaluate_growth : evaluate_boolean)(
      v, e, window, grown, positive, out);
}

/* ---- placements ---- */

/* Boxes with their placements, which become the flat shapes. */
typedef struct placed {
  eda_box_list boxes;
  uint32_t *placement;
  size_t capacity;
} placed;

static void placed_add(placed *p, eda_box box, uint32_t placement) {
  eda_grow(&p->placement, &p->capacity, p->boxes.count + 1,
           sizeof *p->placement);
  p->placement[p->boxes.count] = placement;
  eda_box_list_add(&p->boxes, box);
}

/* Dissect the shapes of a source into boxes, and add the boxes, enlarged by
   s->grown, with their placements to *out. */
static int source_boxes(const source *s, placed *out, opc_error *error) {
  int code = OPC_OK;
  for (size_t i = 0; i < s->flat.shapes.count && !code; i++) {
    uint32_t first = s->flat.shapes.start[i];
    uint32_t start[] = {0, s->flat.shapes.start[i + 1] - first};
    eda_point *points = s->flat.shapes.points + first;
    eda_shapes one = {.count = 1, .start = start, .points = points};
    if (eda_is_box(points, start[1])) {
      eda_box box = eda_box_grown(eda_bounds(points, 4), s->grown);
      placed_add(out, box, s->flat.placement[i]);
      continue;
    }
    eda_shapes merged = {0};
    eda_box *boxes = NULL;
    size_t n = 0;
    code = eda_boolean(EDA_OR, &one, NULL, &merged, error);
    if (!code) code = eda_fracture(&merged, &boxes, &n, error);
    for (size_t k = 0; k < n && !code; k++)
      placed_add(out, eda_box_grown(boxes[k], s->grown), s->flat.placement[i]);
    eda_shapes_clear(&merged);
    free(boxes);
  }
  return code;
}

static eda_box box_both(eda_box a, eda_box b) {
  return (eda_box){MAX(a.x0, b.x0), MAX(a.y0, b.y0), MIN(a.x1, b.x1),
                   MIN(a.y1, b.y1)};
}

/* Add the parts of *result that are covered by boxes of a source to *out, with
   the placements of these boxes, and remove the parts from *result. */
static int place_source(const source *s, eda_shapes *result, placed *out,
                        opc_error *error) {
  placed from = {0};
  eda_box *boxes = NULL;
  size_t n = 0;
  eda_shapes rest = {0};
  int code = source_boxes(s, &from, error);
  if (!code) code = eda_fracture(result, &boxes, &n, error);
  eda_index *index = eda_index_new(boxes, n, 0);
  for (size_t i = 0; i < from.boxes.count && !code; i++) {
    eda_finder f = eda_index_find(index, from.boxes.box[i]);
    for (uint32_t k; eda_index_next(&f, &k);) {
      eda_box both = box_both(boxes[k], from.boxes.box[i]);
      if (both.x0 < both.x1 && both.y0 < both.y1)
        placed_add(out, both, from.placement[i]);
    }
  }
  eda_shapes covered = eda_shapes_of_boxes(from.boxes.count);
  for (size_t i = 0; i < from.boxes.count; i++)
    eda_shapes_set_box(&covered, i, from.boxes.box[i]);
  if (!code) code = eda_boolean(EDA_NOT, result, &covered, &rest, error);
  eda_shapes_clear(result);
  *result = rest;
  eda_shapes_clear(&covered);
  eda_index_free(index);
  free(boxes);
  free(from.boxes.box);
  free(from.placement);
  return code;
}

/* Add the parts of the result outside all sources to *out, with placement 0:
   the top cell. */
static int place_rest(const eda_shapes *result, placed *out, opc_error *error) {
  eda_box *boxes = NULL;
  size_t n = 0;
  int code = eda_fracture(result, &boxes, &n, error);
  for (size_t k = 0; k < n && !code; k++) placed_add(out, boxes[k], 0);
  free(boxes);
  return code;
}

/* Convert the boxes that touch the window to flat shapes. */
static void flat_take(eda_flat *out, const placed *p, const eda_box *window) {
  size_t n = 0;
  for (size_t i = 0; i < p->boxes.count; i++) {
    if (window && !eda_boxes_touch(p->boxes.box[i], *window)) continue;
    p->boxes.box[n] = p->boxes.box[i];
    p->placement[n++] = p->placement[i];
  }
  if (!n) return;
  out->shapes = eda_shapes_of_boxes(n);
  out->placement = eda_alloc(n, sizeof *out->placement);
  for (size_t i = 0; i < n; i++) {
    eda_shapes_set_box(&out->shapes, i, p->boxes.box[i]);
    out->placement[i] = p->placement[i];
  }
  out->vertices = 4 * n;
}

int derived_flatten(const eda_layout *layout, int32_t top, int32_t layer,
                    double grid, const eda_box *window, eda_flat *out,
                    opc_error *error) {
  *out = (eda_flat){0};
  evaluation v = {
      .layout = layout, .top = top, .grid = grid, .out = out, .error = error};
  eda_shapes result = {0};
  placed all = {0};
  int code =
      evaluate_any(&v, derived_find(layout, layer), window, 0, 1, &result);
  for (size_t i = 0; i < v.n_sources && !code; i++)
    code = place_source(&v.sources[i], &result, &all, error);
  if (!code) code = place_rest(&result, &all, error);
  if (!code)
    flat_take(out, &all, window);
  else
    *out = (eda_flat){0};
  for (size_t i = 0; i < v.n_sources; i++) eda_flat_clear(&v.sources[i].flat);
  free(v.sources);
  eda_shapes_clear(&result);
  free(all.boxes.box);
  free(all.placement);
  return code;
}

/* ---- extent ---- */

/* Join the bounds of the layers of an expression, enlarged by the growths. */
static int expression_bounds(evaluation *v, const expression *e, int32_t grown,
                             eda_box *all) {
  int32_t by = 0;
  int code = OPC_OK;
  if (e->kind == EXPRESSION_LAYER) {
    eda_box box;
    code =
        eda_layout_bounds(v->layout, v->top, e->layer, v->grid, &box, v->error);
    if (!code && box.x0 <= box.x1) eda_box_join(all, eda_box_grown(box, grown));
    return code;
  }
  if (e->kind == EXPRESSION_GROW) code = growth_units(v, e, &by);
  if (!code) code = expression_bounds(v, e->a, grown + MAX(by, 0), all);
  return code || !e->b ? code : expression_bounds(v, e->b, grown, all);
}

int derived_bounds(const eda_layout *layout, int32_t top, int32_t layer,
                   double grid, eda_box *box, opc_error *error) {
  evaluation v = {.layout = layout, .top = top, .grid = grid, .error = error};
  *box = (eda_box)EDA_BOX_EMPTY;
  int code = expression_bounds(&v, derived_find(layout, layer), 0, box);
  if (code || box->x0 > box->x1) *box = (eda_box){0, 0, -1, -1};
  return code;
}

static double expression_bytes(const eda_layout *layout, int32_t top,
                               const expression *e) {
  if (!e) return 0;
  if (e->kind == EXPRESSION_LAYER)
    return eda_layout_flat_bytes(layout, top, e->layer);
  return expression_bytes(layout, top, e->a) +
         expression_bytes(layout, top, e->b);
}

double derived_bytes(const eda_layout *layout, int32_t top, int32_t layer) {
  return expression_bytes(layout, top, derived_find(layout, layer));
}
