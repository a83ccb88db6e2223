/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of synthesizer.epe share. Coordinates and lengths are in steps
   of the mask grid where they are not said to be in nm. */
#ifndef SYNTHESIZER_EPE_H
#define SYNTHESIZER_EPE_H

#include <eda/bars.h>
#include <eda/index.h>
#include <eda/synthesizer.h>
#include <stdlib.h>

/* How edges are cut, where errors are measured (grid steps), and the rules of
   the mask. */
typedef struct epe_rules {
  int32_t fragment, concave_corner, corner_edge, line_end, ripple;
  int32_t ripple_reach, min_edge, tangency;
  int32_t min_width, min_space, min_jog, max_shift;
  double blur; /* of the coupling between fragments */
} epe_rules;

/* A fragment of an edge as drawn. It moves outwards along `axis`, towards
   larger coordinates if `sign` is 1, else -1. */
typedef struct epe_piece {
  eda_point from, to;
  uint32_t polygon, edge;  /* of its layer, in order */
  uint32_t previous, next; /* around its polygon */
  int32_t gate;            /* the transistor it belongs to, -1: none */
  uint8_t axis;            /* EDA_X, EDA_Y */
  int8_t sign;
  uint8_t corner; /* EPE_FROM, EPE_TO: which of its ends are corners */
  uint8_t still;  /* too short to be moved */
  uint8_t hole;   /* its polygon is one */
} epe_piece;

enum { EPE_FROM = 1, EPE_TO = 2 };

/* Of an edge: it is to be settled again, as bounds of it were narrowed, or as a
   run of it is too short; it moves in one piece. */
enum { EPE_NARROWED = 1, EPE_SHORT = 2, EPE_WHOLE = 4 };

static inline double epe_length(const epe_piece *p) {
  return abs(p->to.x - p->from.x) + abs(p->to.y - p->from.y);
}

/* Fragments of an edge that move alike. */
typedef struct epe_run {
  uint32_t first, end;
  double weighted, length; /* sum of wanted * length, and of lengths */
  int32_t low, high, shift;
  int32_t before, after; /* its neighbours among the runs, -1: none */
} epe_run;

/* Two fragments that face each other, through the mask's inside or across a
   space, or that follow one another around a corner, where their jogs may; and
   how near they may come. */
typedef struct epe_pair {
  uint32_t a, b;
  uint16_t inside, corner;
  float limit;
} epe_pair;

/* A sparse matrix by rows: what moves the print at each site, and by how much
   if the gain were 1; or its transpose. */
typedef struct epe_coupling {
  uint32_t *start, *index;
  float *weight;
} epe_coupling;

/* No NaN in them, so no call of a library is needed. */
static inline double epe_min(double a, double b) { return a < b ? a : b; }
static inline double epe_max(double a, double b) { return a > b ? a : b; }
static inline double epe_within(double x, double low, double high) {
  return epe_min(epe_max(x, low), high);
}

typedef struct epe_layer {
  const opc_context *context;
  const epe_rules *rules;
  size_t count; /* fragments; 0: this layer is not moved */
  epe_piece *pieces;
  size_t polygons;
  uint32_t *start; /* the first fragment of each polygon, and the end */
  eda_point *from;
  double *site; /* nm */
  size_t edges;
  uint32_t *edge; /* the first fragment of each edge, and the end */
  uint8_t *state; /* EPE_NARROWED and so on, of each edge */
  epe_pair *pairs;
  size_t pair_count;

  /* Of each fragment, in two blocks of memory: */
  double *reals;
  int32_t *integers;
  double *wanted; /* where feedback puts each fragment */
  double *gain;   /* of the coupling, measured */
  epe_coupling coupling, transposed;
  double *work[5];        /* of steer.c */
  double *step;           /* how far each may move at once */
  double *side;           /* the sign of the last error that there was, or of
                             the print at a site that has no edge near */
  double *error, *before; /* of the last print and of the one before it, in
                             grid steps; NAN: no edge near the site */
  double *cost;           /* |EPE| as it was measured, nm */
  int32_t *shift, *last;  /* measured, and measured before */
  int32_t *best;
  int32_t *low, *high; /* what the rules leave each fragment */
  int32_t *most;       /* how far outwards each fragment may go */
  eda_box_list bars;   /* assist features */
  epe_run *runs;       /* of each edge, where its fragments are */
  int32_t *settled;    /* shifts while rules.c makes them */
  uint8_t *broken;     /* pairs that are too near */
} epe_layer;

/* cut.c: the fragments of the drawn shapes of a layer, their sites and
   owners. */
void epe_cut(epe_layer *layer, const eda_gates *gates, int which);
void epe_clear(epe_layer *layer);

/* assist.c: place the bars and leave the fragments room beside them. */
int epe_place_bars(epe_layer *layer, const eda_bar_rule *rule,
                   const eda_shapes *drawn, opc_error *error);

/* The bars of somebody else, in place of those there were: whether they are
   others. */
int epe_take_bars(epe_layer *layer, eda_boxes bars);

/* pairs.c: find the fragments that may come too near to each other. */
void epe_find_pairs(epe_layer *layer);
/* Narrow low and high of the fragments that come too near to each other in the
   mask of `shift`, or make an edge too short; how many pairs and edges there
   are. `hard`: their edges stay as drawn. */
size_t epe_part(epe_layer *layer, const int32_t *shift, int hard);

/* rules.c: the shifts nearest to layer->wanted that the rules allow. */
void epe_settle(epe_layer *layer, int32_t *shift);

/* window.c: weigh the errors that were measured, and their costs, with those of
   other doses, which print where the level set is `level` more or less.
   `weight` is that of the others; 0: they are not looked at. */
void epe_weigh(epe_layer *layer, const eda_field *print, double weight,
               double level, double grid);

/* couple.c: whose moves change the print at each site, and by how much. */
void epe_couple(epe_layer *layer, double grid);

/* steer.c: move layer->wanted against the errors. */
typedef struct epe_steering {
  double step;      /* the largest move */
  double damping;   /* the part of an error that it is to take away */
  double stiffness; /* what a move costs against an error */
} epe_steering;
void epe_steer(epe_layer *layer, const epe_steering *by);

/* The line that a fragment lies on, along its axis, and the span it covers
   along the other one, after the moves of `shift` (NULL: as drawn). */
static inline int32_t epe_line(const epe_piece *p, const int32_t *shift,
                               uint32_t i) {
  int32_t at = p[i].axis == EDA_X ? p[i].from.x : p[i].from.y;
  return at + (shift ? p[i].sign * shift[i] : 0);
}

static inline int32_t epe_along(const epe_piece *p, eda_point at) {
  return p->axis == EDA_X ? at.y : at.x;
}

static inline int32_t epe_begin(const epe_piece *p, const int32_t *shift,
                                uint32_t i) {
  return p[i].corner & EPE_FROM ? epe_line(p, shift, p[i].previous)
                                : epe_along(&p[i], p[i].from);
}

static inline int32_t epe_end(const epe_piece *p, const int32_t *shift,
                              uint32_t i) {
  return p[i].corner & EPE_TO ? epe_line(p, shift, p[i].next)
                              : epe_along(&p[i], p[i].to);
}

#endif
