/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistors and the mask edges that control them. Data kinds (opcflow/step.h)
   "gates" (eda_gates) and "mask" (eda_mask). [any], [main]: opcflow/plugin.h.

   Terms. A gate is the area in which poly crosses active, and stands for its
   transistor. A fragment is a part of a mask edge that moves as a whole.
   "Drawn" are the shapes of the layout; the corrected mask has displaced edges.
   Figures of a transistor are Ion, Ioff, equivalent length and width, and area.
   A simulated contour is kept as a level set: a function of the plane that is
   positive where the layer prints. The slices of a gate are strips of the
   channel (extractor.h). Further terms: docs/reference/glossary.md. */
#pragma once

#include <eda/devices.h>
#include <eda/geometry.h>
#include <eda/imaging.h>

OPC_C_BEGIN

/* Numbers of the layers poly and active in a layout with transistors. Find all
   other layers by name. */
enum { EDA_POLY = 0, EDA_ACTIVE = 1 };

/* Axes. The axis of a gate is the direction of the channel current: EDA_X for a
   vertical poly line, with L along x and W along y. */
enum { EDA_X = 0, EDA_Y = 1 };

/* Role of a fragment of a mask edge for the transistor that controls the
   fragment. LOW and HIGH are the sides of smaller and larger coordinates. */
enum {
  EDA_FIXED = 0, /* no transistor: the fragment does not move */
  EDA_L_LOW = 1, /* poly, edge along W */
  EDA_L_HIGH = 2,
  EDA_W_LOW = 3, /* active, edge along L */
  EDA_W_HIGH = 4,
  EDA_END_LOW = 5, /* poly, line end beyond the active */
  EDA_END_HIGH = 6
};

/* A fragment of a mask edge: from the point `from` to the point `from` of the
   next fragment of the polygon. The interior is on the left (outlines
   counter-clockwise, holes clockwise); outward movement is to the right. */
typedef struct eda_fragment {
  eda_point from;
  int32_t gate; /* index of the transistor; -1: none */
  uint8_t role;
} eda_fragment;

/* All edges of a layer, dissected into fragments. Polygon p has the fragments
   start[p] .. start[p+1]-1, in order. */
typedef struct eda_edges {
  size_t polygons;
  uint32_t *start;
  eda_fragment *fragments;
} eda_edges;

/* Figures of a transistor for which a goal has targets. */
enum { EDA_GOAL_ION, EDA_GOAL_IOFF, EDA_GOAL_AREA, EDA_GOAL_TARGETS };

/* Individual goal of the correction of one transistor. */
typedef struct eda_goal {
  double weight; /* the synthesizer divides its tolerance, the largest deviation
                    that it does not correct, by the weight; 0: the transistor
                    is not corrected */
  double target[EDA_GOAL_TARGETS]; /* targets relative to the figures of the
                                      drawn transistor */
  uint8_t given; /* 1: the goal was set by the designer or by a step; steps that
                    set goals then skip this transistor */
} eda_goal;

/* Default goal. */
static const eda_goal eda_goal_none OPC_UNUSED = {1, {1, 1, 1}, 0};

/* All transistors of a flat layout on the mask grid, in arrays ordered by
   lowest, then leftmost corner. A layout without transistors (count 0) can be
   corrected for edge placement. */
