/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "regulator": enforces design rules on the printed contours in the
   correction loop. A veto forbids the synthesizer a direction of a gate's
   biases. Kind, [main]: see opcflow/plugin.h. */
#pragma once

#include <eda/synthesizer.h>

OPC_C_BEGIN

/* Input of a regulator: the simulation of one iteration of the loop. Arrays
   without a stated length have one element for each gate. */
typedef struct eda_printed {
  uint32_t iteration;
  const eda_gates *gates;
  const uint32_t *flags; /* EDA_PRINT_* */
  const int32_t *l, *w;  /* biases of the simulated mask (eda_moves) */
  /* Extension of the printed poly beyond the printed active, nm, [2 * i +
     side]; negative if the poly ends within the active; INFINITY: no end. */
  const double *extension;
  const eda_shapes *shapes; /* [layers]: the simulated mask, merged, in grid
                               units of the gates */
  const eda_field *print;   /* [layers]: level sets, positive where the resist
                               prints */

  /* Requests of the synthesizer, nm, [2 * i + side]: extension of the printed
     line end beyond the active; additional width of a hammerhead on each side.
     The regulator applies the larger of a request and its own parameter, within
     its rules. NULL: no request. Since 0.2. */
  const double *want_extension, *want_head;

  /* eda_moves.aside of the simulated mask. NULL: all 0. Since 0.5. */
  const int32_t *aside;

  /* Scanner, for default lengths (natural.h). Since 0.7. */
  eda_scanner scanner;
} eda_printed;

/* Result of a regulator. vetoes[i]: EDA_VETO_* of gate i, zeroed on entry.
   end[2 * i + side]: biases of the line ends, grid steps, outwards positive; on
   entry those of the simulated mask. */
typedef struct eda_ruling {
  uint32_t *vetoes;
  int32_t *end;
  size_t transistors; /* number of transistors that print without a failure */
  /* [layers]: all rectangles added to the next mask, in grid units, for example
     to enlarge the enclosure of a contact; all rectangles cut out afterwards.
     Empty on entry; the regulator owns them until its next call. */
  eda_boxes *added, *cutouts;
} eda_ruling;

/* Functions of a regulator. */
typedef struct eda_regulator {
  /* Check a simulation against the rules; write vetoes and repairs. [main] */
  int (*rule)(void *self, const eda_printed *printed, eda_ruling *ruling,
              opc_error *error);

  /* Write at most `most` violations of a simulation, and set *count to the
     number of all violations. [main] */
  int (*violations)(void *self, const eda_printed *printed,
                    eda_violation *violations, size_t most, size_t *count,
                    opc_error *error);
  OPC_MAY_GROW
} eda_regulator;

OPC_C_END
