/* SPDX-License-Identifier: BSD-3-Clause */
/* Fields, mask spectra, and the transforms between them.

   Everything is periodic with the period of a frame. The clear field has
   intensity 1; masks are dark inside drawn shapes (chrome lines, positive
   resist). */
#pragma once

#include <eda/geometry.h>

OPC_C_BEGIN

/* The period: lower left corner and side lengths, nm. */
typedef struct eda_frame {
  double x0, y0, width, height;
} eda_frame;

/* A smooth real function of the plane as a periodic quintic B-spline. Value at
   (x, y) = sum c[i, j] b((x - x0) / dx - i) b((y - y0) / dy - j), where b is
   centred and c[i, j] = coefficients[j * nx + i]. Adding a constant to all
   coefficients adds the constant to the function. Sums and multiples of
   functions are those of their coefficients. */
typedef struct eda_field {
  eda_frame frame;
  int32_t nx, ny;      /* dx = width / nx, dy = height / ny */
  float *coefficients; /* from eda_alloc */
} eda_field;

/* Return the node number i modulo n > 0, in 0 .. n - 1. [any] */
static inline int eda_wrap(int i, int n) {
  if (i >= 0 && i < n) return i;
  i %= n;
  return i < 0 ? i + n : i;
}

/* The Fourier coefficients of a mask's transmission for frequencies up to
   `band` (1/nm). t(x, y) = sum a[k, l] exp(2 pi i (k (x - x0) / width + l (y -
   y0) / height)). The mask is real, so only k >= 0 is stored. The real and
   imaginary parts of a[k, l] are data[2 * ((l mod rows) * columns + k)] and the
   next element; 0 <= k < columns, |l| <= (rows - 1) / 2. Coefficients beyond
   the band are zero. */
typedef struct eda_spectrum {
  eda_frame frame;
  double band;
  int32_t columns, rows; /* rows is odd */
  float *data;           /* from eda_alloc */
} eda_spectrum;

/* Symmetry of a kernel: its transfer function at (fx, -fy) is that of the
   kernel `kernel` at (fx, fy), conjugated or not; at (-fx, fy) the value is the
   same, times -1 if `odd`. */
typedef struct eda_mirrored {
  size_t kernel;
  int32_t conjugate, odd;
} eda_mirrored;

enum { EDA_RESIDUALS = 2 };

/* A sum of coherent kernels (SOCS): intensity = sum over s of weight[s]
   |E_s|^2, E_s being the mask filtered by the transfer function of kernel s. */
typedef struct eda_kernels {
  size_t count;
  const double *weight;
  double band;           /* cut-off of the transfer functions, 1/nm */
  double intensity_band; /* cut-off of the intensity, 1/nm: 2 NA / wavelength */
  /* Fill out[2 * i], out[2 * i + 1] with the real and imaginary part of the
     transfer function of kernel s at the frequencies (fx[i], fy), i < n.
     [any] */
  void (*transfer)(const void *self, size_t s, const double *fx, double fy,
                   size_t n, float *out);
  const void *self;
  /* Transmission of the mask = offset + scale * (its spectrum), complex. Scale
     1 and offset 0 use the spectrum as given. */
  double offset[2], scale[2];
  /* Number of residual terms of a truncated sum (at most EDA_RESIDUALS),
     numbered from `count` on. Each residual kernel is squared and then
     filtered. The spectrum of the square of kernel count + k at (fx[i], fy) is
     multiplied by out[i], and by the same factor at -fx and -fy. [any] */
  size_t residuals;
  void (*residual)(const void *self, size_t k, const double *fx, double fy,
                   size_t n, float *out);
  /* Return the symmetry of kernel s. NULL: symmetry unknown; otherwise
     `transfer` is called for fx >= 0 and fy >= 0 only, a quarter of the work.
     [any] */
  eda_mirrored (*mirror)(const void *self, size_t s);
} eda_kernels;

/* All functions are [any]. Functions that take a context use its threads and
   return the same bits for any number of threads, and on all processors with
   AVX2 and FMA (eda/simd.h). The caller clears results, which are zeroed on
   failure. Frames without area or too large for a field return OPC_INVALID;
   cancelled work returns OPC_CANCELLED. */

/* Compute the spectrum of a mask up to `band`, 1/nm: transmission 1, dark in
   `shapes` (merged, in units of `grid` nm; shapes that leave the frame wrap
   around). Exact up to single precision: the shapes are rasterised through the
   antiderivative of a B-spline, which is then deconvolved (source:
   imaging/raster.c). Edges may have any angle. */
OPC_EXPORT int eda_mask_spectrum(const opc_context *context,
                                 const eda_shapes *shapes, double grid,
                                 eda_frame frame, double band,
                                 eda_spectrum *out, opc_error *error);

/* Compute the intensity of a mask through a sum of coherent kernels on a grid
   of at most `step` nm (0: 32 nm). The kernels are source points of Abbe's
   method, or those of Hopkins' transmission cross coefficients. */