typedef struct eda_gates {
  char *name;     /* name of the top cell */
  double grid;    /* mask grid: nm per unit */
  eda_box extent; /* bounding box of all drawn shapes, grid units */

  /* The layers. */
  size_t layers;
  char **layer;       /* names: "poly", "active", "contact", "metal1" */
  uint8_t *corrected; /* 1: the mask of the layer is corrected; 0: the layer
                         only restricts other layers */
  eda_shapes *drawn;  /* merged */
  eda_edges *edges;   /* edges of `drawn`; empty for layers that are not
                         corrected */

  size_t count;
  eda_box *box;           /* drawn gate: intersection of poly and active, on the
                             grid */
  uint8_t *type;          /* EDA_NMOS, EDA_PMOS */
  uint8_t *axis;          /* EDA_X, EDA_Y */
  double *length, *width; /* drawn L and W, nm, not rounded to the grid as
                             `box`; reference for performance */
  /* Free space beside the gate, nm, at [2 * i + side] (0: LOW, 1: HIGH):
     distance along L, at the middle of W, from the gate to the next poly edge.
     The space is limited to max(2 L, 2 d), d being the distance to the end of
     the active, and to EDA_SEGMENT_REACH (segment.h). A contour beyond half the
     space counts as merged. */
  double *space;
  /* Extension of the drawn poly beyond the active along W, nm, at [2 * i +
     side], up to a line end with a fragment EDA_END_LOW or EDA_END_HIGH of this
     transistor; INFINITY where the poly turns or continues. */
  double *extension;
  char **instance;  /* path of the instance; "": the top cell */
  char **cell;      /* cell that contains the transistor */
  uint32_t *number; /* number in the instance, from 1 */
  /* The goal of each gate; NULL: eda_goal_none for all. Since 0.8. */
  eda_goal *goal;

  void *texts; /* storage of the texts above; private to eda */

  /* Serial number of the object in this process. Caches compare this number to
     detect that an address now belongs to other gates. 0 if the object was not
     created by eda_gates_new. Since 0.6. */
  uint64_t serial;

  /* Flavour of each transistor: a device variant such as "lvt", identified by
     marker layers in the layout; NULL without marker. The array is NULL if no
     transistor has a flavour. Since 0.6. */
  char **flavour;
} eda_gates;

/* Return gates with `layers` layers and `count` transistors; arrays are zeroed,
   `goal` and `flavour` NULL. The caller allocates shapes, edges and goals by
   eda_alloc, texts by eda_gates_text. [main] */
OPC_EXPORT eda_gates *eda_gates_new(size_t layers, size_t count);
/* Free gates with all arrays and texts (NULL: do nothing); release function of
   an output of the data kind "gates". [any] */
OPC_EXPORT void eda_gates_free(void *gates);

/* Return a copy of a text, freed with the gates. Equal texts share one copy.
   [main] */
OPC_EXPORT char *eda_gates_text(eda_gates *gates, const char *text);

/* Return the OWNER in the name OWNER:NUMBER of transistor i: the path of its
   instance, or in the top cell the name of the cell. [any] */
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
/* Copy type, axis, sizes, space, extension, goal and flavour of gate j of
   `from` to gate i of `to`. [main] */
OPC_EXPORT void eda_gates_copy(eda_gates *to, size_t i, const eda_gates *from,
                               size_t j);

/* Return the number of the layer with this name, -1 if there is none. [any] */
OPC_EXPORT int eda_gates_layer(const eda_gates *gates, const char *name);

/* Check that all arrays exist, layer names differ, transistors have a size and
   a position, and fragments name existing transistors. Return OPC_OK, or
   OPC_FAILED and *error; check function of an output. [any] */
OPC_EXPORT int eda_gates_check(const void *gates, opc_error *error);

/* Return a constant sample for tests of plugins: a poly line over two active
   areas on a grid of 1 nm. The transistors are NMOS (L 60 nm, W 200 nm) and
   PMOS (L 60 nm, W 300 nm). [any] */
OPC_EXPORT const eda_gates *eda_gates_sample(void);

/* Faults of a printed transistor, as flags; 0: valid. */
enum {
  EDA_PRINT_OPEN = 1 << 0,      /* at one slice or more, the poly does not print
                                   in the middle of the drawn length */
  EDA_PRINT_NO_ACTIVE = 1 << 1, /* the active does not print in the middle of
                                   the gate */
  EDA_PRINT_MERGED = 1 << 2,    /* the printed poly or active has no edge up to
                                   half of the free space, or up to 300 nm
                                   beyond the drawn edge */
  EDA_PRINT_SHORT = 1 << 3,     /* the poly ends within the printed active */
  EDA_PRINT_ISLAND = 1 << 4,    /* poly or active prints as several shapes */
  /* The flags below are warnings, not failures. */
  EDA_PRINT_NECK = 1 << 5,  /* a slice is shorter than 0.75 times the drawn
                               length */
  EDA_PRINT_WIDE = 1 << 6,  /* a slice is longer than twice the drawn length */
  EDA_PRINT_NOTCH = 1 << 7, /* the printed edge of the active is not straight
                              in the channel */
  EDA_PRINT_OUTSIDE = 1 << 8, /* as eda_performance.outside */
  EDA_PRINT_NOTES = 15 << 5   /* mask of the warning flags */
};

/* Return 1 if flags contain a failure of a transistor, otherwise 0. [any] */
OPC_UNUSED static inline int eda_print_failed(uint32_t flags) {
  return (flags & ~(uint32_t)EDA_PRINT_NOTES) != 0;
}

