/* SPDX-License-Identifier: BSD-3-Clause */
/* Files, tables and metrics that the instances of a run publish into its
   folder. */
#pragma once

#include "core/run/run.h"

/* Host functions for instances of a run; their `data` is reserved for the
   run. */
extern const opc_host opc_run_publisher;
