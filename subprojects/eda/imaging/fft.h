/* SPDX-License-Identifier: BSD-3-Clause */
/* Fourier transforms of many lines by FFTW in single precision. Callers of
   two-dimensional transforms process a few lines at a time in the cache, and
   skip lines of zeros. Plans use FFTW_ESTIMATE, so that each run uses the same
   plans. Plans are cached. */
#pragma once

#include <complex.h>
#include <stddef.h>

/* Transforms of a line of n numbers. */
enum {
  EDA_FFT_BACKWARD,     /* sum a[k] exp(+2 pi i k x / n), in place */
  EDA_FFT_FORWARD,      /* sum a[x] exp(-2 pi i k x / n), in place */
  EDA_FFT_REAL_FORWARD, /* n real to n / 2 + 1 complex numbers */
  EDA_FFT_REAL_BACKWARD /* inverse of REAL_FORWARD; destroys the input */
};

/* Return a plan for `lines` transforms of n (even) numbers. Lines are adjacent:
   n numbers apart, or n / 2 + 1 for half-complex data. Transforms are not
   normalised. The plan is valid until the program ends. [any] */
typedef struct eda_fft eda_fft;
const eda_fft *eda_fft_plan(int what, int n, int lines);

/* Run a plan on arrays from eda_fft_alloc, or on parts of such arrays that
   begin at a complex element with an even index. In-place transforms ignore
   `out`. [any] */
void eda_fft_run(const eda_fft *plan, void *in, void *out);

/* Return the smallest even number >= max(minimum, 16) without prime factors
   above 7. */
int eda_fft_size(double minimum);

/* Return n bytes, aligned for transforms; free with eda_fft_free. Ends the
   program if memory is exhausted, as eda_alloc. */
void *eda_fft_alloc(size_t n);

/* Free an array. Large arrays are kept for later requests of similar size. The
   total size is at most 3/2 of the largest size in use. */
void eda_fft_free(void *memory);

/* Return the memory of idle arrays to the system. */
void eda_fft_trim(void);
