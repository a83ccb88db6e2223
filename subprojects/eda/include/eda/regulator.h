/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "regulator": what holds the correction loop within design rules. */
#ifndef EDA_REGULATOR_H
#define EDA_REGULATOR_H

#include <eda/synthesizer.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the regulator sees. */
typedef struct eda_printed {
  uint32_t iteration;
  const eda_gates *gates;
  const uint32_t *flags; /* EDA_PRINT_* */
  const int32_t *l, *w;  /* biases of the mask that printed so */
  /* How far the printed poly goes past the printed active, nm, [2 * i + side];
     negative where it ends before it; INFINITY where it goes on. */
  const double *extension;
  const eda_shapes
      *shapes;            /* [layers]: that mask, merged, on the gates' grid */
  const eda_field *print; /* [layers]: positive where it prints */

  /* What the synthesizer asks for, nm, [2 * i + side]: how far the printed line
     end should reach past the active, and how much wider its head may get on
     each flank. The regulator gives what its rules allow, and no less than by
     its own parameters. NULL: nobody asks. Since 0.2. */
  const double *want_extension, *want_head;

  /* As `w`: how far both sides of each gate's active lie towards HIGH of where
     `w` has them (eda_moves.aside). NULL: not at all. Since 0.5. */
  const int32_t *aside;

  /* What lengths that are not given follow from. Since 0.7. */
  eda_scanner scanner;
} eda_printed;

/* What it answers. `vetoes` comes zeroed, `end` with the present biases of the
   line ends, in grid steps, outwards positive, [2 * i + side]. */
typedef struct eda_ruling {
  uint32_t *vetoes;
  int32_t *end;
  size_t transistors; /* how many print as one of their own */
  /* Of each layer: rectangles that are added to its mask, on the grid of the
     gates, as a larger enclosure of a contact; and rectangles that are taken
     away after that. All of them, each time. They belong to the regulator until
     its next call; empty when it is asked. */
  eda_boxes *patches, *bites;
} eda_ruling;

typedef struct eda_regulator {
  /* Judge a print, set vetoes and fixes. [main] */
  int (*rule)(void *self, const eda_printed *printed, eda_ruling *ruling,
              opc_error *error);

  /* The violations of a print, at most `most`; *count is how many there are in
     all. [main] */
  int (*violations)(void *self, const eda_printed *printed,
                    eda_violation *violations, size_t most, size_t *count,
                    opc_error *error);
} eda_regulator;

#ifdef __cplusplus
}
#endif
#endif
