/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow file with those it extends, read and laid over each other: the steps
   as text, the variants and what to sweep, not yet a flow. */
#ifndef OPCFLOW_CORE_RECIPE_H
#define OPCFLOW_CORE_RECIPE_H

#include "core/text/node.h"

/* A key with its value, in one of the files. */
typedef struct opc_entry {
  const opc_node *key, *value;
} opc_entry;

typedef struct opc_variant {
  const char *name;
  const opc_node *key; /* where it was first named */
  GPtrArray *parts;    /* const opc_node *: maps, those of the base first */
} opc_variant;

typedef struct opc_recipe {
  char *path;               /* as given */
  char *name, *description; /* of the flow itself; description may be NULL */
  GPtrArray *sources;       /* opc_source *: the file, then what it extends */
  GPtrArray *roots;         /* opc_node *: of each */
  opc_node *steps;          /* all, laid over each other; NULL: none given */
  GPtrArray *variants;      /* opc_variant *, in the order they came */
  GArray *sweep;            /* opc_entry: path and values */
} opc_recipe;

/* NULL if a file cannot be read at all; otherwise it is good if no problem was
   added. */
opc_recipe *opc_recipe_read(const char *path, opc_problems *problems);
void opc_recipe_free(opc_recipe *recipe);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_recipe, opc_recipe_free)

/* NULL and a problem, with a suggestion, if there is none of that name. */
const opc_variant *opc_recipe_variant(const opc_recipe *recipe,
                                      const char *name, opc_problems *problems);

/* Letters, digits, '_', '-' and, if `dots`, dots; not a dot or '-' first. */
gboolean opc_is_name(const char *text, gboolean dots);

#endif
