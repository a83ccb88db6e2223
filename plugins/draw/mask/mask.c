/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `draw.mask`: a picture of the drawn layout, the corrected
   mask, the printed contours and the deviation of each transistor's drive
   current. */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "drawer.h"

/* ---- state ---- */

/* Pixels per nm below which no lines are drawn. At this scale, 65 nm are three
   pixels, which lines would cover. */
static const double coarse = 0.05;

/* ---- work: content ---- */

/* Return 1 if the scale is too small for lines. */
static int drawer_is_coarse(const view *v) { return v->scale < coarse; }

/* Return 1 if the window or an inset shows lines. */
static int shows_lines(const drawer *d) {
  return !drawer_is_coarse(&d->view) || d->n_worst;
}

static const eda_field *drawn_print(const drawer *d, size_t layer) {
  const eda_field *all = d->mask->drawn_print;
  return all && d->state != AFTER && all[layer].coefficients ? &all[layer]
                                                             : NULL;
}

static const eda_field *print_of(const drawer *d, size_t layer) {
  const eda_field *print = &d->mask->print[layer];
  return d->state != BEFORE && print->coefficients ? print : NULL;
}

/* ---- work: layers ---- */

static int is_contact(const eda_gates *g, size_t layer) {
  return (int)layer == eda_gates_layer(g, "contact");
}

/* Return 1 for the layers of transistors, corrected layers and contacts. */
static int is_shown(const eda_gates *g, size_t layer) {
  return layer <= EDA_ACTIVE || g->corrected[layer] || is_contact(g, layer);
}

static int fill_layer(const drawer *d, size_t layer, opc_error *error) {
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
  double deviation = drawer_figure(d, i);
  eda_use(v->paper->cairo, isnan(deviation)
                               ? eda_unknown
                               : eda_diverging((deviation / d->range + 1) / 2));
  cairo_rectangle(v->paper->cairo, x, y, width, height);
  cairo_fill(v->paper->cairo);
  if (drawer_fails(d, i)) eda_cross(v->paper, x, y, width, height);
}

/* Contours of the drawn and of the corrected mask. */
typedef struct contours {
  const drawer *drawer;
  view_contours *of; /* [2 * layer + corrected] */
  opc_error *error;
} contours;

static void find_contours(void *data, size_t i) {
  contours *c = data;
  const drawer *d = c->drawer;
  const eda_field *print = i % 2 ? print_of(d, i / 2) : drawn_print(d, i / 2);
  if (print) view_find_contours(&d->view, print, &c->of[i], &c->error[i]);
}

/* Draw the contours. In a difference, contours of the drawn mask are dashed. */
static int draw_prints(const drawer *d, opc_error *error) {
  const double dash = 0.5 * d->view.paper->font;
  cairo_t *cairo = d->view.paper->cairo;
  size_t n = 2 * d->mask->gates->layers;
  contours c = {d, eda_alloc(n, sizeof *c.of), eda_alloc(n, sizeof *c.error)};
  opc_parallel(d->view.context, n, find_contours, &c);
  int code = OPC_OK;
  for (size_t k = n; k-- > 0;) { /* poly is drawn last */
    if (!code && (code = c.error[k].code)) *error = c.error[k];
    cairo_set_dash(cairo, &dash, d->state == DIFFERENCE && k % 2 == 0, 0);
    if (!code) view_draw_contours(&d->view, &c.of[k], eda_layer_contour(k / 2));
    view_clear_contours(&c.of[k]);
  }
  cairo_set_dash(cairo, NULL, 0, 0);
  free(c.of);
  free(c.error);
  return code;
}

/* Return the number of violations. Violations belong to the corrected mask. */
static size_t count_violations(const drawer *d) {
  return d->state == BEFORE ? 0 : d->mask->n_violations;
}

/* Mark violations by rings, or by dots that together cover a tenth of the
   window if there are too many violations for rings. */
