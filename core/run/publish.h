/* SPDX-License-Identifier: BSD-3-Clause */
/* What the instances of a run publish into its folder. */
#pragma once

#include "core/run/run.h"

/* The functions that instances of a run call; `data` is for the run. */
extern const opc_host opc_run_publisher;
