/* SPDX-License-Identifier: BSD-3-Clause */
/* Tasks that several threads share; guard.h blames the plugin that called. */
#pragma once

#include <stddef.h>

/* Call task(data, i) for each i below n, from at most `threads` threads; all
   are done when the function returns. May be nested. The first call of the
   process decides how many threads there are. [any] */
void pool_run(unsigned threads, size_t n, void (*task)(void *data, size_t i),
              void *data);
