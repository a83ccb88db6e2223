/* SPDX-License-Identifier: BSD-3-Clause */
/* Interfaces between the files of regulator.drc. Boxes and int32_t lengths are
   in steps of the mask grid, doubles in nm. */
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

/* Boxes with an index; edges are flat boxes. */
typedef struct places {
  eda_box *box;
  size_t n;
  eda_index *index;
} places;

/* Measured response of a printed edge to moves of the mask edge. */
typedef struct response {
  int32_t bias; /* bias of the mask at the last measurement */
  double value; /* printed figure at that bias */
  int seen;
} response;

enum {
  SITE_ENCLOSURE, /* a contact that the layer must cover */
  SITE_CONTACT,   /* a contact that poly must not touch */
  SITE_LINE,      /* a cross-section of a line, of the length of the least
                     width */
  SITE_GAP        /* the middle between two edges of a layer */
};

/* A place at which the printed image is checked. */
typedef struct site {
  eda_box box;
  int32_t gate;   /* nearest gate; -1: none */
  int32_t repair; /* index of the repair (gap: of the pair of trims); -1:
                     none */
  uint16_t layer;
  uint8_t kind;
  uint8_t sides;   /* checked sides, 1 << LEFT and so on; of a gap the lower one
                      of the two walls */
  uint8_t failing; /* sides that fail the last check */
} site;

/* Line end [2 * i + side]. */
typedef struct line_end {
  eda_box tip;           /* drawn edge, flat */
  int side;              /* direction; -1: the gate has no line end */
  int32_t most, by;      /* largest and present outward move */
  int32_t share;         /* half of the drawn spacing before the line end */
  int32_t limit;         /* largest move that neighbours allow at present */
  int32_t start;         /* begin of the head, inwards of the tip */
  int32_t widest, wider; /* largest and present width of the head on each
                            flank */
  double requested; /* nm: request for which `widest` was computed; INFINITY:
                       the head was reduced and stays so */
  response length, width;
} line_end;

/* Repair of a site that failed at least once. By side: distance of the drawn
   edge, segment of that edge that a repair shape moves (along the edge),
   largest and present outward move, and measured contour. */
typedef struct repair {
  uint32_t site;
  int32_t edge[SIDES], from[SIDES], to[SIDES];
  int32_t limit[SIDES], grow[SIDES];
  uint8_t whole[SIDES]; /* 1: the segment is the whole edge */
  /* Edges of the gate width that move the corners at both ends of the segment;
     NULL: none. */
  const eda_fragment *corner[SIDES][2];
  uint32_t back[SIDES]; /* round of the last reduction */
  double value[SIDES];  /* from the side of the box outwards to the contour */
  response response[SIDES];
  double flanked[SIDES]; /* contour when the adjacent sides last moved outwards
                            for this one; 0: never */
} repair;

/* A stretch of a drawn poly edge that moves inwards. */
typedef struct trim {
  eda_box wall;         /* the stretch, flat */
  int side;             /* side of the stretch on which the gap is */
  int32_t limit, depth; /* largest and present inward move */
  int32_t front;        /* half of the gap, which repair shapes must leave free
                           too */
  uint32_t round;       /* round of the last move */
} trim;

/* A filled notch or removed bump, and the straight edge that replaces it, from
   `from` to `to`, with the shape on the left. */
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

  const eda_gates *gates; /* gates to which all data below belong; NULL: none
                             yet */
  uint64_t serial;
  double grid;
  size_t layers;
  uint32_t iteration; /* last iteration processed */

  places *edges;              /* [layers]: drawn edges */
  places boxes;               /* boxes of the gates */
  places contacts;            /* contacts that poly must not touch */
  places pads;                /* contacts that poly must cover */
  places widths;              /* edges of active that the width of a gate
                                 moves */
  const eda_fragment **width; /* fragment of each of them */
  places mask;     /* edges of poly on the present mask, built on demand */
  char **bridging; /* [layers]: name of the rule violated by a bridged gap */
  site *sites;
  size_t n_sites, sites_capacity;

  line_end *ends;
  repair *repairs;
  size_t n_repairs, repairs_capacity;
  trim *trims;
  size_t n_trims, trims_capacity;
  int32_t (*pairs)[2]; /* trims on both sides of a failed gap; -1: none */
  size_t n_pairs, pairs_capacity;
  uint32_t round;         /* number of checked iterations */
  smoothings *smoothings; /* [layers] */
  int reverted;           /* number of smoothed jogs reverted for another one */

  eda_box_list *added, *cutouts; /* [layers]: shapes added and cut out by the
                                   last ruling */
} drc;

/* A list of violations of limited capacity; `count` includes those that do not
   fit. */
