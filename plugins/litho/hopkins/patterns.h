/* SPDX-License-Identifier: BSD-3-Clause */
/* Small mask patterns for measuring the error of kernels, and the reference
   images of these patterns. */
#pragma once

#include "kernels.h"

/* Number of patterns. */
enum { PATTERNS = 5 };

/* Compute the spectrum of pattern `which`, whose size is inversely proportional
   to the cutoff of the kernels. Return OPC_OK or an error. [any] */
int pattern_spectrum(const kernels *k, int which, eda_spectrum *out,
                     opc_error *error);

/* Compute the image of a mask on the grid of `like` from the transmission cross
   coefficient T (k->cross). The image is a sum over all pairs of frequencies
   and independent of the kernels. [any] */
void pattern_image(const opc_context *context, const kernels *k,
                   const eda_spectrum *mask, const eda_field *like,
                   eda_field *out);

/* Return 1 if a mask does not depend on y and has few enough frequencies for
   pattern_lines. [any] */
int pattern_is_lines(const kernels *k, const eda_spectrum *mask);

/* Replace *image by the image of a mask of lines on the same grid, computed by
   the double sum of pattern_image. [any] */
void pattern_lines(const opc_context *context, const kernels *k,
                   const eda_spectrum *mask, eda_field *image);
