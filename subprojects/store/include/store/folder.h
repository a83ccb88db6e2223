/* SPDX-License-Identifier: BSD-3-Clause */
/* Run folders. A run is written into a hidden folder beside the place it is
   meant for, its slot, which a lock keeps as long as the run lives; when it is
   done it gets its name, or changes places with an earlier run, as a whole. */
#ifndef OPC_STORE_FOLDER_H
#define OPC_STORE_FOLDER_H

#include <glib.h>
#include <opcflow/base.h>

typedef struct opc_folder {
  char *slot;    /* .NAME.opcflow-N, with the three below */
  char *lock;    /* a file, locked while the run lives */
  char *work;    /* the run; once it has its name, the one that it replaced */
  char *old;     /* the earlier run, where two folders cannot change places */
  int locked;    /* the lock's descriptor */
  gboolean kept; /* the run could get no name, and stays in `work` */
} opc_folder;

/* Whether the result may go to `target`: it is not there, or `force` is set and
   it is an empty folder or a run of which all is as it was written. OPC_IO and
   *error. */
int opc_folder_allowed(const char *target, gboolean force, opc_error *error);

/* Make an empty folder to write into, beside `target`. What killed runs of that
   name left behind is removed, or put back where it was. `sole`: refuse if
   another run of that name is at work. NULL and *error. */
opc_folder *opc_folder_open(const char *target, gboolean sole,
                            opc_error *error);

/* Give the run the name `target`, in place of an earlier run if `replace`, else
   TARGET-2, -3 ... if that is taken; it is an error if it is, unless `number`.
   *got is where the run is then, whatever is returned (g_free). OPC_IO and
   *error. */
int opc_folder_close(opc_folder *folder, const char *target, gboolean replace,
                     gboolean number, char **got, opc_error *error);

/* Remove what is still in the slot, and the slot. NULL is fine. */
void opc_folder_free(opc_folder *folder);

#endif
