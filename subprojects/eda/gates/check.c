/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of data returned by plugins before use. An error names the fault;
   eda_blame adds the plugin. */
#include <eda/check.h>

#include <eda/chip.h>
#include <eda/goals.h>
#include <eda/memory.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  MOST_SLICES = 1 << 16,
  MOST_BOXES = 1 << 24, /* largest number of boxes added to a mask layer */
  FURTHEST = 1 << 20,   /* largest displacement, grid steps */
  OUTERMOST = 1 << 30,  /* largest absolute coordinate, grid steps */
  ALL_VETOES = 15
};

/* Set *error to OPC_FAILED with a message, and return OPC_FAILED. */
#define unsound(error, ...) opc_fail(error, OPC_FAILED, NULL, __VA_ARGS__)

const char *eda_enter(const opc_context *context, const opc_module *module,
                      opc_error *error) {
  error->code = OPC_OK;
  *error->parameter = *error->message = 0;
  return opc_enter(context, module->id);
}

int eda_blame(opc_error *error, int code, const char *slot) {
  if (code == OPC_OK) return OPC_OK;
  char parameter[sizeof error->parameter], message[sizeof error->message];
  error->parameter[sizeof error->parameter - 1] = 0;
  error->message[sizeof error->message - 1] = 0;
  snprintf(parameter, sizeof parameter, "%s%s%.40s", slot,
           *error->parameter ? "." : "", error->parameter);
  memcpy(message, error->message, sizeof message);
  if (code < OPC_INVALID || code > OPC_CANCELLED) code = OPC_FAILED;
  return opc_fail(error, code, parameter, "%s",
                  *message ? message : "no error message");
}

typedef struct tasks {
  int (*task)(void *data, size_t i, opc_error *error);
  void *data;
  opc_error *error; /* [task] */
} tasks;

static void try_one(void *data, size_t i) {
  tasks *t = data;
  t->error[i].code = t->task(t->data, i, &t->error[i]);
}

int eda_try_all(const opc_context *context, size_t n,
                int (*task)(void *data, size_t i, opc_error *error), void *data,
                opc_error *error) {
  tasks t = {task, data, eda_alloc(n, sizeof *t.error)};
  opc_parallel(context, n, try_one, &t);
  int code = OPC_OK;
  for (size_t i = 0; i < n && !code; i++)
    if ((code = t.error[i].code)) *error = t.error[i];
  free(t.error);
  return code;
}

/* ---- fields ---- */

/* Return whether any of n numbers is infinite or NaN. Such numbers have all
   bits of the exponent set. */
static int has_wild(const float *x, size_t n) {
  uint32_t wild = 0;
  for (size_t i = 0; i < n; i++) {
    uint32_t bits;
    memcpy(&bits, x + i, sizeof bits);
    wild |= (bits & 0x7F800000u) == 0x7F800000u;
  }
  return wild != 0;
}

static int wild_field(const eda_field *f, const char *what, opc_error *error) {
  size_t i = 0;
  while (isfinite(f->coefficients[i])) i++;
  size_t nx = (size_t)f->nx;
  double x = f->frame.x0 + f->frame.width / f->nx * (double)(i % nx);
  size_t row = i / nx;
  double y = f->frame.y0 + f->frame.height / f->ny * (double)row;
  return unsound(error, "%s is %s at (%.1f, %.1f) nm", what,
                 isnan(f->coefficients[i]) ? "not a number" : "infinite", x, y);
}

int eda_check_field(const eda_field *f, const eda_frame *frame,
                    const char *what, opc_error *error) {
  if (!f->coefficients || f->nx < 1 || f->ny < 1)
    return unsound(error, "%s is a field of %d x %d without values", what,
                   f->nx, f->ny);
  const eda_frame *g = &f->frame;
  if (g->x0 != frame->x0 || g->y0 != frame->y0 || g->width != frame->width ||
      g->height != frame->height)
    return unsound(error,
                   "%s has the frame (%g, %g) %g x %g nm, but the mask has "
                   "(%g, %g) %g x %g nm",
                   what, g->x0, g->y0, g->width, g->height, frame->x0,
                   frame->y0, frame->width, frame->height);
  if (!has_wild(f->coefficients, (size_t)f->nx * (size_t)f->ny)) return OPC_OK;
  return wild_field(f, what, error);
}

/* ---- performance ---- */

