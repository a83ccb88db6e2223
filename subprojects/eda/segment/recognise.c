/* SPDX-License-Identifier: BSD-3-Clause */
/* Recognition of transistors: checks that each region where poly crosses active
   is a valid gate, and finds the axis and the type of the gate. */
#include <stdlib.h>
#include <string.h>

#include "segment/segment.h"

/* ---- the axis ---- */

/* Return whether the whole side of a box is part of an edge of the layer. */
static int is_edge(const segment *s, int layer, const eda_box *b, int d,
                   int side) {
  return segment_edge(&s->index[layer], d, side, box_side(b, d, side),
                      box_side(b, !d, LOW), box_side(b, !d, HIGH)) != NULL;
}

/* Return NULL and the axis, or a description of the fault. */
static const char *find_axis(const segment *s, const eda_box *b,
                             uint8_t *axis) {
  int poly[2], active[2], both = 0; /* numbers of sides that are edges of poly,
                                       of active, and of both */
  for (int d = 0; d < 2; d++) {
    poly[d] = active[d] = 0;
    for (int side = 0; side < 2; side++) {
      int p = is_edge(s, EDA_POLY, b, d, side);
      int a = is_edge(s, EDA_ACTIVE, b, d, side);
      poly[d] += p;
      active[d] += a;
      both += p && a;
    }
  }
  if (both) return "an edge of poly coincides with an edge of active";
  for (int d = 0; d < 2; d++)
    if (poly[d] == 2 && active[!d] == 2) {
      *axis = (uint8_t)d;
      return NULL;
    }
  if (poly[0] && poly[1]) return "poly ends on active";
  return "no two opposite sides are edges of poly";
}

static const char *recognise_region(segment *s, size_t i) {
  const eda_shapes *r = &s->regions;
  const eda_point *p = r->points + r->start[i];
  if (r->hole[i]) return "the gate has a hole";
  if (r->start[i + 1] - r->start[i] != 4) return "the gate is not a rectangle";
  eda_box *b = &s->gates->box[i];
  *b = (eda_box){p[0].x, p[0].y, p[2].x, p[2].y};
  const char *fault = find_axis(s, b, &s->gates->axis[i]);
  if (fault) return fault;
  int d = s->gates->axis[i];
  s->gates->length[i] =
      s->grid * ((double)box_side(b, d, HIGH) - box_side(b, d, LOW));
  s->gates->width[i] =
      s->grid * ((double)box_side(b, !d, HIGH) - box_side(b, !d, LOW));
  return NULL;
}

int segment_refuse(segment *s, size_t i, const char *fault) {
  const eda_shapes *r = &s->regions;
  eda_box b = eda_shape_box(r, i);
  int32_t cell = -1;
  char *path = s->placement[i] == UINT32_MAX
                   ? NULL
                   : segment_path(s, s->placement[i], &cell);
  const char *name = cell < 0 ? "" : eda_layout_cell_name(s->layout, cell);
  int code = opc_fail(
      s->error, OPC_INVALID, NULL,
      "transistor from (%.10g, %.10g) to (%.10g, %.10g) nm, cell '%.100s'%s"
      "%.300s%s: %s",
      s->grid * b.x0, s->grid * b.y0, s->grid * b.x1, s->grid * b.y1, name,
      path && *path ? ", instance '" : "", path ? path : "",
      path && *path ? "'" : "", fault);
  free(path);
  return code;
}

/* ---- the type ---- */

static int point_before(eda_point a, eda_point b) {
  return a.y < b.y || (a.y == b.y && a.x < b.x);
}

/* Mark the regions that are equal to one of `shapes`. Both are sorted by their
   first points. */
