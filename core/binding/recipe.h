/* SPDX-License-Identifier: BSD-3-Clause */
/* Recipes. A recipe is a flow file merged with the chain of files that it
   extends: unchecked steps, variants and sweep. flow.h makes a flow of a recipe
   and choices of variant, point and values. */
#pragma once

#include <base/node.h>

/* A merged flow file. */
typedef struct opc_recipe {
  char *path;               /* as passed to opc_recipe_read */
  char *name, *description; /* name and description in the first file;
                               description may be NULL */
  GPtrArray *sources;       /* opc_source *: flow files, variants, list files */
  GPtrArray *roots;         /* opc_node *: one per file */
  opc_node *steps;          /* merged steps; NULL if no file has steps */
  opc_node *variants; /* name -> (path -> value). Entries of the extended flow
                         come first; if a path occurs twice, the later entry
                         applies */
  opc_node *sweep;    /* path -> values */
  opc_node *demands;  /* merged "require"; empty: none */
} opc_recipe;

/* Read a flow file and the extended files. Returns NULL if a file cannot be
   read; otherwise a recipe (opc_recipe_free), valid if no problem was added. */
opc_recipe *opc_recipe_read(const char *path, opc_problems *problems);
void opc_recipe_free(opc_recipe *recipe);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_recipe, opc_recipe_free)

/* Return whether the recipe has a variant of that name; if not, add a problem
   with a suggestion at `at` or, if NULL, the file. */
gboolean opc_recipe_has(const opc_recipe *recipe, const char *variant,
                        const opc_place *at, opc_problems *problems);
