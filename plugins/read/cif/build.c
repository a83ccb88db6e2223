/* SPDX-License-Identifier: BSD-3-Clause */
/* From the commands of a CIF file to the shapes, texts and instances of a
   layout. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cif.h"

#define PI 3.14159265358979323846

enum { SIDES = 32 }; /* of the polygon that a round flash becomes */

static cif_symbol *symbol(cif *c) { return &c->symbols[c->current]; }

/* What the layout said to a command; a refusal with the command's place. */
static int located(cif *c, int code, opc_error *error) {
  if (!code) return OPC_OK;
  opc_error why = *error;
  return cif_refuse(c, c->command, error, why.message);
}

/* ---- layers ---- */

/* The layout's layer for the current one: the name that the map gives it, or
   its own. */
static int find_layer(cif *c, opc_error *error) {
  const opc_map *map = &c->r->layers;
  const char *name = c->layer;
  for (size_t i = 0; i < map->count; i++) {
    if (strcmp(map->pairs[i].value, c->layer) != 0) continue;
    c->seen[i] = 1;
    name = map->pairs[i].key;
    break;
  }
  for (size_t i = 0; i < map->count && name == c->layer; i++)
    if (!strcmp(map->pairs[i].key, name))
      return cif_refuse(c, c->command, error,
                        "a layer has the name that 'layers' gives to another");
  c->layer_number = eda_layout_layer(c->layout, name, error);
  return c->layer_number < 0 ? error->code : OPC_OK;
}

/* What is drawn now: whether there is a layer; in the survey, count it. */
static int draw(cif *c, opc_error *error) {
  if (!c->layer || !c->layer[0])
    return cif_refuse(c, c->command, error, "a shape without a layer");
  if (!c->building) {
    if (c->current == 0) c->loose++;
    return OPC_OK;
  }
  return c->layer_number < 0 ? find_layer(c, error) : OPC_OK;
}

int cif_check_layers(cif *c, opc_error *error) {
  const opc_map *map = &c->r->layers;
  for (size_t i = 0; i < map->count; i++) {
    if (c->seen[i]) continue;
    char there[400] = "";
    size_t used = 0;
    for (size_t k = 0; k < eda_layout_layers(c->layout); k++) {
      const char *name = eda_layout_layer_name(c->layout, (int32_t)k);
      for (size_t j = 0; j < map->count; j++)
        if (!strcmp(map->pairs[j].key, name)) {
          name = map->pairs[j].value;
          break;
        }
      if (used + strlen(name) + 3 > sizeof there) break;
      used += (size_t)snprintf(there + used, sizeof there - used, "%s%s",
                               used ? ", " : "", name);
    }
    return opc_fail(error, OPC_INVALID, "layers",
                    "'%s': there is no layer %s for '%s'; there are %s",
                    c->r->file, map->pairs[i].value, map->pairs[i].key,
                    used ? there : "no layers at all");
  }
  return OPC_OK;
}

/* ---- coordinates ---- */

static int outside(cif *c, opc_error *error) {
  return cif_refuse(c, c->command, error, "a coordinate beyond 32 bits");
}

int cif_units(cif *c, int64_t v, int32_t *out, opc_error *error) {
  *out = 0;
  if (!c->building) return OPC_OK;
  int64_t units = v * symbol(c)->factor; /* below 2^62 */
  if (units != (int32_t)units) return outside(c, error);
  *out = (int32_t)units;
  return OPC_OK;
}

static int put(cif *c, double x, double y, eda_point *out, opc_error *error) {
  x = floor(x + 0.5);
  y = floor(y + 0.5);
  if (!(fabs(x) <= INT32_MAX && fabs(y) <= INT32_MAX)) return outside(c, error);
  *out = (eda_point){(int32_t)x, (int32_t)y};
  return OPC_OK;
}

double cif_angle(int64_t dx, int64_t dy) {
  if (dy == 0) return dx > 0 ? 0 : 180;
  if (dx == 0) return dy > 0 ? 90 : 270;
  if (dx == dy) return dx > 0 ? 45 : 225;
  if (dx == -dy) return dy > 0 ? 135 : 315;
  double angle = atan2((double)dy, (double)dx) * 180 / PI;
  return angle < 0 ? angle + 360 : angle;
}

/* ---- shapes ---- */

