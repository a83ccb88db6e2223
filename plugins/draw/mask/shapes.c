/* SPDX-License-Identifier: BSD-3-Clause */
/* What is inside the window: shapes as drawn, transistors, mask, print. */
#include <math.h>

#include "picture.h"

/* Contours are exact where they cross the lines of their grid. Between them
   they are chords, which leave an arc of radius r by step^2 / (8 r): the step
   is such that this is a tenth of a pixel, but a grid has no more than
   MAX_NODES. */
enum { MAX_NODES = 4000000 };
static const double least_radius = 40; /* nm, of a printed corner */
static const double max_step = 20;     /* nm: lines are not stepped over */

/* ---- places ---- */

static double paper_x(const picture *p, double x) {
  return p->left + (x - p->x0) * p->scale;
}

static double paper_y(const picture *p, double y) {
  return p->top + (p->y1 - y) * p->scale;
}

double picture_mask_line(const picture *p) {
  double line = fmin(0.075 * p->font, 5 * p->scale);
  return p->raster && line >= 0.5 ? round(line) : fmax(line, 0.25);
}

double picture_print_line(const picture *p) {
  return fmax(fmin(fmax(0.11 * p->font, 1.5), 5 * p->scale), 0.25);
}

/* Lines of whole pixels are sharp if their edges are those of pixels. */
static double sharp(const picture *p, double place, double line) {
  if (!p->raster || line != round(line)) return place;
  double half = fmod(line, 2) / 2;
  return floor(place + 0.5 - half) + half;
}

/* ---- shapes ---- */

static int32_t clamped(double x) {
  return (int32_t)fmax(-(1 << 30), fmin(1 << 30, x));
}

/* The window with something around it, in units of the grid: what is cut there
   is not seen, and nothing leaves the range of cairo's coordinates. */
static opc_box clip_box(const picture *p) {
  double grid = p->mask->gates->grid;
  double x = (p->x1 - p->x0) / 8, y = (p->y1 - p->y0) / 8;
  return (opc_box){clamped(floor((p->x0 - x) / grid) - 1),
                   clamped(floor((p->y0 - y) / grid) - 1),
                   clamped(ceil((p->x1 + x) / grid) + 1),
                   clamped(ceil((p->y1 + y) / grid) + 1)};
}

