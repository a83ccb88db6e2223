/* SPDX-License-Identifier: BSD-3-Clause */
/* Median of independent values, with a confidence interval. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Smallest number of values for which an interval is computed. The range of
   five values contains the median of their distribution with a probability of 1
   - 2 / 2^5 = 93.75 %, the range of four with 87.5 %. */
enum { EDA_MEDIAN_FEWEST = 5 };

/* A median and its confidence interval. */
typedef struct eda_median {
  double value;     /* median; NAN if n = 0 */
  double low, high; /* ends of the interval; NAN if n < EDA_MEDIAN_FEWEST */
  int64_t n;        /* number of values */
} eda_median;

/* Return the median of n finite values, and a 95 % confidence interval (93.75 %
   for five values) of the median of their distribution, which must be
   continuous. The probability that the range between two order statistics
   contains the median follows from the binomial distribution. The ends are
   interpolated between two such ranges (Hettmansperger and Sheather, Statist.
   Probab. Lett. 4 (1986) 75). [any] (opcflow/plugin.h) */
OPC_EXPORT eda_median eda_median_of(const double *values, size_t n);

OPC_C_END
