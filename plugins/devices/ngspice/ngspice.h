/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of devices.ngspice. Lengths in nm, currents in A and capacitances
   in F of the transistor that was simulated. */
#pragma once

#include <eda/curves.h>
#include <eda/models.h>
#include <opcflow/step.h>

/* What is measured: eda's currents and, if told to, the capacitance of the
   gate. */
enum { TYPES = 2, CGATE = EDA_CURRENTS, QUANTITIES };

/* Where the models end, or a current that has to rise with decreasing length
   does not. */
enum {
  CUT,    /* the table begins there */
  REFUSE, /* an error */
  EXTEND, /* the outermost bins go on; then as CUT */
  SLOPE   /* the currents go on with the slope that they have there */
};

typedef struct bias {
  double gate, drain; /* V, of the n-transistor; the p-transistor has -V */
} bias;

/* What is to be simulated. */
typedef struct plan {
  const opc_host *host;
  const char *card[TYPES];  /* parameters: files */
  const char *model[TYPES]; /* names in them */
  const char *library, *corner, *osdi;
  int ends;
  opc_reals width_list;
  opc_map overrides;
  double supply, temperature, width; /* V, C, nm */
  double from, to, step;
  opc_reals list;
  bias bias[QUANTITIES]; /* of CGATE: where the swing of the gate ends */
  int with_cgate;
  double reference_length, reference_width;    /* NAN: none */
  const char *name, *file, *picture, *flavour; /* NULL: of none */
  double limit;                                /* s */
  char *path[TYPES];  /* of the cards, or of the library, whole */
  eda_models *models; /* NULL: cards */
  size_t count;
  double *length; /* increasing */
  size_t widths;
  double *each_width; /* increasing; the last is `width` */
} plan;

typedef struct currents {
  /* [width * count + length] */
  double *at[TYPES][QUANTITIES];
  double reference[TYPES][QUANTITIES];
  char simulator[32]; /* "ngspice-39" */
  size_t first;       /* of the plan's lengths that the table begins with */
  /* The first that was simulated at all widths; before it the slope goes on. */
  size_t simulated[TYPES];
  size_t cut[TYPES][QUANTITIES]; /* the first that is good, as was told; 0 */
  double narrowest[TYPES]; /* nm; narrower ones go on by slope; 0: none does */
} currents;

/* How many quantities there are. */
static inline int quantities(const plan *p) {
  return p->with_cgate ? QUANTITIES : EDA_CURRENTS;
}

/* Those of the widest. */
static inline const double *widest(const plan *p, const currents *c, int type,
                                   int current) {
  return c->at[type][current] + (p->widths - 1) * p->count;
}

/* ---- simulate.c ---- */

/* Simulate all, and find where the table begins; `out` has the arrays, which
   are zero. */
int simulate(const plan *p, currents *out, opc_error *error);

/* ---- table.c ---- */

/* What of the table is no model's, in words: FALSE if there is nothing. */
int table_extended(const plan *p, const currents *c, char *text, size_t room);

int table_write(const plan *p, const currents *c, const char *name,
                opc_error *error);

/* Per nm of length, in %: of the logarithm of a current at a length, by the
   table's lengths next to it; NAN if they do not lie around it. */
double table_slope(const plan *p, const currents *c, int type, int current,
                   double length);

/* ---- picture.c ---- */

int picture_draw(const plan *p, const currents *c, const char *name,
                 opc_error *error);
