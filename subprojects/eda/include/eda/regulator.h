/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "regulator": enforces design rules on the printed contours in the
   correction loop. A veto forbids the synthesizer to change the bias of L or
   W of a gate in one direction. Kind, [main]: see opcflow/plugin.h. */
#pragma once

#include <eda/synthesizer.h>

OPC_C_BEGIN

/* Input of a regulator: the simulation of one iteration of the loop. Arrays
   have one element for each gate. [layers]: one element for each of the
   gates->layers layers. [2 * i + side]: two elements for gate i; side 0 is the
   line end at the LOW end of W, side 1 that at the HIGH end. */
typedef struct eda_printed {
  uint32_t iteration;
  const eda_gates *gates;
  const uint32_t *flags; /* EDA_PRINT_* */
  const int32_t *l, *w;  /* biases of the simulated mask (eda_moves) */
  /* Extension of the printed poly beyond the printed active, nm, [2 * i +
     side]; negative if the poly ends within the active; INFINITY if the poly
     has no line end there. */
  const double *extension;
  const eda_shapes *shapes; /* [layers]: the simulated mask, merged, in grid
                               units of the gates */
  const eda_field *print;   /* [layers]: level sets, positive where the resist
                               prints */

  /* Requests of the synthesizer, nm, [2 * i + side]. `want_extension`:
     extension of the printed line end beyond the active. `want_head`: widening
     of the line end on each of its two flanks (hammerhead). The regulator
     applies the larger of a request and its own parameter, within its rules.
     NULL: no request. Since 0.2. */
  const double *want_extension, *want_head;

  /* eda_moves.aside of the simulated mask. NULL: all 0. Since 0.5. */
  const int32_t *aside;

  /* Wavelength and numerical aperture of the litho model, from which default
     lengths of parameters follow (natural.h). Since 0.7. */
  eda_scanner scanner;
} eda_printed;

/* Result of a regulator, for the next mask. */
typedef struct eda_ruling {
  uint32_t *vetoes; /* EDA_VETO_* of each gate; 0 on entry */
  /* [2 * i + side], as in eda_printed: biases of the line ends, grid steps,
     positive outwards; on entry those of the simulated mask. */
  int32_t *end;
  size_t transistors; /* number of transistors that print without a failure */
  /* [layers]: rectangles that are added to the shapes of the next mask, in grid
     units, for example to enlarge the enclosure of a contact. The lists are
     complete: a rectangle of the simulated mask that is not listed disappears.
     Empty on entry; the regulator keeps the rectangles valid until its next
     call. */
  eda_boxes *added;
  /* As `added`: rectangles that are removed from the next mask, after `added`
     has been added. */
  eda_boxes *cutouts;
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

  /* Optional. Repair the mask rules of a mask that is not simulated yet,
     without a check of `printed->print`, which is that of the last simulated
     mask. Write `added` and `cutouts` of the mask; ignore `vetoes` and `end`.
     The function is called after `rule` and the moves of the synthesizers, with
     the iteration of the next `rule`, and again after each change of the mask,
     at most 8 times. Since 0.9. [main] */
  int (*smooth)(void *self, const eda_printed *printed, eda_ruling *ruling,
                opc_error *error);
  OPC_MAY_GROW
} eda_regulator;

OPC_C_END
