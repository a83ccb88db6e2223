/* SPDX-License-Identifier: BSD-3-Clause */
/* What stands around the window: title, legend, scales. */
#include <math.h>
#include <stdio.h>

#include "picture.h"

/* ---- title ---- */

/* Mean and largest deviation, of those that have one. */
static void deviations(const picture *p, const opc_performance *of,
                       double *mean, double *max) {
  size_t n = 0;
  *mean = *max = 0;
  for (size_t i = 0; i < p->mask->gates->count; i++) {
    double d = fabs(picture_deviation(of, p->mask, i));
    if (isnan(d)) continue;
    *mean += d;
    *max = fmax(*max, d);
    n++;
  }
  if (n) *mean /= (double)n;
}

static const char *plural(double n) { return n == 1 ? "" : "s"; }

double picture_title(const void *data, double top, int draw) {
  const picture *p = data;
  legend l = {.n = 0};
  const view *v = &p->view;
  const opc_gates *g = p->mask->gates;
  double height = legend_heading(v, g->name ? g->name : "", top, draw);
  legend_add(&l, LEGEND_PLAIN, picture_ink, "%zu transistor%s", g->count,
             plural((double)g->count));
  if (g->count) {
    double mean, max;
    deviations(p, &p->mask->before, &mean, &max);
    legend_add(&l, LEGEND_PLAIN, picture_ink,
               "|Ion deviation| as drawn: mean %.2f, max %.2f %%", mean, max);
    deviations(p, &p->mask->after, &mean, &max);
    legend_add(&l, LEGEND_PLAIN, picture_ink,
               "after %u iteration%s: mean %.2f, max %.2f %%",
               p->mask->iterations, plural(p->mask->iterations), mean, max);
  }
  return height + legend_flow(v, &l, top + height, draw) + 0.4 * v->font;
}

/* ---- legend ---- */

static int any_fails(const opc_mask *mask) {
  for (size_t i = 0; i < mask->gates->count; i++)
    if (picture_fails(mask, i)) return 1;
  return 0;
}

static void add_layers(const picture *p, legend *l) {
  static const char *const drawn[OPC_LAYERS] = {
      [OPC_POLY] = "poly as drawn",
      [OPC_ACTIVE] = "active as drawn",
      [OPC_CONTACT] = "contact"};
  static const char *const mask[OPC_MASKS] = {
      [OPC_POLY] = "poly mask", [OPC_ACTIVE] = "active mask"};
  static const char *const print[OPC_MASKS] = {
      [OPC_POLY] = "printed poly", [OPC_ACTIVE] = "printed active"};
  const view *v = &p->view;
  for (int layer = 0; layer < OPC_LAYERS; layer++) {
    if (p->mask->gates->drawn[layer].count)
      legend_add(l, LEGEND_FILL, picture_drawn[layer], "%s", drawn[layer]);
    if (layer >= OPC_MASKS) continue;
    if (p->mask->shapes[layer].count)
      legend_add(l, LEGEND_LINE, picture_mask[layer], "%s", mask[layer])->line =
          fmax(0.08 * v->font, view_outline_width(v));
    if (p->mask->print[layer].coefficients)
      legend_add(l, LEGEND_LINE, picture_print[layer], "%s", print[layer])
          ->line = fmax(0.08 * v->font, view_contour_width(v));
  }
}

static rgb deviation_colour(double t) { return picture_diverging(2 * t - 1); }

static void add_scale(const picture *p, legend *l) {
  legend_entry *e =
      legend_add(l, LEGEND_RAMP, picture_ink, "Ion deviation after correction");
  e->ramp = deviation_colour;
  (void)snprintf(e->low, sizeof e->low, "-%g %%", p->range);
  (void)snprintf(e->high, sizeof e->high, "+%g %%", p->range);
}

double picture_legend(const void *data, double top, int draw) {
  const picture *p = data;
  legend l = {.n = 0};
  const view *v = &p->view;
  legend_use_font(v);
  add_layers(p, &l);
  double gap = 0.6 * v->font;
  legend_add_scale_bar(&l, v);
  if (p->mask->gates->count) add_scale(p, &l);
  if (any_fails(p->mask))
    legend_add(&l, LEGEND_CROSS, picture_unknown, "does not print well");
  return gap + legend_flow(v, &l, top + gap, draw);
}
