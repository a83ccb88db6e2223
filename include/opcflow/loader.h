/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "loader": plugins in files that are not shared objects, such as Python
   files. The plugin "loader.EXT" reads the files ID.EXT of the plugin folders
   and implements the functions of the plugins in these files. [main]: see
   plugin.h. */
#ifndef OPCFLOW_LOADER_H
#define OPCFLOW_LOADER_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* Functions of a loader. */
typedef struct opc_loader {
  /* Return the descriptor of the plugin `id` in the file `path`, valid until
     the process ends. The instances of the plugin find the descriptor by
     OPC_DESCRIPTOR. Returns NULL and *error on failure. [main] */
  const opc_plugin *(*load)(const char *path, const char *id, opc_error *error);

  /* Return the paths of all files, except shared objects, that determine the
     results of the plugin; the last element is NULL. The files are part of the
     key of stored results. `id` is the field of the descriptor that `load`
     returned. Owned by the loader. [main] */
  const char *const *(*files)(const char *id);
  OPC_MAY_GROW
} opc_loader;

/* Name of the service of a host that returns the descriptor of the instance,
   with the pointers `id`, `kind` and `extension` of the plugin's own
   descriptor. */
#define OPC_DESCRIPTOR "opcflow.descriptor/1"

OPC_C_END
#endif
