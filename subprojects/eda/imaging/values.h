/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory for the values of fields, and complex numbers of kernels. */
#pragma once

#include <complex.h>
#include <eda/imaging.h>

/* Spare bytes behind the values of fields allocated by the library. Guard words
   (gates/fence.h) use this memory, so that the field need not be copied. */
enum { EDA_VALUES_SPARE = 512 };

/* Return n uninitialised values, freed by eda_field_clear. Ends the program if
   memory is exhausted. [any] */
float *eda_values_new(size_t n);

/* Free values. If `eda_values_take` is not NULL, it is called first: it frees
   values that were not allocated by malloc and returns 1; for all other values
   it returns 0, and free() is called. [any] */
void eda_values_free(float *values);
extern int (*eda_values_take)(float *values);

/* Return the complex number of a real and an imaginary part. */
static inline float complex eda_complex_of(const double a[2]) {
  return (float)a[0] + (float)a[1] * I;
}

/* Return the factor of the mask spectrum; {0, 0} means 1. */
static inline float complex eda_scale_of(const eda_kernels *kernels) {
  float complex scale = eda_complex_of(kernels->scale);
  return scale == 0 ? 1 : scale;
}
