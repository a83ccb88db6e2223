/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernel sets in files in the format of the ICCAD 2013 contest: a text of
   weights and a binary file per kernel in the same folder. */
#pragma once

#include <opcflow/base.h>

enum { KERNEL_MOST = 255 }; /* largest number of frequencies across a kernel */

/* `count` kernels in the frequency domain, size x size values each. Real and
   imaginary part of the value of kernel s at frequency (k - half, l - half) are
   data[2 * ((s * size + l) * size + k)] and the next element. */
typedef struct kernel_set {
  size_t count;
  int size, half; /* size = 2 * half + 1 */
  double radius;  /* radius of the nonzero values, in steps of the frequency */
  double *weight;
  float *data;
} kernel_set;

/* Read the text `path` (number of kernels, then weights) and the files fh0.bin,
   fh1.bin ... in its folder. A kernel file has a header of 24 bytes: rows and
   columns as big-endian 32-bit integers, and four unused integers. Pairs of
   big-endian 32-bit floats follow, row by row. Read the first `most` kernels,
   all if `most` is 0. Return OPC_OK, OPC_INVALID if the text has fewer kernels,
   or OPC_IO. */
int kernel_set_read(const char *path, size_t most, kernel_set *out,
                    opc_error *error);
/* Free the kernels. */
void kernel_set_clear(kernel_set *set);
