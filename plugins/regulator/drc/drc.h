/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of regulator.drc share. Boxes and int32_t lengths are in steps
   of the mask grid, doubles in nm. */
#ifndef REGULATOR_DRC_H
#define REGULATOR_DRC_H

#include <eda/index.h>
#include <eda/regulator.h>
#include <eda/rules.h>
#include <opcflow/follow.h>

/* The sides of a box, and of what is looked for from there. */
enum { LEFT, RIGHT, BELOW, ABOVE, SIDES };

static inline int upright(int side) { return side == LEFT || side == RIGHT; }
static inline int opposite(int side) { return side ^ 1; }

/* Boxes and an index of them; edges are flat ones. */
typedef struct places {
  eda_box *box;
  size_t n;
  eda_index *index;
} places;

/* What is known of how a print answers to a moved mask edge. */
typedef struct response {
  int32_t bias; /* of the mask at the print before */
  double value; /* what printed then */
  int seen;
} response;

enum {
  SITE_ENCLOSURE, /* a contact that its layer must cover */
  SITE_CONTACT,   /* a contact that poly must not touch */
  SITE_LINE,      /* across a line, as long as it must be wide */
  SITE_GAP        /* the middle between two edges of a layer */
};

/* A place where the print is looked at. */
typedef struct site {
  eda_box box;
  int32_t gate;   /* the nearest one, -1 for none */
  int32_t repair; /* its number (of a gap: of its pair of trims); -1: none */
  uint16_t layer;
  uint8_t kind;
  uint8_t sides;   /* those that are looked at, 1 << LEFT and so on; of a gap
                      the lower one of the two walls */
  uint8_t failing; /* at the last look */
} site;

/* Line end [2 * i + side]. */
typedef struct line_end {
  eda_box tip;           /* as drawn, flat */
  int side;              /* that it faces; -1: the gate has none */
  int32_t most, by;      /* how far it may go out, and was sent */
  int32_t share;         /* half of what is drawn free before it */
  int32_t room;          /* how far the others leave room now */
  int32_t start;         /* of its head, inwards of the tip */
  int32_t widest, wider; /* the same on each flank */
  double asked; /* nm: what widest was found for; INFINITY: it went back
                   and stays so */
  response length, width;
} line_end;

/* A site that failed once: by side, how far off the drawn edge is, the piece of
   it that a patch moves (along the edge), how far the mask may go past it, how
   far it goes, and what prints. */
typedef struct repair {
  uint32_t site;
  int32_t edge[SIDES], from[SIDES], to[SIDES];
  int32_t room[SIDES], grow[SIDES];
  uint8_t whole[SIDES]; /* that piece is the whole edge */
  /* What moves the corners at both ends of that piece, NULL for nothing. */
  const eda_fragment *corner[SIDES][2];
  uint32_t back[SIDES]; /* the round in which it last went back */
  double value[SIDES];  /* from the side of the box outwards to the contour */
  response response[SIDES];
  double flanked[SIDES]; /* what printed when the sides beside last went out for
                            it; 0: they did not */
} repair;

/* A stretch of a drawn edge of poly that goes back. */
typedef struct trim {
  eda_box wall;        /* the stretch, flat */
  int side;            /* of it, on which the gap lies */
  int32_t room, depth; /* how far it may go back, and does */
  int32_t front;       /* half of the gap, which patches are to leave as well */
  uint32_t round;      /* when it last went back */
} trim;

/* A notch or a bump, and the straight edge that is there instead, from `from`
   to `to`, with the shape on its left. */
typedef struct mend {
  eda_box box;
  eda_point from, to;
  uint8_t bump, stays;
} mend;

typedef struct mends {
  mend *at;
  size_t n, room;
} mends;

typedef struct drc {
  const opc_host *host;
  double overlay, min_extension, want_extension, max_growth, max_head;
  double min_space, min_width, min_mask_width;

  const eda_gates *gates; /* all below is of these; NULL: of none yet */
  uint64_t serial;
  double grid;
  size_t layers;
  uint32_t iteration; /* the last one seen */

  places *edges;              /* [layers]: drawn */
  places boxes;               /* of the gates */
  places contacts;            /* those that poly must not touch */
  places pads;                /* contacts that poly must cover */
  places widths;              /* edges of active that a gate's width moves */
  const eda_fragment **width; /* of each of them */
  places mask; /* edges of the poly that is looked at, once they are needed */
  char **bridging; /* [layers]: the rule that a gap of it breaks */
  site *sites;
  size_t n_sites, sites_room;

  line_end *ends;
  repair *repairs;
  size_t n_repairs, repairs_room;
  trim *trims;
  size_t n_trims, trims_room;
  int32_t (*pairs)[2]; /* trims on both sides of a gap that failed; -1: none
                        */
  size_t n_pairs, pairs_room;
  uint32_t round; /* of prints that were looked at */
  mends *mends;   /* [layers] */
  int undone;     /* how often one of them made way for another */

  eda_box_list *patch, *bite; /* [layers]: of the last ruling */
} drc;