static int cut(const picture *p, const opc_shapes *shapes, opc_shapes *out,
               opc_error *error) {
  opc_box b = clip_box(p);
  opc_point points[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
  uint32_t start[] = {0, 4};
  opc_shapes window = {.count = 1, .start = start, .points = points};
  return p->host->geometry->boolean(p->host, OPC_AND, shapes, &window, out,
                                    error);
}

static void polygon_path(const picture *p, const opc_shapes *s, size_t i,
                         double line) {
  double grid = p->mask->gates->grid;
  cairo_new_sub_path(p->cairo);
  for (uint32_t k = s->start[i]; k < s->start[i + 1]; k++)
    cairo_line_to(p->cairo, sharp(p, paper_x(p, s->points[k].x * grid), line),
                  sharp(p, paper_y(p, s->points[k].y * grid), line));
  cairo_close_path(p->cairo);
}

static int fill(const picture *p, int layer, opc_error *error) {
  opc_shapes s;
  int code = cut(p, &p->mask->gates->drawn[layer], &s, error);
  if (code) return code;
  for (size_t i = 0; i < s.count; i++) polygon_path(p, &s, i, 0);
  cairo_set_fill_rule(p->cairo, CAIRO_FILL_RULE_EVEN_ODD);
  picture_use(p->cairo, picture_drawn[layer]);
  cairo_fill(p->cairo);
  p->host->geometry->release(&s);
  return OPC_OK;
}

static int outline(const picture *p, int layer, opc_error *error) {
  opc_shapes s;
  int code = cut(p, &p->mask->shapes[layer], &s, error);
  if (code) return code;
  double line = picture_mask_line(p);
  picture_use(p->cairo, picture_mask[layer]);
  cairo_set_line_width(p->cairo, line);
  cairo_set_line_join(p->cairo, CAIRO_LINE_JOIN_MITER);
  for (size_t i = 0; i < s.count; i++) {
    polygon_path(p, &s, i, line);
    cairo_stroke(p->cairo); /* one by one: cairo's time grows with a path's */
  }
  p->host->geometry->release(&s);
  return OPC_OK;
}

/* ---- transistors ---- */

static void gate(const picture *p, size_t i, opc_box clip) {
  const opc_gates *g = p->mask->gates;
  opc_box b = g->box[i];
  if (b.x1 < clip.x0 || b.x0 > clip.x1 || b.y1 < clip.y0 || b.y0 > clip.y1)
    return;
  if (b.x0 < clip.x0) b.x0 = clip.x0;
  if (b.x1 > clip.x1) b.x1 = clip.x1;
  if (b.y0 < clip.y0) b.y0 = clip.y0;
  if (b.y1 > clip.y1) b.y1 = clip.y1;
  double x = paper_x(p, b.x0 * g->grid), y = paper_y(p, b.y1 * g->grid);
  double width = paper_x(p, b.x1 * g->grid) - x;
  double height = paper_y(p, b.y0 * g->grid) - y;
  double deviation = picture_deviation(&p->mask->after, p->mask, i);
  picture_use(p->cairo, isnan(deviation)
                            ? picture_unknown
                            : picture_diverging(deviation / p->range));
  cairo_rectangle(p->cairo, x, y, width, height);
  cairo_fill(p->cairo);
  if (p->mask->flags[i]) picture_cross(p, x, y, width, height);
}

/* ---- print ---- */

typedef struct contours {
  const picture *picture;
  double *points[OPC_MASKS];
  uint32_t *start[OPC_MASKS];
  size_t count[OPC_MASKS];
  opc_error error[OPC_MASKS];
} contours;

/* The part of the window that the print covers. */
static opc_frame printed_window(const picture *p, opc_frame f) {
  double around = 4 / p->scale; /* the lines along its border are not seen */
  double x0 = fmax(p->x0 - around, f.x0), y0 = fmax(p->y0 - around, f.y0);
  return (opc_frame){x0, y0, fmin(p->x1 + around, f.x0 + f.width) - x0,
                     fmin(p->y1 + around, f.y0 + f.height) - y0};
}

static void find(void *data, size_t layer) {
  contours *c = data;
  const picture *p = c->picture;
  const opc_field *print = &p->mask->print[layer];
  c->error[layer].code = OPC_OK;
  if (!print->coefficients) return;
  opc_frame w = printed_window(p, print->frame);
  if (!(w.width > 0 && w.height > 0)) return;
  double step = fmin(sqrt(0.8 * least_radius / p->scale), max_step);
  step = fmax(step, sqrt(w.width * w.height / MAX_NODES));
  p->host->imaging->contours(p->host, print, w, step, &c->points[layer],
                             &c->start[layer], &c->count[layer],
                             &c->error[layer]);
}

/* Points nearer to the last one than that, in pixels, are left out. */
static const double too_near = 0.4;

static void contour(const picture *p, const double *points, size_t n) {
  double x = 0, y = 0;
  for (size_t i = 0; i < n; i++) {
    double to_x = paper_x(p, points[2 * i]);
    double to_y = paper_y(p, points[2 * i + 1]);
    if (i && fabs(to_x - x) + fabs(to_y - y) < too_near) continue;
    x = to_x;
    y = to_y;
    cairo_line_to(p->cairo, x, y);
  }
  cairo_close_path(p->cairo);
  cairo_stroke(p->cairo);
}

static int prints(const picture *p, opc_error *error) {
  contours c = {.picture = p};
  p->host->parallel(p->host, OPC_MASKS, find, &c);
  int code = OPC_OK;
  cairo_set_line_width(p->cairo, picture_print_line(p));
  cairo_set_line_join(p->cairo, CAIRO_LINE_JOIN_ROUND);
  for (int layer = OPC_MASKS; layer-- > 0;) { /* poly on top */
    if (!code && (code = c.error[layer].code)) *error = c.error[layer];
    picture_use(p->cairo, picture_print[layer]);
    for (size_t i = 0; i < c.count[layer] && !code; i++) {
      uint32_t first = c.start[layer][i];
      contour(p, c.points[layer] + 2 * (size_t)first,
              c.start[layer][i + 1] - first);
    }
    p->host->free(p->host, c.points[layer]);
    p->host->free(p->host, c.start[layer]);
  }
  return code;
}

/* ---- all of it ---- */

int picture_shapes(const picture *p, opc_error *error) {
  cairo_save(p->cairo);
  cairo_rectangle(p->cairo, p->left, p->top, p->width, p->height);
  cairo_clip(p->cairo);
  int code = fill(p, OPC_ACTIVE, error);
  if (!code) code = fill(p, OPC_POLY, error);
  opc_box clip = clip_box(p);
  for (size_t i = 0; i < p->mask->gates->count && !code; i++) gate(p, i, clip);
  if (!code) code = fill(p, OPC_CONTACT, error);
  if (!code) code = outline(p, OPC_ACTIVE, error);
  if (!code) code = outline(p, OPC_POLY, error);
  if (!code && p->host->cancelled(p->host))
    code = p->host->fail(p->host, error, OPC_CANCELLED, NULL, "stopped");
  if (!code) code = prints(p, error);
  cairo_restore(p->cairo);
  picture_use(p->cairo, picture_faint);
  cairo_set_line_width(p->cairo, 1);
  cairo_rectangle(p->cairo, p->left - 0.5, p->top - 0.5, p->width + 1,
                  p->height + 1);
  cairo_stroke(p->cairo);
  return code;
}
