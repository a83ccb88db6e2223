/* SPDX-License-Identifier: BSD-3-Clause */
/* Interfaces between the files of regulator.drc. Boxes and int32_t lengths are
   in steps of the mask grid, lengths of type double in nm. The ruling is the
   result of the regulator after each simulation (eda/regulator.h). */
#pragma once

#include <eda/index.h>
#include <eda/regulator.h>
#include <eda/rules.h>
#include <opcflow/follow.h>

/* Sides of a box; also search directions. */
enum { LEFT, RIGHT, BELOW, ABOVE, SIDES };

/* Return 1 for LEFT and RIGHT. */
static inline int side_upright(int side) {
  return side == LEFT || side == RIGHT;
}
/* Return the opposite side. */
static inline int side_opposite(int side) { return side ^ 1; }

/* Boxes with a spatial index. An edge is a box of width or height 0. */
typedef struct places {
  eda_box *box;
  size_t n;
  eda_index *index;
} places;

/* Last measurement of a printed edge, for the response of the printed edge to
   displacements of the mask edge (rules_advance). */
typedef struct response {
  int32_t bias; /* displacement of the mask edge at the measurement */
  double value; /* measured extension or distance of the printed edge, nm */
  int seen;     /* 1: an earlier measurement exists */
} response;

/* Kinds of sites. */
enum {
  SITE_ENCLOSURE, /* a contact that the layer must cover */
  SITE_CONTACT,   /* a contact that poly must not touch */
  SITE_LINE,      /* a cross-section of a line, of length min_width, around the
                     centre of the drawn line */
  SITE_GAP        /* the centre between two facing edges of a layer */
};

/* A place at which the printed image is checked. */
typedef struct site {
  eda_box box;
  int32_t gate;   /* nearest gate, or -1 */
  int32_t repair; /* index in drc.repairs (SITE_GAP: drc.pairs), or -1 */
  uint16_t layer;
  uint8_t kind;
  uint8_t sides;   /* bit set of checked sides (1 << LEFT and so on); SITE_GAP:
                      only LEFT or BELOW, the direction across the gap */
  uint8_t failing; /* bit set of sides that failed the last check */
} site;

/* Line end of poly beyond an end of the width of gate i. The head is the
   widened part of a line end. Order: element 2 * i of drc.ends for the LOW end,
   2 * i + 1 for the HIGH end. */
typedef struct line_end {
  eda_box tip; /* drawn edge of the line end, a box of height or width
                  0 */
  int side;    /* outward direction; -1 if the gate has no line end there */
  int32_t most, by; /* largest and present outward displacement */
  int32_t share;    /* displacement that uses half of the drawn space in
                       front of the line end */
  int32_t limit;    /* largest displacement that neighbours permit at
                       present */
  int32_t start;    /* distance from the tip inwards to the begin of the head */
  int32_t widest, wider; /* largest and present widening of the head, per flank
                          */
  double requested; /* requested widening, nm, for which `widest` was computed;
                       INFINITY: the head must not be widened again */
  response length, width; /* responses of the printed extension to `by` and to
                             `wider` */
} line_end;

/* Repair of a site that failed at least once. A repair shape displaces a
   segment of the drawn edge on each side outwards. Arrays [SIDES]: distance
   from the site's box to the drawn edge (edge), ends of the segment along that
   edge (from, to), largest (limit) and present (grow) outward displacement. */
typedef struct repair {
  uint32_t site;
  int32_t edge[SIDES], from[SIDES], to[SIDES];
  int32_t limit[SIDES], grow[SIDES];
  uint8_t whole[SIDES]; /* 1: the segment is the entire edge */
  /* Active edges whose displacement by a gate's width displaces the corner at
     each end of the segment, or NULL. */
  const eda_fragment *corner[SIDES][2];
  uint32_t back[SIDES]; /* value of drc.round at the last reduction */
  double value[SIDES];  /* distance from the side outwards to the contour, nm */
  response response[SIDES];
  double flanked[SIDES]; /* `value` when the adjacent sides were last displaced
                            for this side; 0 if they were not displaced */
} repair;

/* A stretch of a drawn poly edge that is displaced inwards by a cut-out. */
typedef struct trim {
  eda_box wall;         /* the stretch, a box of width or height 0 */
  int side;             /* direction from the stretch to the gap */
  int32_t limit, depth; /* largest and present inward displacement */
  int32_t front;        /* half of the gap's width; the cut-out extends so far
                           into the gap, to remove repair shapes there */
  uint32_t round;       /* value of drc.round at the last displacement */
} trim;

