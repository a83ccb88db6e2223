/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels of a rotationally symmetric T: their eigenfunctions (radial.c) and
   the systems that are made of them (systems.c, rest.c). */
#ifndef OPCFLOW_HOPKINS_RADIAL_H
#define OPCFLOW_HOPKINS_RADIAL_H

#include "kernels.h"

enum {
  PANELS = 4,
  FIRST = 8,  /* nodes where the whole source passes the pupil */
  OTHER = 56, /* nodes of each panel beyond, at most */
  NODES = FIRST + (PANELS - 1) * OTHER,
  RINGS = 4, /* nodes of the source's radius between two breaks */
  SOURCE = (NODES + 1) * RINGS,
  ARC = 48,    /* nodes of an arc of a pupil that is not real */
  ANGLES = 48, /* between the pairs that D is fitted to, over half a turn */
  SHIFTS = 32, /* intervals of the table of D, along h; */
  TURNS = 5,   /* values in all directions */
  ORDERS = 32, /* angular orders */
  TABLE = 1024 /* intervals of a radial function's table */
};

typedef struct panel {
  double from, to;
  int first, n; /* nodes */
} panel;

typedef struct eigen {
  double value;
  int order, index;
} eigen;

/* A coherent system. For a real mask and pupil, the orders m and -m of one
   radial function (both have the same square), or two radial functions of order
   0 in real and imaginary part; else one function of one order. */
typedef struct coherent {
  int order;
  float *re, *im; /* TABLE + 2 values each; NULL: 0 */
} coherent;

typedef struct radial {
  kernels base;
  const optics *o;
  double defocus;
  double sigma, sigma_in;
  int real;    /* mask and pupil: systems come in pairs */
  int scalar;  /* light: T(f, f) is known in closed form; if `real`, all of T */
  size_t part; /* of the light, that is expanded (vector.h) */
  double whole; /* source: what T(0, 0) is before it is normalised */
  panel panels[PANELS];
  int other;                         /* nodes of the panels but the first */
  int n, rings;                      /* nodes in all */
  double node[NODES], weight[NODES]; /* radius, in units of the cutoff */
  double place[NODES], bary[NODES];  /* t of panel_place; see place_table */
  double root[NODES];                /* eigenvectors are R times this */
  double ring[SOURCE], ring_weight[SOURCE]; /* of the source's radius */
  double arc[ARC], arc_weight[ARC];         /* on 0 .. 1 */
  double *g[2], *t[2];  /* re and, unless real, im of g_m: [order][node][ring]
                           and T_m: [order][node][node] */
  double *functions[2]; /* R: [order][index][node] */
  double *blend; /* from values at nodes to a table: [TABLE + 2][OTHER] */
  int begin[TABLE + 2];                       /* the first of these nodes */
  double at_node[NODES], diagonal[TABLE + 2]; /* T(f, f) */
  double *pairs; /* T of every other node: [pair][angle]; NULL: by its orders */
  double bound[ORDERS]; /* no eigenvalue of the order is larger */
  int solved;           /* orders whose R are there */
  eigen *sorted;        /* of these orders, strongest first */
  size_t n_sorted;
  coherent *systems;
  double *weights;
  float s_table[TABLE + 2];
  float d_table[(SHIFTS + 1) * TURNS];
} radial;

/* ---- radial.c ---- */

/* Solve orders until no other one can be among the first n systems; the number
   of functions in these. */
size_t radial_solve(radial *r, size_t n);

/* R of an eigenfunction at the nodes, its real or imaginary part. */
static inline const double *radial_function(const radial *r, const eigen *e,
                                            int part) {
  return r->functions[part] +
         ((size_t)e->order * (size_t)r->n + (size_t)e->index) * (size_t)r->n;
}

/* ---- systems.c ---- */

/* T in closed form: of scalar light in focus. */
double radial_cross(const radial *r, double a, double b, double angle);

/* As in kernels.h. */
void radial_keep(kernels *base, size_t n);
void radial_transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out);
eda_mirrored radial_mirror(const void *self, size_t s);

/* Drop the systems that are used. */
void radial_drop(radial *r);

/* ---- rest.c ---- */

/* T of every other pair of nodes, those with node 2 i. */
void radial_evaluate_pairs(void *self, size_t i);

/* S and D of what is left when the first `kept` eigenfunctions are used. */
void radial_find_rest(radial *r, size_t kept);

/* The transfer function of system `rest` of them, as `transfer`. */
void radial_rest(const radial *r, size_t rest, const double *fx, double fy,
                 size_t n, float *out);

/* As in kernels.h. */
void radial_filter(const void *self, size_t rest, const double *fx, double fy,
                   size_t n, float *out);

#endif
