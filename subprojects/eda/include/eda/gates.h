/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistors and the mask edges that move with them. Data kinds "gates"
   (eda_gates) and "mask" (eda_mask). */
#pragma once

#include <eda/devices.h>
#include <eda/geometry.h>
#include <eda/imaging.h>

OPC_C_BEGIN

/* The two layers that form transistors are always the first two, if there are
   transistors. All others are found by name. */
enum { EDA_POLY = 0, EDA_ACTIVE = 1 };

/* Directions. The axis of a gate is the direction of the current: EDA_X for a
   vertical poly line, with L along x and W along y. */
enum { EDA_X = 0, EDA_Y = 1 };

/* Role of a fragment of a mask edge for the transistor that owns the fragment.
   LOW and HIGH are the sides of smaller and larger coordinates. */
enum {
  EDA_FIXED = 0, /* no transistor: not moved */
  EDA_L_LOW = 1, /* poly, side along the gate */
  EDA_L_HIGH = 2,
  EDA_W_LOW = 3, /* active, side along the current */
  EDA_W_HIGH = 4,
  EDA_END_LOW = 5, /* poly, line end past the active */
  EDA_END_HIGH = 6
};

/* A fragment of a mask edge, from `from` to the `from` of the next fragment of
   its polygon. The interior is on the left (outlines counter-clockwise, holes
   clockwise); outward movement is to the right. */
typedef struct eda_fragment {
  eda_point from;
  int32_t gate; /* transistor; -1: none */
  uint8_t role;
} eda_fragment;

/* All edges of a layer, dissected into fragments. Polygon p has the fragments
   start[p] .. start[p+1]-1, in order. */
typedef struct eda_edges {
  size_t polygons;
  uint32_t *start;
  eda_fragment *fragments;
} eda_edges;

/* Figures of a transistor that a goal has a target for. */
enum { EDA_GOAL_ION, EDA_GOAL_IOFF, EDA_GOAL_AREA, EDA_GOAL_TARGETS };

/* How the correction of one transistor differs from that of others. */
typedef struct eda_goal {
  double weight; /* the tolerance is divided by it; 0: leave it as drawn */
  double target[EDA_GOAL_TARGETS]; /* factors relative to the drawn
                                      transistor */
  uint8_t given; /* 1: the designer or a step set this goal; steps that make
                    goals leave such a transistor alone */
} eda_goal;

/* The goal of a transistor that nobody made one for. */
static const eda_goal eda_goal_none OPC_UNUSED = {1, {1, 1, 1}, 0};

/* All transistors of a layout, flat, on a grid, in plain arrays ordered by
   lowest, then leftmost corner. A layout without transistors (count 0) can
   still be corrected for its edges. */
typedef struct eda_gates {
  char *name;     /* name of the top cell */
  double grid;    /* mask grid: nm per unit */
  eda_box extent; /* bounding box of all drawn shapes */

  /* The layers given by the flow. */
  size_t layers;
  char **layer;       /* names: "poly", "active", "contact", "metal1" */
  uint8_t *corrected; /* 1: the mask of the layer is corrected; 0: the layer
                         only limits others */
  eda_shapes *drawn;  /* merged */
  eda_edges *edges;   /* edges of `drawn`; empty if not corrected */

  size_t count;
  eda_box *box;           /* drawn gate: intersection of poly and active, on the
                             grid */
  uint8_t *type;          /* EDA_NMOS, EDA_PMOS */
  uint8_t *axis;          /* EDA_X, EDA_Y */
  double *length, *width; /* L and W as drawn, nm: the reference for
                             performance. `box` is rounded to the grid */
  /* Free space, nm, on the LOW and HIGH side along L, from the middle of W to
     the next poly edge; at most the larger of 2 L and twice the distance to the
     end of the active area there, and at most EDA_SEGMENT_REACH; [2 * i +
     side]. A printed edge further out than half the space has merged. */
  double *space;
  /* Extension of the drawn poly past the active, nm, at the LOW and HIGH end
     along W: [2 * i + side]. It ends at the transistor's own line end, which
     has a fragment END_LOW or END_HIGH; INFINITY where the poly turns or
     continues. */
  double *extension;
  char **instance;  /* path of the instance, "" at the top */
  char **cell;      /* cell that draws the transistor */
  uint32_t *number; /* number within the instance, from 1 */
  /* The goal of each gate, from the notes of the layout or from a step.
     NULL: eda_goal_none for all. Since 0.8. */
  eda_goal *goal;

  void *texts; /* storage of the texts above; private to eda */

  /* Serial number, different for all objects that eda_gates_new made in a
     process: caches use it to detect other gates at the same address. 0: not
     made by eda_gates_new. Since 0.6. */
  uint64_t serial;

  /* Flavour of each transistor by marker layers, such as "lvt"; NULL for
     transistors without a marker. NULL: no transistor has one. Since 0.6. */
  char **flavour;
} eda_gates;

/* Return gates with `layers` layers and `count` transistors, all arrays zeroed,
   `goal` and `flavour` NULL. The caller fills in the rest: shapes, edges and
   goals from eda_alloc, texts from eda_gates_text. [main] */
