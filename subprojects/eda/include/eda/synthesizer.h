/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "synthesizer": what drives the correction loop. Given what the last mask
   printed as, it says which edges move by how much, and nothing else. */
#ifndef EDA_SYNTHESIZER_H
#define EDA_SYNTHESIZER_H

#include <eda/gates.h>
#include <eda/natural.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the regulator forbids a gate; flags. */
enum {
  EDA_VETO_LONGER = 1 << 0, /* a larger L: go back, and go on with W */
  EDA_VETO_SHORTER = 1 << 1,
  EDA_VETO_WIDER = 1 << 2,
  EDA_VETO_NARROWER = 1 << 3
};

/* The measurements of one iteration. Arrays of gates->count or of
   gates->layers; valid during the call. */
typedef struct eda_feedback {
  uint32_t iteration; /* 0: the mask as drawn */
  const eda_gates *gates;
  const eda_performance *design, *printed;
  const uint32_t *flags;  /* EDA_PRINT_* */
  const uint32_t *vetoes; /* EDA_VETO_* */

  /* Of each layer: edge placement errors of the fragments that the synthesizer
     asked for with `cut`, nm along the outward normal, positive where the print
     is too large; NAN where there is no edge within 0.389 wavelength / NA (100
     nm at 193 nm, NA 0.75) of the site. NULL for a layer without such
     fragments. */
  const double *const *epe;

  /* The line ends of the mask that printed so, and of the next one, as the
     regulator has them: grid steps, as eda_ruling.end. */
  const int32_t *end, *next_end;

  /* The level sets of that print, [layers], positive where it prints. NULL
     where there is no print. */
  const eda_field *print;

  /* What lengths that are not given follow from. Since 0.7. */
  eda_scanner scanner;

  /* The largest |Ion deviation| that the step allows, %; NULL: not known. A
     synthesizer's own limit follows from it where the flow has none. */
  const double *ion_limit;
} eda_feedback;

/* Set the limit of a synthesizer, which is NAN where the flow has none, to that
   of the step; 0.5 % where the step has none. [main] */
OPC_UNUSED static inline void eda_follow_ion_limit(const eda_feedback *feedback,
                                                   double *limit) {
  if (*limit == *limit) return;
  *limit = feedback->ion_limit ? *feedback->ion_limit : 0.5;
}

/* The biases of each gate's mask, in grid steps against the drawn one. They
   hold what was measured; the synthesizer writes what to try next. */
typedef struct eda_moves {
  /* `l` of its length (both sides of the poly together), `w` of its width (both
     sides of the active together). An odd bias moves the HIGH side by one
     more. */
  int32_t *l, *w;

  /* A length longer by one step more over a part of the width: the edge of the
     poly that l + 1 would move, the HIGH side if `l` is even, else the LOW one,
     gets a jog. So much of its fragment (gates->edges), in grid steps from its
     LOW end along W, lies one step further out. 0: none; as long as the
     fragment or longer: the same as l + 1. */
  int32_t *jog;

  /* Of each layer: how far each fragment of `cut` lies outwards of where it was
     drawn, in grid steps; NULL for a layer without such fragments, whose edges
     follow `l`, `w` and `jog`. */
  int32_t *const *shift;

  /* Of each layer: its assist features (eda_cuts), those of the mask that was
     measured. Others in their place, which belong to the synthesizer until its
     next update, are those of the next mask. */
  eda_boxes *assists;

  /* The parts of each gate, [EDA_PARTS * i + k], in their order, none
     over another; the first that is empty (from >= to) ends them. They may
     reach past the gate, and are cut off where its fragments end. What `by`
     adds to `l` is shared by both sides as `l` is, and `jog` comes upon that,
     in the side that `l` alone says.
     Since 0.2; NULL in a loop that has none. */
  eda_part *part;

  /* How far both sides of each gate's active lie towards HIGH of where `w` has
     them, in grid steps: a gate gets wider on one side alone where a line end
     is thin on the other one. Since 0.5; NULL in a loop that has none. */
  int32_t *aside;
} eda_moves;

/* Edge fragments of a synthesizer's own. Polygon p of the layer's drawn shapes
   has the fragments start[p] .. start[p+1]-1. Fragment f goes from from[f] to
   the from of the next one of its polygon; all corners of the polygon are among
   them, in its order. `site` is where its edge placement error is measured: a
   point of the fragment or elsewhere on the same drawn edge. The arrays belong
   to the synthesizer and stay as they are until its next `begin` or its end. */
typedef struct eda_cuts {
  size_t polygons; /* 0: none, the gates' biases move this layer */
  const uint32_t *start;
  const eda_point *from;
  const double *site; /* x, y of each fragment, nm */

  /* Assist features: rectangles that the layer's mask has besides its shapes,
     on the grid of the gates, clear of them, and that are not to print. They
     stay until eda_moves has others. */
  eda_boxes assists;
} eda_cuts;

/* What holds for a synthesizer; flags. */
enum {
  /* Line ends and patches of the regulator may come together with its first
     moves. Otherwise they are settled before it is asked for any, as it would
     take their effect for that of its moves. */
  EDA_SYNTHESIZER_ENDS_ANYTIME = 1 << 0
};

typedef struct eda_synthesizer {
  /* Before the first iteration, with feedback->printed NULL; allocate here
     what the loop needs. A later begin starts anew. [main] */
  int (*begin)(void *self, const eda_feedback *feedback, opc_error *error);

  /* The next moves. *done = 1 to end the loop: `moves` is then the result, and
     the loop prints it once more if it differs from what was measured. A gate
     to leave alone keeps its biases. [main] */
  int (*update)(void *self, const eda_feedback *feedback, eda_moves *moves,
                int *done, opc_error *error);

  /* NULL: it tells nothing. Why a gate was left with the deviation it has, for
     the table: one word or few ("within limit", "grid", "bridging"); NULL for
     nothing. [main] */
  const char *(*verdict)(const void *self, size_t gate);

  /* NULL: it moves gates only. The fragments of a layer that it moves one by
     one; called after `begin`, for each layer that is corrected. [main] */
  int (*cut)(void *self, const eda_gates *gates, int layer, eda_cuts *cuts,
             opc_error *error);

  uint32_t flags; /* EDA_SYNTHESIZER_* */

  /* NULL: 1 for all. The Ion that it steers a gate to, as a factor of the drawn
     one; NAN: it leaves that gate alone. The loop judges by it which mask of
     the gate is better. [main] */
  double (*target)(const void *self, size_t gate);
} eda_synthesizer;

#ifdef __cplusplus
}
#endif
#endif
