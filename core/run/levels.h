/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs of a flow at the points of a sweep. Each step belongs to a level, which
   follows from the last axis of the sweep that changes the step, directly or
   through an input. Level 0, the trunk, has the steps that no axis changes;
   they run once. Level i + 1 has the steps whose last axis is the axis of
   layers i (opcflow/inner.h); they run again if a value of the axes 0 to i
   changes. All axes of parameters together form the last level. The steps of
   the last level run at each point. */
#pragma once

#include "core/run/run.h"

/* Runs of all levels. */
typedef struct opc_levels {
  const opc_recipe *recipe;
  opc_choice choice; /* changes to the recipe, with the sweep */
  opc_registry *registry;
  const opc_watch *watch; /* for all runs but the trunk */
  opc_run *outer;         /* run that contains all levels */
  /* Return by step number whether a step must run (g_free). A NULL pointer
     selects all steps. */
  gboolean *(*needed)(const void *data, const opc_flow *flow);
  const void *data;
  gboolean one_folder; /* file names must be unique over all levels */
  const char *folder;  /* contains the folder .1 of level 1, and so on */
  /* ---- set by the functions below ---- */
  unsigned depth;          /* number of the last level */
  opc_run **runs;          /* one per level; NULL if the level has no steps */
  opc_problems **failures; /* one per level; NULL if the level did not run */
  guint *at;               /* one per level: index of the value of its axis */
  opc_run *last;           /* run of level `depth`; NULL if not started */
} opc_levels;

/* Set up the levels above `trunk` and exclude the steps of other levels from
   the trunk. The caller first sets the fields `recipe` to `folder`. */
void opc_levels_begin(opc_levels *levels, opc_run *trunk);

/* Free all runs but the trunk and remove their folders. */
void opc_levels_clear(opc_levels *levels);

/* Run a point in a folder and set `last`. Levels whose values equal those of
   the previous point are reused together with their problems. */
void opc_levels_run(opc_levels *levels, size_t point, const char *folder,
                    opc_problems *problems);

/* Discard levels that the user stopped, so that these levels run again. */
void opc_levels_forget_stopped(opc_levels *levels);

/* Return the folder of a level (g_free). */
char *opc_levels_folder(const opc_levels *levels, unsigned level);

/* Write the resolved flow and the metrics of a point's run into the folder of
   the run; if `keep` is FALSE, remove the folder instead. */
void opc_levels_close(const opc_run *run, gboolean keep,
                      opc_problems *problems);
