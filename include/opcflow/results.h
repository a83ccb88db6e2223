/* SPDX-License-Identifier: BSD-3-Clause */
/* Service "opcflow.results/1": a plugin keeps results for later runs in the
   store of the host. The user can limit, clear or disable the store
   (OPCFLOW_STORE, --no-cache, `opcflow cache`), so any result may be missing at
   any time. [main]: see plugin.h. */
#ifndef OPCFLOW_RESULTS_H
#define OPCFLOW_RESULTS_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* Name of the service, for opc_host.service. */
#define OPC_RESULTS "opcflow.results/1"

/* Functions of the service. All are [main], while a step or a command runs. */
typedef struct opc_results {
  size_t size; /* size of this struct */

  /* Return a hash (SHA-256, hexadecimal) of the plugin in `slot`, or of this
     plugin for NULL. The hash covers the plugin's build, the values of its
     parameters, the contents of files that parameters name, and the plugins in
     its slots; it does not cover inputs. The text is "" for an empty slot, and
     valid as long as the instance. Returns NULL and fills *error in four cases:
     `slot` is not a slot of this plugin; a file cannot be read; a plugin is not
     OPC_DETERMINISTIC; a plugin in a slot, at any depth, has an input
     ('${gates}'). */
  const char *(*identity)(const opc_host *host, const char *slot,
                          opc_error *error);

  /* Return a copy of the bytes stored under `key`, to be freed by free(), and
     their number in *size; NULL if nothing is stored. `key` is any text that
     identifies the dependencies of the result; the host adds the id and the
     build of the plugin. */
  void *(*find)(const opc_host *host, const char *key, size_t *size);

  /* Store bytes under `key` and replace earlier bytes. If this fails, the host
     informs the user and the caller continues. */
  void (*keep)(const opc_host *host, const char *key, const void *bytes,
               size_t size);
  OPC_MAY_GROW
} opc_results;

/* Return the service; NULL if the host keeps nothing for this instance. */
OPC_UNUSED static const opc_results *opc_get_results(const opc_host *host) {
  return (const opc_results *)host->service(host, OPC_RESULTS);
}

OPC_C_END
#endif