int eda_check_slicing(size_t n, const double *place, const double *width,
                      opc_error *error) {
  if (n < 1 || n > MOST_SLICES || !place || !width)
    return unsound(error, "divides a gate into %zu slices, expected 1 to %d", n,
                   MOST_SLICES);
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    double least = i ? place[i - 1] : 0;
    if (!(place[i] >= least && place[i] <= 1))
      return unsound(error,
                     "slice %zu is at %g of the width, not within %g to 1",
                     i + 1, place[i], least);
    if (!(width[i] >= 0))
      return unsound(error, "slice %zu has the width %g, expected at least 0",
                     i + 1, width[i]);
    sum += width[i];
  }
  if (fabs(sum - 1) < 1e-9) return OPC_OK;
  return unsound(error,
                 "the widths of the slices sum to %.9g of the width of the "
                 "gate, expected 1",
                 sum);
}

static int wrong_figure(const eda_gates *gates, size_t i, const char *name,
                        double x, opc_error *error) {
  const char *instance = gates->instance[i];
  return unsound(error, "%s of transistor '%s:%u' is %g", name,
                 *instance ? instance : gates->cell[i], gates->number[i], x);
}

int eda_check_performance(const eda_gates *gates, size_t first,
                          const uint32_t *flags, const eda_performance *p,
                          opc_error *error) {
  static const char *const names[] = {"ion",      "ioff", "leq_ion",
                                      "leq_ioff", "weq",  "area"};
  const double *const figures[] = {p->ion,      p->ioff, p->leq_ion,
                                   p->leq_ioff, p->weq,  p->area};
  for (size_t i = 0; i < p->count; i++) {
    int bad = flags && flags[i] & ~(uint32_t)EDA_PRINT_NOTES;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
      double x = figures[k][i];
      if (isfinite(x) && (x > 0 || (bad && x == 0))) continue;
      return wrong_figure(gates, first + i, names[k], x, error);
    }
    if (p->outside && p->outside[i] > 1)
      return wrong_figure(gates, first + i, "outside", p->outside[i], error);
  }
  return OPC_OK;
}

/* ---- boxes added to a mask ---- */

/* Check the boxes of a layer; `what` names the boxes in errors. */
static int check_boxes(const char *what, const char *layer,
                       const eda_boxes *boxes, opc_error *error) {
  size_t n = boxes->count;
  if (n > MOST_BOXES || (n && !boxes->box))
    return unsound(error, "returns %zu %s of %s%s", n, what, layer,
                   n > MOST_BOXES ? "" : " without an array of boxes");
  for (size_t i = 0; i < n; i++) {
    eda_box b = boxes->box[i];
    if (b.x0 < b.x1 && b.y0 < b.y1 && b.x0 >= -OUTERMOST &&
        b.y0 >= -OUTERMOST && b.x1 <= OUTERMOST && b.y1 <= OUTERMOST)
      continue;
    return unsound(
        error,
        "number %zu of the %s of %s is not a valid box: (%d, %d) to (%d, %d)",
        i + 1, what, layer, (int)b.x0, (int)b.y0, (int)b.x1, (int)b.y1);
  }
  return OPC_OK;
}

/* Check the boxes ([layers]) of all corrected layers; ignore boxes of other
   layers. */
static int check_all_boxes(const eda_gates *gates, const char *what,
                           const eda_boxes *boxes, opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < gates->layers && !code; k++)
    if (gates->corrected[k])
      code = check_boxes(what, gates->layer[k], &boxes[k], error);
  return code;
}

/* ---- moves ---- */

static int far_move(const char *what, size_t gate, int32_t steps,
                    opc_error *error) {
  return unsound(
      error, "moves the %s of transistor %zu by %d steps, expected at most %d",
      what, gate + 1, (int)steps, FURTHEST);
}

static int is_far(int32_t steps) {
  return steps > FURTHEST || steps < -FURTHEST;
}

/* Check the parts of a transistor up to the first empty part: ordered along W,
   not overlapping, not displaced too far. */
static int check_parts(const eda_part *s, size_t gate, opc_error *error) {
  for (int k = 0; k < EDA_PARTS && s[k].from < s[k].to; k++) {
    if (is_far(s[k].by)) return far_move("part", gate, s[k].by, error);
    if (k && s[k].from < s[k - 1].to)
      return unsound(error,
                     "part %d of transistor %zu begins at %d, before the end "
                     "of the preceding part (%d)",
                     k + 1, gate + 1, (int)s[k].from, (int)s[k - 1].to);
  }
  return OPC_OK;
}

