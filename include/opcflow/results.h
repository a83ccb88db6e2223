/* SPDX-License-Identifier: BSD-3-Clause */
/* Service "opcflow.results/1": results that a plugin keeps beyond a run, in the
   store of the host, for later runs. The user limits the store (OPCFLOW_STORE,
   --no-cache, `opcflow cache`), so any result may be missing at any time. */
#ifndef OPCFLOW_RESULTS_H
#define OPCFLOW_RESULTS_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

#define OPC_RESULTS "opcflow.results/1"

/* Functions of the service. All are [main], while a step or a command runs. */
typedef struct opc_results {
  size_t size; /* of this struct */

  /* Return the hash (SHA-256 in hexadecimal) of everything except inputs that
     determines the results of the plugin in `slot`, or of this plugin for NULL:
     build, parameters, contents of files, and the plugins in the slots. Valid
     as long as the instance. Returns NULL and fills *error if a file cannot be
     read. Also if the plugin in the slot, or a plugin below it, takes the
     result of a step ('${gates}'): the hash would not include that result. */
  const char *(*identity)(const opc_host *host, const char *slot,
                          opc_error *error);

  /* Return a copy of the bytes stored under `key`, to be freed by free(); NULL
     if there are none. `key` is any text that identifies the dependencies of
     the result; the host adds the id and the build of the plugin. */
  void *(*find)(const opc_host *host, const char *key, size_t *size);

  /* Store bytes under `key`, replacing earlier ones. The host reports a failure
     to the user; the caller continues. */
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
