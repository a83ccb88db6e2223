/* SPDX-License-Identifier: BSD-3-Clause */
/* The grid of a sweep: each parameter over its values, all combinations. */
#ifndef OPCFLOW_CORE_SWEEP_H
#define OPCFLOW_CORE_SWEEP_H

#include <opcflow/inner.h>

#include "core/flow/recipe.h"

/* One parameter. */
typedef struct opc_axis {
  opc_inner_axis told; /* what steps hear of it; its texts are as written */
  opc_place at;
  opc_source *source; /* of its values */
  GPtrArray *values;  /* opc_node * */
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
void opc_sweep_free(opc_sweep *sweep);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_sweep, opc_sweep_free)

/* Lay what `map` sweeps over that: paths, which may be cut into maps, with
   their values. */
void opc_sweep_lay_over(opc_sweep *sweep, const opc_node *map,
                        opc_problems *problems);

/* Which value of axis `a` a point has; the last axis changes first. */
guint opc_sweep_index(const opc_sweep *sweep, guint a, size_t point);

/* Lay the values of a point over steps. */
void opc_sweep_lay(const opc_sweep *sweep, size_t point, opc_node *steps,
                   opc_problems *problems);

/* A point that has the value `value` of axis `a` and the first ones of the
   others. */
size_t opc_sweep_point(const opc_sweep *sweep, guint a, guint value);

#endif
