/* SPDX-License-Identifier: BSD-3-Clause */
/* How sure a mean is. */
#pragma once

#include <opcflow/base.h>

typedef struct interval {
  double mean, low, high; /* NAN for too few values */
} interval;

/* The mean of n finite values and the interval that has the mean of all such
   values with a probability of 95 %: bootstrap with bias correction and
   acceleration (BCa: B. Efron, J. Am. Stat. Assoc. 82 (1987) 171). The same
   bits for any number of threads. [any] */
interval bootstrap_mean(const double *values, size_t n,
                        const opc_context *context);
