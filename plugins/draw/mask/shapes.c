/* SPDX-License-Identifier: BSD-3-Clause */
/* What is inside the window: shapes as drawn, transistors, mask, print. */
#include <math.h>

#include "picture.h"

static int fill(const picture *p, int layer, opc_error *error) {
  picture_use(p->view.cairo, picture_drawn[layer]);
  return view_fill(&p->view, &p->mask->gates->drawn[layer], error);
}

static int outline(const picture *p, int layer, opc_error *error) {
  picture_use(p->view.cairo, picture_mask[layer]);
  return view_outline(&p->view, &p->mask->shapes[layer],
                      view_outline_width(&p->view), error);
}

/* ---- transistors ---- */

static void gate(const picture *p, size_t i, opc_box clip) {
  const opc_gates *g = p->mask->gates;
  const view *v = &p->view;
  opc_box b = g->box[i];
  if (b.x1 < clip.x0 || b.x0 > clip.x1 || b.y1 < clip.y0 || b.y0 > clip.y1)
    return;
  if (b.x0 < clip.x0) b.x0 = clip.x0;
  if (b.x1 > clip.x1) b.x1 = clip.x1;
  if (b.y0 < clip.y0) b.y0 = clip.y0;
  if (b.y1 > clip.y1) b.y1 = clip.y1;
  double x = view_x(v, b.x0 * g->grid), y = view_y(v, b.y1 * g->grid);
  double width = view_x(v, b.x1 * g->grid) - x;
  double height = view_y(v, b.y0 * g->grid) - y;
  double deviation = picture_deviation(&p->mask->after, p->mask, i);
  picture_use(v->cairo, isnan(deviation)
                            ? picture_unknown
                            : picture_diverging(deviation / p->range));
  cairo_rectangle(v->cairo, x, y, width, height);
  cairo_fill(v->cairo);
  if (picture_fails(p->mask, i)) legend_cross(v, x, y, width, height);
}

/* ---- print ---- */

typedef struct contours {
  const picture *picture;
  view_contours of[OPC_MASKS];
  opc_error error[OPC_MASKS];
} contours;

static void find(void *data, size_t layer) {
  contours *c = data;
  const picture *p = c->picture;
  c->error[layer].code = OPC_OK;
  view_find_contours(&p->view, &p->mask->print[layer], &c->of[layer],
                     &c->error[layer]);
}

static int prints(const picture *p, opc_error *error) {
  const view *v = &p->view;
  contours c = {.picture = p};
  v->host->parallel(v->host, OPC_MASKS, find, &c);
  int code = OPC_OK;
  cairo_set_line_width(v->cairo, view_contour_width(v));
  for (int layer = OPC_MASKS; layer-- > 0;) { /* poly on top */
    if (!code && (code = c.error[layer].code)) *error = c.error[layer];
    picture_use(v->cairo, picture_print[layer]);
    if (!code) view_draw_contours(v, &c.of[layer]);
    view_release_contours(v, &c.of[layer]);
  }
  return code;
}

/* ---- all of it ---- */

int picture_shapes(const void *data, opc_error *error) {
  const picture *p = data;
  const opc_host *host = p->view.host;
  int code = fill(p, OPC_ACTIVE, error);
  if (!code) code = fill(p, OPC_POLY, error);
  opc_box clip = view_clip(&p->view);
  for (size_t i = 0; i < p->mask->gates->count && !code; i++) gate(p, i, clip);
  if (!code) code = fill(p, OPC_CONTACT, error);
  if (!code) code = outline(p, OPC_ACTIVE, error);
  if (!code) code = outline(p, OPC_POLY, error);
  if (!code && host->cancelled(host))
    code = host->fail(host, error, OPC_CANCELLED, NULL, "stopped");
  if (!code) code = prints(p, error);
  return code;
}
