/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask rule check (MRC): limits of mask writing and inspection. */
#pragma once

#include <eda/geometry.h>

OPC_C_BEGIN

/* The rules. */
enum {
  /* Space between facing edges, also of one polygon (notches), and diagonal
     space between convex corners. */
  EDA_RULE_SPACE,
  /* Width of a shape between opposite edges, and diagonal width between concave
     corners. */
  EDA_RULE_WIDTH,
  /* Length of an edge that is at least as long as one of the two adjacent
     edges, as in staircases, small bumps and notches. An edge that is shorter
     than both adjacent edges, such as a single jog or a line end, is not
     checked. */
  EDA_RULE_EDGE,
  /* Height of a jog: of an edge between a convex and a concave corner that is
     shorter than both neighbours. */
  EDA_RULE_JOG,
  EDA_RULES /* number of rules */
};

/* Violation of a rule. */
typedef struct eda_rule_fault {
  int rule;     /* EDA_RULE_* */
  double x, y;  /* position, nm */
  double value; /* measured value, below the limit of the rule, nm */
} eda_rule_fault;

/* Find all violations of the rules in merged rectilinear shapes (units of
   `grid` nm). limit[rule] is the smallest allowed value, nm; 0 disables the
   rule. Return the number of violations, and the violations in a new array
   *faults; free the array with free(). [any]: opcflow/plugin.h. */
OPC_EXPORT size_t eda_rules_check(const eda_shapes *shapes, double grid,
                                  const double limit[EDA_RULES],
                                  eda_rule_fault **faults);

/* Return the name of a rule: "space", "width", "edge", "jog". [any] */
OPC_EXPORT const char *eda_rule_name(int rule);

OPC_C_END