int eda_check_moves(const eda_gates *gates, const eda_moves *moves,
                    const size_t *fragments, opc_error *error) {
  for (size_t i = 0; i < gates->count; i++) {
    if (is_far(moves->l[i])) return far_move("length", i, moves->l[i], error);
    if (is_far(moves->w[i])) return far_move("width", i, moves->w[i], error);
    if (is_far(moves->jog[i])) return far_move("jog", i, moves->jog[i], error);
    if (moves->aside && is_far(moves->aside[i]))
      return far_move("active", i, moves->aside[i], error);
    int code = moves->part ? check_parts(moves->part + EDA_PARTS * i, i, error)
                           : OPC_OK;
    if (code) return code;
  }
  for (size_t k = 0; k < gates->layers; k++)
    for (size_t i = 0; i < fragments[k]; i++)
      if (is_far(moves->shift[k][i]))
        return unsound(
            error, "moves fragment %zu of %s by %d steps, expected at most %d",
            i + 1, gates->layer[k], (int)moves->shift[k][i], FURTHEST);
  return check_all_boxes(gates, "assists", moves->assists, error);
}

int eda_check_ruling(const eda_gates *gates, const eda_ruling *r,
                     opc_error *error) {
  for (size_t i = 0; i < gates->count; i++) {
    if (r->vetoes[i] & ~(uint32_t)ALL_VETOES)
      return unsound(error, "the veto %#x of transistor %zu is unknown",
                     (unsigned)r->vetoes[i], i + 1);
    for (size_t side = 0; side < 2; side++)
      if (is_far(r->end[2 * i + side]))
        return far_move("line end", i, r->end[2 * i + side], error);
  }
  int code = check_all_boxes(gates, "added shapes", r->added, error);
  return code ? code : check_all_boxes(gates, "cut-outs", r->cutouts, error);
}

int eda_check_violations(const eda_violation *v, size_t n, size_t gates,
                         opc_error *error) {
  for (size_t i = 0; i < n; i++) {
    if (!v[i].rule) return unsound(error, "violation %zu has no rule", i + 1);
    if (v[i].gate < -1 || (v[i].gate >= 0 && (size_t)v[i].gate >= gates))
      return unsound(
          error, "violation %zu names transistor %d, but the layout has %zu",
          i + 1, (int)v[i].gate + 1, gates);
  }
  return OPC_OK;
}

/* ---- fragments of synthesizers ---- */

/* A fragment and the drawn edge from `a` to `b` that contains the fragment. */
typedef struct cut_place {
  const eda_cuts *cuts;
  const char *layer;
  double grid;
  uint32_t fragment;
  eda_point a, b;
} cut_place;

static int cut_misplaced(const cut_place *c, const char *what, double x,
                         double y, opc_error *error) {
  return unsound(
      error,
      "fragments of %s: %s of fragment %u, (%g, %g) nm, is not on the edge "
      "from (%g, %g) to (%g, %g) nm, or not in order along the edge",
      c->layer, what, c->fragment + 1, x, y, c->a.x * c->grid, c->a.y * c->grid,
      c->b.x * c->grid, c->b.y * c->grid);
}

/* Return the distance of the point (x, y) from `a` along the edge, nm; NAN if
   the point is not on the edge. */
static double position_along(const cut_place *c, double x, double y) {
  const double slack = 1e-3; /* rounding tolerance, nm */
  double ax = c->a.x * c->grid, ay = c->a.y * c->grid;
  double bx = c->b.x * c->grid, by = c->b.y * c->grid;
  double aside = c->a.x == c->b.x ? x - ax : y - ay;
  double at = c->a.x == c->b.x ? y - ay : x - ax;
  double to = c->a.x == c->b.x ? by - ay : bx - ax;
  if (to < 0) at = -at, to = -to;
  return fabs(aside) <= slack && at >= -slack && at <= to + slack ? at : NAN;
}

/* Check the end `next` and the control site of a fragment that begins at
   distance `at` along the edge, nm. Write the distance of the fragment's end to
   *end. */
