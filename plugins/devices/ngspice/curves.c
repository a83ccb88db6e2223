/* SPDX-License-Identifier: BSD-3-Clause */
/* Two charts over length: the on and the off currents, on logarithmic axes, as
   both change by their share with each nm. */
#include <math.h>
#include <stdio.h>

#include "../../draw/chart.h"
#include "ngspice.h"

static const double paper_width = 1200, paper_height = 560;

static rgb colour_of(int type) {
  return picture_mask[type == OPC_NMOS ? OPC_POLY : OPC_ACTIVE];
}

static void draw_chart(chart *c, const plan *p, const currents *all,
                       int current) {
  char title[96], width[32];
  size_t first = all->first, count = p->count - first;
  c->y0 = INFINITY, c->y1 = -INFINITY;
  for (int type = 0; type < TYPES; type++) {
    const double *y = all->at[type][current];
    c->y1 = fmax(c->y1, log10(y[first]));
    c->y0 = fmin(c->y0, log10(y[p->count - 1]));
  }
  chart_widen(&c->y0, &c->y1, 0.05, 0.02);
  c->y0 = pow(10, c->y0);
  c->y1 = pow(10, c->y1);
  (void)snprintf(width, sizeof width, "%.6g um", p->width / 1000);
  (void)snprintf(title, sizeof title, "%s of W = %s, Vgs %g V, Vds %g V",
                 current == ION ? "Ion" : "Ioff", width, p->bias[current].gate,
                 p->bias[current].drain);
  chart_axes(c, title, "drawn length, nm", NULL);
  const double x[] = {p->reference_length, p->reference_length};
  const double y[] = {c->y0, c->y1};
  chart_line(c, picture_ink, 1, 4, x, y, 2);
  for (int type = 0; type < TYPES; type++)
    chart_line(c, colour_of(type), 2.5, 0, p->length + first,
               all->at[type][current] + first, count);
}

static void draw_key(const chart *c, const plan *p, double x, double y) {
  for (int type = 0; type < TYPES; type++) {
    char text[160];
    (void)snprintf(text, sizeof text, "%s-transistor, model %.120s",
                   type == OPC_NMOS ? "n" : "p", p->model[type]);
    x = chart_key(c, x, y, colour_of(type), 0, text);
  }
}

int curves_draw(const opc_host *host, const plan *p, const currents *all,
                const char *name, int format, const char *path,
                opc_error *error) {
  paper file;
  chart c;
  int code = chart_open(&file, host, format, path, paper_width, paper_height,
                        &c, error);
  if (code) return code;
  chart_title(&c, 70, 1.8 * c.font, name);
  draw_key(&c, p, 70, 3.4 * c.font);
  c.top = 90;
  c.width = 460;
  c.height = 410;
  c.x0 = p->length[all->first];
  c.x1 = p->length[p->count - 1];
  c.decades = "A";
  c.left = 100;
  draw_chart(&c, p, all, ION);
  c.left = 690;
  draw_chart(&c, p, all, IOFF);
  return paper_close(&file, OPC_OK, error);
}
