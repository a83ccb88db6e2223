/* SPDX-License-Identifier: BSD-3-Clause */
/* What the instances of a run publish into its folder. */
#ifndef OPCFLOW_CORE_PUBLISH_H
#define OPCFLOW_CORE_PUBLISH_H

#include "core/run/run.h"

/* The functions that instances of a run call; `data` is for the run. */
extern const opc_host opc_run_publisher;

#endif
