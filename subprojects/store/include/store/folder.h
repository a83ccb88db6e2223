/* SPDX-License-Identifier: BSD-3-Clause */
/* Run folders. A run is written into a hidden folder beside its target, its
   slot, which a lock protects as long as the run lives. A finished run is
   renamed to the target, or exchanged with an earlier run, as a whole. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

typedef struct opc_folder {
  char *slot;    /* .NAME.opcflow-N, holds the three below */
  char *lock;    /* a file, locked while the run lives */
  char *work;    /* the run; after the exchange, the replaced run */
  char *old;     /* the earlier run, where folders cannot be exchanged */
  int locked;    /* descriptor of the lock */
  gboolean kept; /* the run could not be renamed and stays in `work` */
} opc_folder;

/* Return OPC_OK if the result may be written to `target`: the target does not
   exist, or `force` is set and the target is an empty folder or an unchanged
   run. Otherwise return OPC_IO and *error. */
int opc_folder_allowed(const char *target, gboolean force, opc_error *error);

/* Return a new empty folder beside `target`. Remains of killed runs of that
   name are removed or restored. `sole`: fail if another run of that name is
   active. NULL and *error on failure. */
opc_folder *opc_folder_open(const char *target, gboolean sole,
                            opc_error *error);

/* Rename the run to `target`. `replace`: replace an earlier run. If the name is
   taken, use TARGET-2, -3 ... with `number`, fail otherwise. *got is the final
   path in any case (g_free). Return OPC_IO and *error on failure. */
int opc_folder_close(opc_folder *folder, const char *target, gboolean replace,
                     gboolean number, char **got, opc_error *error);

/* Remove the slot with all contents and free the struct (NULL: nothing). */
void opc_folder_free(opc_folder *folder);
