/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of netlist.match share. Coordinates are in units of the
   gates' grid. */
#ifndef OPCFLOW_NETLIST_MATCH_H
#define OPCFLOW_NETLIST_MATCH_H

#include <opcflow/circuit.h>
#include <opcflow/layout.h>

#include "../netlist.h"

/* Layers that conduct: poly, active, then metals; cuts join two of them.
   Number 2 + 2 k is metal k + 1 less one's cut: contact, metal1, via1 ... */
enum { POLY, ACTIVE, CONTACT, METAL1, METALS = 10, LAYERS = 2 + 2 * METALS };

/* (x, y) -> (xx x + xy y + dx, yx x + yy y + dy), from a cell to the top, in
   units of the layout. */
typedef struct transform {
  double xx, xy, yx, yy, dx, dy;
} transform;

/* A subcircuit of the netlist and the part of the layout that is it. */
typedef struct region {
  const scope *scope;
  int32_t cell;
  const char *path; /* of the instance in the layout; "" at the top */
  transform at;
  uint64_t first_device; /* of the flat netlist */
} region;

/* A net has two terminals at most on a gate's sides and one on the gate. */
typedef struct terminals {
  uint32_t gate, low, high;
} terminals;

typedef struct label {
  uint32_t net, group;
  const char *text;
} label;

typedef struct job {
  const opc_host *host;
  opc_error *error;
  pool pool;
  netlist netlist;
  const opc_layout *layout;
  int32_t top;
  const opc_gates *gates;
  int ignore_hierarchy;
  double tolerance;                          /* of sizes, as a fraction */
  int32_t layer[LAYERS], text_layer[LAYERS]; /* -1: none */

  size_t groups, room_groups;
  region *group;
  name_map group_of;  /* paths to groups */
  uint32_t *of_group; /* of each gate; UINT32_MAX: of none */

  terminals *terminals; /* of each gate: nets; those of a group are its own */
  size_t nets;
  uint32_t *known; /* of each net: its number in its group; UINT32_MAX */
  size_t labels, room_labels;
  label *label;
  size_t loose; /* labels that lie on nothing */

  flat_netlist flat; /* the whole netlist */
  uint32_t *owner;   /* of each gate: its device; UINT32_MAX none */
  size_t by_order;   /* choices that nothing but the order settled */
} job;

int match_no_memory(job *j);
/* "NAME:NUMBER", as it is told in messages. */
const char *match_gate_name(const job *j, size_t gate, char *buffer,
                            size_t room);

/* pairing.c: which subcircuit is which part of the layout. */
int match_pair(job *j, const scope *top);
/* The group that an instance lies in, by its path; UINT32_MAX: in none. */
uint32_t match_group_of(const job *j, const char *path);

/* extract.c: what is connected in the layout. */
int match_extract(job *j);

/* solve.c: the devices of all groups to their gates: j->owner. */
int match_solve(job *j);

/* ---- rectangles.c ---- */

typedef struct rectangle {
  opc_box box;
  uint32_t group;
} rectangle;

typedef struct rectangles {
  size_t count, room;
  rectangle *all;
} rectangles;

/* Cut a rectilinear polygon, which may cross itself, into rectangles. -1 where
   an edge is slanted, with its number. */
int match_cut(job *j, const opc_point *points, size_t n, uint32_t group,
              rectangles *out, size_t *slanted);
/* Take boxes away from rectangle `from`, into out. */
int match_subtract(job *j, const rectangle *from, const opc_box *boxes,
                   size_t n, rectangles *out);

/* Rectangles by place. */
typedef struct bins {
  const rectangles *of;
  double x0, y0, side;
  int32_t nx, ny;
  uint32_t *start, *item;
} bins;

int match_bins(job *j, const rectangles *of, bins *out);
/* Call `found` for each rectangle of the bins that touches the box, maybe more
   than once. */
void match_query(const bins *b, opc_box box,
                 void (*found)(void *data, uint32_t i), void *data);

/* How much two boxes share along x and y; negative if they lie apart. */
static inline void match_overlap(opc_box a, opc_box b, int64_t *dx,
                                 int64_t *dy) {
  *dx = (int64_t)(a.x1 < b.x1 ? a.x1 : b.x1) - (a.x0 > b.x0 ? a.x0 : b.x0);
  *dy = (int64_t)(a.y1 < b.y1 ? a.y1 : b.y1) - (a.y0 > b.y0 ? a.y0 : b.y0);
}

#endif