/* A filled notch or a removed bump, replaced by a straight edge. The polygon is
   on the left of the edge from `from` to `to`. */
typedef struct smoothing {
  eda_box box;
  eda_point from, to;
  uint8_t bump, stays; /* bump: 1: bump, 0: notch; stays: 1: the straight edge
                          is on the mask */
} smoothing;

/* A list of smoothed places. */
typedef struct smoothings {
  smoothing *at;
  size_t n, capacity;
} smoothings;

/* The instance of regulator.drc. */
typedef struct drc {
  const opc_host *host;
  double overlay, min_extension, want_extension, max_growth, max_head;
  double min_space, min_width, min_mask_width, min_edge;

  const eda_gates *gates; /* gates to which all members below apply; NULL before
                             the first call */
  uint64_t serial;
  double grid;
  size_t layers;
  uint32_t iteration; /* last iteration processed */

  places *edges;              /* [layers]: drawn edges */
  places boxes;               /* boxes of the gates */
  places contacts;            /* contacts that poly must not touch */
  places pads;                /* contacts that poly must cover */
  places widths;              /* active edges at ends of gate widths */
  const eda_fragment **width; /* [widths.n]: fragments of `widths` */
  places mask;                /* poly edges of the present mask, computed on
                                 demand */
  char **bridging; /* [layers]: name of the violation if a gap prints */
  site *sites;
  size_t n_sites, sites_capacity;

  line_end *ends;
  repair *repairs;
  size_t n_repairs, repairs_capacity;
  trim *trims;
  size_t n_trims, trims_capacity;
  int32_t (*pairs)[2]; /* indices in `trims` of the two edges of a failed gap,
                          or -1 */
  size_t n_pairs, pairs_capacity;
  uint32_t round;         /* number of checked iterations */
  smoothings *smoothings; /* [layers], filled notches and removed bumps */
  int reverted;           /* number of bumps restored because their removal
                             created a notch */

  eda_box_list *added, *cutouts; /* [layers]: boxes added to the mask and cut
                                    out of the mask by the last ruling */
} drc;

/* A list of violations. `count` includes violations beyond the capacity. */
typedef struct violations {
  eda_violation *v;
  size_t capacity, count;
} violations;

/* ---- near.c: search by place ---- */

/* Return the box with two opposite corners. */
eda_box box_between(eda_point a, eda_point b);

/* Take ownership of `box`; build the index. `nm`: typical distance of a search
   by position. */
void places_init(places *p, eda_box *box, size_t n, double nm, double grid);
/* Free the boxes and the index. */
void places_clear(places *p);

/* Return all edges of the shapes in the order of their points. The caller frees
   the array with free(). */
eda_box *shapes_edges(const eda_shapes *shapes, size_t *n);

/* Return the box from `from` to `to` steps outwards of a side of `box`,
   extended by `beside` steps beyond both ends of the side. */
eda_box box_window(eda_box box, int side, int32_t from, int32_t to,
                   int32_t beside);

/* Return the distance, in direction `side`, from the edge of `window` opposite
   to `side` to the nearest box that overlaps the inside of the window; `none`
   if no box is nearer than `none`. `which` (may be NULL) receives the nearest
   box. */
int32_t places_nearest(const places *p, eda_box window, int side, int32_t none,
                       eda_box *which);

/* Return the largest displacement of an edge towards `side`, at most `most`,
   that keeps min_space to other poly of the present mask. */
int32_t mask_spacing(drc *r, const eda_printed *p, eda_box edge, int side,
                     int32_t most);

/* ---- rules.c ---- */

/* Return the bias of a mask edge at which a measured value of the printed edge
   is expected to reach `target` plus tuned.spare, nm. `value`: the value
   measured at `bias`, nm. The response is the slope between the last two
   measurements; after the first measurement, it is tuned.usual times `steep`.
   Store the measurement in `r`. */
int32_t rules_advance(response *r, int32_t bias, double value, double target,
                      double steep, double grid);
/* Append a violation to the list. */
void violations_add(violations *l, eda_violation v);

/* ---- sites.c: sites at which the image is checked ---- */

/* Find the sites of a layout. */
int sites_find(drc *r, opc_error *error);

/* ---- ends.c: displacements and heads of line ends ---- */

/* Find the line ends of a layout. */
void ends_find(drc *r);
/* Displace a line end outwards if the printed extension is too short, or widen
   the head if the line end is at its limit. `bias`: on entry the present
   displacement, on return the next displacement. */
