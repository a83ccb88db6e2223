/* SPDX-License-Identifier: BSD-3-Clause */
/* The limits of the regulator, and how a mask edge is moved until its print
   keeps them. */
#ifndef OPCFLOW_REGULATOR_RULES_H
#define OPCFLOW_REGULATOR_RULES_H

#include <opcflow/mask.h>

/* nm; as the parameters, and mask_width is min_mask_width */
typedef struct limits {
  double overlay, min_extension, max_growth, min_space, min_width;
  double mask_width, want_extension, max_head;
} limits;

/* How far at once goes back what does harm, nm. */
static const double rules_back = 5;

/* What is known of how a print answers to a moved mask edge. */
typedef struct response {
  int32_t bias;    /* of the mask at the print before, grid steps */
  double value;    /* nm, what printed then */
  int seen;
} response;

/* The bias that should bring `value` (nm) of a print with `bias` to `target`
   and a little more, `bias` or more: by the secant through the last two prints, or
   at first by a usual response, `steep` times that of an edge. Remembers this
   print. */
int32_t rules_advance(response *r, int32_t bias, double value, double target,
                      double steep, double grid);

/* Boxes that are added to a mask, or taken away. */
typedef struct box_list {
  opc_box *at;
  size_t n, most;
} box_list;

/* 0 if there is no memory. */
int boxes_add(box_list *b, opc_box one);

/* A list of violations with room for some; all are counted. */
typedef struct violations {
  opc_violation *v;
  size_t room, count;
} violations;

void violations_add(violations *l, opc_violation v);

#endif
