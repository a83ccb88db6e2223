/* SPDX-License-Identifier: BSD-3-Clause */
/* Distribution of tasks over threads. The guard (guard.h) attributes all tasks
   to the calling plugin. */
#pragma once

#include <stddef.h>

/* Call task(data, i) for each i below n in at most `threads` threads, and
   return when all calls are done. Calls may be nested. The first call that
   starts threads sets their number for the process. [any]: see
   opcflow/plugin.h. */
void pool_run(unsigned threads, size_t n, void (*task)(void *data, size_t i),
              void *data);
