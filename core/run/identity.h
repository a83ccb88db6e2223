/* SPDX-License-Identifier: BSD-3-Clause */
/* What the results of an instance depend on, but for its inputs, as one sum. */
#ifndef OPCFLOW_CORE_IDENTITY_H
#define OPCFLOW_CORE_IDENTITY_H

#include "core/binding/binding.h"

/* opc_host.identity, in a run, of a host whose `data` is a binding. */
const char *opc_identity(const opc_host *host, const char *slot,
                         opc_error *error);

/* The same of a host outside of runs. */
const char *opc_identity_alone(const opc_host *host, const char *slot,
                               opc_error *error);

#endif