int cif_box(cif *c, int64_t length, int64_t width, int64_t x, int64_t y,
            int64_t dx, int64_t dy, opc_error *error) {
  if ((length | width) & 1) symbol(c)->odd = 1;
  if (draw(c, error)) return error->code;
  if (!c->building) return OPC_OK;
  double k = (double)symbol(c)->factor;
  double size = hypot((double)dx, (double)dy);
  double ux = (double)dx / size, uy = (double)dy / size;
  double l = (double)length * k / 2, w = (double)width * k / 2;
  static const int along[4] = {-1, 1, 1, -1}, across[4] = {-1, -1, 1, 1};
  eda_point corner[4];
  for (int i = 0; i < 4; i++) {
    double px = (double)x * k + along[i] * l * ux - across[i] * w * uy;
    double py = (double)y * k + along[i] * l * uy + across[i] * w * ux;
    if (put(c, px, py, &corner[i], error)) return error->code;
  }
  return located(c,
                 eda_layout_add_polygon(c->layout, symbol(c)->cell,
                                        c->layer_number, corner, 4, error),
                 error);
}

int cif_polygon(cif *c, opc_error *error) {
  size_t n = c->n_points;
  if (n > 1 && c->building && c->points[0].x == c->points[n - 1].x &&
      c->points[0].y == c->points[n - 1].y)
    n--;
  if (c->n_points < 3)
    return cif_refuse(c, c->command, error, "a polygon of fewer than 3 points");
  if (draw(c, error)) return error->code;
  if (!c->building || n < 3) return OPC_OK;
  return located(c,
                 eda_layout_add_polygon(c->layout, symbol(c)->cell,
                                        c->layer_number, c->points, n, error),
                 error);
}

/* The ends are drawn half a width longer, as is the custom; the standard's
   round ones were never meant for masks. */
int cif_wire(cif *c, int64_t width, opc_error *error) {
  int32_t units;
  if (width & 1) symbol(c)->odd = 1;
  if (!c->n_points)
    return cif_refuse(c, c->command, error, "a wire without points");
  if (draw(c, error) || cif_units(c, width, &units, error)) return error->code;
  if (!c->building) return OPC_OK;
  return located(
      c,
      eda_layout_add_path(c->layout, symbol(c)->cell, c->layer_number,
                          c->points, c->n_points, units, 2, 0, 0, error),
      error);
}

int cif_flash(cif *c, int64_t diameter, int64_t x, int64_t y,
              opc_error *error) {
  if (draw(c, error)) return error->code;
  if (!c->building || diameter == 0) return OPC_OK;
  double k = (double)symbol(c)->factor, r = (double)diameter * k / 2;
  eda_point corner[SIDES];
  for (int i = 0; i < SIDES; i++) {
    double angle = 2 * PI * i / SIDES;
    if (put(c, (double)x * k + r * cos(angle), (double)y * k + r * sin(angle),
            &corner[i], error))
      return error->code;
  }
  return located(c,
                 eda_layout_add_polygon(c->layout, symbol(c)->cell,
                                        c->layer_number, corner, SIDES, error),
                 error);
}

int cif_label(cif *c, const char *label, int64_t x, int64_t y,
              opc_error *error) {
  eda_point at;
  if (draw(c, error) || cif_units(c, x, &at.x, error) ||
      cif_units(c, y, &at.y, error))
    return error->code;
  if (!c->building) return OPC_OK;
  return located(c,
                 eda_layout_add_text(c->layout, symbol(c)->cell,
                                     c->layer_number, at, label, error),
                 error);
}

/* ---- calls ---- */

int cif_call(cif *c, size_t called, const cif_transform *t, opc_error *error) {
  if (!c->building) {
    if (c->current) return OPC_OK;
    c->calls++;
    c->called = called;
    if (t->mirror || t->angle != 0 || t->x != 0 || t->y != 0) c->moved = 1;
    return OPC_OK;
  }
  if (symbol(c)->cell < 0) return OPC_OK; /* it is the top itself */
  double k = (double)symbol(c)->factor;
  eda_placement p = {.magnification = 1,
                     .angle = t->angle,
                     .mirror = (uint32_t)t->mirror,
                     .columns = 1,
                     .rows = 1};
  if (put(c, t->x * k, t->y * k, &p.origin, error)) return error->code;
  return located(
      c,
      eda_layout_add_instance(c->layout, symbol(c)->cell,
                              c->symbols[called].cell, &p, NULL, error),
      error);
}
