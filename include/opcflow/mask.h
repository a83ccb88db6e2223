/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds "mask" and "drc": what drives the correction loop, and what holds it
   within bounds. */
#ifndef OPCFLOW_MASK_H
#define OPCFLOW_MASK_H

#include <opcflow/gates.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the regulator (kind "drc") forbids a gate; flags. */
enum {
  OPC_VETO_LONGER = 1 << 0,   /* a larger L: go back, and go on with W */
  OPC_VETO_SHORTER = 1 << 1,
  OPC_VETO_WIDER = 1 << 2,
  OPC_VETO_NARROWER = 1 << 3
};

/* The measurements of one iteration. Arrays of gates->count, valid during the
   call. */
typedef struct opc_feedback {
  size_t size;               /* sizeof(opc_feedback) */
  uint32_t iteration;        /* 0: the mask as drawn */
  const opc_gates *gates;
  const opc_performance *design, *printed;
  const uint32_t *flags;     /* OPC_PRINT_* */
  const uint32_t *vetoes;    /* OPC_VETO_* */

  /* Since 1.1. Edge placement errors of the fragments that the synthesizer
     asked for with `cut`, nm along the outward normal, positive where the print
     is too large; NAN where there is no edge within 100 nm of the site. NULL
     for a layer without such fragments. */
  const double *epe[OPC_MASKS];
  /* Since 1.1. The line ends of the mask that printed so, as the regulator has
     them: opc_ruling.end. */
  const int32_t *end;
  /* Since 1.2. The level sets of that print, [OPC_MASKS], positive where it
     prints. NULL where there is no print. */
  const opc_field *print;
  /* Since 1.2. The line ends of the next mask, as the regulator has them by
     now: grid steps, as `end`. */
  const int32_t *next_end;
} opc_feedback;

/* The biases of each gate's mask, in grid steps against the drawn one: `l` of
   its length (both sides of the poly together), `w` of its width (both sides
   of the active together). They hold what was measured; the synthesizer
   writes what to try next. An odd bias moves the HIGH side by one more. */
typedef struct opc_moves {
  size_t size;               /* sizeof(opc_moves) */
  int32_t *l, *w;

  /* Since 1.1. A length longer by one step more over a part of the width: the
     edge of the poly that l + 1 would move, the HIGH side if `l` is even, else
     the LOW one, gets a jog. So much of its fragment (gates->edges), in grid
     steps from its LOW end along W, lies one step further out. 0: none; as long
     as the fragment or longer: the same as l + 1. */
  int32_t *jog;
  /* Since 1.1. How far each fragment of `cut` lies outwards of where it was
     drawn, in grid steps; NULL for a layer without such fragments, whose edges
     follow `l`, `w` and `jog`. */
  int32_t *shift[OPC_MASKS];
  /* Since 1.2. The assist features of each layer (opc_cuts): those of the mask
     that was measured. Others in their place, which belong to the synthesizer
     until its next update, are those of the next mask. */
  const opc_box *assists[OPC_MASKS];
  size_t assist_count[OPC_MASKS];
} opc_moves;

/* Edge fragments of a synthesizer's own, since 1.1. Polygon p of the layer's
   drawn shapes has the fragments start[p] .. start[p+1]-1. Fragment f goes from
   from[f] to the from of the next one of its polygon; all corners of the
   polygon are among them, in its order. `site` is where its edge placement
   error is measured: a point of the fragment or elsewhere on the same drawn
   edge. The arrays belong to the synthesizer and stay as they are until its
   next `begin` or its end. */
typedef struct opc_cuts {
  size_t size;               /* sizeof(opc_cuts) */
  size_t polygons;           /* 0: none, the gates' biases move this layer */
  const uint32_t *start;
  const opc_point *from;
  const double *site;        /* x, y of each fragment, nm */

  /* Since 1.2. Assist features: rectangles that the layer's mask has besides its
     shapes, on the grid of the gates, clear of them, and that are not to print.
     They stay until opc_moves has others. NULL and 0 when it is asked: none. */
  const opc_box *assists;
  size_t assist_count;
} opc_cuts;

