/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a flow at the points of a sweep: steps that no axis touches run once, in
   the trunk, the others at each point. */
#pragma once

#include "core/run/levels.h"

typedef struct opc_points {
  opc_run *trunk; /* has the folder and the table */
  opc_levels levels;
  size_t done;
  double *seconds; /* of each point */
  char **results;  /* of each: "good", or what is wrong */
} opc_points;

/* Leave out the swept steps in the trunk. */
void opc_points_begin(opc_points *points, opc_run *trunk,
                      const opc_choice *choice);

/* Run all points, the trunk's steps having run. */
void opc_points_run(opc_points *points, opc_problems *problems);
void opc_points_clear(opc_points *points);