static int check_cut(const cut_place *c, double at, eda_point next, double *end,
                     opc_error *error) {
  double x = next.x * c->grid, y = next.y * c->grid;
  *end = position_along(c, x, y);
  if (!(*end > at)) return cut_misplaced(c, "the end", x, y, error);
  const double *site = c->cuts->site + 2 * (size_t)c->fragment;
  if (!isnan(position_along(c, site[0], site[1]))) return OPC_OK;
  return cut_misplaced(c, "the site", site[0], site[1], error);
}

/* Check all fragments of polygon p along the edges of the polygon. The list of
   fragments may begin at any corner. */
static int check_cut_polygon(cut_place c, const eda_shapes *drawn, size_t p,
                             opc_error *error) {
  const eda_point *corner = drawn->points + drawn->start[p];
  uint32_t corners = drawn->start[p + 1] - drawn->start[p];
  uint32_t start = c.cuts->start[p], n = c.cuts->start[p + 1] - start;
  const eda_point *from = c.cuts->from + start;
  uint32_t first = 0, used = 0;
  while (first < n &&
         (from[first].x != corner[0].x || from[first].y != corner[0].y))
    first++;
  for (uint32_t k = 0; k < corners; k++) {
    c.a = corner[k];
    c.b = corner[(k + 1) % corners];
    eda_point next;
    double at = 0;
    do {
      if (used == n || first == n)
        return unsound(
            error,
            "fragments of %s: no fragment begins at the corner (%g, %g) nm",
            c.layer, c.a.x * c.grid, c.a.y * c.grid);
      c.fragment = start + (first + used) % n;
      next = from[(first + ++used) % n];
      int code = check_cut(&c, at, next, &at, error);
      if (code) return code;
    } while (next.x != c.b.x || next.y != c.b.y);
  }
  if (used == n) return OPC_OK;
  return unsound(error,
                 "fragments of %s: polygon %zu has %u fragments, but a full "
                 "traversal has %u",
                 c.layer, p + 1, n, used);
}

int eda_check_cuts(const eda_gates *gates, int layer, const eda_cuts *cuts,
                   opc_error *error) {
  const eda_shapes *drawn = &gates->drawn[layer];
  const char *name = gates->layer[layer];
  int code = check_boxes("assists", name, &cuts->assists, error);
  if (code) return code;
  if (!cuts->polygons) return OPC_OK;
  if (cuts->polygons != drawn->count)
    return unsound(error, "fragments %zu polygons of %s, expected %zu",
                   cuts->polygons, name, drawn->count);
  if (!cuts->start || !cuts->from || !cuts->site || cuts->start[0])
    return unsound(error, "fragments of %s: an array is missing", name);
  cut_place place = {.cuts = cuts, .layer = name, .grid = gates->grid};
  for (size_t p = 0; p < cuts->polygons && !code; p++)
    if (cuts->start[p + 1] < cuts->start[p])
      code = unsound(
          error,
          "fragments of %s: the fragments of polygon %zu end before they begin",
          name, p + 1);
    else
      code = check_cut_polygon(place, drawn, p, error);
  return code;
}

/* ---- data of steps ---- */

static int check_shapes(const eda_shapes *s, const char *what,
                        opc_error *error) {
  if (!s->count) return OPC_OK;
  int sound = s->start && s->points && s->start[0] == 0;
  for (size_t i = 0; sound && i < s->count; i++)
    sound = s->start[i + 1] >= s->start[i];
  if (sound) return OPC_OK;
  return unsound(error, "%s: the point ranges of the polygons are not valid",
                 what);
}

static int check_edges(const eda_gates *g, size_t layer, opc_error *error) {
  const eda_edges *e = &g->edges[layer];
  if (!e->polygons) return OPC_OK;
  if (!e->start || !e->fragments || e->start[0])
    return unsound(error, "edges are missing");
  for (size_t i = 0; i < e->polygons; i++)
    if (e->start[i + 1] < e->start[i])
      return unsound(error, "the edges of polygon %zu end before they begin",
                     i + 1);
  for (uint32_t i = 0; i < e->start[e->polygons]; i++) {
    const eda_fragment *f = &e->fragments[i];
    int owned = f->gate >= 0 && (size_t)f->gate < g->count;
    if (f->role > EDA_END_HIGH || (f->role != EDA_FIXED && !owned))
      return unsound(error,
                     "edge fragment %u of role %u names transistor %d, but the "
                     "layout has %zu",
                     i + 1, f->role, (int)f->gate + 1, g->count);
  }
  return OPC_OK;
}

