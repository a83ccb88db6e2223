/* SPDX-License-Identifier: BSD-3-Clause */
/* The circuit simulator, in a process of its own. What the plugins that
   simulate share; compiled into each. */
#ifndef OPCFLOW_SPICE_H
#define OPCFLOW_SPICE_H

#include <opcflow/plugin.h>

/* One vector of a finished analysis. */
typedef struct opc_spice_vector {
  char *name;                /* "v(out)", "time", "i(vdd)", lower case */
  size_t count;
  double *value;             /* real; the real part of a complex one */
} opc_spice_vector;

/* What an analysis left. */
typedef struct opc_spice_plot {
  char *name;                /* ngspice's: "tran1", "dc2" */
  size_t count;
  opc_spice_vector *vector;
} opc_spice_plot;

typedef struct opc_spice_result {
  size_t count;
  opc_spice_plot *plot;      /* in the order they were made; not "const" */
  char *words;               /* what the simulator said, whole */
} opc_spice_result;

/* Run a deck (the text of a netlist file; the first line is its title, it ends
   with .end) and then commands, one a line ("dc v1 0 1.1 0.01"), in a child
   process that has the ngspice shared library. A command that fails ends the
   run. Fails with OPC_FAILED and the simulator's own first words of trouble if
   it fails, crashes or takes longer than `limit` seconds; with OPC_NO_PLUGIN
   if the library is not installed. Several may run at once. [any]

   The child stands in an empty folder that is removed: names of files in a deck
   are absolute. No start-up file of ngspice is read. `out` is to be released
   also after a failure; it then has the plots of the commands before, and the
   words. The environment variable OPCFLOW_NGSPICE names another library than
   libngspice.so.0. */
int opc_spice_run(const opc_host *host, const char *deck, const char *commands,
                  double limit, opc_spice_result *out, opc_error *error);

/* As host->parallel, for tasks that run decks. One after another under
   AddressSanitizer: a child that is forked while another thread is inside its
   allocator finds that locked for ever. (Those of the C library can be forked.) */
void opc_spice_parallel(const opc_host *host, size_t n,
                        void (*task)(void *data, size_t i), void *data);

void opc_spice_release(opc_spice_result *result);

/* The vector of a plot by name, NULL if it is not there. */
const opc_spice_vector *opc_spice_vector_find(const opc_spice_plot *plot,
                                              const char *name);

#endif
