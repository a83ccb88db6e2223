/* SPDX-License-Identifier: BSD-3-Clause */
/* Guarantee that no transistor of the final mask is worse than that of the
   drawn mask, for any synthesizer. A transistor that prints as drawn still
   prints. Its own edges cause no violation of a regulator's rule that the drawn
   mask satisfies. Its |Ion deviation| is at most the larger of the drawn mask's
   and the loop's limit.

   Otherwise the transistor is reverted stepwise: to the best mask it has had
   with its present line ends, to half of that, to the drawn edges. If it still
   does not print, everything around it is reverted within a growing distance.
   If it does print, the best of these steps is kept. If that is still worse
   than drawn, trial simulations find the cause: a rule or a neighbour without
   which the transistor would be as good as drawn. */
#pragma once

#include <eda/regulator.h>

#include <correct/trial.h>

struct loop;

/* Level of reversion of a transistor. */
enum {
  GUARD_KEPT = 0,  /* result of the synthesizer */
  GUARD_BEST,      /* best mask during the loop */
  GUARD_HALF,      /* half of the best mask */
  GUARD_DRAWN,     /* its own edges as drawn */
  GUARD_SURROUNDED /* this and higher levels: its environment, too */
};

/* Displacements of one gate, as in eda_moves. */
typedef struct gate_moves {
  int32_t l, w, aside, jog;
  eda_part part[EDA_PARTS];
} gate_moves;

typedef struct guarded {
  gate_moves best;   /* best mask with the line ends `end` */
  int32_t end[2];    /* grid steps */
  double off;        /* |Ion deviation| of `best`, %; INFINITY: none */
  double least;      /* smallest |Ion deviation| at a tried level, % */
  uint8_t pick;      /* level of `least` */
  uint8_t tries;     /* number of tried levels */
  uint8_t level;     /* GUARD_* or higher */
  uint8_t fault;     /* fault of the last simulation */
  const char *cause; /* cause of a remaining fault; NULL: none */
  double x, y;       /* position of the cause, nm */
} guarded;

typedef struct guard {
  guarded *state;       /* [gates] */
  uint32_t *flags;      /* [gates], EDA_PRINT_* of the mask as drawn */
  eda_violation *drawn; /* [rules], violations of the mask as drawn */
  size_t rules, prints; /* violations; simulations by the guard */
  size_t back, worse, lost;
} guard;

OPC_EXPORT void correct_guard_init(guard *guard, size_t gates);
OPC_EXPORT void correct_guard_clear(guard *guard);

/* Record the simulation of the drawn mask (correct_guard_begin; its figures are
   in loop.before; a second, more accurate one replaces the first) and of any
   mask of the loop (correct_guard_watch). */
OPC_EXPORT int correct_guard_begin(struct loop *loop, const eda_printed *drawn,
                                   opc_error *error);
OPC_EXPORT void correct_guard_watch(struct loop *loop);

/* Return the |Ion deviation| of a gate from its target in the last simulation,
   %; NAN: the gate does not print or has no target. */
OPC_EXPORT double correct_guard_off(const struct loop *loop, size_t gate);

/* Revert transistors that are worse than drawn until none is, simulating after
   each step, and count the reverted and the remaining ones. Returns
   OPC_CANCELLED if the run was stopped. */
OPC_EXPORT int correct_guard_hold(struct loop *loop, opc_error *error);
/* Count reverted and worse transistors; change nothing. */
OPC_EXPORT void correct_guard_count(struct loop *loop);

/* Return the verdict on a transistor for its table row, or NULL if it was not
   reverted. The caller frees the text with g_free(). */
OPC_EXPORT char *correct_guard_verdict(const guard *guard, size_t gate);
