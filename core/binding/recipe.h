/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow file with those it extends, read and laid over each other: the steps
   as text, the variants and what to sweep, not yet a flow. */
#pragma once

#include <base/node.h>

typedef struct opc_recipe {
  char *path;               /* as given */
  char *name, *description; /* of the flow itself; description may be NULL */
  GPtrArray *sources; /* opc_source *: the file, what it extends, variants */
  GPtrArray *roots;   /* opc_node *: of each file */
  opc_node *steps;    /* all, laid over each other; NULL: none given */
  opc_node *variants; /* name to path to value: those of the base first, then
                         those of what extends it, perhaps of the same path */
  opc_node *sweep;    /* path to values */
  opc_node *demands;  /* "require", laid over each other, if it is given */
} opc_recipe;

/* NULL if a file cannot be read at all; otherwise it is good if no problem was
   added. */
opc_recipe *opc_recipe_read(const char *path, opc_problems *problems);
void opc_recipe_free(opc_recipe *recipe);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_recipe, opc_recipe_free)

/* Whether there is a variant of that name; if not, a problem, with a
   suggestion, at `at` (NULL: of the file). */
gboolean opc_recipe_has(const opc_recipe *recipe, const char *variant,
                        const opc_place *at, opc_problems *problems);