/* Performance of transistors, arrays of `count`. Currents in A, lengths in nm,
   area of the channel in nm^2. With EDA_PRINT_OPEN or EDA_PRINT_NO_ACTIVE all
   figures are 0. Check the flags before comparing figures: a current of 0
   suggests a long gate, but the poly of an open gate is too thin. With other
   failures the figures indicate only the direction of a deviation. */
typedef struct eda_performance {
  size_t count;
  double *ion, *ioff;
  double *leq_ion, *leq_ioff; /* length of the rectangular gate with the same
                                 current */
  double *weq;                /* width of this rectangular gate */
  double *area;
  /* 1: figures beyond the range of the device table, valid for steering only;
     otherwise 0. */
  uint8_t *outside;
} eda_performance;

/* eda_performance_init: allocate zeroed arrays of n elements.
   eda_performance_clear: free the arrays. eda_performance_copy: copy all
   figures to a struct of the same `count`. [any] */
OPC_EXPORT void eda_performance_init(eda_performance *performance, size_t n);
OPC_EXPORT void eda_performance_clear(eda_performance *performance);
OPC_EXPORT void eda_performance_copy(eda_performance *to,
                                     const eda_performance *from);
/* Copy the figures of transistor i. [any] */
OPC_EXPORT void eda_performance_one(eda_performance *to,
                                    const eda_performance *from, size_t i);

/* Copy the figures of transistor j to transistor i. [any] */
OPC_EXPORT void eda_performance_take(eda_performance *to, size_t i,
                                     const eda_performance *from, size_t j);

/* The figures of one transistor, as in eda_performance. */
typedef struct eda_figures {
  double ion, ioff, leq_ion, leq_ioff, weq, area;
} eda_figures;

/* Return the figures of transistor i. [any] */
OPC_UNUSED static inline eda_figures eda_figures_of(const eda_performance *of,
                                                    size_t i) {
  eda_figures f = {of->ion[i],      of->ioff[i], of->leq_ion[i],
                   of->leq_ioff[i], of->weq[i],  of->area[i]};
  return f;
}

/* A part of the width of a gate where the mask is longer (L) by `by` grid
   steps. `from` and `to`: grid steps along W from the LOW end of the gate's
   box. */
typedef struct eda_part {
  int32_t from, to, by;
} eda_part;

enum { EDA_PARTS = 18 }; /* largest number of parts of a gate */

/* Values of eda_part: `from` = -EDA_PART_END and `to` = EDA_PART_END denote the
   LOW and the HIGH end of the gate's fragments. */
enum { EDA_PART_END = 1 << 20 };

/* Directions in which the biases of a gate are mirrored, as in a mirrored cell.
   Along L: the LOW edge moves by the odd step of `l` and of parts, and the jog
   is on the other side. Along W: the LOW edge moves by the odd step of `w`, and
   the jog begins at HIGH. */
enum { EDA_FLIP_L = 1 << 0, EDA_FLIP_W = 1 << 1 };

/* Displacements of mask edges from the drawn position, grid steps, for example
   as start of another correction. `w`, `aside`, `l`, `jog` and `part` are as in
   eda_moves (synthesizer.h), `end` as in eda_ruling (regulator.h). All are in
   layout coordinates, mirrored according to `flip`. */
typedef struct eda_moved {
  size_t layers, gates;
  int32_t *w, *aside, *l, *jog;
  int32_t *end;          /* [2 * i + side] */
  eda_part *part;        /* [EDA_PARTS * i + k] */
  uint8_t *flip;         /* EDA_FLIP_* of each gate */
  eda_box_list *added;   /* [layers], shapes added to the mask */
  eda_box_list *cutouts; /* [layers], shapes cut out of the mask after the
                            additions */
  double *seen; /* [gates], ln(Ion of a fast simulation / Ion of an accurate
                   simulation); 0 if unknown. Since 0.6. */
} eda_moved;

/* Return zeroed displacements for numbers of layers and gates.
   eda_moved_free: free displacements (NULL: do nothing). [any] */
OPC_EXPORT eda_moved *eda_moved_new(size_t layers, size_t gates);
OPC_EXPORT void eda_moved_free(eda_moved *moved);

