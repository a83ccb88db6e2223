/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements rule-based assist features beside gates. */
#include <correct/assists.h>

#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include <correct/loop.h>

/* Return the edge of a gate that faces larger (`high` 1) or smaller coordinates
   along L. */
static eda_sraf_edge edge_of(const eda_gates *g, size_t i, int high) {
  eda_box b = g->box[i];
  eda_sraf_edge e = {.upright = g->axis[i] == EDA_X, .sign = high ? 1 : -1};
  e.at = e.upright ? (high ? b.x1 : b.x0) : (high ? b.y1 : b.y0);
  e.low = e.upright ? b.y0 : b.x0;
  e.high = e.upright ? b.y1 : b.x1;
  return e;
}

int32_t correct_steps(const eda_gates *gates, double nm) {
  return (int32_t)lround(fmin(nm / gates->grid, 1e6));
}

static void assists_show(loop *l) {
  correct_trial_set_boxes(
      &l->next.assists[EDA_POLY],
      (eda_boxes){l->assists.srafs.box, l->assists.srafs.count});
}

/* The layout repeats beyond the clear field. A scatter bar outside the
   simulation frame would overlap the next copy of the layout, and its
   transmission would be counted twice. */
int correct_assists_check(const loop *l, opc_error *error) {
  const eda_frame *f = &l->printer.frame;
  double g = l->gates->grid;
  for (size_t k = 0; k < l->gates->layers; k++) {
    eda_boxes srafs = l->next.assists[k];
    for (size_t i = 0; i < srafs.count; i++) {
      eda_box b = srafs.box[i];
      if (b.x0 * g >= f->x0 && b.x1 * g <= f->x0 + f->width &&
          b.y0 * g >= f->y0 && b.y1 * g <= f->y0 + f->height)
        continue;
      return opc_fail(
          error, OPC_INVALID, "margin",
          "a scatter bar of layer '%s', from (%g, %g) to (%g, %g) nm, extends "
          "beyond the clear field: increase 'margin'",
          l->gates->layer[k], b.x0 * g, b.y0 * g, b.x1 * g, b.y1 * g);
    }
  }
  return OPC_OK;
}

int correct_assists_begin(loop *l, opc_error *error) {
  gate_srafs *a = &l->assists;
  size_t n = l->gates->count;
  if (!a->rows || !n) return OPC_OK;
  if (l->next.shift[EDA_POLY])
    return opc_fail(error, OPC_INVALID, "assist",
                    "'assist' does not apply to '%s', which dissects the poly "
                    "layer: remove 'assist'",
                    l->drivers[MAIN].module->id);
  const eda_sraf_rule rule = {
      .rows = (int32_t)a->rows,
      .width = correct_steps(l->gates, a->width),
      .distance = correct_steps(l->gates, a->distance),
      .space = correct_steps(l->gates, a->space),
      .min_length = correct_steps(l->gates, a->min_length),
      .overhang = correct_steps(l->gates, a->overhang)};
  if (rule.width < 1)
    return opc_fail(
        error, OPC_INVALID, "assist_width",
        "'assist_width' is %g nm, expected at least the mask grid of %g nm",
        a->width, l->gates->grid);
  eda_sraf_edge *edges = eda_alloc(n, 2 * sizeof *edges);
  for (size_t i = 0; i < 2 * n; i++) edges[i] = edge_of(l->gates, i / 2, i % 2);
  int code = eda_srafs_place(edges, 2 * n, &rule, &l->gates->drawn[EDA_POLY],
                             &a->srafs, error);
  free(edges);
  if (!code) assists_show(l);
  return code;
}

void correct_assists_clear(loop *l) { free(l->assists.srafs.box); }

void correct_assists_watch(loop *l) {
  gate_srafs *a = &l->assists;
  size_t gone =
      eda_srafs_drop(l->host->context, &a->srafs, &l->printer.print[EDA_POLY],
                     l->gates->grid, a->margin);
  a->dropped += gone;
  if (gone) assists_show(l);
}

int correct_assists_report(const loop *l, opc_error *error) {
  const gate_srafs *a = &l->assists;
  if ((!a->rows || !l->gates->count) && !l->search.most) return OPC_OK;
  const opc_metric_value values[] = {
      {"assists", (double)l->now.assists[EDA_POLY].count},
      {"assists_dropped", (double)(a->dropped + l->search.dropped)}};
  return opc_put_metrics(l->host, OPC_ARRAY(values), error);
}
