/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistors and the mask edges that move them. Data kinds "gates"
   (eda_gates) and "mask" (eda_mask). */
#ifndef EDA_GATES_H
#define EDA_GATES_H

#include <eda/devices.h>
#include <eda/geometry.h>
#include <eda/imaging.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The two layers that make transistors are always the first two, where there
   are transistors. All others are found by their names. */
enum { EDA_POLY = 0, EDA_ACTIVE = 1 };

/* Directions. A gate's axis is that of the current: EDA_X for a vertical poly
   line, whose L lies along x and W along y. */
enum { EDA_X = 0, EDA_Y = 1 };

/* What a fragment of a mask edge is to the transistor that owns it. LOW and
   HIGH are the sides of smaller and larger coordinate. */
enum {
  EDA_FIXED = 0, /* of no transistor: stays where it is drawn */
  EDA_L_LOW = 1, /* poly, along the gate */
  EDA_L_HIGH = 2,
  EDA_W_LOW = 3, /* active, along the current */
  EDA_W_HIGH = 4,
  EDA_END_LOW = 5, /* poly, the line end past the active */
  EDA_END_HIGH = 6
};

/* A piece of a mask edge, from `from` to the `from` of the next fragment of
   its polygon. Interior on the left (outlines counter-clockwise, holes
   clockwise), so that it moves outwards to its right. */
typedef struct eda_fragment {
  eda_point from;
  int32_t gate; /* -1: none */
  uint8_t role;
} eda_fragment;

/* The edges of a layer, all of them, cut into fragments. Polygon p has the
   fragments start[p] .. start[p+1]-1, in order. */
typedef struct eda_edges {
  size_t polygons;
  uint32_t *start;
  eda_fragment *fragments;
} eda_edges;

/* Figures of a transistor that a wish has a target for. */
enum { EDA_WISH_ION, EDA_WISH_IOFF, EDA_WISH_AREA, EDA_WISH_TARGETS };

/* How the correction of one transistor differs from that of others. */
typedef struct eda_wish {
  double weight; /* the tolerance is divided by it; 0: leave it as drawn */
  double target[EDA_WISH_TARGETS]; /* factors of what is drawn */
  uint8_t given; /* 1: the designer or a step set this wish; steps that make
                    wishes leave such a transistor alone */
} eda_wish;

/* The wish of a transistor that nobody made one for. */
static const eda_wish eda_wish_none OPC_UNUSED = {1, {1, 1, 1}, 0};

/* All transistors of a layout, flat, on a grid. Plain arrays; the order of the
   transistors is by lowest, then leftmost corner. A layout without transistors
   (count 0) can still be corrected for its edges. */
typedef struct eda_gates {
  char *name;     /* the top cell */
  double grid;    /* nm per unit: the mask grid */
  eda_box extent; /* of all drawn shapes */

  /* The layers, as many as the flow says. */
  size_t layers;
  char **layer;       /* names: "poly", "active", "contact", "metal1" */
  uint8_t *corrected; /* 1: its mask is corrected; 0: it only limits */
  eda_shapes *drawn;  /* merged */
  eda_edges *edges;   /* of drawn; empty if not corrected */

  size_t count;
  eda_box *box;           /* the drawn gate: poly and active together, on
                             the grid */
  uint8_t *type;          /* EDA_NMOS, EDA_PMOS */
  uint8_t *axis;          /* EDA_X, EDA_Y */
  double *length, *width; /* nm, as drawn: what performance is held against.
                             The grid may have given `box` others */
  /* The free space, nm, on the LOW and HIGH side along L, seen from the middle
     of W: to the next poly edge, but at most twice the distance to the end of
     the active there, or 2 L if that is more, and never more than
     EDA_SEGMENT_REACH; [2 * i + side]. A print that reaches further than half
     of it has merged. */
  double *space;
  /* How far the drawn poly goes past the active on the LOW and HIGH side along
     W, nm: to the transistor's own line end, which has a fragment END_LOW or
     END_HIGH; INFINITY where the poly turns or goes on; as [2 * i + side]. */
  double *extension;
  char **instance;  /* the path of its instance, "" at the top */
  char **cell;      /* the cell that draws it */
  uint32_t *number; /* within that instance, from 1 */
  /* The wish of each gate, from the notes of the layout or from a step.
     NULL: eda_wish_none for all. Since 0.8. */
  eda_wish *wish;

  void *texts; /* what the texts above point into; eda's own */

  /* No two that eda_gates_new made in a process have the same: whoever
     remembers something of gates sees by it that others have come to their
     place. 0: not made by that. Since 0.6. */
  uint64_t serial;

  /* Which of the process's transistors of its type each one is, as marker
     layers tell it: "lvt"; NULL for those that no marker covers. NULL: all are
     such. Since 0.6. */
  char **flavour;
} eda_gates;

/* Gates of `layers` layers and `count` transistors, all arrays zeroed and
   `wish` and `flavour` NULL. Whoever makes them fills in all else; shapes,
   edges and wishes come from eda_alloc, texts from eda_gates_text. [main] */
