/* SPDX-License-Identifier: BSD-3-Clause */
/* Confidence interval of a mean. */
#pragma once

#include <opcflow/base.h>

typedef struct interval {
  double mean, low, high; /* NAN if there are too few values */
} interval;

/* Return the mean of n finite values and its 95 % confidence interval, by the
   bootstrap with bias correction and acceleration (BCa: B. Efron, J. Am. Stat.
   Assoc. 82 (1987) 171). The result is bit-identical for any number of threads.
   [any] */
interval bootstrap_mean(const double *values, size_t n,
                        const opc_context *context);