void ends_advance(drc *r, const eda_printed *p, size_t end, int32_t *bias);
/* If a failing site is beyond an end of the nearest gate's width, reduce the
   head or the displacement of the line end at that end. From then on, the head
   grows no more, and the displacement by at most half of its reduction. `bias`:
   displacements of all line ends. Return 1 if the line end was reduced. */
int ends_revert(drc *r, const site *wrong, int32_t *bias);
/* Add the shapes of all heads to the ruling. */
void ends_add_heads(drc *r);
/* Return the name of the violation for an extension that is too short, with the
   cause. */
const char *ends_reason(const drc *r, size_t end);

/* ---- segments.c: segments of drawn edges that repair shapes displace ---- */

/* Return the repair shape on a side: a box from min_mask_width inside of the
   drawn edge to the present displacement. Its ends move with the adjacent
   corners. */
eda_box repair_shape(const drc *r, const eda_printed *printed,
                     const repair *one, int side);
/* Choose the segment to displace on a side: the entire edge, which adds no jog,
   or only the part in front of the site if that part may move further. */
void repair_find_edge(const drc *r, const site *s, repair *one, int side);
/* Displace only the part of an edge in front of the site, because displacing
   the entire edge caused bridging. */
void repair_keep_segment(const drc *r, const site *s, repair *one, int side);
/* Veto narrower gates whose width has displaced the active inwards at a failing
   side of a contact, if the repair cannot displace that side outwards. */
void repair_veto(const drc *r, const eda_printed *p, const repair *one,
                 uint32_t *vetoes);
/* Extend the segment in front of a contact to the corners of the drawn edge
   within tuned.corner, if the present displacement is permitted there, too. A
   segment may end before a corner if the contact extends over a concave corner:
   both edges of the corner are equally near, and the nearest edge that was
   found is perpendicular to the side. If the segment ends at these corners, a
   shape of poly is extended over `at`. This is a short edge of the mask, from
   the end of the shape to the next jog. */
void repair_extend(const drc *r, const eda_printed *printed, repair *one,
                   int side, const eda_rule_fault *at);

/* ---- repairs.c: failing sites and repair shapes ---- */

/* Check the sites on a printed image, and create repairs of failing sites. */
void repairs_check(drc *r, const eda_printed *p);
/* Enlarge repair shapes of failing sites. At a bridged gap or a touched
   contact, reduce the repair shapes that cause the fault, or trim poly
   edges. */
void repairs_grow(drc *r, const eda_printed *p);
/* Add the shapes of all repairs to the ruling. */
void repairs_add_shapes(drc *r, const eda_printed *p);
/* Report the failing sites, with the cause if they cannot be repaired. */
void repairs_report(const drc *r, const eda_printed *p, violations *out);

/* ---- trims.c: inward displacements of poly edges at bridged gaps, away from
   gates and contacts ---- */

/* Displace the edges on both sides of a failing gap inwards by one step, at
   most once per iteration. Return 1 if an edge was displaced. */
int trims_deepen(drc *r, site *gap);
/* Reduce the depth of trims that pinch a line, and limit the trims to the new
   depth. Return 1 if a trim was found. */
int trims_revert(drc *r, const site *line);
/* Return 1 if an edge of the gap can be displaced further inwards. */
int trims_can_deepen(const drc *r, const site *gap);
/* Add the cut-outs of all trims to the ruling. */
void trims_add_cutouts(drc *r);

/* ---- smooth.c: notches and bumps that violate the rules of the mask ---- */

/* Find notches narrower than min_space and bumps narrower than min_mask_width
   in the simulated masks, which include earlier smoothings. Notches will be
   filled, bumps removed. */
void smooth_masks(drc *r, const eda_printed *p);
/* Discard smoothings that touch a place where the mask violates its rules. The
   next iteration searches that place for notches and bumps again. */
void smooth_drop(drc *r, size_t layer, eda_box place);
/* Add filled notches and removed bumps to the ruling. */
void smooth_add_boxes(drc *r);

/* ---- mrc.c: rules of the mask ---- */

/* Faults of a layer. If `wanted` is 1, mrc_find sets `fault` to an array of n
   faults, which the caller frees with free(). */
typedef struct mrc_faults {
  int wanted;
  eda_rule_fault *fault;
  size_t n;
} mrc_faults;

/* Find widths below min_mask_width, spaces below min_space and edges below
   `min_edge` nm (0: no edges) in the merged shapes of the wanted layers, in
   parallel. */
void mrc_find(const drc *r, const eda_shapes *shapes, double min_edge,
              mrc_faults *faults);
/* Add the faults of the masks of all layers as violations. */
void mrc_check(const drc *r, const eda_shapes *shapes, violations *out);
