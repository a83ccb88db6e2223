/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "synthesizer": drives the correction loop. A synthesizer computes the
   next edge displacements from the simulation of the last mask. The synthesizer
   either moves the sides of whole gates by biases of L and W, or defines
   fragments of edges (`cut`) and moves each by a displacement. Kind, [main]:
   see opcflow/plugin.h; gate, fragment, figures: gates.h. */
#pragma once

#include <eda/gates.h>
#include <eda/natural.h>

OPC_C_BEGIN

/* Moves of a gate that the regulator forbids, as flags (vetoes). A synthesizer
   should obey: after a veto of L, revert L and correct with W. */
enum {
  EDA_VETO_LONGER = 1 << 0,  /* larger L */
  EDA_VETO_SHORTER = 1 << 1, /* smaller L */
  EDA_VETO_WIDER = 1 << 2,   /* larger W */
  EDA_VETO_NARROWER = 1 << 3 /* smaller W */
};

/* Measurements of one iteration. Arrays of gates->count or, marked [layers], of
   gates->layers elements; valid during the call. */
typedef struct eda_feedback {
  uint32_t iteration; /* 0: the drawn mask */
  const eda_gates *gates;
  const eda_performance *design;  /* figures of the drawn gates */
  const eda_performance *printed; /* figures of the printed gates */
  const uint32_t *flags;          /* EDA_PRINT_* */
  const uint32_t *vetoes;         /* EDA_VETO_* */

  /* [layers]: edge placement errors of the fragments returned by `cut`, nm
     along the outward normal, positive where the printed shape is too large;
     NAN if no contour is within 0.389 wavelength / NA of the site (100 nm at
     193 nm, NA 0.75). NULL for a layer without such fragments. */
  const double *const *epe;

  /* Biases of the line ends of the simulated mask, grid steps, [2 * i + side]
     for gate i (eda_ruling.end). */
  const int32_t *end;
  /* As `end`, of the next mask: set by the regulator after the simulation. */
  const int32_t *next_end;

  /* [layers]: level sets of the simulated contours, positive where the resist
     prints. NULL without simulation. */
  const eda_field *print;

  /* Wavelength and numerical aperture of the litho model, from which default
     lengths of parameters follow (natural.h). Since 0.7. */
  eda_scanner scanner;

  /* Largest |Ion deviation| that the step allows, %; NULL: unknown. A
     synthesizer uses this value if its own limit is not set. */
  const double *ion_limit;

  /* [EDA_RULES]: limits of mask rules of the step (rules.h), nm; 0 disables a
     rule; NULL: unknown. A synthesizer uses these values if its own rules are
     not set. Since 0.8. */
  const double *rules;

  /* 1: refinement of an earlier mask. Only transistors beyond their limits are
     to be corrected; all others have the figures of `design`. Since 0.9. */
  int refines;
} eda_feedback;

/* If *limit, a parameter of a synthesizer, has no value (NAN), set it to the
   limit of the step, or to 0.5 % if the step has none. [main] */
OPC_UNUSED static inline void eda_follow_ion_limit(const eda_feedback *feedback,
                                                   double *limit) {
  if (*limit == *limit) return;
  *limit = feedback->ion_limit ? *feedback->ion_limit : 0.5;
}

/* Biases of the mask of each gate relative to the drawn shapes, grid steps. On
   entry those of the simulated mask; the synthesizer writes the next ones. */
typedef struct eda_moves {
  /* Bias of the length: sum of the outward displacements of both sides of the
     poly. For an odd bias the HIGH side moves one step more than the LOW side.
   */
  int32_t *l;
  /* Bias of the width: the same for both sides of the active. */
  int32_t *w;

  /* Length of a jog, grid steps along W from the LOW end of the fragment
     (gates->edges). Over this length, one poly edge is one step further out:
     the HIGH edge if `l` is even, otherwise the LOW edge. 0: no jog. A jog as
     long as the fragment has the same effect as `l` increased by 1. */
  int32_t *jog;

  /* [layers]: outward displacement of each fragment of `cut` from its drawn
     position, grid steps. NULL for a layer without such fragments; `l`, `w` and
     `jog` then move the edges. */
  int32_t *const *shift;

  /* [layers]: assist features (eda_cuts) of the simulated mask. For the next
     mask, the synthesizer may set other arrays, which must stay valid until the
     next call of `update`. */
  eda_boxes *assists;

  /* Parts of the width with their own biases of L (eda_part, gates.h): those of
     gate i at [EDA_PARTS * i + k], ordered, without overlap, ended by an empty
     part (from >= to). Parts are clipped where the fragments of the gate end.
     The sum l + by is divided between both sides in the same way as `l`; `jog`
     is added, on the side that `l` determines. Since 0.2; NULL in a loop
     without parts. */
  eda_part *part;

  /* Displacement of both active edges of each gate towards HIGH, grid steps.
     Use: widen a gate only on one side, because the line end at the other side
     is short. Since 0.5; NULL in a loop without these displacements. */
  int32_t *aside;
} eda_moves;

