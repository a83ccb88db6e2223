/* SPDX-License-Identifier: BSD-3-Clause */
/* What holds a loop's result, whatever plugin moved the edges: no transistor of
   the mask that is written is worse than that of the drawn mask.

   It prints as one of its own if it did as drawn; it breaks no rule of the
   regulator that it kept as drawn, if its own edges can do something for it;
   and its Ion is no further off what is wanted of it than the larger of the
   drawn mask's and the loop's limit. What is not so goes back: to the best mask
   that it has had with its present line ends, to half of that, to the drawn
   one. One that then still does not print takes all around it back to drawn,
   further and further, so that it ends. One that does takes the best of these;
   if it is off by more than it was, it tells what stands in the way: a rule or
   a neighbour without which, as a trial shows, it would be as good as drawn. */
#ifndef CORRECT_GUARD_H
#define CORRECT_GUARD_H

#include <eda/regulator.h>

#include <correct/trial.h>

struct loop;

/* How far a transistor is back. */
enum {
  GUARD_KEPT = 0,  /* as the synthesizer left it */
  GUARD_BEST,      /* the best mask that it had in the loop */
  GUARD_HALF,      /* half of that */
  GUARD_DRAWN,     /* its own edges as drawn */
  GUARD_SURROUNDED /* all around it, too, from here on */
};

/* What a synthesizer says of one gate: eda_moves. */
typedef struct gate_moves {
  int32_t l, w, aside, jog;
  eda_part part[EDA_PARTS];
} gate_moves;

typedef struct guarded {
  gate_moves best;   /* the best mask with the line ends `end` */
  int32_t end[2];    /* grid steps */
  double off;        /* |Ion deviation| of that, %; INFINITY: none printed */
  double least;      /* of what the guard has tried, */
  uint8_t pick;      /* which was this level */
  uint8_t tries;     /* that it has had */
  uint8_t level;     /* GUARD_* and more */
  uint8_t fault;     /* of the last print */
  const char *cause; /* what stands in the way; NULL: nothing does */
  double x, y;       /* of the cause, nm */
} guarded;

typedef struct guard {
  guarded *state;       /* of each transistor */
  uint32_t *flags;      /* EDA_PRINT_* of the mask as drawn */
  eda_violation *drawn; /* rules that it breaks */
  size_t rules, prints; /* of them; that the guard has made */
  size_t back, worse, lost;
} guard;

OPC_EXPORT void correct_guard_init(guard *guard, size_t gates);
OPC_EXPORT void correct_guard_clear(guard *guard);

/* The mask as drawn was printed, `before` of the loop has its figures; it may
   be so twice, the better print later. And any mask was. */
OPC_EXPORT int correct_guard_begin(struct loop *loop, const eda_printed *drawn,
                                   opc_error *error);
OPC_EXPORT void correct_guard_watch(struct loop *loop);

/* |Ion deviation| of a gate of the last print from what is wanted of it, %;
   NAN: it does not print, or nothing is. */
OPC_EXPORT double correct_guard_off(const struct loop *loop, size_t gate);

/* Look at the last print, and take back what is worse than drawn until nothing
   is; count what went back and what is worse still. */
OPC_EXPORT int correct_guard_hold(struct loop *loop, opc_error *error);
/* Only count. */
OPC_EXPORT void correct_guard_count(struct loop *loop);

/* What became of a transistor, for its row; NULL: nothing to say. The text
   belongs to the caller (g_free). */
OPC_EXPORT char *correct_guard_verdict(const guard *guard, size_t gate);

#endif
