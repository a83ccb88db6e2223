/* SPDX-License-Identifier: BSD-3-Clause */
/* Fourier transforms of OPC_LANES lines side by side: number i of all lines is
   one point, a vector of real parts and one of imaginary parts. Each operation
   is then one of whole vectors, whatever the length. For sums of coherent
   systems, where nearly all the time goes; FFTW (fft.h) does the rest. */
#ifndef OPCFLOW_CORE_LANES_H
#define OPCFLOW_CORE_LANES_H

#include <stddef.h>

enum { OPC_LANES = 16 };

typedef float opc_vector __attribute__((vector_size(4 * OPC_LANES)));

typedef struct opc_lanes {
  opc_vector re, im;
} opc_lanes;

/* A plan for lines of n numbers, n as opc_lanes_size says. Any thread; lives as
   long as the program. */
typedef struct opc_lanes_plan opc_lanes_plan;
const opc_lanes_plan *opc_lanes_plan_for(int n);

/* sum a[k] exp(+2 pi i k x / n), in place; `work` has opc_lanes_room(plan)
   points. Not normalised. Both arrays from opc_fft_alloc. Any thread. */
void opc_lanes_backward(const opc_lanes_plan *plan, opc_lanes *a,
                        opc_lanes *work);
size_t opc_lanes_room(const opc_lanes_plan *plan);

/* Lane j of from[i * from_stride] becomes lane i of to[j * to_stride], for
   OPC_LANES vectors. Any thread. */
void opc_lanes_turn(const opc_vector *from, size_t from_stride, opc_vector *to,
                    size_t to_stride);

/* The smallest even number >= minimum (and >= 16) that has no prime factor
   above 5. */
int opc_lanes_size(double minimum);

#endif
