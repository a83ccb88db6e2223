/* SPDX-License-Identifier: BSD-3-Clause */
/* Run folders. A run is written into a slot, which here is a hidden folder
   beside the target folder. A lock protects the slot until opc_folder_free or
   the end of the process. A finished run is renamed to the target as a whole,
   or exchanged with an earlier run. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* A slot. */
typedef struct opc_folder {
  char *slot;    /* folder .NAME.opcflow-N, which contains the next three */
  char *lock;    /* a file, locked while the process runs */
  char *work;    /* folder of the run; after an exchange, the earlier run */
  char *old;     /* earlier run, if the file system cannot exchange folders */
  int locked;    /* file descriptor of the lock */
  gboolean kept; /* the run could not be renamed and stays in `work` */
} opc_folder;

/* Return OPC_OK if the result may be written to `target`. Either the target
   does not exist, or `force` is set and the target is an empty folder or a run
   folder whose files have not changed since the run. Otherwise return OPC_IO
   and *error. */
int opc_folder_allowed(const char *target, gboolean force, opc_error *error);

/* Return a new slot with an empty folder beside `target`. Slots that killed
   runs left for this target are removed; an earlier run in such a slot is first
   moved back to the target. If `sole` is TRUE, fail if another run with this
   target is active. Missing parent folders are created. NULL and *error on
   failure: OPC_INVALID if the target does not end in a name, else OPC_IO. */
opc_folder *opc_folder_open(const char *target, gboolean sole,
                            opc_error *error);

/* Rename the run to `target`. If `replace` is TRUE, replace an earlier run.
   Otherwise, if the target exists, use TARGET-2, -3 ... (`number` TRUE) or fail
   (`number` FALSE). *got receives the final path in any case (g_free). Return
   OPC_IO and *error on failure; the run is then kept as TARGET-2, -3 ... or in
   folder->work. */
int opc_folder_close(opc_folder *folder, const char *target, gboolean replace,
                     gboolean number, char **got, opc_error *error);

/* Remove the slot with all contents, unless folder->kept is set, and free the
   struct. `folder` may be NULL. */
void opc_folder_free(opc_folder *folder);
