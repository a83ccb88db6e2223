/* SPDX-License-Identifier: BSD-3-Clause */
/* The guard of the correction (not that of the process, guard/guard.h) reverts
   displacements until no transistor is worse in the final mask than in the
   drawn mask. A transistor is not worse if three conditions hold: It prints if
   it prints with the drawn mask. With its edges, it violates no rule of the
   regulator that it satisfies with the drawn mask. Its |Ion deviation| is at
   most the larger of the value as drawn and the limit of the loop.

   A worse transistor is reverted in steps: to its best displacements in the
   loop with the present line ends, to half of these displacements, and to the
   drawn edges. If the transistor still does not print, all edges within a
   growing distance are reverted. Otherwise the result of the best step is kept.
   If that result is worse than the drawn mask, trial simulations search for the
   cause. The cause is a shape of the regulator or a neighbour without which the
   transistor would not be worse. */
#pragma once

#include <eda/regulator.h>

#include <correct/trial.h>

struct loop;

/* Level of reversion of a transistor. */
enum {
  GUARD_KEPT = 0,  /* result of the synthesizer */
  GUARD_BEST,      /* best mask during the loop */
  GUARD_HALF,      /* half of the best mask */
  GUARD_DRAWN,     /* the transistor's own edges as drawn */
  GUARD_SURROUNDED /* and above: also the edges within a distance as drawn */
};

/* Displacements of one gate, as in eda_moves. */
typedef struct gate_moves {
  int32_t l, w, aside, jog;
  eda_part part[EDA_PARTS];
} gate_moves;

/* State of one transistor. */
typedef struct guarded {
  gate_moves best;   /* best displacements with the line ends `end` */
  int32_t end[2];    /* displacements of the line ends that belong to `best`,
                        grid steps */
  double off;        /* |Ion deviation| of `best`, %; INFINITY: none */
  double least;      /* smallest |Ion deviation| at a tried level, % */
  uint8_t pick;      /* level of `least` */
  uint8_t tries;     /* number of tried levels */
  uint8_t level;     /* present level: GUARD_* or higher */
  uint8_t fault;     /* fault in the last simulation */
  const char *cause; /* cause of a remaining fault; NULL: none */
  double x, y;       /* position of the cause, nm */
  const char *rule;  /* last rule whose violation reverted the transistor; NULL:
                        none */
  double at[2];      /* position of that violation, nm */
} guarded;

/* State of the guard. */
typedef struct guard {
  guarded *state;           /* [gates] */
  uint32_t *flags;          /* [gates], EDA_PRINT_* of the mask as drawn */
  eda_violation *drawn;     /* [rules], violations of the mask as drawn */
  size_t rules, prints;     /* length of `drawn`; number of simulations by the
                               guard */
  size_t back, worse, lost; /* numbers of transistors: reverted, worse than
                               drawn, no longer printed */
  size_t ruled, first;      /* number of transistors that were reverted because
                               of a rule and are beyond the limit of the loop;
                               the first of these */
} guard;

/* Set up a guard; free its arrays. */
OPC_EXPORT void correct_guard_init(guard *guard, size_t gates);
OPC_EXPORT void correct_guard_clear(guard *guard);

/* correct_guard_begin: record the simulation of the drawn mask, whose
   performance is loop.before. A second call, after an accurate simulation,
   replaces the record. correct_guard_watch: record the displacements of the
   simulated mask as the best for each transistor that they improve. */
OPC_EXPORT int correct_guard_begin(struct loop *loop, const eda_printed *drawn,
                                   opc_error *error);
OPC_EXPORT void correct_guard_watch(struct loop *loop);

/* Return the |deviation| of a gate's Ion from the synthesizer's target in the
   last simulation, %; NAN if the gate does not print or has no target. */
OPC_EXPORT double correct_guard_off(const struct loop *loop, size_t gate);

/* Revert worse transistors step by step, and simulate after each step, until no
   transistor is worse or no step remains. After 30 simulations, revert the
   whole mask. Then count reverted and worse transistors. Returns OPC_CANCELLED
   if the run was stopped. */
OPC_EXPORT int correct_guard_hold(struct loop *loop, opc_error *error);
/* Count reverted and worse transistors without a change of the mask. */
OPC_EXPORT void correct_guard_count(struct loop *loop);

/* Return the verdict on a transistor for its table row, or NULL if it was not
   reverted. The caller frees the text with g_free(). */
OPC_EXPORT char *correct_guard_verdict(const guard *guard, size_t gate);