OPC_EXPORT eda_gates *eda_gates_new(size_t layers, size_t count);
/* Free them with all arrays and texts; the release of a port. NULL: nothing.
   [any] */
OPC_EXPORT void eda_gates_free(void *gates);

/* A copy of a text that lives as long as the gates; equal texts are one.
   [main] */
OPC_EXPORT char *eda_gates_text(eda_gates *gates, const char *text);

/* The path of the instance of transistor i, or its cell at the top. Names of
   transistors are OWNER:NUMBER. [any] */
OPC_UNUSED static inline const char *eda_gates_owner(const eda_gates *gates,
                                                     size_t i) {
  return *gates->instance[i] ? gates->instance[i] : gates->cell[i];
}

/* The wish of transistor i. [any] */
OPC_UNUSED static inline eda_wish eda_gates_wish(const eda_gates *gates,
                                                 size_t i) {
  return gates->wish ? gates->wish[i] : eda_wish_none;
}
/* Give gate i of `to` the wish of gate j of `from`. [main] */
OPC_EXPORT void eda_gates_take_wish(eda_gates *to, size_t i,
                                    const eda_gates *from, size_t j);

/* The flavour of transistor i; "" if it has none. [any] */
OPC_EXPORT const char *eda_gates_flavour(const eda_gates *gates, size_t i);
/* The same of gate i of `to` as of gate j of `from`. [main] */
OPC_EXPORT void eda_gates_take_flavour(eda_gates *to, size_t i,
                                       const eda_gates *from, size_t j);

/* The number of the layer of that name, -1 if there is none. [any] */
OPC_EXPORT int eda_gates_layer(const eda_gates *gates, const char *name);

/* OPC_OK if gates are sound: all arrays are there, layers have names of their
   own, transistors a size and a place, fragments a transistor. Else OPC_FAILED
   and *error; the check of a port. [any] */
OPC_EXPORT int eda_gates_check(const void *gates, opc_error *error);

/* A poly line of 60 nm over two actives, on a grid of 1 nm: an n-transistor of
   L 60, W 200 and a p-transistor of L 60, W 300, with their edges. For tests
   and for trying plugins out. Constant. [any] */
OPC_EXPORT const eda_gates *eda_gates_sample(void);

/* What the print of a transistor was found to be; flags, 0 is good. */
enum {
  EDA_PRINT_OPEN = 1 << 0,      /* the poly does not print all across */
  EDA_PRINT_NO_ACTIVE = 1 << 1, /* the active does not print */
  EDA_PRINT_MERGED = 1 << 2,    /* it reaches a neighbour */
  EDA_PRINT_SHORT = 1 << 3,     /* the line end stops before the active does */
  EDA_PRINT_ISLAND = 1 << 4,    /* poly or active prints in pieces there */
  /* The last four are worth a look, no failure. */
  EDA_PRINT_NECK = 1 << 5,    /* a slice is far shorter than the drawn gate */
  EDA_PRINT_WIDE = 1 << 6,    /* a slice is far longer than the drawn gate */
  EDA_PRINT_BITE = 1 << 7,    /* the active's edge is not straight in the
                                 channel */
  EDA_PRINT_OUTSIDE = 1 << 8, /* eda_performance.outside */
  EDA_PRINT_NOTES = 15 << 5   /* the flags that are no failure */
};

/* Performance of transistors, arrays of `count`. Currents A, lengths nm, area
   nm^2. A print that is open or has no active is no transistor: all its figures
   are 0. Whoever compares figures asks the flags first: of a 0 a deviation is
   -100 %, as if it were weak, while the line is too thin. Those of the other
   prints that fail tell which way to go, and no more. */
typedef struct eda_performance {
  size_t count;
  double *ion, *ioff;
  double *leq_ion, *leq_ioff; /* length of the rectangle with that current */
  double *weq;                /* its width */
  double *area;
  /* 1: figures come from beyond the ends of the device table, so that they are
     good for steering only; else 0. */
  uint8_t *outside;
} eda_performance;

/* Zeroed arrays of n in *performance; freeing them, and zeroing the struct;
   copying the figures of all to one of as many. [any] */
OPC_EXPORT void eda_performance_init(eda_performance *performance, size_t n);
OPC_EXPORT void eda_performance_clear(eda_performance *performance);
OPC_EXPORT void eda_performance_copy(eda_performance *to,
                                     const eda_performance *from);
/* The figures of transistor i alone. [any] */
OPC_EXPORT void eda_performance_one(eda_performance *to,
                                    const eda_performance *from, size_t i);

/* The figures of one transistor, as eda_performance has them. */
typedef struct eda_figures {
  double ion, ioff, leq_ion, leq_ioff, weq, area;
} eda_figures;

OPC_UNUSED static inline eda_figures eda_figures_of(const eda_performance *of,
                                                    size_t i) {
  eda_figures f = {of->ion[i],      of->ioff[i], of->leq_ion[i],
                   of->leq_ioff[i], of->weq[i],  of->area[i]};
  return f;
}

/* A part of a gate's width, from `from` to `to` grid steps along W from the LOW
   end of its box, in which the mask's length is `by` grid steps more. */
