/* SPDX-License-Identifier: BSD-3-Clause */
/* Images of masks: fields (real functions of the plane, such as intensities),
   spectra of masks, and the transforms between them. [any]: opcflow/plugin.h.

   Everything is periodic with the period of a frame. The clear field has
   intensity 1; masks are dark inside drawn shapes (chrome lines, positive
   resist). */
#pragma once

#include <eda/geometry.h>

OPC_C_BEGIN

/* One period of the plane: lower left corner and side lengths, nm. */
typedef struct eda_frame {
  double x0, y0, width, height;
} eda_frame;

/* A smooth real function of the plane as a periodic quintic B-spline. Value at
   (x, y) = sum c[i, j] b((x - x0) / dx - i) b((y - y0) / dy - j), where b is
   centred and c[i, j] = coefficients[j * nx + i]. Adding a constant to all
   coefficients adds the constant to the function. Linear combinations of
   functions are linear combinations of coefficients. */
typedef struct eda_field {
  eda_frame frame;
  int32_t nx, ny;      /* dx = width / nx, dy = height / ny */
  float *coefficients; /* allocated by eda_alloc */
} eda_field;

/* Return i modulo n > 0, in 0 .. n - 1, for periodic node numbers. [any] */
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
  float *data;           /* allocated by eda_alloc */
} eda_spectrum;

/* Symmetry of a kernel. Its transfer function at (fx, -fy) equals the transfer
   function of kernel number `kernel` at (fx, fy), conjugated if `conjugate`.
   Its transfer function at (-fx, fy) equals its value at (fx, fy), times -1 if
   `odd`. */
typedef struct eda_mirrored {
  size_t kernel;
  int32_t conjugate, odd;
} eda_mirrored;

/* Largest number of residual terms (eda_kernels.residual). */
enum { EDA_RESIDUALS = 2 };

/* A sum of coherent kernels (SOCS): intensity = sum over s of weight[s]
   |E_s|^2, where E_s is the mask filtered by the transfer function of kernel
   s. */
typedef struct eda_kernels {
  size_t count;          /* number of kernels */
  const double *weight;  /* [count] */
  double band;           /* cut-off of the transfer functions, 1/nm */
  double intensity_band; /* cut-off of the intensity, 1/nm: 2 NA / wavelength */
  /* Fill out[2 * i], out[2 * i + 1] with the real and imaginary part of the
     transfer function of kernel s at the frequencies (fx[i], fy), i < n.
     [any] */
  void (*transfer)(const void *self, size_t s, const double *fx, double fy,
                   size_t n, float *out);
  const void *self; /* first argument of the functions */
  /* The transmission of the mask is offset + scale * t(x, y), t being the
     function that the spectrum describes. Both numbers are complex (real,
     imaginary part). Scale 0 counts as 1. */
  double offset[2], scale[2];
  /* Number of residual terms (at most EDA_RESIDUALS), which approximate the sum
     of the kernels beyond `count`. Term k is the intensity of kernel count + k,
     filtered: the spectrum of |E|^2 at (fx[i], fy), (-fx[i], fy), (fx[i], -fy)
     is multiplied by out[i]. [any] */
  size_t residuals;
  void (*residual)(const void *self, size_t k, const double *fx, double fy,
                   size_t n, float *out);
  /* Return the symmetry of kernel s. NULL: unknown; otherwise `transfer` is
     called for fx >= 0 and fy >= 0 only. [any] */
  eda_mirrored (*mirror)(const void *self, size_t s);
} eda_kernels;

/* All functions are [any]. Functions that take a context use its threads and
   return the same bits for any number of threads, and on all processors with
   AVX2 and FMA (eda/simd.h). The caller frees results by the _clear functions;
   on failure results are zeroed. Frames without area or too large for a field
   return OPC_INVALID; cancelled work returns OPC_CANCELLED. */

/* Compute the spectrum of a mask up to `band`, 1/nm. The transmission is 0 in
   `shapes` (merged, in units of `grid` nm, wrapped around at the frame) and 1
   elsewhere. Edges may have any angle. The result is exact up to single
   precision: the shapes, convolved with a B-spline, are rasterised, and the
   spectrum is deconvolved (source: imaging/raster.c). */
OPC_EXPORT int eda_mask_spectrum(const opc_context *context,
                                 const eda_shapes *shapes, double grid,
                                 eda_frame frame, double band,
                                 eda_spectrum *out, opc_error *error);

/* Compute the intensity of a mask through a sum of coherent kernels on a grid
   of at most `step` nm (0: 32 nm). The kernels are from source points (Abbe) or
   transmission cross coefficients (Hopkins). */
OPC_EXPORT int eda_coherent_sum(const opc_context *context,
                                const eda_spectrum *mask,
                                const eda_kernels *kernels, double step,
                                eda_field *out, opc_error *error);

/* Compute the gradient of F, the integral over a frame of weight * intensity,
   with respect to the mask. The gradient at a point is the change of F per area
   (nm^2) added to the shapes. `weight` and *out have the same grid and contain
   values at nodes, not coefficients. The numbers of nodes along x and y are
   even and exceed the numbers of frequencies of the mask's spectrum. Residual
   terms are omitted. Return OPC_INVALID for other numbers of nodes and for
   kernels with the function `mirror`. [any] */
