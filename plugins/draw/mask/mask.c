/* SPDX-License-Identifier: BSD-3-Clause */
/* draw.mask: a picture of a corrected mask: what was drawn, the mask, what it
   prints, and how far each transistor is from its drive current. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../view.h"

/* ---- state ---- */

typedef struct drawer {
  const opc_host *host;
  view view;
  const eda_mask *mask;
  double range; /* the deviation at the ends of the scale, % */
} drawer;

static const double least_range = 2; /* of the scale of deviations, % */

/* ---- work: deviations ---- */

/* Of the drive current of a transistor; NAN where it has none. */
static double deviation_of(const eda_performance *p, const eda_mask *mask,
                           size_t gate) {
  double d = eda_deviation(p->ion[gate], mask->design.ion[gate]);
  return isfinite(d) ? d : NAN;
}

/* Whether it does not print as a transistor of its own; notes on its print are
   no failure. */
static int fails(const eda_mask *mask, size_t gate) {
  return (mask->flags[gate] & ~(uint32_t)EDA_PRINT_NOTES) != 0;
}

/* The largest deviation of those that print, rounded up; what lies beyond has
   the colour of the end. */
static double deviation_range(const eda_mask *mask) {
  static const double steps[] = {2, 5, 10, 20};
  double worst = least_range;
  for (size_t i = 0; i < mask->gates->count; i++)
    if (!fails(mask, i))
      worst = fmax(worst, fabs(deviation_of(&mask->after, mask, i)));
  size_t k = 0;
  while (k + 1 < sizeof steps / sizeof steps[0] && steps[k] < worst - 1e-9) k++;
  return steps[k];
}

/* Mean and largest deviation, of those that have one. */
static void deviations(const eda_mask *mask, const eda_performance *of,
                       double *mean, double *max) {
  size_t n = 0;
  *mean = *max = 0;
  for (size_t i = 0; i < mask->gates->count; i++) {
    double d = fabs(deviation_of(of, mask, i));
    if (isnan(d)) continue;
    *mean += d;
    *max = fmax(*max, d);
    n++;
  }
  if (n) *mean /= (double)n;
}

/* ---- work: layers ---- */

static int is_contact(const eda_gates *g, size_t layer) {
  return (int)layer == eda_gates_layer(g, "contact");
}

/* What is drawn of a layer is shown of those that transistors need and of those
   that are corrected. */
static int is_shown(const eda_gates *g, size_t layer) {
  return layer <= EDA_ACTIVE || g->corrected[layer] || is_contact(g, layer);
}

static int fill(const drawer *d, size_t layer, opc_error *error) {
  const eda_gates *g = d->mask->gates;
  return view_fill(
      &d->view, &g->drawn[layer],
      is_contact(g, layer) ? eda_contact_fill : eda_layer_fill(layer), error);
}

static void draw_gate(const drawer *d, size_t i, eda_box clip) {
  const eda_gates *g = d->mask->gates;
  const view *v = &d->view;
  eda_box b = g->box[i];
  if (b.x1 < clip.x0 || b.x0 > clip.x1 || b.y1 < clip.y0 || b.y0 > clip.y1)
    return;
  if (b.x0 < clip.x0) b.x0 = clip.x0;
  if (b.x1 > clip.x1) b.x1 = clip.x1;
  if (b.y0 < clip.y0) b.y0 = clip.y0;
  if (b.y1 > clip.y1) b.y1 = clip.y1;
  double x = view_x(v, b.x0 * g->grid), y = view_y(v, b.y1 * g->grid);
  double width = view_x(v, b.x1 * g->grid) - x;
  double height = view_y(v, b.y0 * g->grid) - y;
  double deviation = deviation_of(&d->mask->after, d->mask, i);
  eda_use(v->paper->cairo, isnan(deviation)
                               ? eda_unknown
                               : eda_diverging((deviation / d->range + 1) / 2));
  cairo_rectangle(v->paper->cairo, x, y, width, height);
  cairo_fill(v->paper->cairo);
  if (fails(d->mask, i)) eda_cross(v->paper, x, y, width, height);
}

typedef struct contours {
  const drawer *drawer;
  view_contours *of; /* each layer */
  opc_error *error;
} contours;

static void find_contours(void *data, size_t layer) {
  contours *c = data;
  const drawer *d = c->drawer;
  view_find_contours(&d->view, &d->mask->print[layer], &c->of[layer],
                     &c->error[layer]);
}

static int draw_prints(const drawer *d, opc_error *error) {
  size_t layers = d->mask->gates->layers;
  contours c = {d, eda_alloc(layers, sizeof *c.of),
                eda_alloc(layers, sizeof *c.error)};
  opc_parallel(d->view.context, layers, find_contours, &c);
  int code = OPC_OK;
  for (size_t k = layers; k-- > 0;) { /* poly on top */
    if (!code && (code = c.error[k].code)) *error = c.error[k];
    if (!code) view_draw_contours(&d->view, &c.of[k], eda_layer_contour(k));
    view_clear_contours(&c.of[k]);
  }
  free(c.of);
  free(c.error);
  return code;
}

