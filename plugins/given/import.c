/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the import of masks made by other tools, whose files may have
   another cell, scale, origin or grid. Masks that cannot belong to the gates
   are rejected. For doubtful masks, a finding states the likely cause. */
#include "import.h"

#include <glib.h>
#include <math.h>

/* Tuned constants. */
static const struct {
  double covers, scale, place;
} tuned = {
    /* If a mask covers a smaller fraction of the drawing, the step reports a
       finding. Corrected masks cover more, because edges move by tenths of a
       line width. Unrelated shapes cover about 0.2. */
    .covers = 0.6,

    /* Ratio of the sizes of mask and drawing that indicates another scale.
       Assist features around a small cell change the ratio by less. */
    .scale = 1.2,

    /* Distance between the centres of mask and drawing, nm, that indicates a
       shift. Assist features on one side move the centre by less. */
    .place = 20,
};

/* ---- position ---- */

static eda_box shapes_bounds(const eda_shapes *s) {
  return eda_bounds(s->points, s->count ? s->start[s->count] : 0);
}

/* Return a text such as "(0, 0) to (1200, 900) nm". */
static char *place_of(const eda_gates *g, eda_box b) {
  return g_strdup_printf("(%g, %g) to (%g, %g) nm", b.x0 * g->grid,
                         b.y0 * g->grid, b.x1 * g->grid, b.y1 * g->grid);
}

/* Return the likely reason for a mask that does not cover the drawing. */
static char *guess_cause(const eda_gates *g, eda_box mask, eda_box drawn) {
  double width = ((double)mask.x1 - mask.x0) / ((double)drawn.x1 - drawn.x0);
  double height = ((double)mask.y1 - mask.y0) / ((double)drawn.y1 - drawn.y0);
  double dx = ((double)mask.x0 + mask.x1 - drawn.x0 - drawn.x1) / 2 * g->grid;
  double dy = ((double)mask.y0 + mask.y1 - drawn.y0 - drawn.y1) / 2 * g->grid;
  double least = fmin(width, height), most = fmax(width, height);
  if (most < tuned.scale * least &&
      (least > tuned.scale || most < 1 / tuned.scale))
    return g_strdup_printf(
        "the mask is %.4g times as large: check the 'scale' of the file",
        sqrt(width * height));
  if (most < tuned.scale && least > 1 / tuned.scale &&
      hypot(dx, dy) > tuned.place)
    return g_strdup_printf("the mask seems displaced by (%g, %g) nm", dx, dy);
  return g_strdup(
      "check that the mask belongs to this cell and layer and has dark shapes "
      "on a clear field");
}

/* ---- one layer ---- */

/* Set the parameter of the error to a key of `layers`. */
static int blame_layer(opc_error *error, const char *name) {
  (void)snprintf(error->parameter, sizeof error->parameter, "layers.%.56s",
                 name);
  return error->code;
}

/* Compute the fraction of the drawing that the mask covers, 0 to 1. */
static int mask_coverage(const eda_shapes *mask, const eda_shapes *drawn,
                         double *share, opc_error *error) {
  eda_shapes both;
  int code = eda_boolean(EDA_AND, mask, drawn, &both, error);
  if (code) return code;
  *share = (double)eda_area2(&both) / (double)eda_area2(drawn);
  eda_shapes_clear(&both);
  return OPC_OK;
}

/* Return OPC_INVALID if the mask extends beyond the simulated frame, because
   the image is periodic. */
static int stays_inside(const import *t, size_t layer, eda_box mask,
                        const char *why, opc_error *error) {
  const eda_gates *g = t->gates;
  eda_box e = g->extent;
  double over = fmax(fmax((double)e.x0 - mask.x0, (double)mask.x1 - e.x1),
                     fmax((double)e.y0 - mask.y0, (double)mask.y1 - e.y1));
  if (over * g->grid < t->margin) return OPC_OK;
  opc_fail(error, OPC_INVALID, NULL,
           "the mask extends %g nm beyond the drawn layout, but only %g nm "
           "('margin') are simulated: %s",
           over * g->grid, t->margin, why);
  return blame_layer(error, g->layer[layer]);
}

static int import_check_cover(const import *t, size_t layer,
                              const eda_shapes *mask, opc_error *error) {
  const eda_gates *g = t->gates;
  const eda_shapes *drawn = &g->drawn[layer];
  double share = 1;
  if (!drawn->count) return OPC_OK;
  eda_box there = shapes_bounds(mask), here = shapes_bounds(drawn);
  g_autofree char *why = guess_cause(g, there, here);
  int code = stays_inside(t, layer, there, why, error);
  if (!code) code = mask_coverage(mask, drawn, &share, error);
  if (code || share >= tuned.covers) return code;
  g_autofree char *from = place_of(g, there), *to = place_of(g, here);
  g_autofree char *much =
      share > 0 ? g_strdup_printf("%.0f %%", 100 * share) : g_strdup("nothing");
  t->host->log(t->host, OPC_LOG_FINDING,
               "the mask of '%s' covers %s of the drawn shapes: the mask "
               "extends from %s, the drawn shapes from %s; %s",
               g->layer[layer], much, from, to, why);
  return OPC_OK;
}

