/* SPDX-License-Identifier: BSD-3-Clause */
/* What an instance may ask its host for by name: opc_host.service of hosts
   whose `data` is a binding. */
#ifndef OPCFLOW_CORE_SERVICES_H
#define OPCFLOW_CORE_SERVICES_H

#include "core/flow/binding.h"

/* Outside of runs: results are kept in the binding's store, pieces nowhere. */
const void *opc_basic_service(const opc_host *host, const char *name);

/* In a run: results are kept in the store of the run, pieces too, and shared.
 */
const void *opc_run_service(const opc_host *host, const char *name);

#endif