static void mark_violations(const drawer *d) {
  const view *v = &d->view;
  cairo_t *cairo = v->paper->cairo;
  size_t n = 0;
  for (size_t i = 0; i < count_violations(d); i++)
    n += (size_t)view_contains(v, d->mask->violations[i].x,
                               d->mask->violations[i].y);
  double radius = sqrt(0.1 * v->width * v->height / (M_PI * (double)n));
  for (size_t i = 0; n && i < count_violations(d); i++) {
    const eda_violation *at = &d->mask->violations[i];
    double x = view_x(v, at->x), y = view_y(v, at->y);
    if (!view_contains(v, at->x, at->y)) continue;
    if (radius > 0.55 * v->paper->font) {
      eda_ring(v->paper, x, y);
      continue;
    }
    cairo_rectangle(cairo, x - radius, y - radius, 2 * radius, 2 * radius);
    eda_use(cairo, eda_ring_colour);
    cairo_fill(cairo);
  }
}

int drawer_paint(const drawer *d, opc_error *error) {
  const eda_gates *g = d->mask->gates;
  eda_box clip = view_clip(&d->view);
  int code = OPC_OK, contact = eda_gates_layer(g, "contact");
  int lines = !drawer_is_coarse(&d->view);
  for (size_t k = g->layers; k-- > 0 && !code;) /* poly is drawn over active */
    if (is_shown(g, k) && !is_contact(g, k)) code = fill_layer(d, k, error);
  for (size_t i = 0; i < g->count && !code; i++) draw_gate(d, i, clip);
  if (!code && contact >= 0) code = fill_layer(d, (size_t)contact, error);
  for (size_t k = g->layers; k-- > 0 && !code && lines && d->state != BEFORE;)
    code = view_outline(&d->view, &d->mask->shapes[k], eda_layer_outline(k),
                        error);
  if (!code && opc_cancelled(d->view.context))
    code = opc_fail(error, OPC_CANCELLED, NULL, "stopped");
  if (!code && lines) code = draw_prints(d, error);
  if (!code) mark_violations(d);
  return code;
}

static int mask_content(const void *self, opc_error *error) {
  int code = drawer_paint(self, error);
  return code ? code : drawer_put_insets(self, error);
}

static const char *plural_of(size_t n) { return n == 1 ? "" : "s"; }

