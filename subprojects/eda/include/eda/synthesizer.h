/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "synthesizer": drives the correction loop. From the measurements of the
   last mask a synthesizer computes the next displacements of edges. */
#pragma once

#include <eda/gates.h>
#include <eda/natural.h>

OPC_C_BEGIN

/* Moves that the regulator forbids to a gate, as flags. */
enum {
  EDA_VETO_LONGER = 1 << 0, /* larger L: go back and continue with W */
  EDA_VETO_SHORTER = 1 << 1,
  EDA_VETO_WIDER = 1 << 2,
  EDA_VETO_NARROWER = 1 << 3
};

/* Measurements of one iteration. Arrays of gates->count or of gates->layers;
   valid during the call. */
typedef struct eda_feedback {
  uint32_t iteration; /* 0: the drawn mask */
  const eda_gates *gates;
  const eda_performance *design, *printed;
  const uint32_t *flags;  /* EDA_PRINT_* */
  const uint32_t *vetoes; /* EDA_VETO_* */

  /* [layers]: edge placement errors of the fragments returned by `cut`, nm
     along the outward normal, positive where the printed shape is too large;
     NAN without an edge within 0.389 wavelength / NA (100 nm at 193 nm, NA
     0.75) of the site. NULL for a layer without such fragments. */
  const double *const *epe;

  /* Line ends of the simulated mask and of the next one, set by the regulator:
     grid steps, as eda_ruling.end. */
  const int32_t *end, *next_end;

  /* Level sets of the print, [layers], positive where the resist prints. NULL
     without a print. */
  const eda_field *print;

  /* Scanner, for lengths that are not given. Since 0.7. */
  eda_scanner scanner;

  /* Largest |Ion deviation| that the step allows, %; NULL: unknown. The default
     of a synthesizer's own limit. */
  const double *ion_limit;

  /* [EDA_RULES]: mask rules of the step, nm, 0 for none; NULL: unknown. The
     defaults of a synthesizer's own rules. Since 0.8. */
  const double *rules;
} eda_feedback;

/* Set the limit of a synthesizer that the flow does not give (NAN) to that of
   the step, or to 0.5 % if the step has none. [main] */
OPC_UNUSED static inline void eda_follow_ion_limit(const eda_feedback *feedback,
                                                   double *limit) {
  if (*limit == *limit) return;
  *limit = feedback->ion_limit ? *feedback->ion_limit : 0.5;
}

/* Biases of each gate's mask, in grid steps from the drawn one. On entry those
   of the measured mask; the synthesizer writes the next ones. */
typedef struct eda_moves {
  /* `l`: bias of the length (both sides of the poly together); `w`: bias of the
     width (both sides of the active together). An odd bias moves the HIGH side
     by one more. */
  int32_t *l, *w;

  /* Jog: the length is one step longer over a part of the width. The poly edge
     that l + 1 would move (HIGH if `l` is even, otherwise LOW) is one step
     further out over this many grid steps. They start at the LOW end of its
     fragment (gates->edges) along W. 0: none; the length of the fragment or
     more: same as l + 1. */
  int32_t *jog;

  /* [layers]: outward displacement of each fragment of `cut` from its drawn
     position, in grid steps; NULL for a layer without such fragments, whose
     edges follow `l`, `w` and `jog`. */
  int32_t *const *shift;

  /* [layers]: assist features (eda_cuts) of the measured mask. The synthesizer
     may replace them by those of the next mask, which it owns until its next
     update. */
  eda_boxes *assists;

  /* Parts of each gate, [EDA_PARTS * i + k], ordered, without overlap; the
     first empty part (from >= to) ends them. Parts may reach past the gate and
     are clipped where its fragments end. `by` is added to `l` and distributed
     over both sides like `l`; `jog` is applied on top, on the side determined
     by `l` alone. Since 0.2; NULL in a loop without parts. */
  eda_part *part;

  /* Displacement of both sides of each gate's active towards HIGH, in grid
     steps: widens a gate on one side only, if a line end is short on the other.
     Since 0.5; NULL in a loop without it. */
  int32_t *aside;
} eda_moves;

/* Edge fragments defined by a synthesizer. Polygon p of the layer's drawn
   shapes has the fragments start[p] .. start[p+1]-1. Fragment f runs from
   from[f] to the `from` of the next one of its polygon; all corners of the
   polygon are among these points, in order. `site` is the point where the edge
   placement error is measured, on the fragment or elsewhere on the same drawn
   edge. The arrays belong to the synthesizer and stay unchanged until its next
   `begin` or its end. */
typedef struct eda_cuts {
  size_t polygons; /* 0: none, the gates' biases move this layer */
  const uint32_t *start;
  const eda_point *from;
  const double *site; /* x, y of each fragment, nm */

  /* Assist features: rectangles of the layer's mask besides its shapes, on the
     grid of the gates, clear of the shapes, which must not print. Used until
     eda_moves replaces them. */
  eda_boxes assists;
} eda_cuts;

/* Properties of a synthesizer, as flags. */
enum {
  /* Line ends and additions of the regulator may change together with the first
     moves. Otherwise they are settled before the first moves, because the
     synthesizer would attribute their effect to its own moves. */
  EDA_SYNTHESIZER_ENDS_ANYTIME = 1 << 0
};

typedef struct eda_synthesizer {
  /* Start a loop, with feedback->printed NULL; allocate state. A later call
     starts anew. [main] */
  int (*begin)(void *self, const eda_feedback *feedback, opc_error *error);

  /* Compute the next moves. *done = 1 ends the loop: `moves` is the result,
     which the loop simulates once more if it differs from the measured mask.
     Unchanged gates keep their biases. [main] */
  int (*update)(void *self, const eda_feedback *feedback, eda_moves *moves,
                int *done, opc_error *error);

  /* Optional. Return the reason why a gate keeps its deviation, for the table:
     a few words ("within limit", "grid", "bridging"); NULL: none. [main] */
  const char *(*verdict)(const void *self, size_t gate);

  /* Optional; NULL: only gates move. Define the fragments of a layer that the
     synthesizer moves individually; called after `begin` for each corrected
     layer. [main] */
  int (*cut)(void *self, const eda_gates *gates, int layer, eda_cuts *cuts,
             opc_error *error);

  uint32_t flags; /* EDA_SYNTHESIZER_* */

  /* Optional; NULL: 1 for all. Return the target Ion of a gate as a factor of
     the drawn one; NAN: the gate is not corrected. The loop uses the target to
     select the better of two masks of a gate. [main] */
  double (*target)(const void *self, size_t gate);
  OPC_MAY_GROW
} eda_synthesizer;

OPC_C_END
