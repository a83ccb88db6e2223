/* SPDX-License-Identifier: BSD-3-Clause */
/* Interfaces between the files of regulator.drc. Boxes and int32_t lengths are
   in steps of the mask grid, lengths of type double in nm. */
#pragma once

#include <eda/index.h>
#include <eda/regulator.h>
#include <eda/rules.h>
#include <opcflow/follow.h>

/* Sides of a box; also search directions. */
enum { LEFT, RIGHT, BELOW, ABOVE, SIDES };

static inline int side_upright(int side) {
  return side == LEFT || side == RIGHT;
}
static inline int side_opposite(int side) { return side ^ 1; }

/* Boxes with a spatial index. An edge is a box of width or height 0. */
typedef struct places {
  eda_box *box;
  size_t n;
  eda_index *index;
} places;

/* Last measurement of a printed edge, from which rules_advance computes the
   response of the printed edge to moves of the mask edge. */
typedef struct response {
  int32_t bias; /* move of the mask edge at the last measurement */
  double value; /* figure of the printed edge at that bias, nm */
  int seen;
} response;

enum {
  SITE_ENCLOSURE, /* a contact that the layer must cover */
  SITE_CONTACT,   /* a contact that poly must not touch */
  SITE_LINE,      /* a cross-section of a line, min_width long, around the
                     middle of the drawn line */
  SITE_GAP        /* the point in the middle between two edges of a layer */
};

/* A place at which the printed image is checked. */
typedef struct site {
  eda_box box;
  int32_t gate;   /* nearest gate; -1: none */
  int32_t repair; /* index in drc.repairs (gap: in drc.pairs); -1: none */
  uint16_t layer;
  uint8_t kind;
  uint8_t sides;   /* set of checked sides, 1 << LEFT and so on; gap: LEFT or
                      BELOW */
  uint8_t failing; /* set of sides that failed the last check */
} site;

/* Line end beyond an end of the width of gate i: element 2 * i of drc.ends for
   the LOW end, 2 * i + 1 for the HIGH end. */
typedef struct line_end {
  eda_box tip;           /* drawn edge, flat */
  int side;              /* outward direction; -1: no line end */
  int32_t most, by;      /* largest and present outward move */
  int32_t share;         /* move that leaves an opposite line end half of the
                            spacing to the line end */
  int32_t limit;         /* largest move that neighbours allow at present */
  int32_t start;         /* length of the head inwards of the tip */
  int32_t widest, wider; /* largest and present growth of the head on each flank
                          */
  double requested; /* requested growth of the head, nm, for which `widest` was
                       computed; INFINITY: must not grow again */
  response length, width;
} line_end;

/* Repair of a site that failed at least once. A repair shape moves a segment of
   the drawn edge on each side outwards. [SIDES]: distance from the site's box
   to the drawn edge (edge), ends of the segment along that edge (from, to),
   largest (limit) and present (grow) outward move. */
typedef struct repair {
  uint32_t site;
  int32_t edge[SIDES], from[SIDES], to[SIDES];
  int32_t limit[SIDES], grow[SIDES];
  uint8_t whole[SIDES]; /* 1: the segment is the whole edge */
  /* Edges of active that a change of a gate's width moves, and with them the
     corners at both ends of the segment; NULL: none. */
  const eda_fragment *corner[SIDES][2];
  uint32_t back[SIDES]; /* drc.round of the last reduction */
  double value[SIDES];  /* nm from the side outwards to the contour */
  response response[SIDES];
  double flanked[SIDES]; /* `value` when the adjacent sides were last moved
                            outwards for this side; 0: never */
} repair;

/* A stretch of a drawn poly edge that moves inwards. */
typedef struct trim {
  eda_box wall;         /* the stretch, flat */
  int side;             /* direction from the stretch to the gap */
  int32_t limit, depth; /* largest and present inward move */
  int32_t front;        /* half of the width of the gap; the cut-out also
                           removes repair shapes there */
  uint32_t round;       /* drc.round of the last move */
} trim;

/* A filled notch or a removed bump. A straight edge replaces the notch or bump;
   the polygon is on the left of the edge from `from` to `to`. */
typedef struct smoothing {
  eda_box box;
  eda_point from, to;
  uint8_t bump, stays;
} smoothing;

typedef struct smoothings {
  smoothing *at;
  size_t n, capacity;
} smoothings;

typedef struct drc {
  const opc_host *host;
  double overlay, min_extension, want_extension, max_growth, max_head;
  double min_space, min_width, min_mask_width;

  const eda_gates *gates; /* gates of all data below; NULL: none yet */
  uint64_t serial;
  double grid;
  size_t layers;
  uint32_t iteration; /* last iteration processed */

  places *edges;              /* [layers]: drawn edges */
  places boxes;               /* boxes of the gates */
  places contacts;            /* contacts that poly must not touch */
  places pads;                /* contacts that poly must cover */
  places widths;              /* edges of active at ends of gate widths */
  const eda_fragment **width; /* [widths.n]: their fragments */
  places mask;                /* edges of poly on the present mask, on demand */
  char **bridging; /* [layers]: name of the rule that a bridged gap violates */
  site *sites;
  size_t n_sites, sites_capacity;

  line_end *ends;
  repair *repairs;
  size_t n_repairs, repairs_capacity;
  trim *trims;
  size_t n_trims, trims_capacity;
  int32_t (*pairs)[2]; /* indices in `trims` of the trims on both sides of a
                          failed gap; -1: none */
  size_t n_pairs, pairs_capacity;
  uint32_t round;         /* number of checked iterations */
  smoothings *smoothings; /* [layers] */
  int reverted;           /* number of removed bumps that were restored because
                             of a notch beside them */

  eda_box_list *added, *cutouts; /* [layers]: boxes added to the mask and boxes
                                    cut out by the last ruling */
} drc;

