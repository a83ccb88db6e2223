/* SPDX-License-Identifier: BSD-3-Clause */
/* The grid of a sweep: all combinations of the values of the axes. An axis is a
   parameter with a list of values, or a list of layers of changes
   (opcflow/inner.h); a combination is a point. */
#pragma once

#include <opcflow/inner.h>

#include "core/binding/recipe.h"

/* A swept parameter, or an axis of layers. */
typedef struct opc_axis {
  opc_inner_axis info; /* description passed to steps */
  opc_place at;
  opc_source *source; /* source of the values */
  GPtrArray *values; /* opc_node *: values; for an axis of layers, maps of paths
                        and values */
  char **variants;   /* NULL for a parameter. For an axis of layers, the variant
                        to which each layer is applied, or ""; `info.texts` are
                        the names of the layers */
} opc_axis;

/* All axes of a sweep. */
typedef struct opc_sweep {
  GPtrArray *axes; /* opc_axis * */
  size_t points;   /* 1 without axes */
} opc_sweep;

/* Return the sweep of a recipe (opc_sweep_free; never NULL), without axes of
   the parameters that `sets` ("a.b=value") and `over` (a map of paths) fix. An
   element of `sweeps` ("a.b=[...]") replaces the axis of the same parameter or
   is appended. Lists are NULL-terminated; all three may be NULL. */
opc_sweep *opc_sweep_new(const opc_recipe *recipe, const char *const *sets,
                         const opc_node *over, const char *const *sweeps,
                         opc_problems *problems);
/* Return a sweep without axes; free a sweep (NULL: do nothing). */
opc_sweep *opc_sweep_none(void);
void opc_sweep_free(opc_sweep *sweep);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_sweep, opc_sweep_free)

/* Replace or append the axes in `map`: paths, which may be split into nested
   maps, with their values. */
void opc_sweep_lay_over(opc_sweep *sweep, const opc_node *map,
                        opc_problems *problems);

/* Add an axis of layers after the other axes of layers. Takes ownership of the
   source, the maps, the names and the variants. */
void opc_sweep_add_layers(opc_sweep *sweep, const char *path,
                          const opc_place *at, opc_source *source,
                          GPtrArray *layers, char **names, char **variants,
                          opc_problems *problems);

/* Return whether an axis changes the step `step` in a flow of `recipe`. */
gboolean opc_axis_touches(const opc_axis *axis, const opc_recipe *recipe,
                          const char *step);

/* Return the number of levels (run/levels.h) of a sweep: one per axis of
   layers, and one for all parameters together. */
unsigned opc_sweep_depth(const opc_sweep *sweep);

/* Return the level of each step, by step number (g_free). The level is 0 if no
   axis changes the step, directly or through a dependency; else the level of
   the last such axis. */
struct opc_flow;
unsigned *opc_sweep_levels(const opc_sweep *sweep, const struct opc_flow *flow);

/* Return the index of the value of axis `a` at a point; the last axis varies
   fastest. */
guint opc_sweep_index(const opc_sweep *sweep, guint a, size_t point);

/* Return the point with value `value` of axis `a` and the first values of the
   other axes. */
size_t opc_sweep_point(const opc_sweep *sweep, guint a, guint value);
