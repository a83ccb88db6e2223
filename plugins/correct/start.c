/* SPDX-License-Identifier: BSD-3-Clause */
/* From a mask to the start of a correction, and back. */
#include "start.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "loop.h"

/* ---- from a mask ---- */

double start_disturbance(const eda_mask *m, size_t i) {
  if (m->flags[i] & ~(uint32_t)EDA_PRINT_NOTES) return NAN;
  return fabs(eda_deviation(m->after.ion[i], m->design.ion[i])) -
         fabs(eda_deviation(m->before.ion[i], m->design.ion[i]));
}

int start_from(const opc_host *host, const eda_gates *gates,
               const eda_mask *mask, double max_diff, start *out,
               opc_error *error) {
  *out = (start){0};
  if (!mask && !isnan(max_diff))
    return opc_fail(error, OPC_INVALID, "max_diff",
                    "there is no 'start' to differ from");
  if (!mask) return OPC_OK;
  if (mask->gates != gates)
    return opc_fail(error, OPC_INVALID, "start",
                    "that mask is of the gates of another step");
  if (!mask->moved)
    return opc_fail(error, OPC_INVALID, "start",
                    "how that mask's edges were moved is not known: it is no "
                    "one's that moves transistors from their drawn edges");
  out->base = mask->moved;
  if (isnan(max_diff)) return OPC_OK;
  size_t refined = 0;
  out->still = eda_alloc(gates->count, 1);
  for (size_t i = 0; i < gates->count; i++) {
    out->still[i] = start_disturbance(mask, i) <= max_diff;
    refined += !out->still[i];
  }
  host->log(host, OPC_LOG_INFO, "%zu of %zu transistors are to be refined",
            refined, gates->count);
  return host->metric(host, "refined", (double)refined, error);
}

int start_mask(const eda_gates *g, const eda_moved *moved, size_t layer,
               eda_shapes *out, opc_error *error) {
  trial none;
  pieces p;
  eda_shapes polygons;
  const eda_box_list *patch = &moved->patch[layer], *bite = &moved->bite[layer];
  const eda_boxes added = {patch->box, patch->count},
                  bites = {bite->box, bite->count};
  trial_init(&none, g->layers, g->count);
  none.biases.base = moved;
  pieces_of_edges(&g->edges[layer], 1, &p);
  pieces_room(&p, &polygons);
  if (g->drawn[layer].hole && polygons.count) {
    polygons.hole = eda_alloc(polygons.count, 1);
    memcpy(polygons.hole, g->drawn[layer].hole, polygons.count);
  }
  pieces_follow(g, layer, &none.biases, &p);
  pieces_build(&p, &polygons);
  int code = mask_merge(&polygons, (boxes_lists){&added, 1},
                        (boxes_lists){&bites, 1}, out, error);
  eda_shapes_clear(&polygons);
  pieces_clear(&p);
  trial_clear(&none);
  return code;
}

/* ---- to a mask ---- */

static eda_box_list copy_of(eda_boxes from) {
  eda_box_list to = {0};
  for (size_t i = 0; i < from.count; i++) eda_box_list_add(&to, from.box[i]);
  return to;
}

/* What comes upon a base, or moves more than gates, is not said in these
   words. */
eda_moved *moved_of(const loop *l) {
  size_t n = l->gates->count, layers = l->gates->layers;
  const trial *t = &l->now;
  if (l->base || !n) return NULL;
  for (size_t k = 0; k < layers; k++)
    if (t->shift[k] || t->assists[k].count) return NULL;
  eda_moved *m = eda_moved_new(layers, n);
  memcpy(m->w, t->biases.w, n * sizeof *m->w);
  memcpy(m->aside, t->biases.aside, n * sizeof *m->aside);
  memcpy(m->l, t->biases.l, n * sizeof *m->l);
  memcpy(m->jog, t->biases.jog, n * sizeof *m->jog);
  memcpy(m->end, t->biases.end, 2 * n * sizeof *m->end);
  memcpy(m->part, t->biases.part, EDA_PARTS * n * sizeof *m->part);
  for (size_t k = 0; k < layers; k++) {
    m->patch[k] = copy_of(t->patches[k]);
    m->bite[k] = copy_of(t->bites[k]);
  }
  return m;
}
