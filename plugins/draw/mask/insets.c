/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements insets: the worst transistors of a layout shown at a small scale,
   each with its environment and a letter at its position. */
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drawer.h"

/* Tuned constants. */
static const struct {
  double scale, least, sizes;
} tuned = {
    /* Pixels per nm above which a gate of 65 nm is recognisable. */
    .scale = 0.2,
    /* Width of the region in an inset: smallest width, nm, and width divided by
       the size of the gate. */
    .least = 1000,
    .sizes = 1.6,
};

typedef struct ranked {
  double rank;
  size_t gate;
} ranked;

/* Order by rank, then by number. */
EDA_COMPARE_FALLING(by_rank, ranked, rank, gate);

static double middle_x(const drawer *d, size_t i) {
  const eda_gates *g = d->mask->gates;
  return ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid;
}

static double middle_y(const drawer *d, size_t i) {
  const eda_gates *g = d->mask->gates;
  return ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid;
}

/* Return the width of the region in an inset, nm. */
static double side_of(const drawer *d, size_t i) {
  const eda_gates *g = d->mask->gates;
  eda_box b = g->box[i];
  double size =
      fmax((double)b.x1 - b.x0, (double)b.y1 - b.y0) * g->grid * tuned.sizes;
  return fmax(size, tuned.least);
}

/* Return 1 if an earlier inset shows the transistor. */
static int is_seen(const drawer *d, size_t i) {
  for (size_t k = 0; k < d->n_worst; k++) {
    double half = side_of(d, d->worst[k]) / 2;
    if (fabs(middle_x(d, i) - middle_x(d, d->worst[k])) < half &&
        fabs(middle_y(d, i) - middle_y(d, d->worst[k])) < half)
      return 1;
  }
  return 0;
}

void drawer_choose_insets(drawer *d) {
  const eda_gates *g = d->mask->gates;
  const view *v = &d->view;
  size_t n = 0;
  d->n_worst = 0;
  d->worst = eda_alloc((size_t)d->insets, sizeof *d->worst);
  double small = (double)v->asked.width / tuned.scale; /* nm */
  if (v->x1 - v->x0 < small && v->y1 - v->y0 < small) return;
  ranked *all = eda_alloc(g->count, sizeof *all);
  for (size_t i = 0; i < g->count; i++) {
    double off = drawer_figure(d, i);
    if (!view_contains(v, middle_x(d, i), middle_y(d, i))) continue;
    if (d->state != DIFFERENCE) off = fabs(off);
    all[n++] = (ranked){drawer_fails(d, i) || isnan(off) ? INFINITY : off, i};
  }
  qsort(all, n, sizeof *all, by_rank);
  for (size_t k = 0; k < n && (int64_t)d->n_worst < d->insets; k++)
    if (!is_seen(d, all[k].gate)) d->worst[d->n_worst++] = all[k].gate;
  free(all);
}

/* ---- places ---- */

static double inset_gap(const view *v) { return ceil(0.8 * v->paper->font); }

static double width_of(const drawer *d) {
  const view *v = &d->view;
  double width = v->paper->width - 2 * v->paper->margin;
  double n = (double)(d->insets > 4 ? d->insets : 4);
  return floor((width - (n - 1) * inset_gap(v)) / n);
}

double drawer_insets_height(const drawer *d) {
  if (!d->n_worst) return 0;
  return inset_gap(&d->view) + width_of(d) + 4.2 * d->view.paper->font;
}

static view inset_view(const drawer *d, size_t place) {
  view v = d->view;
  size_t i = d->worst[place];
  double half = side_of(d, i) / 2;
  v.width = v.height = width_of(d);
  v.left = floor(v.paper->margin + (double)place * (v.width + inset_gap(&v)));
  v.top = d->view.top + d->view.height + inset_gap(&v);
  v.x0 = middle_x(d, i) - half, v.x1 = middle_x(d, i) + half;
  v.y0 = middle_y(d, i) - half, v.y1 = middle_y(d, i) + half;
  v.scale = v.width / (2 * half);
  return v;
}

static void draw_frame(const view *v, double x, double y, double width,
                       double height) {
  cairo_rectangle(v->paper->cairo, floor(x) - 0.5, floor(y) - 0.5,
                  round(width) + 1, round(height) + 1);
  eda_use(v->paper->cairo, eda_ink);
  cairo_set_line_width(v->paper->cairo, 1);
  cairo_stroke(v->paper->cairo);
}

/* ---- content ---- */

/* Draw a frame around the region of an inset, and the letter above. */
static void put_letter(const drawer *d, size_t place) {
  const view *v = &d->view;
  double font = v->paper->font, side = floor(1.3 * font);
  size_t i = d->worst[place];
  double wide = fmax(side_of(d, i) * v->scale, 0.5 * side);
  double x = view_x(v, middle_x(d, i)) - wide / 2;
  double y = view_y(v, middle_y(d, i)) - wide / 2;
  char letter[2] = {(char)('A' + (int)place), 0};
  double left = fmin(fmax(x, v->left), v->left + v->width - side);
  double top = fmax(y - side - 1, v->top);
  draw_frame(v, x, y, wide, wide);
  cairo_rectangle(v->paper->cairo, floor(left), floor(top), side, side);
  cairo_set_source_rgb(v->paper->cairo, 1, 1, 1);
  cairo_fill(v->paper->cairo);
  draw_frame(v, left, top, side, side);
  eda_text(v->paper, floor(left) + side / 2, floor(top) + side - 0.3 * font,
           EDA_MIDDLE, INFINITY, letter);
}

static void put_texts(const drawer *d, const view *v, size_t place) {
  const eda_gates *g = d->mask->gates;
  size_t i = d->worst[place];
  const char *where = g->instance && *g->instance[i] ? g->instance[i]
                      : g->cell                      ? g->cell[i]
                                                     : "";
  double font = v->paper->font, base = v->top + v->height + 1.4 * font;
  g_autofree char *name =
      g_strdup_printf("%c  %s:%u", (char)('A' + (int)place), where,
                      g->number ? (unsigned)g->number[i] : (unsigned)i + 1);
  g_autofree char *before =
      g_strdup_printf("Ion as drawn %+.2f %%; %.6g nm",
                      drawer_deviation(d, &d->mask->before, i), side_of(d, i));
  g_autofree char *after =
      drawer_fails(d, i)
          ? g_strdup("does not print well")
          : g_strdup_printf("by the mask %+.2f %%",
                            drawer_deviation(d, &d->mask->after, i));
  eda_text(v->paper, v->left, floor(base), EDA_LEFT, v->width, name);
  eda_text(v->paper, v->left, floor(base + 1.3 * font), EDA_LEFT, v->width,
           before);
  eda_text(v->paper, v->left, floor(base + 2.6 * font), EDA_LEFT, v->width,
           after);
}

int drawer_put_insets(const drawer *d, opc_error *error) {
  cairo_t *cairo = d->view.paper->cairo;
  int code = OPC_OK;
  for (size_t k = 0; k < d->n_worst && !code; k++) {
    drawer part = *d;
    part.view = inset_view(d, k);
    const view *v = &part.view;
    cairo_save(cairo);
    cairo_reset_clip(cairo);
    cairo_rectangle(cairo, v->left, v->top, v->width, v->height);
    cairo_clip(cairo);
    code = drawer_paint(&part, error);
    cairo_reset_clip(cairo);
    draw_frame(v, v->left, v->top, v->width, v->height);
    put_texts(d, v, k);
    cairo_restore(cairo);
    put_letter(d, k);
  }
  return code;
}
