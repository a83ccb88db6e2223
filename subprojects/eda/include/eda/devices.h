/* SPDX-License-Identifier: BSD-3-Clause */
/* Device tables: the currents of wide transistors against their length
   (thesis 2.2.1), and of narrower ones; and the capacitance of their gates. */
#ifndef EDA_DEVICES_H
#define EDA_DEVICES_H

#include <eda/base.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { EDA_NMOS = 0, EDA_PMOS = 1 };

/* Currents per width, A/nm, against L in nm, increasing. [type][i]; of the
   widest transistors, if the table has several widths. */
typedef struct eda_devices {
  size_t count;
  double *length;
  double *ion[2];
  double *ioff[2];
  double supply; /* V */
  double width;  /* nm, of the transistors that were simulated */
  char *name;
  /* Of a table of several widths: the narrower ones, nm, increasing, below
     `width`; and their currents per width, [type][narrow * count + i]. */
  size_t narrow;
  double *narrow_width;
  double *narrow_ion[2], *narrow_ioff[2];
  /* Of a file with tables of several flavours of transistors: which one this
     is, NULL of the first, and the table after it; NULL: none. Since 0.6. */
  char *flavour;
  struct eda_devices *next;
  /* Capacitance of the gate per width, F/nm, in the shape of the currents: that
     of the widest, and of the narrower ones. NULL: the file has none. */
  double *cgate[2], *narrow_cgate[2];
} eda_devices;

/* Read the tables of a file (docs/reference/devices.md tells the format);
   freeing the first frees all. Errors carry file:line:column. [main] */
OPC_EXPORT eda_devices *eda_devices_read(const char *path, opc_error *error);
OPC_EXPORT void eda_devices_free(eda_devices *devices);

/* The capacitance, F, of the gate of a rectangular transistor, nm: in straight
   lines between the lengths of the table and between its widths, as area and
   edges add to it. Wider ones than the widest, and all of a table of one width,
   have its capacitance by width. NAN if the table has none, or no such length,
   or nothing so narrow. [any] */
OPC_EXPORT double eda_devices_cgate(const eda_devices *devices, int type,
                                    double length, double width);

#ifdef __cplusplus
}
#endif
#endif