/* A list of violations. `count` includes violations beyond the capacity. */
typedef struct violations {
  eda_violation *v;
  size_t capacity, count;
} violations;

/* ---- near.c: search by place ---- */

eda_box box_between(eda_point a, eda_point b);

/* Take ownership of `box`; build the index. `nm`: typical search distance. */
void places_init(places *p, eda_box *box, size_t n, double nm, double grid);
void places_clear(places *p);

/* Return all edges of the shapes in the order of their points. The caller frees
   the array with free(). */
eda_box *shapes_edges(const eda_shapes *shapes, size_t *n);

/* Return the box that extends from `from` to `to` steps outwards of a side of
   `box`, and by `beside` steps beyond both ends of that side. */
eda_box box_window(eda_box box, int side, int32_t from, int32_t to,
                   int32_t beside);

/* Return the distance, in direction `side`, from the first edge of `window` to
   the nearest box that overlaps the inside of the window. Write that box to
   `which` (may be NULL). Return `none` if there is no nearer box. */
int32_t places_nearest(const places *p, eda_box window, int side, int32_t none,
                       eda_box *which);

/* Return the largest move of the edge `edge` towards `side`, at most `most`,
   that keeps min_space to the other poly of the present mask. */
int32_t mask_spacing(drc *r, const eda_printed *p, eda_box edge, int side,
                     int32_t most);

/* ---- rules.c ---- */

/* Return the bias at which the printed figure is expected to reach `target`
   plus a margin. `value`: the figure measured at `bias`, nm. The response is
   the slope between the last two measurements, initially `steep` times
   tuned.usual. Stores the measurement in `r`. */
int32_t rules_advance(response *r, int32_t bias, double value, double target,
                      double steep, double grid);
void violations_add(violations *l, eda_violation v);

/* ---- sites.c: sites at which the image is checked ---- */

int sites_find(drc *r, opc_error *error);

/* ---- ends.c: outward moves and heads of line ends ---- */

void ends_find(drc *r);
/* Move a line end outwards if the printed extension is too short, or widen the
   head if the line end cannot move. `bias`: present, then next move. */
void ends_advance(drc *r, const eda_printed *p, size_t end, int32_t *bias);
/* If a failing site is beyond an end of the nearest gate's width, move the line
   end there inwards and limit later moves to the new position. `bias`: moves of
   all line ends. Return whether the line end moved. */
int ends_revert(drc *r, const site *wrong, int32_t *bias);
/* Add the shapes of all heads to the ruling. */
void ends_add_heads(drc *r);
/* Return the reason for an extension that is too short. */
const char *ends_reason(const drc *r, size_t end);

/* ---- repairs.c: failing sites and repair shapes ---- */

/* Check the sites on a printed image; create repairs of failing sites. */
void repairs_check(drc *r, const eda_printed *p);
/* Enlarge repair shapes of failing sites. Reduce repair shapes, and trim edges
   of poly, that bridge a gap or touch a contact. */
void repairs_grow(drc *r, const eda_printed *p);
/* Add the shapes of all repairs to the ruling. */
void repairs_add_shapes(drc *r, const eda_printed *p);
/* Report the failing sites, with the reason if they cannot be repaired. */
void repairs_report(const drc *r, const eda_printed *p, violations *out);

/* ---- trims.c: inward moves of poly edges at bridged gaps, except for edges
   near gates and contacts ---- */

/* Move the edges on both sides of a failing gap inwards by one step, at most
   once per iteration. Return whether an edge moved. */
int trims_deepen(drc *r, site *gap);
/* Reduce the depth of trims that pinch a line, and limit them to the new depth.
   Return whether there were any. */
int trims_revert(drc *r, const site *line);
/* Return whether an edge of the gap can still move inwards. */
int trims_can_deepen(const drc *r, const site *gap);
/* Add the cut-outs of all trims to the ruling. */
void trims_add_cutouts(drc *r);

/* ---- smooth.c: notches and bumps that violate the rules of the mask ---- */

/* Find notches narrower than min_space, to be filled, and bumps narrower than
   min_mask_width, to be removed, in the masks of a printed image. The masks
   include the smoothings of earlier iterations. */
void smooth_masks(drc *r, const eda_printed *p);
/* Drop smoothings at a place where the mask violates its rules; the next
   iteration finds notches and bumps there again. */
void smooth_drop(drc *r, size_t layer, eda_box place);
/* Add filled notches and removed bumps to the ruling. */
void smooth_add_boxes(drc *r);

/* ---- mrc.c: rules of the mask ---- */

/* Find widths below min_mask_width and spaces below min_space of merged shapes.
   The caller frees `fault` with free(). Return the number of faults. */
size_t mrc_faults(const drc *r, const eda_shapes *shapes,
                  eda_rule_fault **fault);
/* Add the faults of the masks of all layers as violations. */
void mrc_check(const drc *r, const eda_shapes *shapes, violations *out);