OPC_EXPORT int eda_coherent_gradient(const opc_context *context,
                                     const eda_spectrum *mask,
                                     const eda_kernels *kernels,
                                     const eda_field *weight, eda_field *out,
                                     opc_error *error);

/* Estimated size of an image of many kernels, for a model of a given band,
   1/nm: columns and rows of the Fourier transforms; memory of the computation
   including the image (`bytes`), and of the image alone (`field`), bytes. */
typedef struct eda_image_size {
  double columns, rows, bytes, field;
} eda_image_size;
/* Return the estimated size of an image of a frame. */
OPC_EXPORT eda_image_size eda_image_forecast(eda_frame frame, double band);

/* Return the width of the clear field around a layout, nm: sqrt(0.05 / error) /
   band, for a model of the band `band`, 1/nm. This width keeps the error of the
   intensity by periodic repetition below `error` (clear field: 1), since the
   influence of a shape falls with the square of its distance. The factor 0.05
   was measured on lines, rows of transistors and a block. Sources had sigma 0.3
   to 0.9 or were annular; the defocus was up to 80 nm. The worst case reaches
   the bound. [any] */
OPC_EXPORT double eda_margin(double band, double error);

/* Evaluate a field at n points (nm). */
OPC_EXPORT void eda_field_sample(const eda_field *field, const double *x,
                                 const double *y, size_t n, double *out);

/* Compute the contours of value 0 inside `window`: closed lines with the
   positive side on the left, closed along the border of the window. Line i has
   the points start[i] .. start[i+1]-1 (pairs x, y, nm), where the contour
   crosses the lines of a grid of `step` nm. Free *points and *start ([*count +
   1]) with free(); both are NULL on failure. Errors: OPC_INVALID for too many
   steps, OPC_CANCELLED. Method: marching squares (Lorensen, Cline 1987); points
   are refined on the field to 1e-3 nm. */
OPC_EXPORT int eda_contours(const opc_context *context, const eda_field *field,
                            eda_frame window, double step, double **points,
                            uint32_t **start, size_t *count, opc_error *error);

/* Free the array and clear the struct. */
OPC_EXPORT void eda_spectrum_clear(eda_spectrum *spectrum);
OPC_EXPORT void eda_field_clear(eda_field *field);

/* Return the product of a field and a factor, a new field. */
OPC_EXPORT eda_field eda_field_scaled(const eda_field *field, double factor);

/* Displace a field by (x, y), nm, for example by an overlay error. [any] */
OPC_UNUSED static inline void eda_field_shift(eda_field *field, double x,
                                              double y) {
  field->frame.x0 += x;
  field->frame.y0 += y;
}

/* Evaluate a field and its derivatives along x and y (1/nm) at n points (x, y).
   Each of the arrays value, dx and dy may be NULL. */
OPC_EXPORT void eda_field_gradient(const eda_field *field, const double *x,
                                   const double *y, size_t n, double *value,
                                   double *dx, double *dy);

/* The next four functions work in place. The first two return OPC_INVALID and
   leave the field unchanged if `sigma` < 0 or not finite, or `step` <= 0 or too
   small.

   Convolve a field with a Gaussian of standard deviation `sigma` (nm, 0: no
   change) in both directions, with periodic wrap-around. */
OPC_EXPORT int eda_field_diffuse(const opc_context *context, eda_field *field,
                                 double sigma, opc_error *error);

/* Resample the field on a finer or coarser grid of at most `step` nm.
   Components with periods of less than two steps of either grid are removed. */
OPC_EXPORT int eda_field_resample(const opc_context *context, eda_field *field,
                                  double step, opc_error *error);

/* eda_field_samples: replace the coefficients by the values at the nodes (x0 +
   i dx, y0 + j dy). eda_field_from_samples: replace such values by the
   coefficients of the interpolating spline. */
OPC_EXPORT void eda_field_samples(const opc_context *context, eda_field *field);
OPC_EXPORT void eda_field_from_samples(const opc_context *context,
                                       eda_field *field);

/* Return the signed distance, nm, from (x, y) to the nearest sign change of a
   field along x (axis 0) or y (axis 1), within +-reach; NAN without sign
   change. Close pairs of sign changes are found, too: the signs of the spline's
   Bernstein coefficients bound the number of sign changes. */
OPC_EXPORT double eda_field_edge(const eda_field *field, int axis, double x,
                                 double y, double reach);

/* Return the edge placement error at the site (x, y), nm: the distance to the
   next sign change along `axis`, at most `reach`. If the field is positive at
   the site, the search goes outwards (`out`: +1 or -1 along the axis) and the
   error is positive. Otherwise the search goes inwards and the error is
   negative. NAN without sign change. */
OPC_EXPORT double eda_field_epe(const eda_field *field, int axis, int out,
                                double x, double y, double reach);

OPC_C_END
