/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistors and the mask edges that move them. Data kinds "gates"
   (opc_gates) and "mask" (opc_mask). */
#ifndef OPCFLOW_GATES_H
#define OPCFLOW_GATES_H

#include <opcflow/devices.h>
#include <opcflow/geometry.h>
#include <opcflow/imaging.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The layers that the print of a transistor depends on, and those that limit
   it. */
enum {
  OPC_POLY = 0,
  OPC_ACTIVE = 1,
  OPC_MASKS = 2,       /* the layers that are corrected: those above */
  OPC_CONTACT = 2,
  OPC_LAYERS = 3
};

/* Directions. A gate's axis is that of the current: OPC_X for a vertical poly
   line, whose L lies along x and W along y. */
enum { OPC_X = 0, OPC_Y = 1 };

/* What a fragment of a mask edge is to the transistor that owns it. LOW and
   HIGH are the sides of smaller and larger coordinate. */
enum {
  OPC_FIXED = 0,       /* of no transistor: stays where it is drawn */
  OPC_L_LOW = 1,       /* poly, along the gate */
  OPC_L_HIGH = 2,
  OPC_W_LOW = 3,       /* active, along the current */
  OPC_W_HIGH = 4,
  OPC_END_LOW = 5,     /* poly, the line end past the active */
  OPC_END_HIGH = 6
};

/* A piece of a mask edge, from `from` to the `from` of the next fragment of
   its polygon. Interior on the left (outlines counter-clockwise, holes
   clockwise), so that it moves outwards to its right. Frozen. */
typedef struct opc_fragment {
  opc_point from;
  int32_t gate;        /* -1: none */
  uint8_t role;
  uint8_t reserved[3];
} opc_fragment;

/* The edges of a layer, all of them, cut into fragments. Polygon p has the
   fragments start[p] .. start[p+1]-1, in order. */
typedef struct opc_edges {
  size_t polygons;
  uint32_t *start;
  opc_fragment *fragments;
} opc_edges;

/* All transistors of a layout, flat, on a grid. Plain arrays of `count`; the
   order is by lowest, then leftmost corner. Everything is allocated with
   host->alloc by who makes it. */
typedef struct opc_gates {
  size_t size;               /* sizeof(opc_gates) */
  const char *name;          /* the top cell */
  double grid;               /* nm per unit: the mask grid */
  opc_box extent;            /* of all drawn shapes of the three layers */
  opc_shapes drawn[OPC_LAYERS];   /* merged */
  opc_edges edges[OPC_MASKS];     /* of drawn[POLY] and drawn[ACTIVE] */

  size_t count;
  opc_box *box;              /* the drawn gate: poly and active together */
  uint8_t *type;             /* OPC_NMOS, OPC_PMOS */
  uint8_t *axis;             /* OPC_X, OPC_Y */
  double *length, *width;    /* nm */
  /* The free room, nm, on the LOW and HIGH side along L, seen from the middle
     of W: to the next poly edge, but at most twice the distance to the end of
     the active there, or 2 L if that is more; [2 * i + side]. A print that
     reaches further than half of it has merged. */
  double *room;
  /* How far the drawn poly goes past the active on the LOW and HIGH side along
     W, nm: to the transistor's own line end, which has a fragment END_LOW or
     END_HIGH; INFINITY where the poly turns or goes on; as [2 * i + side]. */
  double *extension;
  const char **instance;     /* the path of its instance, "" at the top */
  const char **cell;         /* the cell that draws it */
  uint32_t *number;          /* within that instance, from 1 */

  /* Since 1.2. What the layout's designer wrote upon each gate: a text of the
     layer of notes whose point lies in the gate's box, NULL where there is
     none. NULL: the layout has no such layer. */
  const char **note;
} opc_gates;

/* What the print of a transistor was found to be; flags, 0 is good. */
enum {
  OPC_PRINT_OPEN = 1 << 0,     /* the poly does not print all across */
  OPC_PRINT_NO_ACTIVE = 1 << 1,/* the active does not print */
  OPC_PRINT_MERGED = 1 << 2,   /* it reaches a neighbour */
  OPC_PRINT_SHORT = 1 << 3,    /* the line end stops before the active does */
  /* Since 1.1. The last three are worth a look, no failure. */
  OPC_PRINT_ISLAND = 1 << 4,   /* poly or active prints in pieces there */
  OPC_PRINT_NECK = 1 << 5,     /* a slice is far shorter than the drawn gate */
  OPC_PRINT_WIDE = 1 << 6,     /* a slice is far longer than the drawn gate */
  OPC_PRINT_BITE = 1 << 7,     /* the active's edge is not straight in the
                                  channel */
  OPC_PRINT_NOTES = 7 << 5     /* the flags that are no failure */
};

/* Performance of transistors, arrays of `count`. Currents A, lengths nm, area
   nm^2. Frozen. */
typedef struct opc_performance {
  size_t count;
  double *ion, *ioff;
  double *leq_ion, *leq_ioff;  /* length of the rectangle with that current */
  double *weq;                 /* its width */
  double *area;
} opc_performance;

/* A corrected mask. The gates it was made from outlive it. */
typedef struct opc_mask {
  size_t size;               /* sizeof(opc_mask) */
  const opc_gates *gates;
  opc_shapes shapes[OPC_MASKS];   /* on the grid of the gates; merged */
  opc_field print[OPC_MASKS];     /* level set of the corrected mask's print */
  opc_performance design, before, after;
  uint32_t *flags;           /* OPC_PRINT_* of each gate, at the end */
  uint32_t iterations;
  uint32_t simulations;      /* litho simulations, of one layer each */
} opc_mask;

#ifdef __cplusplus
}
#endif
#endif
