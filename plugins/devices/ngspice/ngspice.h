/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of devices.ngspice. Lengths in nm, currents in A of the transistor
   that was simulated. */
#ifndef OPCFLOW_DEVICES_NGSPICE_H
#define OPCFLOW_DEVICES_NGSPICE_H

#include <eda/curves.h>
#include <opcflow/step.h>

enum { TYPES = 2 };

typedef struct bias {
  double gate, drain; /* V, of the n-transistor; the p-transistor has -V */
} bias;

/* What is to be simulated. */
typedef struct plan {
  const opc_host *host;
  const char *card[TYPES];  /* parameters: files */
  const char *model[TYPES]; /* names in them */
  opc_map overrides;
  double supply, temperature, width; /* V, C, nm */
  double from, to, step;
  opc_reals list;
  bias bias[EDA_CURRENTS];
  double reference_length, reference_width; /* NAN: none */
  const char *name, *file, *picture;
  double limit;      /* s */
  char *path[TYPES]; /* of the cards, whole */
  size_t count;
  double *length; /* increasing */
} plan;

typedef struct currents {
  /* As many as the plan has lengths, from the longest down; 0 where there is
     none. */
  double *at[TYPES][EDA_CURRENTS];
  double reference[TYPES][EDA_CURRENTS];
  char simulator[32]; /* "ngspice-39" */
  size_t first;       /* of the plan's lengths that the table begins with */
} currents;

/* ---- simulate.c ---- */

/* Simulate all, and find where the table begins; `out` has the arrays. */
int simulate(const plan *p, currents *out, opc_error *error);

/* ---- table.c ---- */

int table_write(const plan *p, const currents *c, const char *name,
                opc_error *error);

/* Per nm of length, in %: of the logarithm of a current at a length, by the
   table's lengths next to it; NAN if they do not lie around it. */
double table_slope(const plan *p, const currents *c, int type, int current,
                   double length);

/* ---- picture.c ---- */

int picture_draw(const plan *p, const currents *c, const char *name,
                 opc_error *error);

#endif
