/* SPDX-License-Identifier: BSD-3-Clause */
/* Results that a plugin keeps beyond a run, in the store of the host: what one
   run computed, a later one finds. The user decides whether and how much is
   kept (OPCFLOW_STORE, --no-cache, `opcflow cache`), so that each result may be
   missing at any time. */
#ifndef OPCFLOW_RESULTS_H
#define OPCFLOW_RESULTS_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

#define OPC_RESULTS "opcflow.results/1"

/* All functions are [main], while a step or a command runs. */
typedef struct opc_results {
  size_t size; /* of this struct */

  /* Return the sum (SHA-256 in hexadecimal) of all that the results of the
     plugin in a slot, or of this one for NULL, depend on but for inputs: its
     build, its parameters, the contents of files, and the plugins in its slots.
     Valid as long as the instance. NULL and *error if a file cannot be read, or
     if a plugin in the slot, or in a slot of that, takes the result of a step
     ('${gates}'), which the sum would not include. */
  const char *(*identity)(const opc_host *host, const char *slot,
                          opc_error *error);

  /* Return a copy of the bytes that were kept under `key`, freed by free();
     NULL if there are none. `key` is any text that says what the result depends
     on; the host adds the id and the build of the plugin to it. */
  void *(*find)(const opc_host *host, const char *key, size_t *size);

  /* Keep bytes under `key`, in place of earlier ones. A failure is reported to
     the user, as the store reports it, and does no harm. */
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
