/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "regulator": required functions, tests of a plugin, and the template of
   a new one. */
#include <eda/regulator.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "../try.h"
#include "templates.h"

enum {
  GATES = 2, /* gates of the sample */
  ROOM = 64  /* capacity of the list of violations */
};

/* ---- work ---- */

/* Simulate the printed image of the mask as drawn. */
static int print_drawn(opc_inspector *in, const eda_gates *g,
                       eda_field *print) {
  for (size_t k = 0; k < g->layers; k++)
    if (!try_develop(in, (int)k, &print[k])) return 0;
  return 1;
}

static int forward_rule(void *self, const eda_printed *printed,
                        eda_ruling *ruling, opc_error *error) {
  const try_shim *shim = self;
  const eda_regulator *o = shim->plugin->functions;
  return *shim->code = o->rule(shim->plugin->self, printed, ruling, error);
}

static int forward_smooth(void *self, const eda_printed *printed,
                          eda_ruling *ruling, opc_error *error) {
  const try_shim *shim = self;
  const eda_regulator *o = shim->plugin->functions;
  return *shim->code = o->smooth(shim->plugin->self, printed, ruling, error);
}

static int forward_violations(void *self, const eda_printed *printed,
                              eda_violation *list, size_t most, size_t *count,
                              opc_error *error) {
  const try_shim *shim = self;
  const eda_regulator *o = shim->plugin->functions;
  return *shim->code = o->violations(shim->plugin->self, printed, list, most,
                                     count, error);
}

static const eda_regulator forwards = {.rule = forward_rule,
                                       .violations = forward_violations,
                                       .smooth = forward_smooth};

/* Call rule, or smooth if `smooth` is 1. Return 1 if the call succeeds. */
static int try_rule(opc_inspector *in, const opc_module *m,
                    const eda_printed *printed, int smooth) {
  const eda_gates *g = printed->gates;
  uint32_t vetoes[GATES] = {0};
  int32_t end[2 * GATES] = {0};
  eda_boxes *added = eda_alloc(2 * g->layers, sizeof *added);
  eda_ruling ruling = {.vetoes = vetoes,
                       .end = end,
                       .added = added,
                       .cutouts = added + g->layers};
  opc_error error = {0};
  int own = OPC_OK;
  const try_shim shim = {m, &own};
  const opc_module shown = {&forwards, (void *)&shim, m->id};
  int code =
      eda_call_rule(in->context, &shown, printed, smooth, &ruling, &error);
  int good = try_call(in, smooth ? "smooth" : "rule", own, code, &error);
  if (good) {
    in->add(in, vetoes, sizeof vetoes);
    in->add(in, end, sizeof end);
    for (size_t k = 0; k < 2 * g->layers; k++)
      in->add(in, added[k].box, added[k].count * sizeof(eda_box));
  }
  free(added);
  return good;
}

/* Check that each violation is at most 1 um outside the layout. */
static void try_places(opc_inspector *in, const eda_gates *g,
                       const eda_violation *list, size_t n) {
  const double beyond = 1000;
  const eda_box e = g->extent;
  for (size_t i = 0; i < n; i++) {
    const eda_violation *v = &list[i];
    if (v->x >= e.x0 * g->grid - beyond && v->x <= e.x1 * g->grid + beyond &&
        v->y >= e.y0 * g->grid - beyond && v->y <= e.y1 * g->grid + beyond)
      continue;
    in->find(in, "violations: '%s' at (%g, %g) nm is not in the layout",
             v->rule, v->x, v->y);
    return;
  }
}

/* Return the number of violations, of which at most `most` are written to the
   list, or -1 on failure. */
static int64_t violations_call(opc_inspector *in, const opc_module *m,
                               const eda_printed *printed, eda_violation *list,
                               size_t most) {
  opc_error error = {0};
  size_t count = 0;
  int own = OPC_OK;
  const try_shim shim = {m, &own};
  const opc_module shown = {&forwards, (void *)&shim, m->id};
  int code = eda_call_violations(in->context, &shown, printed, list, most,
                                 &count, &error);
  const char *what = most ? "violations" : "violations without an array";
  return try_call(in, what, own, code, &error) ? (int64_t)count : -1;
}

/* Check the violations, and that their number does not depend on the capacity
   of the list. */
static void try_violations(opc_inspector *in, const opc_module *m,
                           const eda_printed *printed) {
  eda_violation list[ROOM] = {{0}};
  int64_t many = violations_call(in, m, printed, list, ROOM), none;
  if (many < 0) return;
  try_places(in, printed->gates, list, many < ROOM ? (size_t)many : ROOM);
  none = violations_call(in, m, printed, NULL, 0);
  if (none >= 0 && many != none)
    in->find(in,
             "violations counts %" PRId64 " with an array and %" PRId64
             " without",
             many, none);
}

static void exercise(const opc_module *m, opc_inspector *in) {
  const eda_gates *g = eda_gates_sample();
  const uint32_t flags[GATES] = {0, EDA_PRINT_MERGED};
  const int32_t l[GATES] = {3, -2}, w[GATES] = {0, 1}, aside[GATES] = {2, -1};
  const double extension[2 * GATES] = {60, INFINITY, INFINITY, -5};
  eda_field *print = eda_alloc(g->layers, sizeof *print);
  const eda_printed printed = {.iteration = 1,
                               .gates = g,
                               .flags = flags,
                               .l = l,
                               .w = w,
                               .aside = aside,
                               .extension = extension,
                               .shapes = g->drawn,
                               .print = print};
  const eda_regulator *r = m->functions;
  if (print_drawn(in, g, print) && try_rule(in, m, &printed, 0) &&
      (!r->smooth || try_rule(in, m, &printed, 1)))
    try_violations(in, m, &printed);
  for (size_t k = 0; k < g->layers; k++) eda_field_clear(&print[k]);
  free(print);
}

/* ---- entry ---- */

static const opc_function required[] = {
    OPC_FUNCTION(eda_regulator, rule), OPC_FUNCTION(eda_regulator, violations)};
OPC_KIND("regulator", eda_regulator,
         "regulators: rules that bound the correction");
