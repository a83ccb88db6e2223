/* SPDX-License-Identifier: BSD-3-Clause */
/* Files, tables and metrics that instances publish into the run folder. */
#pragma once

#include "core/run/run.h"

/* Host functions that publish results into the run of the calling instance
   (opc_binding.run). */
extern const opc_host opc_run_publisher;
