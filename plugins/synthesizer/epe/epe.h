/* SPDX-License-Identifier: BSD-3-Clause */
/* Interfaces between the files of synthesizer.epe. Coordinates and lengths are
   in steps of the mask grid unless a comment says nm. */
#pragma once

#include <eda/index.h>
#include <eda/srafs.h>
#include <eda/synthesizer.h>
#include <stdlib.h>

/* Parameters of synthesizer.epe for fragmentation, measurement sites and mask
   rules, in grid steps. */
typedef struct epe_rules {
  int32_t fragment, concave_corner, corner_edge, line_end, ripple;
  int32_t ripple_reach, min_edge, tangency;
  int32_t min_width, min_space, min_jog, max_shift;
  double blur; /* standard deviation of the Gaussian coupling of fragments */
} epe_rules;

/* A fragment of a drawn edge. The outside is along `axis`, towards larger
   (`sign` 1) or smaller (-1) coordinates. Shifts are positive outwards. */
typedef struct epe_fragment {
  eda_point from, to;
  uint32_t polygon, edge;  /* indices in the layer, in order */
  uint32_t previous, next; /* adjacent fragments of the polygon */
  int32_t gate;            /* transistor that owns the fragment, or -1 */
  uint8_t axis;            /* EDA_X, EDA_Y */
  int8_t sign;
  uint8_t corner; /* set of ends that are corners: EPE_FROM, EPE_TO */
  uint8_t still;  /* 1: not shifted, because the edge is too short */
  uint8_t hole;   /* 1: the polygon is a hole */
} epe_fragment;

/* Ends of a fragment: at `from`, at `to`. */
enum { EPE_FROM = 1, EPE_TO = 2 };

/* States of an edge, a bit set. EPE_NARROWED: the bounds of a fragment were
   narrowed. EPE_SHORT: a run is shorter than min_edge. In both states
   epe_settle computes the edge again. EPE_WHOLE: all fragments have one
   shift. */
enum { EPE_NARROWED = 1, EPE_SHORT = 2, EPE_WHOLE = 4 };

/* Return the length of a fragment. */
static inline double epe_length(const epe_fragment *p) {
  return abs(p->to.x - p->from.x) + abs(p->to.y - p->from.y);
}

/* Adjacent fragments of an edge with equal shifts, from `first` to `end` -
   1. */
typedef struct epe_run {
  uint32_t first, end;
  double weighted, length;  /* sums of wanted shift * length, and of length */
  int32_t low, high, shift; /* bounds and value of the shift */
  int32_t before, after;    /* adjacent runs; -1 at an end of the edge */
} epe_run;

/* Two fragments and their smallest permitted distance, `limit`. The fragments
   face each other through the inside of the mask (inside 1) or across a space,
   or are on different sides of a corner (corner 1). */
typedef struct epe_pair {
  uint32_t a, b;
  uint16_t inside, corner;
  float limit;
} epe_pair;

/* A sparse matrix by rows, or its transpose: displacement of the printed edge
   at each site (row) per shift of each fragment (column), for a gain of 1. */
typedef struct epe_coupling {
  uint32_t *start, *index;
  float *weight;
} epe_coupling;

/* Return the smaller operand. Operands are never NaN, so a call of fmin is not
   needed. */
static inline double epe_min(double a, double b) { return a < b ? a : b; }
static inline double epe_max(double a, double b) { return a > b ? a : b; }
static inline double epe_within(double x, double low, double high) {
  return epe_min(epe_max(x, low), high);
}