static void mark_same(const segment *s, const eda_shapes *shapes, uint8_t mark,
                      uint8_t *state) {
  const eda_shapes *r = &s->regions;
  for (size_t i = 0, j = 0; i < r->count && j < shapes->count;) {
    const eda_point *p = r->points + r->start[i];
    const eda_point *q = shapes->points + shapes->start[j];
    if (point_before(*p, *q)) {
      i++;
    } else if (point_before(*q, *p)) {
      j++;
    } else {
      uint32_t n = shapes->start[j + 1] - shapes->start[j];
      if (n == 4 && p[2].x == q[2].x && p[2].y == q[2].y) state[i] = mark;
      i++;
      j++;
    }
  }
}

int segment_cover(segment *s, const eda_shapes *layer, uint8_t *state) {
  memset(state, layer->count ? SEGMENT_PARTLY : SEGMENT_OUTSIDE,
         s->regions.count);
  if (!layer->count) return OPC_OK;
  for (int k = 0; k < 2; k++) {
    eda_shapes part;
    int code =
        eda_boolean(k ? EDA_AND : EDA_NOT, &s->regions, layer, &part, s->error);
    if (code) return code;
    mark_same(s, &part, k ? SEGMENT_INSIDE : SEGMENT_OUTSIDE, state);
    eda_shapes_clear(&part);
  }
  return OPC_OK;
}

/* Return NULL and the type, or a description of the fault. Implants decide
   first, then wells. */
static const char *find_type(const int *has, const uint8_t *at, uint8_t *type) {
  if (at[NIMPLANT] == SEGMENT_PARTLY)
    return "'nimplant' covers the transistor in part";
  if (at[PIMPLANT] == SEGMENT_PARTLY)
    return "'pimplant' covers the transistor in part";
  if (at[NIMPLANT] && at[PIMPLANT]) return "both implants cover the transistor";
  if (at[NIMPLANT] || at[PIMPLANT]) {
    *type = at[PIMPLANT] ? EDA_PMOS : EDA_NMOS;
    return NULL;
  }
  int well = has[NWELL] ? NWELL : PWELL;
  if (!has[well])
    return "the type is unknown: no layer 'nwell' or 'pwell' exists, and no "
           "implant covers the transistor";
  if (at[NWELL] == SEGMENT_PARTLY)
    return "'nwell' covers the transistor in part";
  if (at[PWELL] == SEGMENT_PARTLY)
    return "'pwell' covers the transistor in part";
  if (at[NWELL] && at[PWELL]) return "both wells cover the transistor";
  *type = (well == NWELL) == (at[well] == SEGMENT_INSIDE) ? EDA_PMOS : EDA_NMOS;
  return NULL;
}

/* Warn of a well layer that is empty, has only texts or a wrong number: all
   transistors then have one type without any other message. */
static void warn_of_well(const segment *s) {
  int well = s->has_doping[NWELL] ? NWELL : PWELL;
  if (s->has_doping[NIMPLANT] || s->has_doping[PIMPLANT] ||
      !s->has_doping[well] || s->doping[well].count)
    return;
  segment_log(s, 1,
              "layer '%s' has no shape, so that all transistors are "
              "%c-transistors: check the name of the layer",
              well == NWELL ? "nwell" : "pwell", well == NWELL ? 'n' : 'p');
}

static int find_types(segment *s) {
  size_t n = s->regions.count;
  uint8_t *state = eda_alloc(n, DOPINGS);
  int code = OPC_OK;
  for (int k = 0; !code && k < DOPINGS; k++)
    code = segment_cover(s, &s->doping[k], state + (size_t)k * n);
  for (size_t i = 0; !code && i < n; i++) {
    uint8_t at[DOPINGS];
    for (int k = 0; k < DOPINGS; k++) at[k] = state[(size_t)k * n + i];
    const char *fault = find_type(s->has_doping, at, &s->gates->type[i]);
    if (fault) code = segment_refuse(s, i, fault);
  }
  free(state);
  if (!code && n) warn_of_well(s);
  return code;
}

int segment_recognise(segment *s) {
  for (size_t i = 0; i < s->regions.count; i++) {
    const char *fault = recognise_region(s, i);
    if (fault) return segment_refuse(s, i, fault);
  }
  return find_types(s);
}