/* Edge fragments defined by a synthesizer. Polygon p of the layer's drawn
   shapes has the fragments start[p] .. start[p+1]-1. Fragment f is between
   from[f] and the `from` of the next fragment of the polygon. These points
   include all corners, in order. `site` is the point of the same drawn edge
   where the edge placement error is measured. The arrays belong to the
   synthesizer and are valid until the next `begin`. */
typedef struct eda_cuts {
  size_t polygons; /* 0: the biases of gates move this layer */
  const uint32_t *start;
  const eda_point *from;
  const double *site; /* x, y of each fragment, nm */

  /* Assist features, which must not print: rectangles in grid units that do not
     touch shapes of the layer's mask. Used until eda_moves replaces them. */
  eda_boxes assists;
} eda_cuts;

/* Properties of a synthesizer, as flags. */
enum {
  /* The regulator may change line ends and added shapes together with the first
     moves. Otherwise the regulator finishes before the first moves, because the
     synthesizer would attribute the effect of the regulator to the moves. */
  EDA_SYNTHESIZER_ENDS_ANYTIME = 1 << 0,

  /* The loop may start from a corrected mask: in iteration 0, `moves` contains
     the displacements of that mask, and `update` changes them. Without this
     flag, the loop adds the displacements of such a start itself, and `moves`
     begins with 0. Since 0.9. */
  EDA_SYNTHESIZER_CONTINUES = 1 << 1
};

/* Functions of a synthesizer. */
typedef struct eda_synthesizer {
  /* Start a loop; feedback->printed is NULL. A later call starts anew.
     [main] */
  int (*begin)(void *self, const eda_feedback *feedback, opc_error *error);

  /* Compute the next moves; on entry, `moves` contains those of the simulated
     mask. *done = 1 ends the loop with `moves` as the result, which the loop
     simulates if it differs from the simulated mask. [main] */
  int (*update)(void *self, const eda_feedback *feedback, eda_moves *moves,
                int *done, opc_error *error);

  /* Optional. Return the reason for the remaining deviation of a gate in a few
     words ("within limit", "grid", "bridging"), for a table; NULL: none.
     [main] */
  const char *(*verdict)(const void *self, size_t gate);

  /* Optional; NULL: only biases of gates. Define the fragments of a layer that
     the synthesizer moves individually. Called after `begin` for each corrected
     layer. [main] */
  int (*cut)(void *self, const eda_gates *gates, int layer, eda_cuts *cuts,
             opc_error *error);

  uint32_t flags; /* EDA_SYNTHESIZER_* */

  /* Optional; NULL: 1 for all gates. Return the target of Ion relative to the
     drawn gate; NAN: the gate is not corrected. The loop selects the better of
     two masks of a gate by this target. [main] */
  double (*target)(const void *self, size_t gate);
  OPC_MAY_GROW
} eda_synthesizer;

/* Parameter of a synthesizer that corrects L and W; uses the member max_bias,
   nm. */
#define EDA_MAX_BIAS(self_type)                                                \
  OPC_PARAMETER(self_type, max_bias, .type = OPC_REAL,                         \
                .flags = OPC_ABOVE | OPC_AT_MOST, .unit = "nm",                \
                .follows = "0.311 lambda/NA", .max = 10000,                    \
                .summary =                                                     \
                    "largest correction of L or W; W also changes by at most " \
                    "half of the drawn W")

OPC_C_END
