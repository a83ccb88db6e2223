/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of devices.ngspice. Lengths in nm, currents in A of the transistor
   that was simulated. */
#ifndef OPCFLOW_DEVICES_NGSPICE_H
#define OPCFLOW_DEVICES_NGSPICE_H

#include <opcflow/devices.h>

enum { ION, IOFF, CURRENTS };
enum { TYPES = 2 };

typedef struct bias {
  double gate, drain; /* V, of the n-transistor; the p-transistor has -V */
} bias;

/* What is to be simulated. */
typedef struct plan {
  const char *card[TYPES];  /* whole paths */
  const char *model[TYPES]; /* names in them */
  const opc_pair *overrides;
  size_t n_overrides;
  double supply, temperature, width; /* V, C, nm */
  bias bias[CURRENTS];
  double limit; /* s */
  size_t count;
  double *length;                           /* increasing */
  double reference_length, reference_width; /* length 0: none */
} plan;

typedef struct currents {
  /* As many as the plan has lengths, from the longest down; 0 where there is
     none. */
  double *at[TYPES][CURRENTS];
  double reference[TYPES][CURRENTS];
  char simulator[32]; /* "ngspice-39" */
  size_t first;       /* of the plan's lengths that the table begins with */
} currents;

/* ---- simulate.c ---- */

/* Simulate all, and find where the table begins; `out` has the arrays. */
int simulate(const opc_host *host, const plan *p, currents *out,
             opc_error *error);

/* ---- table.c ---- */

int table_write(const opc_host *host, const plan *p, const currents *c,
                const char *name, const char *path, opc_error *error);

/* Per nm of length, in %: of the logarithm of a current at a length, by the
   table's lengths next to it; NAN if they do not lie around it. */
double table_slope(const plan *p, const currents *c, int type, int current,
                   double length);

/* ---- curves.c ---- */

int curves_draw(const opc_host *host, const plan *p, const currents *c,
                const char *name, int format, const char *path,
                opc_error *error);

#endif