OPC_EXPORT eda_gates *eda_gates_new(size_t layers, size_t count);
/* Free gates with all arrays and texts (NULL: nothing); release function of an
   output. [any] */
OPC_EXPORT void eda_gates_free(void *gates);

/* Return a copy of a text that lives as long as the gates; equal texts share
   one copy. [main] */
OPC_EXPORT char *eda_gates_text(eda_gates *gates, const char *text);

/* Return the path of the instance of transistor i, or its cell at the top.
   Transistors are named OWNER:NUMBER. [any] */
OPC_UNUSED static inline const char *eda_gates_owner(const eda_gates *gates,
                                                     size_t i) {
  return *gates->instance[i] ? gates->instance[i] : gates->cell[i];
}

/* Return the goal of transistor i. [any] */
OPC_UNUSED static inline eda_goal eda_gates_goal(const eda_gates *gates,
                                                 size_t i) {
  return gates->goal ? gates->goal[i] : eda_goal_none;
}

/* Return the flavour of transistor i; "" if it has none. [any] */
OPC_EXPORT const char *eda_gates_flavour(const eda_gates *gates, size_t i);
/* Copy gate j of `from` to gate i of `to`, except its box, its names and its
   number. [main] */
OPC_EXPORT void eda_gates_copy(eda_gates *to, size_t i, const eda_gates *from,
                               size_t j);

/* Return the number of the layer with this name, -1 if there is none. [any] */
OPC_EXPORT int eda_gates_layer(const eda_gates *gates, const char *name);

/* Check gates: all arrays exist, layer names differ, transistors have a size
   and a position, fragments belong to a transistor. Return OPC_OK, or
   OPC_FAILED and *error; check function of an output. [any] */
OPC_EXPORT int eda_gates_check(const void *gates, opc_error *error);

/* Return a constant sample for tests and trials of plugins: a poly line of 60
   nm over two active areas on a grid of 1 nm. Its transistors, with their
   edges, are of type n with L 60, W 200 and of type p with L 60, W 300.
   [any] */
OPC_EXPORT const eda_gates *eda_gates_sample(void);

/* Faults of a printed transistor, as flags; 0: valid. */
enum {
  EDA_PRINT_OPEN = 1 << 0,      /* the poly does not print across the whole
                                   width */
  EDA_PRINT_NO_ACTIVE = 1 << 1, /* the active does not print */
  EDA_PRINT_MERGED = 1 << 2,    /* the printed poly reaches a neighbour */
  EDA_PRINT_SHORT = 1 << 3,     /* the line end does not reach past the
                                   active */
  EDA_PRINT_ISLAND = 1 << 4,    /* poly or active prints in pieces */
  /* The last four flags are warnings, not failures. */
  EDA_PRINT_NECK = 1 << 5,    /* a slice is far shorter than the drawn gate */
  EDA_PRINT_WIDE = 1 << 6,    /* a slice is far longer than the drawn gate */
  EDA_PRINT_NOTCH = 1 << 7,   /* the printed edge of the active is not straight
                                in the channel */
  EDA_PRINT_OUTSIDE = 1 << 8, /* as eda_performance.outside */
  EDA_PRINT_NOTES = 15 << 5   /* mask of the warning flags */
};

/* Return 1 if a print with these flags is no transistor of its own, else 0.
   [any] */
OPC_UNUSED static inline int eda_print_failed(uint32_t flags) {
  return (flags & ~(uint32_t)EDA_PRINT_NOTES) != 0;
}

/* Performance of transistors, arrays of `count`. Currents in A, lengths in nm,
   area in nm^2. A print that is open or has no active is not a transistor: all
   its figures are 0. Check the flags before comparing figures: 0 would read as
   a deviation of -100 %, a weak transistor, although the line is too thin.
   Figures of other failed prints show the direction of the deviation only. */
typedef struct eda_performance {
  size_t count;
  double *ion, *ioff;
  double *leq_ion, *leq_ioff; /* length of the rectangular gate with the same
                                 current */
  double *weq;                /* its width */
  double *area;
  /* 1: figures beyond the range of the device table, valid for steering only;
     otherwise 0. */
  uint8_t *outside;
} eda_performance;

/* Allocate zeroed arrays of n; free the arrays and clear the struct; copy all
   figures to a struct of the same size. [any] */
OPC_EXPORT void eda_performance_init(eda_performance *performance, size_t n);
OPC_EXPORT void eda_performance_clear(eda_performance *performance);
OPC_EXPORT void eda_performance_copy(eda_performance *to,
                                     const eda_performance *from);
/* Copy the figures of transistor i. [any] */
OPC_EXPORT void eda_performance_one(eda_performance *to,
                                    const eda_performance *from, size_t i);

/* The figures of one transistor, as in eda_performance. */
typedef struct eda_figures {
  double ion, ioff, leq_ion, leq_ioff, weq, area;
} eda_figures;

