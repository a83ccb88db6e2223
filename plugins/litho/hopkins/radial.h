/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels of a rotationally symmetric transmission cross coefficient T
   (kernels.h): eigenfunctions (radial.c), coherent kernels (coherent.c), and
   residual (residual.c). */
#pragma once

#include "kernels.h"

/* Numbers of nodes and of tabulated values. A panel is an interval of the
   radius with its own Gauss-Legendre nodes. */
enum {
  PANELS = 4,
  FIRST = 8,  /* number of nodes of the panel in which the entire source passes
                 the pupil */
  OTHER = 56, /* largest number of nodes of each other panel */
  NODES = FIRST + (PANELS - 1) * OTHER,
  RINGS = 4, /* number of nodes of the source's radius between two breaks */
  SOURCE = (NODES + 1) * RINGS,
  ARC = 48,    /* number of nodes of an arc of a complex pupil */
  ANGLES = 48, /* number of angles, over 180 degrees, of each pair of nodes for
                  the fit of D */
  SHIFTS = 32, /* intervals of the table of D along |h| */
  TURNS = 5,   /* directions of the table of D */
  ORDERS = 32, /* number of angular orders */
  TABLE = 1024 /* intervals of a radial function's table */
};

/* A panel. */
typedef struct panel {
  double from, to;
  int first, n; /* index of the first node; number of nodes */
} panel;

/* Eigenvalue of an angular order, and its index in the order. */
typedef struct eigen {
  double value;
  int order, index;
} eigen;

/* A coherent kernel. If mask and pupil are real, a kernel of order m > 0
   represents the orders m and -m of one radial function, whose intensities are
   equal. A kernel of order 0 then contains two radial functions, as real and
   imaginary part. Otherwise each kernel contains one function of one order. */
typedef struct coherent {
  int order;
  float *re, *im; /* TABLE + 2 values each; im may be NULL: all values are 0 */
} coherent;

/* Radial kernels under construction. */
typedef struct radial {
  kernels base;
  const optics *o;
  double defocus;
  double sigma, sigma_in;
  int real;     /* 1: mask and pupil are real, kernels are combined in pairs */
  int scalar;   /* 1: scalar light. T(f, f) has a closed form; if `real`, also
                   T */
  size_t part;  /* part of polarised light that is being expanded (vector.h) */
  double whole; /* T(0, 0) before normalisation */
  panel panels[PANELS];
  int other;                         /* nodes of each panel after the first */
  int n, rings;                      /* total numbers of nodes */
  double node[NODES], weight[NODES]; /* radius, in units of the cutoff */
  double place[NODES],
      bary[NODES];    /* t of panel_place; weight in place_table */
  double root[NODES]; /* eigenvector divided by R */
  double ring[SOURCE], ring_weight[SOURCE]; /* nodes of the source's radius */
  double arc[ARC], arc_weight[ARC];         /* nodes and weights of an arc, on 0
                                               .. 1 */
  double *g[2], *t[2];  /* real and, unless `real`, imaginary part of g_m:
                           [order][node][ring]; of T_m: [order][node][node] */
  double *functions[2]; /* R: [order][index][node] */
  double *blend;        /* weights from nodes to table: [TABLE + 2][OTHER] */
  int begin[TABLE + 2]; /* first node of each row of `blend` */
  double at_node[NODES], diagonal[TABLE + 2]; /* T(f, f) */
  double *pairs;        /* T at pairs of every second node, [pair][angle]; NULL:
                           T is computed from the angular orders */
  double bound[ORDERS]; /* upper bound of each order's eigenvalues */
  int solved;           /* number of orders with known R */
  eigen *sorted;        /* eigenfunctions of solved orders, strongest first */
  size_t n_sorted;
  coherent *kernels;
  double *weights;
  float s_table[TABLE + 2];
  float d_table[(SHIFTS + 1) * TURNS];
} radial;

/* ---- radial.c ---- */

/* Solve orders until no other order can contribute to the first n kernels.
   Return the number of eigenfunctions in these kernels. */
size_t radial_solve(radial *r, size_t n);

/* Return R of an eigenfunction at the nodes: the real part (`part` 0) or the
   imaginary part (`part` 1). */
static inline const double *radial_function(const radial *r, const eigen *e,
                                            int part) {
  return r->functions[part] +
         ((size_t)e->order * (size_t)r->n + (size_t)e->index) * (size_t)r->n;
}

/* ---- coherent.c ---- */

/* Return T of scalar light in focus, in closed form, for frequencies of radius
   a and b, in units of the cutoff, and the angle between them. */
double radial_cross(const radial *r, double a, double b, double angle);

/* Members of `kernels` (kernels.h). */
void radial_keep(kernels *base, size_t n);
void radial_transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out);
eda_mirrored radial_mirror(const void *self, size_t s);

/* Free the coherent kernels in use. */
void radial_drop(radial *r);

/* ---- residual.c ---- */

/* Compute r->pairs for the pairs of node 2 i with the nodes 0, 2, ... 2 i. */
void radial_evaluate_pairs(void *self, size_t i);

/* Compute S and D of the residual without the first `kept` eigenfunctions. */
void radial_find_residual(radial *r, size_t kept);

/* Compute the transfer function of residual term `residual`; other parameters
   as for kernels.transfer. */
void radial_residual(const radial *r, size_t residual, const double *fx,
                     double fy, size_t n, float *out);

/* Implement kernels.filter. */
void radial_filter(const void *self, size_t residual, const double *fx,
                   double fy, size_t n, float *out);
