/* SPDX-License-Identifier: BSD-3-Clause */
/* Two-dimensional Fourier transforms, by FFTW in single precision. Plans are
   made by estimate, so that they are the same in every run, and kept. All
   functions may be called from any thread. Arrays are row by row, x fastest,
   from opc_fft_alloc. */
#ifndef OPCFLOW_CORE_FFT_H
#define OPCFLOW_CORE_FFT_H

#include <complex.h>
#include <stddef.h>

/* The smallest even number >= minimum (and >= 16) that has no prime factor
   above 7. */
int opc_fft_size(double minimum);

/* n bytes, aligned for the transforms; NULL if there is none. */
void *opc_fft_alloc(size_t n);
void opc_fft_free(void *memory);

/* sum a[k] exp(+2 pi i k x), in place, not normalised. */
void opc_fft_backward(int nx, int ny, float complex *data);
/* sum a[x] exp(-2 pi i k x), ny * nx reals to ny * (nx / 2 + 1) numbers; the
   input is lost. */
void opc_fft_forward_real(int nx, int ny, float *in, float complex *out);
/* Its inverse, not normalised; the input is lost. */
void opc_fft_backward_real(int nx, int ny, float complex *in, float *out);

#endif
