/* SPDX-License-Identifier: BSD-3-Clause */
/* Device tables: the currents of wide and narrower transistors against length
   (thesis 2.2.1), and the capacitance of their gates. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

enum { EDA_NMOS = 0, EDA_PMOS = 1 };

/* Currents per width, A/nm, against L in nm, increasing. [type][i]; of the
   widest transistors if the table has several widths. */
typedef struct eda_devices {
  size_t count;
  double *length;
  double *ion[2];
  double *ioff[2];
  double supply; /* V */
  double width;  /* nm, of the simulated transistors */
  char *name;
  /* Narrower widths of a table of several widths: nm, increasing, below
     `width`; and their currents per width, [type][narrow * count + i]. */
  size_t narrow;
  double *narrow_width;
  double *narrow_ion[2], *narrow_ioff[2];
  /* Flavour of the transistors of this table, NULL for the first table of a
     file; and the next table, NULL: none. Since 0.6. */
  char *flavour;
  struct eda_devices *next;
  /* Capacitance of the gate per width, F/nm, in the layout of the currents: of
     the widest width, and of the narrower ones. NULL: the file has none. */
  double *cgate[2], *narrow_cgate[2];
} eda_devices;

/* Read the tables of a file (format: docs/reference/devices.md). Freeing the
   first table frees all. Errors carry file:line:column. [main] */
OPC_EXPORT eda_devices *eda_devices_read(const char *path, opc_error *error);
OPC_EXPORT void eda_devices_free(eda_devices *devices);

/* Return the gate capacitance, F, of a rectangular transistor (nm),
   interpolated linearly between the lengths of the table and between its
   widths. Widths above the widest, and all widths for a table of one width,
   have the same capacitance per width. NAN if the table has no capacitance, no
   such length or no such narrow width. [any] */
OPC_EXPORT double eda_devices_cgate(const eda_devices *devices, int type,
                                    double length, double width);

OPC_C_END
