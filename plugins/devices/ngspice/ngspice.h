/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of devices.ngspice. Lengths in nm, currents in A and
   capacitances in F of the simulated transistor. */
#pragma once

#include <eda/curves.h>
#include <eda/models.h>
#include <opcflow/step.h>

/* Measured quantities: the currents of eda/curves.h and the gate
   capacitance. */
enum { TYPES = 2, CGATE = EDA_CURRENTS, QUANTITIES };

/* Treatment of lengths outside of the models, or where a current does not
   increase with decreasing length. */
enum {
  CUT,    /* the table begins at the first valid length */
  REFUSE, /* an error */
  EXTEND, /* extrapolate the outermost model bins, then apply CUT */
  SLOPE   /* extrapolate the currents with their slope at the end */
};

/* Voltages of a measurement. */
typedef struct bias {
  double gate, drain; /* V, of the n-transistor; negated for the p-transistor */
} bias;

/* Parameters and data derived from parameters. */
typedef struct plan {
  const opc_host *host;
  const char *card[TYPES];  /* parameters: files */
  const char *model[TYPES]; /* model names in the files */
  const char *library, *corner, *osdi;
  int ends;
  opc_reals width_list;
  opc_map overrides;
  double supply, temperature, width; /* supply voltage, V; temperature, C;
                                        width, nm */
  double from, to, step;
  opc_reals list;
  bias bias[QUANTITIES]; /* CGATE: final gate voltage of the swing */
  int with_cgate;
  double reference_length, reference_width;    /* length NAN: no reference */
  const char *name, *file, *picture, *flavour; /* may be NULL */
  double limit;                                /* time limit of the simulator,
                                                  s */
  char *path[TYPES];  /* absolute paths of the cards or the library */
  eda_models *models; /* NULL if model cards are used */
  size_t count;
  double *length; /* [count], increasing lengths */
  size_t widths;
  double *each_width; /* [widths], increasing widths; the last one is `width` */
} plan;

/* Results of the simulations. */
typedef struct currents {
  /* measured values, [width * count + length] */
  double *at[TYPES][QUANTITIES];
  double reference[TYPES][QUANTITIES];
  char simulator[32]; /* version of the simulator, such as "ngspice-39" */
  size_t first;       /* first length of the table, index in plan.length */
  /* First length simulated at all widths; shorter lengths are extrapolated. */
  size_t simulated[TYPES];
  size_t cut[TYPES][QUANTITIES]; /* first valid length that a warning reported;
                                    0 if no warning was logged */
  double narrowest[TYPES]; /* nm; narrower widths are extrapolated; 0 if no
                              width is extrapolated */
} currents;

/* Return the number of quantities. */
static inline int plan_quantities(const plan *p) {
  return p->with_cgate ? QUANTITIES : EDA_CURRENTS;
}

/* Return the values of the widest transistor, per length. */
static inline const double *currents_widest(const plan *p, const currents *c,
                                            int type, int current) {
  return c->at[type][current] + (p->widths - 1) * p->count;
}

/* ---- simulate.c ---- */

/* Simulate all transistors and find the first length of the table. The caller
   allocates the arrays of `out`, set to zero. */
int simulate(const plan *p, currents *out, opc_error *error);

/* ---- table.c ---- */

/* Describe the extrapolated part of the table in `text`. Return FALSE if
   nothing is extrapolated. */
int table_extended(const plan *p, const currents *c, char *text,
                   size_t capacity);

/* Write the device table to the output file `name`. */
int table_write(const plan *p, const currents *c, const char *name,
                opc_error *error);

/* Return the relative slope of a current at a length, % per nm, from the
   logarithms at the adjacent lengths of the table; NAN outside of the table. */
double table_slope(const plan *p, const currents *c, int type, int current,
                   double length);

/* ---- picture.c ---- */

/* Draw the currents of device table `name` to the picture. */
int picture_draw(const plan *p, const currents *c, const char *name,
                 opc_error *error);
