/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the access to a mask by classes: the flat mask of a window, and
   simulations around classes. */
#include "window.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include <correct/classes.h>
#include <correct/findings.h>
#include <correct/start.h>
#include "align.h"

/* ---- a window ---- */

void window_begin(eda_mask *to) {
  size_t n = to->gates->count;
  to->flags = eda_alloc(n, sizeof *to->flags);
  eda_performance_init(&to->design, n);
  eda_performance_init(&to->before, n);
  eda_performance_init(&to->after, n);
}

void window_put(const eda_mask *from, size_t class, eda_mask *to, size_t i) {
  eda_performance_take(&to->design, i, &from->design, class);
  eda_performance_take(&to->before, i, &from->before, class);
  eda_performance_take(&to->after, i, &from->after, class);
  to->flags[i] = from->flags[class];
}

static int boxes_touch(eda_box a, eda_box b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

/* Set figures and counts of all gates; those outside of the core count 0. */
static void take_figures(const eda_mask *from, eda_box core, eda_mask *to) {
  size_t n = to->gates->count;
  to->count = eda_alloc(n, sizeof *to->count);
  window_begin(to);
  for (size_t i = 0; i < n; i++) {
    size_t k = eda_chip_find(from->chip, to->gates->box[i]);
    if (k == SIZE_MAX) continue;
    to->count[i] = boxes_touch(to->gates->box[i], core) != 0;
    window_put(from, from->chip->gate[k].print, to, i);
  }
}

static int window_make(const eda_mask *mask, eda_box core, int32_t halo,
                       eda_mask **out, opc_error *error) {
  const eda_chip *c = mask->chip;
  eda_segment_settings settings = c->segment;
  eda_gates *g;
  settings.paths = 1;
  int code =
      eda_segment_core(c->layout, c->top, &settings, core, halo, &g, error);
  if (code) return code;
  eda_mask *m = *out = eda_mask_new(g);
  m->own = g;
  m->moved = eda_chip_moved(c, g);
  align_boxes(c, g, m->moved);
  take_figures(mask, core, m);
  code = correct_start_shapes(m, error);
  if (!code) return OPC_OK;
  eda_mask_free(m);
  *out = NULL;
  return code;
}

static int window_flat(const eda_mask *mask, eda_box core, eda_mask **out,
                       opc_error *error) {
  return window_make(mask, core, 0, out, error);
}

/* ---- simulation ---- */

static int simulate_one(const classes_source *s, eda_mask *m,
                        opc_error *error) {
  const opc_host quiet = correct_findings_discarded(s->host);
  correct_settings with = *s->with;
  uint32_t *before = NULL;
  double *extension = NULL;
  eda_performance_clear(&m->before);
  eda_performance_clear(&m->after);
  free(m->flags);
  m->flags = NULL;
  with.margin = CLASSES_GAP;
  int code = correct_print(&with, &quiet, 0, m, &before, &extension, error);
  free(before);
  free(extension);
  return code;
}

static int window_simulate(const eda_mask *mask, const size_t *classes,
                           size_t n, double reach, eda_mask **out,
                           opc_error *error) {
  const classes_source *s = mask->data;
  double grid = mask->gates->grid;
  int32_t more = (int32_t)ceil(reach / grid),
          halo = (int32_t)ceil(s->margin / grid);
  int code = OPC_OK;
  for (size_t i = 0; i < n && !code; i++) {
    eda_box core = eda_box_grown(mask->gates->box[classes[i]], more);
    if (opc_cancelled(s->host->context))
      code = opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    if (!code) code = window_make(mask, core, halo, &out[i], error);
    if (!code) code = simulate_one(s, out[i], error);
  }
  for (size_t i = 0; i < n && code; i++) {
    eda_mask_free(out[i]);
    out[i] = NULL;
  }
  return code;
}

/* ---- access ---- */

/* Keep the layout in the chip: several steps request the same layout, and
   making it takes longer than these steps. */
static int window_layout(const eda_mask *mask, int drawn,
                         const eda_layout **out, opc_error *error) {
  const classes_source *s = mask->data;
  eda_layout **kept = &mask->chip->hierarchy[drawn];
  int code =
      *kept ? OPC_OK
            : hierarchy_make(s->host->context, mask->chip, drawn, kept, error);
  *out = *kept;
  return code;
}

void correct_classes_access(eda_mask *m, const classes_source *source) {
  static const eda_mask_access access = {.size = sizeof access,
                                         .window = window_flat,
                                         .layout = window_layout,
                                         .simulate = window_simulate,
                                         .each_class = parts_visit,
                                         .side = PARTS_SIDE};
  m->access = &access;
  m->data = (void *)source;
}
