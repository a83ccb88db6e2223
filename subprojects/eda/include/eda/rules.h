/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask rules (MRC): limits of mask writing and inspection. */
#pragma once

#include <eda/geometry.h>

OPC_C_BEGIN

enum {
  /* Space between edges that face each other, also within a polygon (notches),
     and between convex corners diagonally across. */
  EDA_RULE_SPACE,
  /* Width between edges across a shape, and between concave corners. */
  EDA_RULE_WIDTH,
  /* Length of an edge next to one of at most the same length, as in staircases,
     small bumps and notches. The step of a single jog is not such an edge,
     because its neighbours are long. */
  EDA_RULE_EDGE,
  /* Height of a jog: an edge with one convex and one concave corner, both
     neighbours of which are longer. */
  EDA_RULE_JOG,
  EDA_RULES
};

/* Place of a violated rule, nm. */
typedef struct eda_rule_fault {
  int rule;
  double x, y, value;
} eda_rule_fault;

/* Find all places of merged rectilinear shapes that violate a rule: *faults,
   freed with free(). `limit` is the smallest allowed value of each rule, nm, 0
   for none. Return the number of places. [any] */
OPC_EXPORT size_t eda_rules_check(const eda_shapes *shapes, double grid,
                                  const double limit[EDA_RULES],
                                  eda_rule_fault **faults);

/* "space", "width", "edge", "jog". [any] */
OPC_EXPORT const char *eda_rule_name(int rule);

OPC_C_END
