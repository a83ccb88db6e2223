/* SPDX-License-Identifier: BSD-3-Clause */
/* Two charts over length: the on and the off currents, on logarithmic axes, as
   both change by their share with each nm. */
#include <eda/drawing.h>
#include <math.h>
#include <stdio.h>

#include "ngspice.h"

static const double paper_width = 1200, paper_height = 560;

/* Of the n-transistor and the p-transistor. */
static eda_colour colour_of(int type) {
  return eda_layer_outline(type == EDA_NMOS ? 0 : 1);
}

static void draw_chart(eda_chart *c, const plan *p, const currents *all,
                       int current) {
  char title[96], width[32];
  size_t first = all->first, count = p->count - first;
  const double *n = all->at[EDA_NMOS][current];
  const double *p_type = all->at[EDA_PMOS][current];
  const double ends[] = {n[first], n[p->count - 1], p_type[first],
                         p_type[p->count - 1]};
  eda_axis_fit(&c->y, ends, 4);
  eda_axis_widen(&c->y, 0.05, 0.02);
  (void)snprintf(width, sizeof width, "%.6g um", p->width / 1000);
  (void)snprintf(title, sizeof title, "%s of W = %s, Vgs %g V, Vds %g V",
                 current == EDA_ION ? "Ion" : "Ioff", width,
                 p->bias[current].gate, p->bias[current].drain);
  c->title = title;
  eda_chart_axes(c);
  c->title = NULL;
  const double x[] = {p->reference_length, p->reference_length};
  const double y[] = {c->y.low, c->y.high};
  eda_chart_line(c, eda_ink, 1, 4, x, y, 2);
  for (int type = 0; type < TYPES; type++)
    eda_chart_line(c, colour_of(type), 2.5, 0, p->length + first,
                   all->at[type][current] + first, count);
}

static void draw_key(const eda_paper *paper, const plan *p, double top) {
  eda_legend l;
  eda_legend_init(&l, paper, top);
  for (int type = 0; type < TYPES; type++)
    eda_legend_add(
        &l,
        &(eda_sign){
            .kind = EDA_SIGN_LINE, .colour = colour_of(type), .line = 2.5},
        "%s-transistor, model %s", type == EDA_NMOS ? "n" : "p",
        p->model[type]);
}

int picture_draw(const plan *p, const currents *all, const char *name,
                 opc_error *error) {
  const char *path = p->host->output_path(p->host, p->picture, error);
  eda_paper *paper =
      path ? eda_paper_open(path, paper_width, paper_height, 15, error) : NULL;
  if (!paper) return error->code;
  paper->margin = 70;
  draw_key(paper, p, 5 + eda_heading(paper, 5, name));
  eda_chart c = {.paper = paper,
                 .left = 100,
                 .top = 90,
                 .width = 460,
                 .height = 410,
                 .x.title = "drawn length, nm",
                 .y = {.log = 1, .unit = "A"}};
  eda_axis_fit(&c.x, p->length + all->first, p->count - all->first);
  draw_chart(&c, p, all, EDA_ION);
  c.left = 690;
  draw_chart(&c, p, all, EDA_IOFF);
  return eda_paper_close(paper, OPC_OK, error);
}
