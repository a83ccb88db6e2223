/* SPDX-License-Identifier: BSD-3-Clause */
/* The grid of a sweep: each parameter over its values, all combinations. */
#pragma once

#include <opcflow/inner.h>

#include "core/binding/recipe.h"

/* One parameter. */
typedef struct opc_axis {
  opc_inner_axis told; /* what steps hear of it; its texts are as written */
  opc_place at;
  opc_source *source; /* of its values */
  GPtrArray *values;  /* opc_node *; of layers: maps of paths and values */
  char **variants;    /* of layers: what lies under each, "" for none; the texts
                         that are told are names. NULL: of a parameter */
} opc_axis;

typedef struct opc_sweep {
  GPtrArray *axes; /* opc_axis * */
  size_t points;   /* 1 where there is nothing to sweep */
} opc_sweep;

/* What a recipe sweeps, less the parameters of `sets` ("a.b=value") and of
   `over` (a map of paths), which are then fixed; `sweeps` ("a.b=[...]") come in
   place of the same parameter or behind. Lists end with NULL; all three may be
   NULL. Never NULL. */
opc_sweep *opc_sweep_new(const opc_recipe *recipe, const char *const *sets,
                         const opc_node *over, const char *const *sweeps,
                         opc_problems *problems);
/* One without axes. */
opc_sweep *opc_sweep_none(void);
void opc_sweep_free(opc_sweep *sweep);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_sweep, opc_sweep_free)

/* Lay what `map` sweeps over that: paths, which may be cut into maps, with
   their values. */
void opc_sweep_lay_over(opc_sweep *sweep, const opc_node *map,
                        opc_problems *problems);

/* Add an axis of layers, behind the others of its kind: takes the source, a map
   of each, their names and variants. */
void opc_sweep_add_layers(opc_sweep *sweep, const char *path,
                          const opc_place *at, opc_source *source,
                          GPtrArray *layers, char **names, char **variants,
                          opc_problems *problems);

/* Whether an axis touches the step of that name of a flow of `recipe`. */
gboolean opc_axis_touches(const opc_axis *axis, const opc_recipe *recipe,
                          const char *step);

/* The levels of a sweep: one for each axis of layers, and one for all
   parameters together. */
unsigned opc_sweep_depth(const opc_sweep *sweep);

/* The level of each step of a flow at a point of the sweep, by number (g_free):
   0 if no axis touches it nor a step that it needs, else, from 1, that of the
   last axis that does. */
struct opc_flow;
unsigned *opc_sweep_levels(const opc_sweep *sweep, const struct opc_flow *flow);

/* Which value of axis `a` a point has; the last axis changes first. */
guint opc_sweep_index(const opc_sweep *sweep, guint a, size_t point);

/* A point that has the value `value` of axis `a` and the first ones of the
   others. */
size_t opc_sweep_point(const opc_sweep *sweep, guint a, guint value);
