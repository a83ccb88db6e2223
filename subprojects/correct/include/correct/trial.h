/* SPDX-License-Identifier: BSD-3-Clause */
/* All displacements and shapes that define a mask: a trial. */
#pragma once

#include <correct/edges.h>

/* Number of displacements per gate in `biases`. Active: w and aside. Poly: l,
   jog, two line ends, and three numbers for each of EDA_PARTS parts. */
enum {
  TRIAL_ACTIVE_BIASES = 2,
  TRIAL_POLY_BIASES = 4 + 3 * EDA_PARTS,
  TRIAL_BIASES = TRIAL_ACTIVE_BIASES + TRIAL_POLY_BIASES
};

/* A mask of the loop. The arrays have one element per layer. */
typedef struct trial {
  size_t layers, gates;
  biases biases;
  size_t *fragments;  /* [layers], lengths of the arrays of `shift` */
  int32_t **shift;    /* [layers], displacements of the fragments of a dissected
                         layer; else NULL */
  eda_boxes *added;   /* shapes added by the regulator */
  eda_boxes *cutouts; /* shapes cut out by the regulator */
  eda_boxes *assists; /* SRAFs of the synthesizers */
} trial;

/* Return the biases of n gates stored in `all`, TRIAL_BIASES numbers for each
   gate. */
OPC_EXPORT biases correct_biases_in(int32_t *all, size_t n);

/* Set up a trial without displacements and shapes. */
OPC_EXPORT void correct_trial_init(trial *trial, size_t layers, size_t gates);
/* Free the arrays of a trial. */
OPC_EXPORT void correct_trial_clear(trial *trial);

/* Allocate the displacements, all 0, of a layer that is dissected into
   fragments. */
OPC_EXPORT void correct_trial_cut(trial *trial, size_t layer, size_t fragments);

/* Copy a trial; both must have equal layers and gates. */
OPC_EXPORT void correct_trial_copy(trial *to, const trial *from);

/* Replace *to by a copy of `from`, which may be a part of *to. */
OPC_EXPORT void correct_trial_set_boxes(eda_boxes *to, eda_boxes from);

/* Replace *to by a copy of the boxes of both lists. */
OPC_EXPORT void correct_trial_set_both(eda_boxes *to, eda_boxes first,
                                       eda_boxes second);

/* Remove the boxes that touch a window. */
OPC_EXPORT void correct_trial_drop_boxes(eda_boxes *boxes, eda_box window);

/* Replace the boxes of `boxes` that touch a window by the boxes of `begun` that
   touch the window. */
OPC_EXPORT void correct_trial_reset_boxes(eda_boxes *boxes, eda_box window,
                                          eda_boxes begun);

/* Return 1 if two trials define different masks of a layer. */
OPC_EXPORT int correct_trial_differs(const trial *a, const trial *b,
                                     size_t layer);