/* A list of violations with room for some; all are counted. */
typedef struct violations {
  eda_violation *v;
  size_t room, count;
} violations;

/* ---- near.c: what lies near a place ---- */

eda_box box_between(eda_point a, eda_point b);

/* Takes over `box`; `nm` is about how far is looked. */
void places_init(places *p, eda_box *box, size_t n, double nm, double grid);
void places_clear(places *p);

/* All edges of the shapes, in the order of their points. */
eda_box *edges_of(const eda_shapes *shapes, size_t *n);

/* The window that lies outwards from a side, from `from` steps on to `to`,
   `beside` wider on both flanks. */
eda_box window_at(eda_box box, int side, int32_t from, int32_t to,
                  int32_t beside);

/* How far from the near edge of `window` the nearest box is that it overlaps
   inside, going to `side`, and which (may be NULL); `none` if there is none
   nearer. */
int32_t nearest(const places *p, eda_box window, int side, int32_t none,
                eda_box *which);

/* How far the mask's poly could go out from `edge`, a flat box of it, towards
   `side`, if nothing else moved; at most `most`. */
int32_t room_now(drc *r, const eda_printed *p, eda_box edge, int side,
                 int32_t most);

/* ---- rules.c ---- */

/* The bias that should bring `value` of a print with `bias` to `target` and a
   little more, `bias` or more: by the secant through the last two prints, or at
   first by a usual response, `steep` times that of an edge. Remembers this
   print. */
int32_t rules_advance(response *r, int32_t bias, double value, double target,
                      double steep, double grid);
void violations_add(violations *l, eda_violation v);

/* ---- sites.c: what is drawn, and where the print is looked at ---- */

int sites_find(drc *r, opc_error *error);

/* ---- ends.c: how far line ends go out, and how wide their heads are ---- */

void ends_find(drc *r);
/* Send a line end further out if the print wants it, or else make it wider.
   `bias` is where it is. */
void ends_advance(drc *r, const eda_printed *p, size_t end, int32_t *bias);
/* What must not print lies before a line end of the nearest gate: it goes back,
   and stays there. Whether it could. `bias` is that of all. */
int ends_back(drc *r, const site *wrong, int32_t *bias);
/* Add the patches of all heads. */
void ends_heads(drc *r);
/* Why the print of a line end is too short. */
const char *ends_reason(const drc *r, size_t end);

/* ---- repairs.c: what fails, and the patches that mend it ---- */

/* Look at the sites of a print. Repairs are made for those that fail and can be
   mended. */
void repairs_look(drc *r, const eda_printed *p);
/* Let patches grow where the print needs it, and edges go back that made poly
   print as one. */
void repairs_grow(drc *r, const eda_printed *p);
/* Add the patches of all. */
void repairs_patches(drc *r, const eda_printed *p);
/* The sites that fail, with the reason where they cannot be mended. */
void repairs_report(const drc *r, const eda_printed *p, violations *out);

/* ---- trims.c: edges of poly that go back where the gap before them does not
   print, those that no transistor and no contact needs ---- */

/* Let both sides of a gap that fails go back a little, at most once a print.
   Whether one could. */
int trims_deepen(drc *r, site *gap);
/* A line is pinched where its edges went back: they come out again, and stay.
   Whether there were any. */
int trims_back(drc *r, const site *line);
/* Whether a side of the gap could still go back. */
int trims_could(const drc *r, const site *gap);
/* Add what they take away. */
void trims_bites(drc *r);

/* ---- smooth.c: jogs so close together that the mask's own rules do not allow
   what is between them ---- */

/* Smooth the masks of a print, which have what was smoothed before: notches are
   filled and bumps taken away that are no deeper than they must be wide. */
void smooth_follow(drc *r, const eda_printed *p);
/* What was smoothed at a place of the mask that does not keep its rules is
   looked at anew. */
void smooth_drop(drc *r, size_t layer, eda_box place);
/* Add what is added to the masks and what is taken away. */
void smooth_boxes(drc *r);

/* ---- mrc.c: the rules of the mask itself ---- */

/* Where merged shapes are narrower than min_mask_width, or closer together than
   min_space; `fault` is freed with free(). Their number. */
size_t mrc_faults(const drc *r, const eda_shapes *shapes,
                  eda_rule_fault **fault);
/* The same as violations, of the masks of all layers. */
void mrc_check(const drc *r, const eda_shapes *shapes, violations *out);

#endif