/* A violated design rule. */
typedef struct eda_violation {
  /* RULE or "RULE; REASON". RULE is a name such as "bridging". REASON is
     present if drawn shapes or a parameter prevent any mask from satisfying the
     rule; otherwise the correction is at fault. A regulator returns constant
     texts. */
  const char *rule;
  int32_t gate;        /* index of the transistor; -1: none */
  double x, y;         /* position, nm */
  double value, limit; /* measured value and limit: nm, or a count */
} eda_violation;

struct eda_chip;   /* chip.h */
struct eda_layout; /* layout.h */
struct eda_mask;
struct eda_mask_part;

/* Receive a part of a mask, which is valid during the call. Other codes than
   OPC_OK end the visit. */
typedef int eda_mask_visit(void *data, const struct eda_mask_part *part,
                           opc_error *error);

/* Access to the shapes of a mask by classes (eda_mask, below). The functions
   find their data in eda_mask.data. Fields may be appended. */
typedef struct eda_mask_access {
  size_t size; /* of this struct */

  /* Make the flat mask of a window: the box `core` (grid units) and a margin.
     The mask owns its gates: the transistors that touch `core`, with the
     figures of their classes. The shapes are those of core and margin. The
     caller frees *out by eda_mask_free. [any] */
  int (*window)(const struct eda_mask *mask, eda_box core,
                struct eda_mask **out, opc_error *error);

  /* Return the mask, or the drawn shapes (`drawn` = 1), as a layout of cells
     and arrays. The layout is made by the first call and belongs to the mask.
     [main] */
  int (*layout)(const struct eda_mask *mask, int drawn,
                const struct eda_layout **out, opc_error *error);

  /* Make n flat masks out[n], one for each class: as `window`, with a core of
     `reach` nm around the transistor of the class. Simulate the contours of
     each mask and of the drawn shapes. The caller frees the masks by
     eda_mask_free; on failure all are NULL. [main] */
  int (*simulate)(const struct eda_mask *mask, const size_t *classes, size_t n,
                  double reach, struct eda_mask **out, opc_error *error);

  /* Implement eda_mask_each_class. `side`: largest width and height of a part,
     nm, without the margin of `reach` on each side. [main] */
  int (*each_class)(const struct eda_mask *mask, double reach,
                    eda_mask_visit *visit, void *data, opc_error *error);
  double side;
} eda_mask_access;

/* A corrected mask. The gates must outlive the mask. A new field must be added
   to eda_mask_save.

   A mask is flat or by classes. A flat mask has all shapes and all transistors.
   A mask by classes has `chip`. A class is a set of transistors whose masks are
   equal within the range of optical interaction. The gates of the mask have one
   transistor for each class, the lowest, then leftmost one. Figures, flags and
   displacements are those of the classes. Shapes, edges and contours are empty;
   `access` provides them by window. */
typedef struct eda_mask {
  const eda_gates *gates;
  size_t layers; /* equals gates->layers */
  /* The next two arrays are [layers], empty for uncorrected layers. */
  eda_shapes *shapes;     /* shapes on the grid of the gates, merged */
  eda_field *print;       /* level set of the simulated contour of the corrected
                             mask; empty if it was not simulated (since 0.6) */
  eda_performance design; /* figures of the transistors as drawn */
  eda_performance before; /* figures as printed from the drawn mask */
  eda_performance after;  /* figures as printed from the corrected mask */
  uint32_t *flags;        /* EDA_PRINT_* of each gate, for the corrected mask */
  uint32_t iterations;
  uint32_t simulations;      /* fast simulations, each of one layer */
  uint32_t fine_simulations; /* accurate simulations, each of one layer */
  /* [layers]: level set of the simulated contour of the drawn mask; empty or
     NULL where not kept. Since 0.5. */
  eda_field *drawn_print;
  /* Violations found by a regulator, in its order. Since 0.5. */
  eda_violation *violations;
  size_t n_violations;
  /* Edge displacements; NULL for a mask with edges displaced by fragment or
     with assist features, and for a mask from another source. Since 0.5. */
  eda_moved *moved;
  /* The next fields are NULL for a flat mask. Since 0.9. */
  struct eda_chip *chip;         /* all transistors, with their classes */
  uint32_t *count;               /* [gates->count], transistors of a class */
  eda_gates *own;                /* `gates`, if eda_mask_free frees them and
                                    `chip`; NULL: both belong to another mask */
  const eda_mask_access *access; /* valid while the mask exists */
  void *data;                    /* of `access`; not owned */
  struct eda_mask *flat;         /* made by eda_mask_flat; owned */
} eda_mask;

