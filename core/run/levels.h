/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs of a flow at points of a sweep, on levels: the steps that no axis
   touches run once (level 0, the trunk), those whose last axis is axis i once
   for each of its values (level i + 1), the others at each point. */
#pragma once

#include "core/run/run.h"

typedef struct opc_levels {
  const opc_recipe *recipe;
  opc_choice choice; /* with the sweep */
  opc_registry *registry;
  const opc_watch *watch; /* of all runs but the trunk */
  opc_run *outer;         /* the run that all levels are a part of */
  /* The steps to run, by number (g_free); NULL: all. */
  gboolean *(*needed)(const void *data, const opc_flow *flow);
  const void *data;
  gboolean one_folder; /* files are named as if all levels shared a folder */
  const char *folder;  /* has the folder .1 of level 1 and so on */
  /* ---- the levels' own ---- */
  unsigned depth;          /* the last level */
  opc_run **runs;          /* of each level; NULL: it has no steps */
  opc_problems **failures; /* of each level; NULL: it did not run */
  guint *at;               /* of each level: the value of its axis */
  opc_run *last;           /* of level `depth`; NULL: none began */
} opc_levels;

/* Set up the levels above `trunk`, and leave out the steps of other levels in
   it. All fields before "own" are set. */
void opc_levels_begin(opc_levels *levels, opc_run *trunk);

/* Free all runs but the trunk, and remove their folders. */
void opc_levels_clear(opc_levels *levels);

/* Run a point in a folder; `last` is its run. Runs of levels that share their
   values with the point before are used again, and so are their problems. */
void opc_levels_run(opc_levels *levels, size_t point, const char *folder,
                    opc_problems *problems);

/* Run a level again next time if the user stopped it. */
void opc_levels_forget_stopped(opc_levels *levels);

/* Return the folder of a level (g_free). */
char *opc_levels_folder(const opc_levels *levels, unsigned level);

/* Write the resolved flow and the metrics of a point's run into its folder, or
   remove the folder. */
void opc_levels_close(const opc_run *run, gboolean keep,
                      opc_problems *problems);
