/* SPDX-License-Identifier: BSD-3-Clause */
/* All that makes a mask of the drawn shapes. */
#ifndef CORRECT_TRIAL_H
#define CORRECT_TRIAL_H

#include <correct/edges.h>

/* Numbers of a gate in `biases`: w and aside; l, jog, both line ends, and
 * parts.
 */
enum {
  TRIAL_ACTIVE_BIASES = 2,
  TRIAL_POLY_BIASES = 4 + 3 * EDA_PARTS,
  TRIAL_BIASES = TRIAL_ACTIVE_BIASES + TRIAL_POLY_BIASES
};

/* Arrays by layer but `biases`. */
typedef struct trial {
  size_t layers, gates;
  biases biases;
  size_t *fragments;  /* of `shift` */
  int32_t **shift;    /* of layers that a synthesizer cut; else NULL */
  eda_boxes *patches; /* of the regulator */
  eda_boxes *bites;   /* what it takes away */
  eda_boxes *assists; /* of the synthesizers */
} trial;

/* The biases of n gates in `all`, room for TRIAL_BIASES * n numbers. */
OPC_EXPORT biases correct_biases_in(int32_t *all, size_t n);

/* The mask as drawn. */
OPC_EXPORT void correct_trial_init(trial *trial, size_t layers, size_t gates);
OPC_EXPORT void correct_trial_clear(trial *trial);

/* A layer is cut into so many fragments, where they are drawn. */
OPC_EXPORT void correct_trial_cut(trial *trial, size_t layer, size_t fragments);

/* `to` becomes what `from` is. */
OPC_EXPORT void correct_trial_copy(trial *to, const trial *from);

/* `to`, of a trial, becomes a copy of `from`, which may be a part of it. */
OPC_EXPORT void correct_trial_set_boxes(eda_boxes *to, eda_boxes from);

/* The same, of two lists. */
OPC_EXPORT void correct_trial_set_both(eda_boxes *to, eda_boxes first,
                                       eda_boxes second);

/* Take those of `boxes` away that touch a window. */
OPC_EXPORT void correct_trial_drop_boxes(eda_boxes *boxes, eda_box window);

/* The same, and those of `begun` that touch it are in their place. */
OPC_EXPORT void correct_trial_reset_boxes(eda_boxes *boxes, eda_box window,
                                          eda_boxes begun);

/* Would the two print other masks of that layer? */
OPC_EXPORT int correct_trial_differs(const trial *a, const trial *b,
                                     size_t layer);

#endif
