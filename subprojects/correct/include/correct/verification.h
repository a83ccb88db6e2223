/* SPDX-License-Identifier: BSD-3-Clause */
/* Verification, by accurate simulations, of a correction that uses fast
   simulations.

   The first displaced mask is simulated with both models. The difference of the
   accurate and the fast image is added to the images of all later fast
   simulations and to the image of the drawn mask. When the synthesizers have
   finished, the final mask is simulated with the accurate model. If its figures
   differ too much from those of the fast simulation, the difference is updated
   and the loop continues. */
#pragma once

#include <eda/print.h>

struct loop;

/* Mask and intensity of the drawn layout, kept until the difference is
   known. */
typedef struct verification {
  eda_shapes *mask;
  eda_field *image; /* both [layers]; NULL: not kept */
} verification;

/* Largest number of verifications. Between two verifications, the difference of
   the images changes by about a fifth (plugins/correct/README.md). If two
   verifications fail, the loop probably does not converge. */
enum { VERIFICATIONS = 3 };

/* Store the fast simulation of the drawn mask. */
OPC_EXPORT int correct_verification_begin(struct loop *loop, opc_error *error);
/* Free the stored mask and images. */
OPC_EXPORT void correct_verification_clear(struct loop *loop);

/* Return 1 if the last simulation is the first simulation of a displaced mask,
   after which an accurate simulation must follow. */
OPC_EXPORT int correct_verification_is_early(const struct loop *loop);

/* Correct the figures of the drawn mask by the difference of the images. */
OPC_EXPORT int correct_verification_of_drawn(struct loop *loop,
                                             opc_error *error);

/* Return 1 if a layer of the mask has no accurate simulation. */
OPC_EXPORT int correct_verification_is_due(const struct loop *loop);

/* Simulate the final mask with the accurate model. Sets *holds to 0 if figures
   of transistors or edge positions differ so much from the fast simulation that
   the loop must continue. */
OPC_EXPORT int correct_verification_of_end(struct loop *loop, int *holds,
                                           opc_error *error);
