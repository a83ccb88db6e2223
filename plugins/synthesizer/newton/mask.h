/* SPDX-License-Identifier: BSD-3-Clause */
/* Masks of a transistor on the grid: lengths with and without a jog, and the
   errors predicted for them. */
#pragma once

#include "observe.h"

/* Return the largest |bias| of W, grid steps. */
double width_most(const newton *t, const eda_gates *g, size_t i);

/* Compute the errors predicted at mask length l and width w. */
void errors_after(const transistor *s, double l, double w, double rest[ERRORS]);

/* Return the mask on the grid for wanted moves dx. L corrects the rounding of
   W, a jog or W that of L (`fine`). */
biases mask_on_grid(const newton *t, const eda_feedback *f, size_t i,
                    const double dx[MOVES], double enough, int cut);

/* Return the size of the predicted errors of a mask and, if the transistor is
   within the limit, of their uncertainty. A transistor beyond the limit has
   little to lose, and its response is corrected by the move. */
double mask_expected_size(const newton *t, size_t i, biases next);