/* ---- work: the parts of the view ---- */

static int content(const void *self, opc_error *error) {
  const drawer *d = self;
  const eda_gates *g = d->mask->gates;
  eda_box clip = view_clip(&d->view);
  int code = OPC_OK, contact = eda_gates_layer(g, "contact");
  for (size_t k = g->layers; k-- > 0 && !code;) /* poly above active */
    if (is_shown(g, k) && !is_contact(g, k)) code = fill(d, k, error);
  for (size_t i = 0; i < g->count && !code; i++) draw_gate(d, i, clip);
  if (!code && contact >= 0) code = fill(d, (size_t)contact, error);
  for (size_t k = g->layers; k-- > 0 && !code;)
    code = view_outline(&d->view, &d->mask->shapes[k], eda_layer_outline(k),
                        error);
  if (!code && opc_cancelled(d->view.context))
    code = opc_fail(error, OPC_CANCELLED, NULL, "stopped");
  return code ? code : draw_prints(d, error);
}

static const char *plural(size_t n) { return n == 1 ? "" : "s"; }

static double title(const void *self, double top) {
  const drawer *d = self;
  const eda_mask *mask = d->mask;
  const eda_paper *paper = d->view.paper;
  size_t count = mask->gates->count;
  const char *name = mask->gates->name;
  double height = eda_heading(paper, top, name ? name : "");
  eda_legend l;
  eda_legend_init(&l, paper, top + height);
  eda_legend_add(&l, NULL, "%zu transistor%s", count, plural(count));
  if (count) {
    double mean, max;
    deviations(mask, &mask->before, &mean, &max);
    eda_legend_add(&l, NULL, "|Ion deviation| as drawn: mean %.2f, max %.2f %%",
                   mean, max);
    deviations(mask, &mask->after, &mean, &max);
    eda_legend_add(&l, NULL, "after %u iteration%s: mean %.2f, max %.2f %%",
                   mask->iterations, plural(mask->iterations), mean, max);
  }
  return height + l.height + 0.4 * paper->font;
}

static void add_layer(const drawer *d, size_t k, eda_legend *l) {
  const eda_gates *g = d->mask->gates;
  double least = 0.08 * d->view.paper->font;
  eda_sign sign = {.kind = EDA_SIGN_FILL, .colour = eda_layer_fill(k)};
  if (is_contact(g, k)) sign.colour = eda_contact_fill;
  if (g->drawn[k].count && is_shown(g, k))
    eda_legend_add(l, &sign, "%s%s", g->layer[k],
                   is_contact(g, k) ? "" : " as drawn");
  sign = (eda_sign){.kind = EDA_SIGN_LINE,
                    .colour = eda_layer_outline(k),
                    .line = fmax(least, view_outline_width(&d->view))};
  if (d->mask->shapes[k].count)
    eda_legend_add(l, &sign, "%s mask", g->layer[k]);
  sign.colour = eda_layer_contour(k);
  sign.line = fmax(least, view_contour_width(&d->view));
  if (d->mask->print[k].coefficients)
    eda_legend_add(l, &sign, "printed %s", g->layer[k]);
}

static double legend(const void *self, double top) {
  const drawer *d = self;
  const eda_gates *g = d->mask->gates;
  double gap = 0.6 * d->view.paper->font;
  size_t failing = 0;
  eda_legend l;
  eda_legend_init(&l, d->view.paper, top + gap);
  for (size_t k = 0; k < g->layers; k++) add_layer(d, k, &l);
  view_add_scale_bar(&d->view, &l);
  if (g->count) {
    char low[16], high[16];
    snprintf(low, sizeof low, "-%g %%", d->range);
    snprintf(high, sizeof high, "+%g %%", d->range);
    eda_legend_add(&l,
                   &(eda_sign){.kind = EDA_SIGN_RAMP,
                               .ramp = eda_diverging,
                               .low = low,
                               .high = high},
                   "Ion deviation after correction");
  }
  for (size_t i = 0; i < g->count; i++) failing += (size_t)fails(d->mask, i);
  if (failing)
    eda_legend_add(&l,
                   &(eda_sign){.kind = EDA_SIGN_CROSS, .colour = eda_unknown},
                   "does not print well");
  return gap + l.height;
}

static int run(void *self, void **outputs, opc_error *error) {
  static const view_parts parts = {title, legend, content};
  drawer *d = self;
  (void)outputs;
  d->range = deviation_range(d->mask);
  int code = view_init(&d->view, d->host, d->mask->gates, "mask", error);
  return code ? code : view_write(&d->view, &parts, d, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(drawer, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "The mask to draw"),
    VIEW_PARAMETERS(drawer, "mask.png"),
};

static int check(void *self, opc_error *error) {
  return view_check(&((drawer *)self)->view, error);
}

/* ---- entry ---- */

static const opc_step functions = {.run = run};

OPC_PLUGIN(drawer, .id = "draw.mask", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "Draw a corrected mask, its print and its transistors",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = check,
           OPC_FUNCTIONS(functions));