/* What holds for a synthesizer, since 1.1; flags. */
enum {
  /* Line ends and patches of the regulator may come together with its first
     moves. Otherwise they are settled before it is asked for any, as it would
     take their effect for that of its moves. */
  OPC_SYNTHESIZER_ENDS_ANYTIME = 1 << 0
};

typedef struct opc_synthesizer {
  size_t size;               /* sizeof(opc_synthesizer) */

  /* Before the first iteration, with feedback->printed NULL; allocate here
     what the loop needs. A later begin starts anew. [main] */
  int (*begin)(void *self, const opc_feedback *feedback, opc_error *error);

  /* The next moves. *done = 1 to end the loop: `moves` is then the result, and
     the loop prints it once more if it differs from what was measured. NaN in
     the moves cannot be; a gate to leave alone keeps its biases. [main] */
  int (*update)(void *self, const opc_feedback *feedback, opc_moves *moves,
                int *done, opc_error *error);

  /* Why gate i was left with the deviation it has, for the table: one word or
     few ("within limit", "grid", "bridging"); NULL for nothing. [main] */
  const char *(*verdict)(const void *self, size_t gate);

  /* Since 1.1; NULL: it moves gates only. The fragments of a layer that it
     moves one by one; called after `begin`, for each layer. [main] */
  int (*cut)(void *self, const opc_gates *gates, int layer, opc_cuts *cuts,
             opc_error *error);

  uint32_t flags;            /* since 1.1: OPC_SYNTHESIZER_* */
} opc_synthesizer;

/* A rule that the print does not keep. Frozen. */
typedef struct opc_violation {
  const char *rule;          /* constant: "bridging", "extension", ... */
  int32_t gate;
  double x, y;               /* nm */
  double value, limit;       /* nm, or a count */
} opc_violation;

/* What the regulator sees. */
typedef struct opc_printed {
  size_t size;               /* sizeof(opc_printed) */
  uint32_t iteration;
  const opc_gates *gates;
  const uint32_t *flags;     /* OPC_PRINT_* */
  const int32_t *l, *w;      /* biases of the mask that printed so */
  /* How far the printed poly goes past the printed active, nm, [2 * i + side];
     negative where it ends before it; INFINITY where it goes on. */
  const double *extension;
  /* Since 1.1: the mask that printed so, merged, and its level sets. */
  const opc_shapes *mask;    /* [OPC_MASKS], on the grid of the gates */
  const opc_field *print;    /* [OPC_MASKS], positive where it prints */
} opc_printed;

/* What it answers. `vetoes` comes zeroed, `end` with the present biases of the
   line ends, in grid steps, outwards positive, [2 * i + side]. */
typedef struct opc_ruling {
  size_t size;               /* sizeof(opc_ruling) */
  uint32_t *vetoes;
  int32_t *end;
  size_t transistors;        /* how many print as one of their own */
  /* Since 1.1. Rectangles that are added to a layer's mask, on the grid of the
     gates, as a larger enclosure of a contact: all of them, each time. They
     belong to the regulator until its next call. NULL and 0 when it is asked:
     none. */
  const opc_box *patches[OPC_MASKS];
  size_t patch_count[OPC_MASKS];
  /* Since 1.2. Rectangles that are taken away from a layer's mask, after the
     patches were added; otherwise as these. */
  const opc_box *bites[OPC_MASKS];
  size_t bite_count[OPC_MASKS];
} opc_ruling;

typedef struct opc_regulator {
  size_t size;               /* sizeof(opc_regulator) */

  /* Judge a print, set vetoes and fixes. [main] */
  int (*rule)(void *self, const opc_printed *printed, opc_ruling *ruling,
              opc_error *error);

  /* The violations of a print, at most `room`; *count is how many there are in
     all. [main] */
  int (*violations)(void *self, const opc_printed *printed,
                    opc_violation *violations, size_t room, size_t *count,
                    opc_error *error);
} opc_regulator;

#ifdef __cplusplus
}
#endif
#endif