static double mask_title(const void *self, double top) {
  const drawer *d = self;
  const eda_mask *mask = d->mask;
  const eda_paper *paper = d->view.paper;
  size_t count = mask->gates->count;
  const char *name = mask->gates->name;
  double height = eda_heading(paper, top, name ? name : "");
  eda_legend l;
  eda_legend_init(&l, paper, top + height);
  eda_legend_add(&l, NULL, "%zu transistor%s", count, plural_of(count));
  if (count) {
    double mean, max;
    drawer_statistics(d, &mask->before, &mean, &max);
    eda_legend_add(&l, NULL, "|Ion deviation| as drawn: mean %.2f, max %.2f %%",
                   mean, max);
    drawer_statistics(d, &mask->after, &mean, &max);
    if (mask->iterations)
      eda_legend_add(&l, NULL, "after %u iteration%s: mean %.2f, max %.2f %%",
                     mask->iterations, plural_of(mask->iterations), mean, max);
    else /* an imported mask has no displacements */
      eda_legend_add(&l, NULL, "by this mask: mean %.2f, max %.2f %%", mean,
                     max);
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
  if (d->mask->shapes[k].count && d->state != BEFORE && shows_lines(d))
    eda_legend_add(l, &sign, "%s mask", g->layer[k]);
  sign.colour = eda_layer_contour(k);
  sign.line = fmax(least, view_contour_width(&d->view));
  if (print_of(d, k) && shows_lines(d))
    eda_legend_add(l, &sign, "printed %s", g->layer[k]);
  if (d->state == DIFFERENCE) sign.dash = 0.3 * d->view.paper->font;
  if (drawn_print(d, k) && shows_lines(d))
    eda_legend_add(l, &sign, "%s printed as drawn", g->layer[k]);
}

static void add_scale(const drawer *d, eda_legend *l) {
  static const char *const texts[] = {
      "Ion deviation as drawn", "Ion deviation after correction",
      "|Ion deviation|, after minus before: below 0 is better"};
  char low[32], high[32];
  (void)snprintf(low, sizeof low, "-%g %%", d->range);
  (void)snprintf(high, sizeof high, "+%g %%", d->range);
  const eda_sign sign = {
      .kind = EDA_SIGN_RAMP, .ramp = eda_diverging, .low = low, .high = high};
  if (d->beyond)
    eda_legend_add(l, &sign, "%s; %zu beyond", texts[d->state], d->beyond);
  else
    eda_legend_add(l, &sign, "%s", texts[d->state]);
}

static double mask_legend(const void *self, double top) {
  const drawer *d = self;
  const eda_gates *g = d->mask->gates;
  double gap = 0.6 * d->view.paper->font + drawer_insets_height(d);
  size_t failing = 0;
  eda_legend l;
  eda_legend_init(&l, d->view.paper, top + gap);
  for (size_t k = 0; k < g->layers; k++) add_layer(d, k, &l);
  view_add_scale_bar(&d->view, &l);
  if (g->count) add_scale(d, &l);
  for (size_t i = 0; i < g->count; i++) failing += (size_t)drawer_fails(d, i);
  if (failing)
    eda_legend_add(&l,
                   &(eda_sign){.kind = EDA_SIGN_CROSS, .colour = eda_unknown},
                   "does not print well");
  if (count_violations(d))
    eda_legend_add(&l, &(eda_sign){.kind = EDA_SIGN_RING},
                   "violated rule (%zu)", count_violations(d));
  return gap + l.height;
}

static int flat_run(drawer *d, opc_error *error) {
  static const view_parts parts = {mask_title, mask_legend, mask_content};
  if (d->state == CLASSES)
    return opc_fail(error, OPC_INVALID, "state",
                    "'classes' needs a mask by classes: set 'divide: "
                    "environments' in the step that corrects");
  int code = view_init(&d->view, d->host, d->mask->gates, "mask", error);
  if (code) return code;
  drawer_set_range(d);
  drawer_choose_insets(d);
  code = view_write(&d->view, &parts, d, error);
  free(d->worst);
  d->worst = NULL;
  return code;
}

/* Draw a window of a mask by classes. */
static int window_run(drawer *d, opc_error *error) {
  const eda_mask *all = d->mask;
  eda_mask *part;
  const double *w = d->view.asked.window.values;
  double grid = all->gates->grid;
  const eda_box core = {(int32_t)floor(w[0] / grid),
                        (int32_t)floor(w[1] / grid), (int32_t)ceil(w[2] / grid),
                        (int32_t)ceil(w[3] / grid)};
  int code = all->access->window(all, core, &part, error);
  if (code) return code;
  d->mask = part;
  code = flat_run(d, error);
  d->mask = all;
  eda_mask_free(part);
  return code;
}

static int mask_run(void *self, void **outputs, opc_error *error) {
  drawer *d = self;
  (void)outputs;
  if (!d->mask->chip) return flat_run(d, error);
  return d->view.asked.window.count && d->state != CLASSES
             ? window_run(d, error)
             : drawer_map(d, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(drawer, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "Mask to draw"),
    VIEW_PARAMETERS(drawer, "mask.png"),
    OPC_PARAMETER(
        drawer, state, .type = OPC_CHOICE, .preset = "after",
        .choices = "before|after|difference|classes",
        .summary =
            "Show the drawn mask, the corrected mask, the difference, or (for "
            "a "
            "mask by classes) the number of transistors with the same mask"),
    OPC_PARAMETER(drawer, scale, .type = OPC_TEXT, .preset = "auto",
                  .summary =
                      "Deviation at the ends of the colour scale, such as 2 %; "
                      "auto: the range of 98 % of the transistors"),
    OPC_PARAMETER(drawer, insets, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "4", .min = 0,
                  .max = 8,
                  .summary = "Number of close-ups of the worst transistors, "
                             "drawn if the scale of the layout is small"),
};

static int mask_check(void *self, opc_error *error) {
  drawer *d = self;
  int code = view_check(&d->view, error);
  return code ? code : drawer_check_scale(d, error);
}

/* ---- entry ---- */

static const opc_step functions = {.run = mask_run};

OPC_PLUGIN(
    drawer, .id = "draw.mask", .kind = "step", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary =
        "Draw a corrected mask, the simulated contours and the transistors",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    .check = mask_check, OPC_FUNCTIONS(functions));
