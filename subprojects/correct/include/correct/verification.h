/* SPDX-License-Identifier: BSD-3-Clause */
/* Verification of a loop of fast simulations by the accurate model.

   The first accurate simulation is that of the first displaced mask. Its
   difference from the fast simulation of the same mask is added to all later
   fast simulations, and the figures of the drawn mask are corrected by it. When
   the synthesizers are done, an accurate simulation either verifies the result
   or updates the difference and the loop continues. */
#pragma once

#include <eda/print.h>

struct loop;

/* Mask and intensity of the drawn layout, kept until the difference is
   known. */
typedef struct verification {
  eda_shapes *mask;
  eda_field *image; /* both [layers]; NULL: not kept */
} verification;

/* Largest number of verifications. The difference changes by a fifth in each
   round of the loop (see the README). Two failures in a row show a loop that
   does not converge. */
enum { VERIFICATIONS = 3 };

/* Keep the fast simulation of the drawn mask. */
OPC_EXPORT int correct_verification_begin(struct loop *loop, opc_error *error);
OPC_EXPORT void correct_verification_clear(struct loop *loop);

/* Return 1 if the accurate simulation must follow this one, the first after
   displacements. */
OPC_EXPORT int correct_verification_is_early(const struct loop *loop);

/* Correct the figures of the drawn mask by the accurate simulation. */
OPC_EXPORT int correct_verification_of_drawn(struct loop *loop,
                                             opc_error *error);

/* Return 1 if a layer has been simulated by the fast model only. */
OPC_EXPORT int correct_verification_is_due(const struct loop *loop);

/* Simulate the mask with the accurate model. Sets *holds to 0 if transistors or
   edges deviate from the fast simulation by so much that the loop must
   continue. */
OPC_EXPORT int correct_verification_of_end(struct loop *loop, int *holds,
                                           opc_error *error);
