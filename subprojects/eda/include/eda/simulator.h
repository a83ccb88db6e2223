/* SPDX-License-Identifier: BSD-3-Clause */
/* The circuit simulator ngspice, in a process of its own for each deck. */
#ifndef EDA_SIMULATOR_H
#define EDA_SIMULATOR_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One vector of a finished analysis. */
typedef struct eda_spice_vector {
  char *name; /* "v(out)", "time", "i(vdd)", lower case */
  size_t count;
  double *value; /* real; the real part of a complex one */
} eda_spice_vector;

/* What an analysis left. */
typedef struct eda_spice_plot {
  char *name; /* ngspice's: "tran1", "dc2" */
  size_t count, room;
  eda_spice_vector *vector;
} eda_spice_plot;

typedef struct eda_spice_result {
  size_t count, room;
  eda_spice_plot *plot; /* in the order they were made; not "const" */
  char *words;          /* what the simulator said, whole; or NULL */
} eda_spice_result;

/* Run a deck (the text of a netlist file; the first line is its title, it ends
   with .end) and then commands, one a line ("dc v1 0 1.1 0.01"). A command that
   fails ends the run. Fails with OPC_INVALID and FILE:LINE:COLUMN, the deck
   itself being "deck", if it or a file that it includes says anything but what
   circuits are made of (simulator/README.md); with OPC_FAILED and the
   simulator's own first words of trouble if it fails, crashes or takes longer
   than `limit` seconds; with OPC_NO_PLUGIN if the library of ngspice or the
   program that loads it is not installed. Several may run at once. [any]

   `.osdi FILE`, of the deck itself and before what needs it, has a file of
   compiled models loaded (a shared object of the Open Source Device Interface):
   code that runs in that program's sandbox. OPC_NO_PLUGIN where the library of
   ngspice knows none.

   Commands are not looked at: nothing that comes from a file may stand in them
   but numbers and names. The simulator can open, write and start nothing
   whatever they say. Names of files in a deck are absolute; what those include
   lies in their folder. No start-up file of ngspice is read. `out` is to be
   cleared also after a failure; it then has the plots of the commands before,
   and the words. The environment variable OPCFLOW_NGSPICE names another library
   than libngspice.so.0, OPCFLOW_SIMULATOR another program to load it. */
OPC_EXPORT int eda_spice_run(const opc_context *context, const char *deck,
                             const char *commands, double limit,
                             eda_spice_result *out, opc_error *error);
OPC_EXPORT void eda_spice_clear(eda_spice_result *result);

/* The vector of a plot by name, NULL if it is not there. */
OPC_EXPORT const eda_spice_vector *eda_spice_vector_find(
    const eda_spice_plot *plot, const char *name);

#ifdef __cplusplus
}
#endif
#endif
