/* SPDX-License-Identifier: BSD-3-Clause */
/* Fourier transforms of many lines by FFTW in single precision. Two-dimensional
   transforms process some lines at a time in the cache, so that lines of zeros
   are skipped. Plans are estimated (FFTW_ESTIMATE), so that every run uses the
   same plans, and cached. */
#pragma once

#include <complex.h>
#include <stddef.h>

enum {
  EDA_FFT_BACKWARD,     /* sum a[k] exp(+2 pi i k x / n), in place */
  EDA_FFT_FORWARD,      /* sum a[x] exp(-2 pi i k x / n), in place */
  EDA_FFT_REAL_FORWARD, /* n real to n / 2 + 1 complex numbers */
  EDA_FFT_REAL_BACKWARD /* inverse; destroys the input */
};

/* Return a plan for `lines` transforms of n (even) numbers, one after another:
   n apart on the real and complex side, n / 2 + 1 apart on the half-complex
   one. Not normalised. Any thread; the plan is valid until the program ends. */
typedef struct eda_fft eda_fft;
const eda_fft *eda_fft_plan(int what, int n, int lines);

/* Run a plan on arrays from eda_fft_alloc, or on an even complex offset into
   one. In-place transforms ignore `out`. Any thread. */
void eda_fft_run(const eda_fft *plan, void *in, void *out);

/* Return the smallest even number >= minimum (and >= 16) without prime factors
   above 7. */
int eda_fft_size(double minimum);

/* Return n bytes, aligned for the transforms. End the program if memory is
   exhausted, as eda_alloc does. */
void *eda_fft_alloc(size_t n);

/* Free memory. Large arrays are kept for later requests of similar size; the
   total exceeds the largest amount in use by at most a half. */
void eda_fft_free(void *memory);

/* Return idle memory to the system. */
void eda_fft_trim(void);
