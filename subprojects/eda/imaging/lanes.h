/* SPDX-License-Identifier: BSD-3-Clause */
/* Fourier transforms of EDA_LANES lines at a time. Element i of all lines is
   stored as one point: a vector of real parts and a vector of imaginary parts.
   Each operation acts on whole vectors, for any length of lines. Used for sums
   of coherent kernels; other transforms use FFTW (fft.h). */
#pragma once

#include <stddef.h>

/* Number of lines transformed together. */
enum { EDA_LANES = 16 };

/* A number of each line. */
typedef float eda_vector __attribute__((vector_size(4 * EDA_LANES)));

/* A complex number of each line. */
typedef struct eda_lanes {
  eda_vector re, im;
} eda_lanes;

/* Return a plan for lines of n numbers, n from eda_lanes_size. The plan is
   valid until the program ends. [any] */
typedef struct eda_lanes_plan eda_lanes_plan;
const eda_lanes_plan *eda_lanes_plan_for(int n);

/* Compute sum a[k] exp(+2 pi i k x / n) in place, not normalised. `work` has
   eda_lanes_capacity(plan) points. Both arrays must come from eda_fft_alloc.
   [any] */
void eda_lanes_backward(const eda_lanes_plan *plan, eda_lanes *a,
                        eda_lanes *work);
size_t eda_lanes_capacity(const eda_lanes_plan *plan);

/* Transpose EDA_LANES vectors: lane j of from[i * from_stride] becomes lane i
   of to[j * to_stride]. [any] */
void eda_lanes_turn(const eda_vector *from, size_t from_stride, eda_vector *to,
                    size_t to_stride);

/* Return the smallest even number >= max(minimum, 16) without prime factors
   above 5. */
int eda_lanes_size(double minimum);
