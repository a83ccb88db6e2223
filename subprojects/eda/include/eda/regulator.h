/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "regulator": keeps the correction loop within design rules. */
#pragma once

#include <eda/synthesizer.h>

OPC_C_BEGIN

/* Input of a regulator. */
typedef struct eda_printed {
  uint32_t iteration;
  const eda_gates *gates;
  const uint32_t *flags; /* EDA_PRINT_* */
  const int32_t *l, *w;  /* biases of the simulated mask */
  /* Extension of the printed poly past the printed active, nm, [2 * i + side];
     negative where the poly ends first; INFINITY where the poly continues. */
  const double *extension;
  const eda_shapes *shapes; /* [layers]: the simulated mask, merged, on the
                               gates' grid */
  const eda_field *print;   /* [layers]: positive where the resist prints */

  /* Requests of the synthesizer, nm, [2 * i + side]: extension of the printed
     line end past the active, and additional width of its head on each flank.
     The regulator grants requests within its rules, and at least its own
     parameters. NULL: no request. Since 0.2. */
  const double *want_extension, *want_head;

  /* Like `w`: displacement of both sides of each gate's active towards HIGH
     (eda_moves.aside). NULL: none. Since 0.5. */
  const int32_t *aside;

  /* Scanner, for lengths that are not given. Since 0.7. */
  eda_scanner scanner;
} eda_printed;

/* Result of a regulator. On entry `vetoes` is zeroed and `end` holds the
   present biases of the line ends, in grid steps, outwards positive, [2 * i +
   side]. */
typedef struct eda_ruling {
  uint32_t *vetoes;
  int32_t *end;
  size_t transistors; /* number of transistors that print as one */
  /* For each layer: rectangles added to its mask, on the grid of the gates, for
     example a larger enclosure of a contact; and rectangles cut out of the mask
     afterwards. Complete at each call. Owned by the regulator until its next
     call; empty on entry. */
  eda_boxes *added, *cutouts;
} eda_ruling;

typedef struct eda_regulator {
  /* Judge a print; set vetoes and repairs. [main] */
  int (*rule)(void *self, const eda_printed *printed, eda_ruling *ruling,
              opc_error *error);

  /* Write the violations of a print, at most `most`; *count is the number of
     all. [main] */
  int (*violations)(void *self, const eda_printed *printed,
                    eda_violation *violations, size_t most, size_t *count,
                    opc_error *error);
  OPC_MAY_GROW
} eda_regulator;

OPC_C_END
