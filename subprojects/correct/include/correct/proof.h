/* SPDX-License-Identifier: BSD-3-Clause */
/* How a loop of cheap prints comes to figures of the fine model.

   The first fine print is that of the first moves. What it differs by from the
   cheap print of the same mask is added to all cheap ones from then on, and the
   drawn mask's figures are taken again with it. When the synthesizers are done,
   a fine print of the mask proves the end, or takes the difference anew and
   lets them go on. */
#ifndef CORRECT_PROOF_H
#define CORRECT_PROOF_H

#include <eda/print.h>

struct loop;

/* The drawn mask and its intensity: what is kept of it until there is a
   difference. */
typedef struct proof {
  eda_shapes *mask;
  eda_field *image; /* both [layers]; NULL: nothing is kept */
} proof;

/* How often the end is proved, at most. The difference changes by a fifth of
   itself with each round of moves (the README has figures), so that a second
   proof that fails is a loop that does not come to rest. */
enum { PROOFS = 3 };

/* The drawn mask was printed, cheaply. */
OPC_EXPORT int correct_proof_begin(struct loop *loop, opc_error *error);
OPC_EXPORT void correct_proof_clear(struct loop *loop);

/* Whether this print, the first after moves, is to be a fine one, too. */
OPC_EXPORT int correct_proof_is_early(const struct loop *loop);

/* There is a fine print: take the drawn mask's figures again. */
OPC_EXPORT int correct_proof_of_drawn(struct loop *loop, opc_error *error);

/* Whether something is printed of which there is no fine print yet. */
OPC_EXPORT int correct_proof_is_due(const struct loop *loop);

/* Print finely what is there. *holds = 0 if transistors or edges have come out
   otherwise than the loop saw them, so that it should go on. */
OPC_EXPORT int correct_proof_of_end(struct loop *loop, int *holds,
                                    opc_error *error);

#endif