/* Vertices that rounding to the grid has moved. */
typedef struct moved {
  size_t vertices;
  double worst; /* largest distance, nm */
} moved;

static void import_log_grid(const import *t, const char *from,
                            const eda_flat *flat, moved *all) {
  all->vertices += flat->moved;
  all->worst = fmax(all->worst, flat->worst);
  if (flat->moved)
    t->host->log(
        t->host, OPC_LOG_FINDING,
        "the grid of %g nm moved %zu of %zu vertices of the mask layer '%s', "
        "by %.3g nm at most: a finer 'grid' of the gates avoids this",
        t->gates->grid, flat->moved, flat->vertices, from, flat->worst);
}

static int import_layer(const import *t, int32_t top, size_t layer,
                        const char *from, eda_shapes *out, moved *all,
                        opc_error *error) {
  const char *name = t->gates->layer[layer];
  opc_error missing;
  int32_t number = eda_layout_select(t->layout, from, &missing);
  eda_flat flat;
  if (number < 0) {
    opc_fail(error, OPC_INVALID, NULL, "the mask: %.800s", missing.message);
    return blame_layer(error, name);
  }
  int code =
      eda_layout_flatten(t->layout, top, number, t->gates->grid, &flat, error);
  if (!code) code = eda_boolean(EDA_OR, &flat.shapes, NULL, out, error);
  if (!code) import_log_grid(t, from, &flat, all);
  eda_flat_clear(&flat);
  if (code) return blame_layer(error, name);
  if (!out->count && t->gates->drawn[layer].count) {
    opc_fail(error, OPC_INVALID, NULL,
             "layer '%.200s' of cell '%.200s' is empty, expected the shapes of "
             "a mask",
             from, eda_layout_cell_name(t->layout, top));
    return blame_layer(error, name);
  }
  return import_check_cover(t, layer, out, error);
}

/* ---- all layers ---- */

static int find_top(const import *t, int32_t *top, opc_error *error) {
  *top = eda_layout_find_cell(t->layout, t->top ? t->top : t->gates->name);
  if (*top < 0 && t->top)
    return opc_fail(error, OPC_INVALID, "top",
                    "the layout of the mask has no cell '%.200s'", t->top);
  if (*top < 0) *top = eda_layout_top(t->layout, error);
  return *top < 0 ? error->code : OPC_OK;
}

/* Return OPC_INVALID if the map names a layer that is not corrected. */
static int check_map(const import *t, opc_error *error) {
  for (size_t i = 0; i < t->layers.count; i++) {
    const char *key = t->layers.pairs[i].key;
    int layer = eda_gates_layer(t->gates, key);
    if (layer >= 0 && t->gates->corrected[layer]) continue;
    opc_fail(error, OPC_INVALID, NULL, "the gates have no %s of this name",
             layer < 0 ? "layer" : "corrected layer");
    return blame_layer(error, key);
  }
  return OPC_OK;
}

static const char *source_of(const import *t, size_t layer) {
  for (size_t i = 0; i < t->layers.count; i++)
    if (!g_strcmp0(t->layers.pairs[i].key, t->gates->layer[layer]))
      return t->layers.pairs[i].value;
  return NULL;
}

int import_shapes(const import *t, eda_mask *mask, opc_error *error) {
  const eda_gates *g = t->gates;
  moved all = {0};
  int32_t top;
  int code = check_map(t, error);
  if (!code) code = find_top(t, &top, error);
  for (size_t k = 0; k < g->layers && !code; k++) {
    const char *from = source_of(t, k);
    if (!g->corrected[k]) continue;
    if (from) {
      code = import_layer(t, top, k, from, &mask->shapes[k], &all, error);
      continue;
    }
    t->host->log(t->host, OPC_LOG_WARNING,
                 "'layers' does not name '%s': the drawn shapes are the mask "
                 "of this layer",
                 g->layer[k]);
    code = eda_boolean(EDA_OR, &g->drawn[k], NULL, &mask->shapes[k], error);
  }
  if (!code)
    code = t->host->metric(t->host, "snapped", (double)all.vertices, error);
  return code ? code
              : t->host->metric(t->host, "snapped_worst", all.worst, error);
}
