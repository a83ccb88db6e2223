/* SPDX-License-Identifier: BSD-3-Clause */
/* Rules of the mask itself: what a writer and an inspection can hold. */
#ifndef EDA_RULES_H
#define EDA_RULES_H

#include <eda/geometry.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  /* Between edges that face each other, within a polygon too (notches), and
     between convex corners across from each other. */
  EDA_RULE_SPACE,
  /* Across a shape: between its edges, and between concave corners. */
  EDA_RULE_WIDTH,
  /* The length of an edge beside one that is no longer, as of steps that follow
     each other and of small bumps and notches. The step of a single jog is no
     such edge: what is beside it is long. */
  EDA_RULE_EDGE,
  /* The height of a jog: an edge with one convex and one concave corner, both
     neighbours of which are longer. */
  EDA_RULE_JOG,
  EDA_RULES
};

/* Where a rule is not kept, nm. */
typedef struct eda_rule_fault {
  int rule;
  double x, y, value;
} eda_rule_fault;

/* All places of merged shapes with horizontal and vertical edges where a rule
   is not kept: *faults, freed with free(); how many there are. `limit` is the
   least value of each rule, nm, 0 for none. [any] */
OPC_EXPORT size_t eda_rules_check(const eda_shapes *shapes, double grid,
                                  const double limit[EDA_RULES],
                                  eda_rule_fault **faults);

/* "space", "width", "edge", "jog". [any] */
OPC_EXPORT const char *eda_rule_name(int rule);

#ifdef __cplusplus
}
#endif
#endif
