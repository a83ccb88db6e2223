/* SPDX-License-Identifier: BSD-3-Clause */
/* The circuit simulator ngspice, in a separate process for each deck (netlist).
 */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* A vector of a finished analysis. */
typedef struct eda_spice_vector {
  char *name; /* "v(out)", "time", "i(vdd)", lower case */
  size_t count;
  double *value; /* real values, or the real part of complex ones */
} eda_spice_vector;

/* Result of an analysis; "plot" as in ngspice. */
typedef struct eda_spice_plot {
  char *name; /* name by ngspice: "tran1", "dc2" */
  size_t count, capacity;
  eda_spice_vector *vector;
} eda_spice_plot;

/* Results of all analyses of a run. */
typedef struct eda_spice_result {
  size_t count, capacity;
  eda_spice_plot *plot; /* in order of creation; without the plot "const" */
  char *words;          /* complete output of the simulator, or NULL */
} eda_spice_result;

/* Run a deck (text of a netlist; first line: title; last line: .end), then
   commands, one per line ("dc v1 0 1.1 0.01"). A failed command ends the run.
   Return OPC_INVALID and FILE:LINE:COLUMN, FILE being "deck" for the deck, if
   the deck or an included file contains a statement that does not describe a
   circuit (simulator/README.md); OPC_FAILED and the first message of the
   simulator if the simulator fails, crashes, takes longer than `limit` seconds
   or returns more than 2 GB; OPC_CANCELLED if the user stops the run;
   OPC_NO_PLUGIN if the library of ngspice or the program that loads it is not
   installed. Several runs may be active at once. [any]: see opcflow/plugin.h.

   `.osdi FILE` in the deck itself, before the devices that need it, loads a
   file of compiled models. The file is a shared object (Open Source Device
   Interface) and runs in the sandbox of the simulator process. Return
   OPC_NO_PLUGIN if the library of ngspice does not support OSDI.

   Commands are not checked: the caller must insert only numbers and checked
   names into commands. The simulator process cannot open or write files or
   start programs. File names in a deck are absolute; included files are in the
   folder of the including file. Start-up files of ngspice are not read. The
   caller clears `out`, also after a failure; `out` then contains the output,
   and the plots of the commands before the failed one. The environment variable
   OPCFLOW_NGSPICE replaces libngspice.so.0, OPCFLOW_SIMULATOR the program that
   loads it. */
OPC_EXPORT int eda_spice_run(const opc_context *context, const char *deck,
                             const char *commands, double limit,
                             eda_spice_result *out, opc_error *error);
/* Free a result and clear the struct. */
OPC_EXPORT void eda_spice_clear(eda_spice_result *result);

/* Return the vector with this name, NULL if there is none. */
OPC_EXPORT const eda_spice_vector *eda_spice_vector_find(
    const eda_spice_plot *plot, const char *name);

/* Return 1 if a text is a valid name in a deck (letters, digits, '_', '.',
   '-'), otherwise 0. [any] */
OPC_EXPORT int eda_spice_is_name(const char *text);

/* Parameters of a step that simulates transistors; uses the members supply, V,
   and temperature, C. */
#define EDA_CONDITIONS(self_type)                                          \
  OPC_PARAMETER(self_type, supply, .type = OPC_REAL, .unit = "V",          \
                .flags = OPC_REQUIRED | OPC_ABOVE | OPC_AT_MOST, .min = 0, \
                .max = 20, .summary = "supply voltage"),                   \
      OPC_PARAMETER(self_type, temperature, .type = OPC_REAL, .unit = "C", \
                    .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "27 C", \
                    .min = -200, .max = 300,                               \
                    .summary = "temperature of the transistors")

OPC_C_END
