/* SPDX-License-Identifier: BSD-3-Clause */
/* What instances may ask their host for by name beyond opc_binding_service. */
#pragma once

#include "core/binding/binding.h"

/* Outside of runs: results are kept in the binding's store. */
const void *opc_results_service(const opc_host *host, const char *name);

/* In a run: results and pieces are kept in the store of the run. */
const void *opc_run_service(const opc_host *host, const char *name);
