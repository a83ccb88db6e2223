/* SPDX-License-Identifier: BSD-3-Clause */
/* Fourier transforms of many lines, by FFTW in single precision: what
   two-dimensional transforms are made of here, line by line in the cache, so
   that lines of zeros need not be transformed nor whole planes be written.
   Plans are made by estimate, so that they are the same in every run, and
   kept. */
#ifndef EDA_FFT_H
#define EDA_FFT_H

#include <complex.h>
#include <stddef.h>

enum {
  EDA_FFT_BACKWARD,     /* sum a[k] exp(+2 pi i k x / n), in place */
  EDA_FFT_FORWARD,      /* sum a[x] exp(-2 pi i k x / n), in place */
  EDA_FFT_REAL_FORWARD, /* n reals to n / 2 + 1 numbers */
  EDA_FFT_REAL_BACKWARD /* its inverse; the input is lost */
};

/* A plan for `lines` transforms of n (even) numbers, one after another: n
   apart on the real and complex side, n / 2 + 1 apart on the half-complex one.
   Not normalised. Any thread; lives as long as the program. */
typedef struct eda_fft eda_fft;
const eda_fft *eda_fft_plan(int what, int n, int lines);

/* Arrays from eda_fft_alloc, or an even number of complex numbers into one.
   In-place transforms ignore `out`. Any thread. */
void eda_fft_run(const eda_fft *plan, void *in, void *out);

/* The smallest even number >= minimum (and >= 16) that has no prime factor
   above 7. */
int eda_fft_size(double minimum);

/* n bytes, aligned for the transforms. Running out of memory ends the program,
   as with eda_alloc. */
void *eda_fft_alloc(size_t n);

/* Large arrays are kept for those that ask for the like, never a half more in
   all than was in use at one time. */
void eda_fft_free(void *memory);

/* Give back to the system what is kept: nobody will ask soon. */
void eda_fft_trim(void);

#endif
