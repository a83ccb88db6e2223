/* SPDX-License-Identifier: BSD-3-Clause */
/* A service that only the extended interface has. */
#pragma once

#include <opcflow/plugin.h>
#include <string.h>

#define COMPAT_ADDED "compat.added/1"

typedef struct compat_added {
  double (*twice)(const opc_host *host, double value);
} compat_added;