OPC_UNUSED static inline eda_figures eda_figures_of(const eda_performance *of,
                                                    size_t i) {
  eda_figures f = {of->ion[i],      of->ioff[i], of->leq_ion[i],
                   of->leq_ioff[i], of->weq[i],  of->area[i]};
  return f;
}

/* A part of the width of a gate with a mask length larger by `by` grid steps.
   `from` and `to` are grid steps along W from the LOW end of its box. */
typedef struct eda_part {
  int32_t from, to, by;
} eda_part;

enum { EDA_PARTS = 18 }; /* largest number of parts of a gate */

/* Extent to the end of the fragments, on either side. */
enum { EDA_PART_END = 1 << 20 };

/* Directions in which the biases of a gate are read reversed, as in a mirrored
   copy of a cell. Along L: the LOW side takes the odd step of `l` and of parts,
   and the jog is on the other side. Along W: the LOW side takes the odd step of
   `w`, and the jog begins at the HIGH end. */
enum { EDA_FLIP_L = 1 << 0, EDA_FLIP_W = 1 << 1 };

/* Displacements of a mask's edges from the drawn position, in grid steps: a
   starting point for another correction. `w`, `aside`, `l`, `jog` and `part` as
   in eda_moves (synthesizer.h), `end` as in eda_ruling (regulator.h), all along
   the axes of the gates as placed, except for `flip`. */
typedef struct eda_moved {
  size_t layers, gates;
  int32_t *w, *aside, *l, *jog;
  int32_t *end;          /* [2 * i + side] */
  eda_part *part;        /* [EDA_PARTS * i + k] */
  uint8_t *flip;         /* EDA_FLIP_* of each gate */
  eda_box_list *added;   /* [layers], shapes added to the mask */
  eda_box_list *cutouts; /* [layers], shapes cut out of the mask afterwards */
  double *seen; /* [gates], known excess of the logarithm of Ion in a fast
                   simulation over an accurate one; 0: unknown. Since 0.6. */
} eda_moved;

/* Return zeroed displacements; free displacements (NULL: nothing). [any] */
OPC_EXPORT eda_moved *eda_moved_new(size_t layers, size_t gates);
OPC_EXPORT void eda_moved_free(eda_moved *moved);

/* A violated design rule. */
typedef struct eda_violation {
  /* Name of the rule: "bridging", "extension", ... After "; " follows the
     reason why no move can satisfy the rule (the drawn shapes or a parameter
     prevent it). A violation without a reason is a fault of the correction.
     Constant, if from a regulator. */
  const char *rule;
  int32_t gate;        /* transistor; -1: none */
  double x, y;         /* nm */
  double value, limit; /* measured value and limit: nm, or a count */
} eda_violation;

/* A corrected mask. Its gates outlive the mask. Keep eda_mask_save complete
   when adding a field. */
typedef struct eda_mask {
  const eda_gates *gates;
  size_t layers; /* equals gates->layers */
  /* [layers], empty for layers that are not corrected. */
  eda_shapes *shapes; /* shapes on the grid of the gates, merged */
  eda_field *print;   /* level set of the simulated contour of the corrected
                         mask; empty if it was not simulated (since 0.6) */
  eda_performance design, before, after;
  uint32_t *flags; /* EDA_PRINT_* of each gate, for the corrected mask */
  uint32_t iterations;
  uint32_t simulations;      /* number of litho simulations of single layers */
  uint32_t fine_simulations; /* number of accurate simulations among the
                                others */
  /* [layers]: level set of the simulated contour of the drawn mask; empty or
     NULL where not kept. Since 0.5. */
  eda_field *drawn_print;
  /* Violations found by a regulator, in its order. Since 0.5. */
  eda_violation *violations;
  size_t n_violations;
  /* Edge displacements; NULL if the mask has others than these can describe:
     fragments of a synthesizer, assist features, or a mask from another source.
     Since 0.5. */
  eda_moved *moved;
} eda_mask;

/* Return a mask of these gates without shapes, prints, performance and flags,
   which the caller fills in from eda_alloc; free a mask and all its parts, as
   release function of an output (NULL: nothing); check that a mask is complete,
   as check function of an output: return OPC_OK, or OPC_FAILED and *error.
   [any] */
OPC_EXPORT eda_mask *eda_mask_new(const eda_gates *gates);
OPC_EXPORT void eda_mask_free(void *mask);
OPC_EXPORT int eda_mask_check(const void *mask, opc_error *error);

/* Replace the violations of a mask by copies of these. [main] */
OPC_EXPORT void eda_mask_set_violations(eda_mask *mask,
                                        const eda_violation *violations,
                                        size_t n);

/* Write a mask without its gates to FOLDER/mask, and read it again for equal
   gates, bit-identical on the same machine. For `save` and `restore` of steps
   (opcflow/step.h). Return OPC_IO, or OPC_FAILED for a file of another format,
   and *error. [any] */
OPC_EXPORT int eda_mask_save(const eda_mask *mask, const char *folder,
                             opc_error *error);
OPC_EXPORT int eda_mask_restore(const eda_gates *gates, const char *folder,
                                void **mask, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
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

OPC_C_END