/* Return the number of transistors that gate i of a mask represents. [any] */
OPC_UNUSED static inline double eda_mask_count(const eda_mask *mask, size_t i) {
  return mask->count ? mask->count[i] : 1;
}

/* A flat mask that is a whole mask, or a part of a mask by classes. */
typedef struct eda_mask_part {
  const eda_mask *mask; /* figures and flags are those of the classes */
  /* Index of each gate in the gates of the whole mask; UINT32_MAX for a gate
     that is in this part only as a neighbour of others. NULL: the part is the
     whole mask. */
  const uint32_t *gate;
  double clear; /* width of the clear field that a simulation of the part needs
                   around it, nm; NAN: the width for a whole layout */
  size_t index, count; /* number of this part; number of parts */
} eda_mask_part;

/* Return the index of gate i of a part in the gates of the whole mask. [any] */
OPC_UNUSED static inline size_t eda_mask_part_gate(const eda_mask_part *part,
                                                   size_t i) {
  return part->gate ? part->gate[i] : i;
}

/* Visit flat masks (parts) that together contain one transistor of each class,
   to simulate these transistors. A part consists of clips of the layout side by
   side. Each clip has all shapes within `reach` nm of its transistor, and at
   least within the range of optical interaction. A flat mask is visited as a
   whole. [main] */
OPC_EXPORT int eda_mask_each_class(const eda_mask *mask, double reach,
                                   eda_mask_visit *visit, void *data,
                                   opc_error *error);

/* Return gates with the layers of the mask and the extent of the largest part
   of eda_mask_each_class, to forecast the simulation of a part. Pointers belong
   to the mask. [any] */
OPC_EXPORT eda_gates eda_mask_part_outline(const eda_mask *mask, double reach);

/* Visit strips of the layout, from bottom to top, with the shapes around each
   strip. Together the strips contain each transistor once, with its name, in
   the order of a flat mask. A flat mask is visited as a whole. [main] */
OPC_EXPORT int eda_mask_each_strip(const eda_mask *mask, eda_mask_visit *visit,
                                   void *data, opc_error *error);

/* Write a mask with all transistors and shapes to *out: `mask` itself if it is
   flat, otherwise a flat mask that belongs to `mask`. Flat masks of masks that
   share a chip (eda_mask_share) also share their gates. Call this only if the
   visits above do not suffice, and add eda_mask_flat_bytes to the forecast of
   memory. [main] */
OPC_EXPORT int eda_mask_flat(const eda_mask *mask, const eda_mask **out,
                             opc_error *error);
/* Return the memory that eda_mask_flat needs, bytes. [any] */
OPC_EXPORT double eda_mask_flat_bytes(const eda_mask *mask);

/* Let a new mask, created for the gates of `of`, use the chip and the access of
   `of`. Copy the numbers of transistors of the classes, and set the edge
   displacements if the new mask has none. Shapes and figures are not copied. Do
   nothing if `of` is flat. `of` must outlive the mask. [main] */
OPC_EXPORT void eda_mask_share(eda_mask *mask, const eda_mask *of);

/* eda_mask_new: return a mask without shapes, performance and flags, which the
   caller allocates by eda_alloc. eda_mask_free: free a mask with all arrays
   (NULL: do nothing). eda_mask_check: check that a mask is complete; return
   OPC_OK, or OPC_FAILED and *error. [any] */
OPC_EXPORT eda_mask *eda_mask_new(const eda_gates *gates);
OPC_EXPORT void eda_mask_free(void *mask);
OPC_EXPORT int eda_mask_check(const void *mask, opc_error *error);

/* Replace the violations of a mask by copies of violations[n]. [main] */
OPC_EXPORT void eda_mask_set_violations(eda_mask *mask,
                                        const eda_violation *violations,
                                        size_t n);

/* eda_mask_save: write a mask without its gates to FOLDER/mask. A mask by
   classes that owns its gates is written with chip and sizes to FOLDER/classes
   (read by eda_chip_mask_restore, chip.h). eda_mask_restore: read FOLDER/mask
   for gates equal to those of the saved mask; all data are bit-identical on the
   same machine. The caller frees *mask, also after a failure. For `save` and
   `restore` of steps (opcflow/step.h). Errors: OPC_IO; OPC_FAILED if the file
   has another format or belongs to other gates. [any] */
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
