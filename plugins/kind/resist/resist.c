/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "resist": required functions, tests of a plugin, and the template of a
   new one. */
#include <eda/resist.h>
#include <math.h>
#include <string.h>

#include "../try.h"
#include "templates.h"

/* Number of tested layers, and nodes of a field along each side. Flows may have
   more layers than poly and active. */
enum { LAYERS = 3, NODES = 16 };

/* ---- work ---- */

static int forward_print(const void *self, int layer, eda_field *field,
                         opc_error *error) {
  const try_shim *shim = self;
  const eda_resist *o = shim->plugin->functions;
  return *shim->code = o->print(shim->plugin->self, layer, field, error);
}

static const eda_resist forwards = {.print = forward_print};

static int print_call(opc_inspector *in, const opc_module *m, int layer,
                      eda_field *field) {
  int own = OPC_OK;
  const try_shim shim = {m, &own};
  const opc_module shown = {&forwards, (void *)&shim, m->id};
  opc_error error = {0};
  int code = eda_call_print(in->context, &shown, layer, field, &error);
  return try_call(in, "print", own, code, &error);
}

/* Return the level set of a field of constant intensity. On failure, return NAN
   and report. */
static double level_of(opc_inspector *in, const opc_module *m, double value) {
  eda_field field = {try_frame, NODES, NODES,
                     eda_alloc(NODES * NODES, sizeof(float))};
  double x = 30, y = 200, level = NAN;
  for (int i = 0; i < NODES * NODES; i++) field.coefficients[i] = (float)value;
  if (print_call(in, m, EDA_POLY, &field))
    eda_field_sample(&field, &x, &y, 1, &level);
  eda_field_clear(&field);
  return level;
}

/* Check that a dark field prints, that the clear field does not, and that the
   level set has one sign change in between. */
static void try_sign(opc_inspector *in, const opc_module *m) {
  enum { STEPS = 20 };
  double last = level_of(in, m, 0), clear = level_of(in, m, 1);
  int signs = 0;
  if (isnan(last) || isnan(clear)) return;
  if (!(last > 0))
    in->find(in, "print: a dark field must print, found no shape");
  if (!(clear < 0))
    in->find(in, "print: a clear field must not print, found a shape");
  for (int i = 1; i <= STEPS; i++) {
    double level = level_of(in, m, (double)i / STEPS);
    if (isnan(level)) return;
    signs += (level > 0) != (last > 0);
    last = level;
  }
  if (signs > 1)
    in->find(
        in,
        "print: the result changes at %d intensities, expected one threshold",
        signs);
}

typedef struct prints {
  const opc_module *m;
  eda_field image[LAYERS], print[LAYERS];
} prints;

static size_t field_bytes(const eda_field *f) {
  return (size_t)f->nx * (size_t)f->ny * sizeof *f->coefficients;
}

static eda_field field_copy(const eda_field *from) {
  eda_field to = *from;
  to.coefficients = eda_alloc(field_bytes(from), 1);
  memcpy(to.coefficients, from->coefficients, field_bytes(from));
  return to;
}

static int same_print(void *data, size_t i) {
  const prints *all = data;
  const eda_resist *o = all->m->functions;
  const eda_field *was = &all->print[i];
  eda_field field = field_copy(&all->image[i]);
  opc_error error = {0};
  int same = !o->print(all->m->self, (int)i, &field, &error) &&
             field_bytes(&field) == field_bytes(was) &&
             !memcmp(field.coefficients, was->coefficients, field_bytes(was));
  eda_field_clear(&field);
  return same;
}

static void try_callers(opc_inspector *in, const opc_module *m) {
  const eda_resist *o = m->functions;
  prints all = {.m = m};
  opc_error error = {0};
  int good = 1;
  for (int i = 0; i < LAYERS && good; i++) {
    good = try_print(in, i, &all.image[i]);
    if (!good) break;
    all.print[i] = field_copy(&all.image[i]);
    good = !o->print(m->self, i, &all.print[i], &error);
  }
  if (good && !try_at_once(LAYERS, same_print, &all))
    in->find(in,
             "print returns different bits while other threads call the "
             "function, although declared [any]");
  for (int i = 0; i < LAYERS; i++) {
    eda_field_clear(&all.image[i]);
    eda_field_clear(&all.print[i]);
  }
}

static void exercise(const opc_module *m, opc_inspector *in) {
  const eda_resist *o = m->functions;
  const opc_module litho = try_litho(in);
  opc_error error = {0};
  const char *before = eda_enter(in->context, m, &error);
  int code = o->prepare(m->self, &litho, &error);
  opc_leave(in->context, before);
  if (!try_went_well(in, "prepare", code, &error)) return;
  for (int layer = 0; layer < LAYERS; layer++) {
    eda_field field;
    if (!try_print(in, layer, &field)) return;
    if (print_call(in, m, layer, &field))
      try_field(in, "print", "level set", &field, &try_frame);
    eda_field_clear(&field);
  }
  try_sign(in, m);
  try_callers(in, m);
}

/* ---- entry ---- */

static const opc_function required[] = {OPC_FUNCTION(eda_resist, prepare),
                                        OPC_FUNCTION(eda_resist, print)};
OPC_KIND("resist", eda_resist, "resist models: printed shapes of an intensity");
