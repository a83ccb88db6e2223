/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a flow at the points of a sweep: steps that no axis changes run once, in
   the trunk (levels.h); other steps run at each point. */
#pragma once

#include "core/run/levels.h"

/* Runs of all points. */
typedef struct opc_points {
  opc_run *trunk; /* owns the folder and the table */
  opc_levels levels;
  size_t done;
  double *seconds; /* one per point */
  char **results;  /* one per point: "good" or the problem */
} opc_points;

/* Set up the points and exclude the swept steps from the trunk. */
void opc_points_begin(opc_points *points, opc_run *trunk,
                      const opc_choice *choice);

/* Run all points, after the steps of the trunk; free the levels. */
void opc_points_run(opc_points *points, opc_problems *problems);
void opc_points_clear(opc_points *points);