typedef struct eda_part {
  int32_t from, to, by;
} eda_part;

enum { EDA_PARTS = 18 }; /* of a gate at most */

/* As far as the fragments go, on either side. */
enum { EDA_PART_END = 1 << 20 };

/* In which directions a gate's biases are read backwards, as in a mirrored copy
   of a cell: along L, so that the LOW side takes the odd step of `l` and of
   parts, and the jog lies in the other side; along W, so that the LOW side
   takes the odd step of `w`, and the jog begins at the HIGH end. */
enum { EDA_FLIP_L = 1 << 0, EDA_FLIP_W = 1 << 1 };

/* How the edges of a mask were moved from where they are drawn, in grid steps:
   what another correction can begin with. `w`, `aside`, `l`, `jog` and `part`
   as eda_moves (synthesizer.h), `end` as eda_ruling (regulator.h), all along
   the axes of the gates as they lie, but for `flip`. */
typedef struct eda_moved {
  size_t layers, gates;
  int32_t *w, *aside, *l, *jog;
  int32_t *end;        /* [2 * i + side] */
  eda_part *part;      /* [EDA_PARTS * i + k] */
  uint8_t *flip;       /* EDA_FLIP_*, of each gate */
  eda_box_list *patch; /* [layers], what is added to the mask */
  eda_box_list *bite;  /* [layers], what is taken away after that */
  double *seen; /* [gates], by how much the logarithm of Ion in a print by the
                   optics' own image is known to be above that of a fine one; 0:
                   nothing is known. Since 0.6. */
} eda_moved;

/* Nothing is moved; freeing it (NULL: nothing). [any] */
OPC_EXPORT eda_moved *eda_moved_new(size_t layers, size_t gates);
OPC_EXPORT void eda_moved_free(eda_moved *moved);

/* A rule that a print does not keep. */
typedef struct eda_violation {
  /* "bridging", "extension", ... After "; " comes the reason why nothing can be
     moved to keep it: what is drawn, or a parameter, stands in the way. Without
     one it is a fault of the correction. Of a regulator: constant. */
  const char *rule;
  int32_t gate;        /* -1: none */
  double x, y;         /* nm */
  double value, limit; /* nm, or a count */
} eda_violation;

/* A corrected mask. The gates it was made from outlive it. What is added here
   is added to eda_mask_save, too. */
typedef struct eda_mask {
  const eda_gates *gates;
  size_t layers; /* gates->layers */
  /* [layers], empty for layers that are not corrected. */
  eda_shapes *shapes; /* on the grid of the gates; merged */
  eda_field *print;   /* level set of the corrected mask's print; empty if it
                         was not printed (since 0.6) */
  eda_performance design, before, after;
  uint32_t *flags; /* EDA_PRINT_* of each gate, at the end */
  uint32_t iterations;
  uint32_t simulations;      /* litho simulations, of one layer each */
  uint32_t fine_simulations; /* those of a finer model, beside them */
  /* [layers]: level set of the drawn mask's print; empty or NULL where
     it was not kept. Since 0.5. */
  eda_field *drawn_print;
  /* What a regulator found of the print, in its order. Since 0.5. */
  eda_violation *violations;
  size_t n_violations;
  /* What moved its edges; NULL if more than that did: edges that were cut into
     fragments, assist features, or a mask from elsewhere. Since 0.5. */
  eda_moved *moved;
} eda_mask;

/* A mask of these gates without shapes, prints, performance and flags: whoever
   makes it fills them in, from eda_alloc; freeing it with them, the release of
   a port (NULL: nothing); OPC_OK if all is there, else OPC_FAILED and *error,
   the check of a port. [any] */
OPC_EXPORT eda_mask *eda_mask_new(const eda_gates *gates);
OPC_EXPORT void eda_mask_free(void *mask);
OPC_EXPORT int eda_mask_check(const void *mask, opc_error *error);

/* Copies of violations, in place of those that the mask has. [main] */
OPC_EXPORT void eda_mask_set_violations(eda_mask *mask,
                                        const eda_violation *violations,
                                        size_t n);

/* Write all of a mask but its gates into FOLDER/mask, and make it again with
   equal gates: the same to the last bit, on this machine. OPC_IO, or OPC_FAILED
   for what is no such file, and *error; for `save` and `restore` of steps
   (opcflow/step.h). [any] */
OPC_EXPORT int eda_mask_save(const eda_mask *mask, const char *folder,
                             opc_error *error);
OPC_EXPORT int eda_mask_restore(const eda_gates *gates, const char *folder,
                                void **mask, opc_error *error);

/* For the initialiser of an opc_port (opcflow/step.h). */
#define EDA_PORT_GATES(port)                                 \
  {                                                          \
    .name = port, .kind = "gates", .check = eda_gates_check, \
    .release = eda_gates_free                                \
  }
#define EDA_PORT_MASK(port)                                \
  {                                                        \
    .name = port, .kind = "mask", .check = eda_mask_check, \
    .release = eda_mask_free                               \
  }

#ifdef __cplusplus
}
#endif
#endif
