/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws charts over length of the on current, the off current and the gate
   capacitance, on logarithmic axes, which show relative changes per nm. */
#include <eda/drawing.h>
#include <eda/memory.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ngspice.h"

static const double paper_height = 560;
static const double chart_step = 590; /* distance between charts */

/* Return the colour of the n- or p-transistor. */
static eda_colour colour_of(int type) {
  return eda_layer_outline(type == EDA_NMOS ? 0 : 1);
}

/* Draw a current at one width; extrapolated parts are dashed. */
static void draw_curve(eda_chart *c, const plan *p, const currents *all,
                       int type, int current, size_t w) {
  double scale = p->widths > 1 ? 1000 / p->each_width[w] : 1;
  double thick = w + 1 == p->widths ? 2.5 : 0.8;
  size_t first = all->first, from = all->simulated[type];
  double *y = eda_alloc(p->count, sizeof *y);
  for (size_t i = first; i < p->count; i++)
    y[i] = scale * all->at[type][current][w * p->count + i];
  if (from > first)
    eda_chart_line(c, colour_of(type), thick, 5, p->length + first, y + first,
                   from - first + 1);
  if (from < first) from = first;
  eda_chart_line(c, colour_of(type), thick, 0, p->length + from, y + from,
                 p->count - from);
  free(y);
}

/* Set the range of the axis from all curves. */
static void fit_axis(eda_axis *y, const plan *p, const currents *all,
                     int current) {
  double ends[2] = {INFINITY, 0};
  for (int type = 0; type < TYPES; type++)
    for (size_t i = 0; i < p->widths * p->count; i++) {
      double scale = p->widths > 1 ? 1000 / p->each_width[i / p->count] : 1;
      double value = scale * all->at[type][current][i];
      if (i % p->count < all->first) continue;
      ends[0] = fmin(ends[0], value);
      ends[1] = fmax(ends[1], value);
    }
  eda_axis_fit(y, ends, 2);
  eda_axis_widen(y, 0.05, 0.02);
}

static void draw_chart(eda_chart *c, const plan *p, const currents *all,
                       int current) {
  static const char *const names[QUANTITIES] = {"Ion", "Ioff", "Cgate"};
  char title[128], width[48];
  c->y.unit = current == CGATE ? "F" : "A";
  fit_axis(&c->y, p, all, current);
  (void)snprintf(width, sizeof width,
                 p->widths > 1 ? "%.6g to %.6g um, by um" : "%.6g um",
                 p->each_width[0] / 1000, p->width / 1000);
  (void)snprintf(title, sizeof title, "%s of W = %s, Vgs %s%g V, Vds %g V",
                 names[current], width, current == CGATE ? "0 to " : "",
                 p->bias[current].gate, p->bias[current].drain);
  c->title = title;
  eda_chart_axes(c);
  c->title = NULL;
  const double x[] = {p->reference_length, p->reference_length};
  const double y[] = {c->y.low, c->y.high};
  eda_chart_line(c, eda_ink, 1, 4, x, y, 2);
  for (int type = 0; type < TYPES; type++)
    for (size_t w = 0; w < p->widths; w++)
      draw_curve(c, p, all, type, current, w);
}

static void draw_key(const eda_paper *paper, const plan *p, const currents *all,
                     double top) {
  eda_legend l;
  eda_legend_init(&l, paper, top);
  for (int type = 0; type < TYPES; type++)
    eda_legend_add(
        &l,
        &(eda_sign){
            .kind = EDA_SIGN_LINE, .colour = colour_of(type), .line = 2.5},
        "%s-transistor, model %s", type == EDA_NMOS ? "n" : "p",
        p->model[type]);
  if (all->simulated[EDA_NMOS] || all->simulated[EDA_PMOS])
    eda_legend_add(
        &l,
        &(eda_sign){
            .kind = EDA_SIGN_LINE, .colour = eda_ink, .line = 2.5, .dash = 5},
        "extrapolated beyond the model");
}

int picture_draw(const plan *p, const currents *all, const char *name,
                 opc_error *error) {
  const char *path = p->host->output_path(p->host, p->picture, error);
  eda_paper *paper =
      path ? eda_paper_open(path, 20 + chart_step * plan_quantities(p),
                            paper_height, 15, error)
           : NULL;
  if (!paper) return error->code;
  paper->margin = 70;
  draw_key(paper, p, all, 5 + eda_heading(paper, 5, name));
  eda_chart c = {.paper = paper,
                 .top = 90,
                 .width = 460,
                 .height = 410,
                 .x.title = "drawn length, nm",
                 .y.log = 1};
  /* If the lengths span a large range, a logarithmic axis resolves the short
     lengths. */
  c.x.log = p->length[p->count - 1] > 10 * p->length[all->first];
  eda_axis_fit(&c.x, p->length + all->first, p->count - all->first);
  for (int k = 0; k < plan_quantities(p); k++) {
    c.left = 100 + chart_step * k;
    draw_chart(&c, p, all, k);
  }
  return eda_paper_close(paper, OPC_OK, error);
}
