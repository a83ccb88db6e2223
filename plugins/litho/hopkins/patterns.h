/* SPDX-License-Identifier: BSD-3-Clause */
/* Small patterns on which kernels are tried, and their true images. */
#ifndef OPCFLOW_HOPKINS_PATTERNS_H
#define OPCFLOW_HOPKINS_PATTERNS_H

#include "kernels.h"

enum { PATTERNS = 5 };

/* The spectrum of a pattern, of a size that fits the kernels' cutoff. [any] */
int pattern_spectrum(const kernels *k, int which, eda_spectrum *out,
                     opc_error *error);

/* The image of its mask by T itself (k->cross), on the grid of `like`: the sum
   over all pairs of frequencies, which shares nothing with the kernels. [any]
 */
void pattern_image(const opc_context *context, const kernels *k,
                   const eda_spectrum *mask, const eda_field *like,
                   eda_field *out);

/* Whether a mask is the same all along y, and has few enough frequencies for
   that sum; and its image by it in place of `image`. [any] */
int pattern_is_lines(const kernels *k, const eda_spectrum *mask);
void pattern_lines(const opc_context *context, const kernels *k,
                   const eda_spectrum *mask, eda_field *image);

#endif
