/* SPDX-License-Identifier: BSD-3-Clause */
/* Files, tables and metrics that instances publish into the run folder. */
#pragma once

#include "core/run/run.h"

/* Host functions for instances of a run, which owns their `data`. */
extern const opc_host opc_run_publisher;
