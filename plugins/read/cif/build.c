/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the construction of a layout's shapes, texts and instances from
   the commands of a CIF file. */
#include <math.h>
#include <string.h>

#include "cif.h"

#define PI 3.14159265358979323846

enum { SIDES = 32 }; /* corners of the polygon of a round flash */

/* ---- layers ---- */

/* Set the layout's layer for the current layer; create the layer if
   necessary. */
static void find_layer(cif *c) {
  const opc_map *map = &c->b.r->layers;
  int renamed = 0, taken = 0;
  for (size_t i = 0; i < map->count; i++) {
    renamed |= !strcmp(map->pairs[i].value, c->layer);
    taken |= !strcmp(map->pairs[i].key, c->layer);
  }
  if (taken && !renamed)
    cif_refuse(c, "a layer has a name that 'layers' assigns to another layer");
  else
    c->layer_number = reading_named_layer(&c->b, c->layer);
}

/* Prepare to draw a shape: fail without a current layer, and count the shape in
   the survey. Return 1 in the pass that builds the layout. */
static int cif_draw(cif *c) {
  if (!c->layer[0]) cif_refuse(c, "a shape without a layer");
  if (!c->building && c->current == cif_symbol_at(c, 0)) c->loose++;
  if (!c->building || c->b.failed) return 0;
  if (c->layer_number < 0) find_layer(c);
  return !c->b.failed;
}

/* ---- coordinates ---- */

static void cif_outside(cif *c) {
  cif_refuse(c, "a coordinate beyond 32 bits");
}

int32_t cif_units(cif *c, int64_t v) {
  if (!c->building) return 0;
  int64_t units = v * c->current->factor; /* below 2^62 */
  if (units != (int32_t)units) cif_outside(c);
  return (int32_t)units;
}

static eda_point cif_add_point(cif *c, double x, double y) {
  x = floor(x + 0.5);
  y = floor(y + 0.5);
  if (fabs(x) <= INT32_MAX && fabs(y) <= INT32_MAX)
    return (eda_point){(int32_t)x, (int32_t)y};
  cif_outside(c);
  return (eda_point){0, 0};
}

double cif_angle(int64_t dx, int64_t dy) {
  if (dy == 0) return dx > 0 ? 0 : 180;
  if (dx == 0) return dy > 0 ? 90 : 270;
  if (dx == dy) return dx > 0 ? 45 : 225;
  if (dx == -dy) return dy > 0 ? 135 : 315;
  return atan2((double)dy, (double)dx) * 180 / PI;
}

/* ---- shapes ---- */

static void add_polygon(cif *c, const eda_point *points, size_t n) {
  if (!c->b.failed)
    reading_check(&c->b, eda_layout_add_polygon(c->b.layout, c->current->cell,
                                                c->layer_number, points, n,
                                                &c->b.layout_error));
}

void cif_box(cif *c, int64_t length, int64_t width, int64_t x, int64_t y,
             int64_t dx, int64_t dy) {
  if ((length | width) & 1) c->current->odd = 1;
  if (!cif_draw(c)) return;
  double k = (double)c->current->factor;
  double size = hypot((double)dx, (double)dy);
  double ux = (double)dx / size, uy = (double)dy / size;
  double l = (double)length * k / 2, w = (double)width * k / 2;
  static const int along[4] = {-1, 1, 1, -1}, across[4] = {-1, -1, 1, 1};
  eda_point corner[4];
  for (int i = 0; i < 4; i++)
    corner[i] =
        cif_add_point(c, (double)x * k + along[i] * l * ux - across[i] * w * uy,
                      (double)y * k + along[i] * l * uy + across[i] * w * ux);
  add_polygon(c, corner, 4);
}

void cif_polygon(cif *c) {
  size_t n = c->points->len;
  const eda_point *p = (const eda_point *)c->points->data;
  if (n < 3) cif_refuse(c, "a polygon of fewer than 3 points");
  if (!cif_draw(c)) return;
  if (p[0].x == p[n - 1].x && p[0].y == p[n - 1].y) n--;
  if (n >= 3) add_polygon(c, p, n);
}

/* Wire ends are extended by half the width, as is common practice. The standard
   has round ends, which are unsuitable for masks. */
void cif_wire(cif *c, int64_t width) {
  if (width & 1) c->current->odd = 1;
  if (!c->points->len) cif_refuse(c, "a wire without points");
  if (!cif_draw(c)) return;
  int32_t units = cif_units(c, width);
  if (!c->b.failed)
    reading_check(&c->b, eda_layout_add_path(
                             c->b.layout, c->current->cell, c->layer_number,
                             (const eda_point *)c->points->data, c->points->len,
                             units, 2, 0, 0, &c->b.layout_error));
}

void cif_flash(cif *c, int64_t diameter, int64_t x, int64_t y) {
  if (!cif_draw(c) || diameter == 0) return;
  double k = (double)c->current->factor, r = (double)diameter * k / 2;
  eda_point corner[SIDES];
  for (int i = 0; i < SIDES; i++) {
    double angle = 2 * PI * i / SIDES;
    corner[i] = cif_add_point(c, (double)x * k + r * cos(angle),
                              (double)y * k + r * sin(angle));
  }
  add_polygon(c, corner, SIDES);
}

void cif_label(cif *c, const char *label, int64_t x, int64_t y) {
  if (!cif_draw(c)) return;
  eda_point at = {cif_units(c, x), cif_units(c, y)};
  if (!c->b.failed)
    reading_check(&c->b, eda_layout_add_text(c->b.layout, c->current->cell,
                                             c->layer_number, at, label,
                                             &c->b.layout_error));
}

/* ---- calls ---- */

void cif_call(cif *c, cif_symbol *called, const cif_transform *t) {
  if (!c->building) {
    if (c->current != cif_symbol_at(c, 0)) return;
    c->calls++;
    c->called = called;
    if (t->mirror || t->angle != 0 || t->x != 0 || t->y != 0) c->moved = 1;
    return;
  }
  if (c->current->cell < 0) return; /* outside of symbols */
  double k = (double)c->current->factor;
  eda_placement p = {.origin = cif_add_point(c, t->x * k, t->y * k),
                     .magnification = 1,
                     .angle = t->angle,
                     .mirror = (uint32_t)t->mirror,
                     .columns = 1,
                     .rows = 1};
  if (!c->b.failed)
    reading_check(&c->b, eda_layout_add_instance(c->b.layout, c->current->cell,
                                                 called->cell, &p, NULL,
                                                 &c->b.layout_error));
}