OPC_EXPORT int eda_coherent_sum(const opc_context *context,
                                const eda_spectrum *mask,
                                const eda_kernels *kernels, double step,
                                eda_field *out, opc_error *error);

/* Compute the gradient of F, the integral over a frame of weight * intensity,
   with respect to the mask. The gradient is the change of F per area (nm^2)
   added to the shapes at a place. `weight` and *out, which gets the grid of
   `weight`, have values at their nodes. Both sides of the grid are even and
   have more nodes than the mask's spectrum has frequencies within the band.
   Residual terms are omitted. Return OPC_INVALID for kernels with `mirror` and
   for other grids. [any] */
OPC_EXPORT int eda_coherent_gradient(const opc_context *context,
                                     const eda_spectrum *mask,
                                     const eda_kernels *kernels,
                                     const eda_field *weight, eda_field *out,
                                     opc_error *error);

/* Lower bound of the size of an image with models of a given band (1/nm):
   points of its Fourier transforms, bytes in total (spectrum and image
   included), and bytes of the image itself. */
typedef struct eda_image_size {
  double columns, rows, bytes, field;
} eda_image_size;
OPC_EXPORT eda_image_size eda_image_forecast(eda_frame frame, double band);

/* Return the width of the clear field around a layout, nm: sqrt(0.05 / error) /
   band, for a model of that band (1/nm). It keeps the change of the image by
   periodic repetition below `error` (clear field 1). The contribution of light
   from a distance falls with its inverse square. Measured on long lines, rows
   of transistors and a block, with margins of 0.5 to 4 um against 16 um, sigma
   0.3 to 0.9, an annular source, and 80 nm defocus. The worst case reaches the
   bound, a block stays at a third. Half the factor is too little for an annular
   source; doubling the factor costs 1.3 um at 1e-4. [any] */
OPC_EXPORT double eda_margin(double band, double error);

/* Evaluate a field at n points (nm). */
OPC_EXPORT void eda_field_sample(const eda_field *field, const double *x,
                                 const double *y, size_t n, double *out);

/* Compute the contours of value 0 inside `window`: closed lines of points in nm
   with the positive side on the left. Line i has the points start[i] ..
   start[i+1]-1, as x, y pairs, where the contour crosses the lines of a grid of
   `step` nm. Lines are closed along the border of the window. Free *points and
   *start ([*count + 1]) with free(); both are NULL on failure. Return
   OPC_INVALID for a window of too many steps, or OPC_CANCELLED. Marching
   squares (Lorensen, Cline 1987); each point is refined on the field to 1e-3
   nm. */
OPC_EXPORT int eda_contours(const opc_context *context, const eda_field *field,
                            eda_frame window, double step, double **points,
                            uint32_t **start, size_t *count, opc_error *error);

/* Free the array and clear the struct. */
OPC_EXPORT void eda_spectrum_clear(eda_spectrum *spectrum);
OPC_EXPORT void eda_field_clear(eda_field *field);

/* Return a new field: the field times a factor. */
OPC_EXPORT eda_field eda_field_scaled(const eda_field *field, double factor);

/* Evaluate a field and its derivatives along x and y (1/nm) at n points. Each
   array except x and y may be NULL. */
OPC_EXPORT void eda_field_gradient(const eda_field *field, const double *x,
                                   const double *y, size_t n, double *value,
                                   double *dx, double *dy);

/* The next four functions work in place. They return OPC_INVALID for a `sigma`
   or `step` that is not a length and leave the field unchanged.

   Convolve a field with a Gaussian of standard deviation `sigma` (nm, 0: no
   change) in both directions, with periodic wrap-around. */
OPC_EXPORT int eda_field_diffuse(const opc_context *context, eda_field *field,
                                 double sigma, opc_error *error);

/* Resample the function on a grid of at most `step` nm, finer or coarser.
   Components with periods of less than two steps of either grid are removed. */
OPC_EXPORT int eda_field_resample(const opc_context *context, eda_field *field,
                                  double step, opc_error *error);

/* Replace the coefficients by the values at the nodes (x0 + i dx, y0 + j dy);
   and replace such values by the coefficients of the interpolating field. */
OPC_EXPORT void eda_field_samples(const opc_context *context, eda_field *field);
OPC_EXPORT void eda_field_from_samples(const opc_context *context,
                                       eda_field *field);

/* Return the distance from (x, y) to the nearest sign change of a field along x
   (axis 0) or y (1), nm, positive towards larger coordinates, within +-reach;
   NAN if there is none. Close pairs are found: the signs of the spline's
   Bernstein coefficients show where sign changes are possible. */
OPC_EXPORT double eda_field_edge(const eda_field *field, int axis, double x,
                                 double y, double reach);

/* Return the edge placement error at the site (x, y), nm: the distance to the
   next sign change along `axis`, at most `reach`. If the field is positive at
   the site, the sign change is searched outwards (`out`: +1 or -1 along the
   axis) and the error is positive; otherwise inwards, and the error is
   negative. NAN if there is none. */
OPC_EXPORT double eda_field_epe(const eda_field *field, int axis, int out,
                                double x, double y, double reach);

OPC_C_END
