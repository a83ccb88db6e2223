/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernel sets in files, as the ICCAD 2013 contest has them: a text of weights
   and, beside it, a file for each kernel. */
#ifndef OPCFLOW_LITHO_KERNEL_FILES_H
#define OPCFLOW_LITHO_KERNEL_FILES_H

#include <opcflow/base.h>

enum { KERNEL_MOST = 255 }; /* frequencies across a kernel */

/* `count` kernels in the frequency domain, size x size each: re, im of the
   frequency (k - half, l - half) of kernel s are
   data[2 * ((s * size + l) * size + k)] and the next. */
typedef struct kernel_set {
  size_t count;
  int size, half; /* size = 2 * half + 1 */
  double radius;  /* of what is not zero, in frequencies */
  double *weight;
  float *data;
} kernel_set;

/* Read the text `path` (how many, then the weights) and fh0.bin, fh1.bin ...
   beside it (24 bytes: rows and columns as big-endian 32-bit integers, four
   more without use; then pairs of big-endian 32-bit floats, row by row); the
   first `most` kernels, 0 for all. */
int kernel_set_read(const char *path, size_t most, kernel_set *out,
                    opc_error *error);
void kernel_set_clear(kernel_set *set);

#endif