typedef struct violations {
  eda_violation *v;
  size_t capacity, count;
} violations;

/* ---- near.c: search by place ---- */

eda_box box_between(eda_point a, eda_point b);

/* Take ownership of `box` and build the index; `nm` is the typical search
   distance. */
void places_init(places *p, eda_box *box, size_t n, double nm, double grid);
void places_clear(places *p);

/* Return all edges of the shapes in the order of their points. The caller frees
   the array. */
eda_box *shapes_edges(const eda_shapes *shapes, size_t *n);

/* Return the window outwards of a side, from `from` to `to` steps, extended by
   `beside` on both flanks. */
eda_box box_window(eda_box box, int side, int32_t from, int32_t to,
                   int32_t beside);

/* Return the distance from the near edge of `window` to the nearest box that
   overlaps the inside, in direction `side`, and that box in `which` (may be
   NULL); `none` if there is no nearer box. */
int32_t places_nearest(const places *p, eda_box window, int side, int32_t none,
                       eda_box *which);

/* Return the largest move of the flat box `edge` towards `side` for which poly
   on the present mask keeps the space, if nothing else moves; at most
   `most`. */
int32_t mask_spacing(drc *r, const eda_printed *p, eda_box edge, int side,
                     int32_t most);

/* ---- rules.c ---- */

/* Return the bias, `bias` or more, at which the printed figure `value` is
   expected to reach `target` plus a margin. The response is the secant through
   the last two measurements, initially `steep` times the typical one of an
   edge. The measurement is stored in `r`. */
int32_t rules_advance(response *r, int32_t bias, double value, double target,
                      double steep, double grid);
void violations_add(violations *l, eda_violation v);

/* ---- sites.c: sites at which the image is checked ---- */

int sites_find(drc *r, opc_error *error);

/* ---- ends.c: outward moves and heads of line ends ---- */

void ends_find(drc *r);
/* Move a line end outwards if its printed extension is too short, or widen the
   head if the line end cannot move. `bias` is the present move. */
void ends_advance(drc *r, const eda_printed *p, size_t end, int32_t *bias);
/* Move back the line end of the nearest gate if the failing site is before that
   line end, and limit the move there. `bias` has the moves of all line ends.
   Return whether the line end moved. */
int ends_revert(drc *r, const site *wrong, int32_t *bias);
/* Add the shapes of all heads to the ruling. */
void ends_add_heads(drc *r);
/* Return the reason for an extension that is too short. */
const char *ends_reason(const drc *r, size_t end);

/* ---- repairs.c: failing sites and repair shapes ---- */

/* Check the sites on a printed image. Create repairs for failing sites that can
   be repaired. */
void repairs_check(drc *r, const eda_printed *p);
/* Enlarge repair shapes of failing sites, and reduce shapes and edges that
   bridge. */
void repairs_grow(drc *r, const eda_printed *p);
/* Add the shapes of all repairs to the ruling. */
void repairs_add_shapes(drc *r, const eda_printed *p);
/* Report the failing sites, with the reason if they cannot be repaired. */
void repairs_report(const drc *r, const eda_printed *p, violations *out);

/* ---- trims.c: edges of poly that move inwards before bridged gaps; edges that
   a transistor or a contact needs do not ---- */

/* Move both sides of a failing gap inwards by one step, at most once per
   iteration. Return whether a side could move. */
int trims_deepen(drc *r, site *gap);
/* Move edges outwards again whose trims pinch a line, and fix them there.
   Return whether there were any. */
int trims_revert(drc *r, const site *line);
/* Return whether a side of the gap can still move inwards. */
int trims_can_deepen(const drc *r, const site *gap);
/* Add the cut-outs of all trims to the ruling. */
void trims_add_cutouts(drc *r);

/* ---- smooth.c: notches and bumps that violate the rules of the mask ---- */

/* Smooth the masks of a printed image, which include earlier smoothing: fill
   notches and remove bumps whose depth is at most the least width. */
void smooth_masks(drc *r, const eda_printed *p);
/* Drop smoothed jogs at a place where the mask violates its rules; the next
   iteration finds them anew. */
void smooth_drop(drc *r, size_t layer, eda_box place);
/* Add filled notches and removed bumps to the ruling. */
void smooth_add_boxes(drc *r);

/* ---- mrc.c: rules of the mask ---- */

/* Find widths below min_mask_width and spaces below min_space of merged shapes.
   The caller frees `fault` with free(). Return the number of faults. */
size_t mrc_faults(const drc *r, const eda_shapes *shapes,
                  eda_rule_fault **fault);
/* Add the same, for the masks of all layers, as violations. */
void mrc_check(const drc *r, const eda_shapes *shapes, violations *out);