static int check_gate(const eda_gates *g, size_t i, opc_error *error) {
  eda_box b = g->box[i];
  if (b.x0 < b.x1 && b.y0 < b.y1 && g->type[i] <= EDA_PMOS &&
      g->axis[i] <= EDA_Y && g->length[i] > 0 && isfinite(g->length[i]) &&
      g->width[i] > 0 && isfinite(g->width[i]) && g->instance[i] &&
      g->cell[i] && g->space[2 * i] >= 0 && g->space[2 * i + 1] >= 0 &&
      !isnan(g->extension[2 * i]) && !isnan(g->extension[2 * i + 1])) {
    eda_goal goal = eda_gates_goal(g, i);
    const char *fault = eda_goal_fault(&goal);
    if (!fault) return OPC_OK;
    return unsound(error, "the goal of transistor %zu has no valid %s", i + 1,
                   fault);
  }
  return unsound(error, "transistor %zu is not valid", i + 1);
}

/* Check the layers: complete arrays, enough layers for transistors, unique
   names. */
static int check_layers(const eda_gates *g, opc_error *error) {
  if (g->layers && !(g->layer && g->corrected && g->drawn && g->edges))
    return unsound(error, "an array of the layers is missing");
  if (g->count && g->layers <= EDA_ACTIVE)
    return unsound(error, "%zu layers are too few for transistors", g->layers);
  for (size_t k = 0; k < g->layers; k++)
    if (!g->layer[k])
      return unsound(error, "layer %zu has no name", k + 1);
    else if (eda_gates_layer(g, g->layer[k]) != (int)k)
      return unsound(error, "two layers have the name '%s'", g->layer[k]);
  int code = OPC_OK;
  for (size_t k = 0; k < g->layers && !code; k++)
    code = check_shapes(&g->drawn[k], "drawn shapes", error);
  for (size_t k = 0; k < g->layers && !code; k++)
    code = check_edges(g, k, error);
  return code;
}

int eda_gates_check(const void *gates, opc_error *error) {
  const eda_gates *g = gates;
  if (!(g->grid > 0) || !isfinite(g->grid))
    return unsound(
        error,
        "the grid of the gates is %g nm, expected a positive finite number",
        g->grid);
  if (g->count &&
      !(g->box && g->type && g->axis && g->length && g->width && g->space &&
        g->extension && g->instance && g->cell && g->number))
    return unsound(error, "an array of the gates is missing");
  int code = OPC_OK;
  for (size_t i = 0; i < g->count && !code; i++) code = check_gate(g, i, error);
  return code ? code : check_layers(g, error);
}

static int check_classes(const eda_mask *m, opc_error *error) {
  if (m->chip->prints != m->gates->count || m->chip->layers != m->layers)
    return unsound(error, "the mask has %zu classes, but its gates have %zu",
                   m->chip->prints, m->gates->count);
  if (!m->count || !m->access || !m->access->window)
    return unsound(error, "the mask by classes has no access to its shapes");
  return eda_chip_check(m->chip, error);
}

int eda_mask_check(const void *mask, opc_error *error) {
  const eda_mask *m = mask;
  if (!m->gates) return unsound(error, "the mask has no gates");
  const eda_performance *const all[] = {&m->design, &m->before, &m->after};
  for (size_t i = 0; i < 3; i++)
    if (all[i]->count != m->gates->count ||
        (all[i]->count &&
         !(all[i]->ion && all[i]->ioff && all[i]->leq_ion && all[i]->leq_ioff &&
           all[i]->weq && all[i]->area && m->flags)))
      return unsound(
          error, "the mask does not have the performance of all transistors");
  if (m->moved && (m->moved->gates != m->gates->count ||
                   m->moved->layers != m->gates->layers))
    return unsound(error,
                   "the edge displacements of the mask belong to other gates");
  int code = m->chip ? check_classes(m, error) : OPC_OK;
  for (size_t k = 0; k < m->gates->layers && !code; k++) {
    const eda_field *print = &m->print[k];
    code = check_shapes(&m->shapes[k], "mask shapes", error);
    if (!code && m->gates->corrected[k] && print->coefficients)
      code = eda_check_field(print, &print->frame, "print", error);
    if (!code && m->drawn_print && m->drawn_print[k].coefficients)
      code = eda_check_field(&m->drawn_print[k], &print->frame, "drawn print",
                             error);
  }
  return code ? code
              : eda_check_violations(m->violations, m->n_violations,
                                     m->gates->count, error);
}