/* The fragments of a layer, with their state. */
typedef struct epe_layer {
  const opc_context *context;
  const epe_rules *rules;
  size_t count; /* number of fragments; 0 if the layer is not corrected */
  epe_fragment *fragments;
  size_t polygons;
  uint32_t *start; /* [polygons + 1]: first fragment of each polygon */
  eda_point *from; /* start of each fragment */
  double *site;    /* x and y of each measurement site, nm */
  size_t edges;
  uint32_t *edge; /* [edges + 1]: first fragment of each edge */
  uint8_t *state; /* EPE_NARROWED ... of each edge */
  epe_pair *pairs;
  size_t pair_count;

  /* Arrays with one element per fragment, in two blocks of memory. */
  double *reals;
  int32_t *integers;
  double *wanted; /* shift that the feedback requests, not rounded */
  double *gain;   /* measured gain of each site */
  epe_coupling coupling, transposed;
  double *work[5];        /* work arrays of steer.c */
  double *step;           /* largest change of the shift per iteration */
  double *side;           /* error to correct; at a site without an edge nearby,
                             only the sign is valid: that of the last measured
                             error or of the level set */
  double *error, *before; /* errors of the last and the previous simulation,
                             grid steps; NAN if no edge is near the site */
  double *cost;           /* measured |EPE|, nm */
  int32_t *shift, *last;  /* shifts of the last and the previous simulation */
  int32_t *best;          /* shifts of the best iteration */
  int32_t *low, *high;    /* bounds of the shift by the mask rules */
  int32_t *most;          /* largest outward shift */
  eda_box_list srafs;     /* assist features */
  epe_run *runs;    /* runs of each edge; those of edge e start at the index
                       of the first fragment of e */
  int32_t *settled; /* shifts of the next mask, computed in rules.c */
  uint8_t *broken;  /* [pair_count], 1: the fragments are too close */
} epe_layer;

/* Dissect the drawn shapes of layer `which` into fragments with sites and
   owners (cut.c). */
void epe_cut(epe_layer *layer, const eda_gates *gates, int which);
/* Free the arrays of a layer. */
void epe_clear(epe_layer *layer);

/* Place assist features and limit the shifts of fragments beside them
   (assist.c). Return OPC_OK or an error. */
int epe_place_srafs(epe_layer *layer, const eda_sraf_rule *rule,
                    const eda_shapes *drawn, opc_error *error);

/* Replace the assist features by `srafs`. Return 1 if they differ (assist.c).
 */
int epe_replace_srafs(epe_layer *layer, eda_boxes srafs);

/* Find the pairs of fragments whose distance may violate a rule (pairs.c). */
void epe_find_pairs(epe_layer *layer);
/* Narrow the bounds low and high of fragments that, in the mask of `shift`, are
   too close to each other or make an edge too short. `hard`: 1: their edges
   stay as drawn. Return the number of such pairs and edges (pairs.c). */
size_t epe_separate(epe_layer *layer, const int32_t *shift, int hard);

/* Set `shift` to shifts near layer->wanted that satisfy the mask rules
   (rules.c). */
void epe_settle(epe_layer *layer, int32_t *shift);

/* Average the errors and costs with those at two other doses, whose contours
   are at the levels +-`level` of the level set `print`. `weight`: weight of the
   other doses, 0 to 1; with 0, or if `print` is NULL, nothing changes. `grid`:
   mask grid, nm (window.c). */
void epe_weigh(epe_layer *layer, const eda_field *print, double weight,
               double level, double grid);

/* Compute the matrices `coupling` and `transposed` of a layer (couple.c).
   `grid`: mask grid, nm. */
void epe_couple(epe_layer *layer, double grid);

/* Parameters of epe_steer, which updates layer->wanted (steer.c). */
typedef struct epe_steering {
  double step;      /* largest change of a shift, grid steps */
  double damping;   /* fraction of the computed changes that is applied */
  double stiffness; /* weight of squared changes relative to squared errors */
} epe_steering;
void epe_steer(epe_layer *layer, const epe_steering *by);

/* Return the coordinate of fragment i along its axis, after the shifts `shift`.
   If `shift` is NULL, return the drawn coordinate. */
static inline int32_t epe_line(const epe_fragment *p, const int32_t *shift,
                               uint32_t i) {
  int32_t at = p[i].axis == EDA_X ? p[i].from.x : p[i].from.y;
  return at + (shift ? p[i].sign * shift[i] : 0);
}

/* Return the coordinate of a point along the edge of the fragment. */
static inline int32_t epe_along(const epe_fragment *p, eda_point at) {
  return p->axis == EDA_X ? at.y : at.x;
}

/* Return the coordinate of the begin or end of fragment i along the edge. At a
   corner, the shift of the fragment on the other side determines the
   coordinate. `shift` is as in epe_line. */
static inline int32_t epe_begin(const epe_fragment *p, const int32_t *shift,
                                uint32_t i) {
  return p[i].corner & EPE_FROM ? epe_line(p, shift, p[i].previous)
                                : epe_along(&p[i], p[i].from);
}

static inline int32_t epe_end(const epe_fragment *p, const int32_t *shift,
                              uint32_t i) {
  return p[i].corner & EPE_TO ? epe_line(p, shift, p[i].next)
                              : epe_along(&p[i], p[i].to);
}
