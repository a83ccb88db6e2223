/* SPDX-License-Identifier: BSD-3-Clause */
/* Device tables: Ion, Ioff (on- and off-currents) and gate capacitances of
   transistors as functions of channel length and width (thesis 2.2.1, see
   docs/background/physics.md). */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Types of transistors. */
enum { EDA_NMOS = 0, EDA_PMOS = 1 };

/* A device table: Ion and Ioff per width, A/nm, [type][i], at length[i], nm,
   increasing; of the widest transistors if the table has several widths. */
typedef struct eda_devices {
  size_t count;
  double *length;
  double *ion[2];
  double *ioff[2];
  double supply; /* supply voltage, V */
  double width;  /* width of the transistors with the currents `ion` and `ioff`,
                    nm */
  char *name;
  size_t narrow;        /* number of further widths, all below `width` */
  double *narrow_width; /* [narrow], nm, increasing */
  /* Currents per width, A/nm, of the further widths: [type][k * count + i] for
     width k and length i. */
  double *narrow_ion[2], *narrow_ioff[2];
  /* Flavour of the transistors of this table: a variant of a type, such as
     "lvt". NULL for the first table of a file, which has transistors without a
     flavour; next table, NULL for the last. Since 0.6. */
  char *flavour;
  struct eda_devices *next;
  /* Gate capacitance per width, F/nm: `cgate` for `width`, indexed as `ion`;
     `narrow_cgate` for `narrow_width`, indexed as `narrow_ion`. NULL: the table
     has no capacitances. */
  double *cgate[2], *narrow_cgate[2];
  /* Shortest length that the model of each type covers, nm; 0: the shortest
     length of the table. Currents of shorter lengths are extrapolated. Since
     0.9. */
  double modelled[2];
} eda_devices;

/* Read all tables of a file (format: docs/reference/devices.md). Return the
   first table of the list; NULL and *error (file:line:column) on failure.
   [main]: see opcflow/plugin.h. */
OPC_EXPORT eda_devices *eda_devices_read(const char *path, opc_error *error);
/* Free a table and the following tables of the list (NULL: do nothing). */
OPC_EXPORT void eda_devices_free(eda_devices *devices);

/* Return the gate capacitance, F, of a rectangular transistor (length, width:
   nm), interpolated linearly between lengths and between widths. Above the
   widest width, and in a table of one width, the capacitance is proportional to
   the width. Return NAN if the table has no capacitances, if the length is
   outside the table, or if the width is below the narrowest width of the table.
   [any] */
OPC_EXPORT double eda_devices_cgate(const eda_devices *devices, int type,
                                    double length, double width);

OPC_C_END
