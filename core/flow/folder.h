/* SPDX-License-Identifier: BSD-3-Clause */
/* Run folders: written under a name of their own, renamed when done. */
#ifndef OPCFLOW_CORE_FOLDER_H
#define OPCFLOW_CORE_FOLDER_H

#include <glib.h>
#include <opcflow/plugin.h>

/* Whether the result may go to `target`: it is not there, or it is an earlier
   run (or empty) and `force` is set. OPC_IO and *error. */
int opc_folder_allowed(const char *target, gboolean force, opc_error *error);

/* Make the folder to write into, hidden beside `target`. NULL and *error. */
char *opc_folder_open(const char *target, opc_error *error);

/* Give `work` the name `target`, in place of an earlier run if `replace`, else
   TARGET-2, -3 ... if that is taken and `number`. The name it got (g_free),
   NULL and *error. */
char *opc_folder_close(const char *work, const char *target, gboolean replace,
                       gboolean number, opc_error *error);

#endif
