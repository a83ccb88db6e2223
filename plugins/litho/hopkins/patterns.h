/* SPDX-License-Identifier: BSD-3-Clause */
/* Small patterns that measure the error of kernels, and their reference
   images. */
#pragma once

#include "kernels.h"

enum { PATTERNS = 5 };

/* Compute the spectrum of pattern `which`, whose size follows the cutoff of the
   kernels. Return OPC_OK or an error. [any] */
int pattern_spectrum(const kernels *k, int which, eda_spectrum *out,
                     opc_error *error);

/* Compute the image of a mask from T itself (k->cross) on the grid of `like`: a
   sum over all pairs of frequencies, independent of the kernels. [any] */
void pattern_image(const opc_context *context, const kernels *k,
                   const eda_spectrum *mask, const eda_field *like,
                   eda_field *out);

/* Return 1 if a mask does not depend on y and has few enough frequencies for
   lines_image, which computes its image from that sum. [any] */
int pattern_is_lines(const kernels *k, const eda_spectrum *mask);
void pattern_lines(const opc_context *context, const kernels *k,
                   const eda_spectrum *mask, eda_field *image);
