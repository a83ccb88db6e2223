/* SPDX-License-Identifier: BSD-3-Clause */
/* Services of hosts in addition to opc_binding_service (binding.h). */
#pragma once

#include "core/binding/binding.h"

/* Return a service of a host outside runs: results are stored in the binding's
   store. NULL if the name is unknown. */
const void *opc_results_service(const opc_host *host, const char *name);

/* Return a service of a host in a run: results and work units (pieces.h) are
   stored in the run's store. NULL if the name is unknown. */
const void *opc_run_service(const opc_host *host, const char *name);
