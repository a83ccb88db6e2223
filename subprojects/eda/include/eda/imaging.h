/* SPDX-License-Identifier: BSD-3-Clause */
/* Fields, mask spectra, and what turns one into the other.

   Everything is periodic: a frame is the period. The clear field has the
   intensity 1; masks are dark where shapes are drawn (chrome lines, positive
   resist). */
#ifndef EDA_IMAGING_H
#define EDA_IMAGING_H

#include <eda/geometry.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The period: lower left corner and sides, nm. */
typedef struct eda_frame {
  double x0, y0, width, height;
} eda_frame;

/* A smooth real function of the plane as a periodic quintic B-spline: value at
   (x, y) = sum c[i, j] b((x - x0) / dx - i) b((y - y0) / dy - j), b centred.
   c[i, j] = coefficients[j * nx + i]. A constant added to all coefficients is
   added to the function; sums and multiples of functions are those of their
   coefficients. */
typedef struct eda_field {
  eda_frame frame;
  int32_t nx, ny;      /* dx = width / nx, dy = height / ny */
  float *coefficients; /* from eda_alloc */
} eda_field;

/* The number of a node, i modulo n > 0: within 0 .. n - 1. [any] */
static inline int eda_wrap(int i, int n) {
  if (i >= 0 && i < n) return i;
  i %= n;
  return i < 0 ? i + n : i;
}

/* The Fourier coefficients of a mask's transmission for frequencies of at most
   `band` (1/nm): t(x, y) = sum a[k, l] exp(2 pi i (k (x - x0) / width +
   l (y - y0) / height)). The mask is real, so only k >= 0 is there:
   re, im of a[k, l] are data[2 * ((l mod rows) * columns + k)] and the next,
   0 <= k < columns, |l| <= (rows - 1) / 2. Zero beyond the band. */
typedef struct eda_spectrum {
  eda_frame frame;
  double band;
  int32_t columns, rows; /* rows is odd */
  float *data;           /* from eda_alloc */
} eda_spectrum;

/* The transfer function of a system at (fx, -fy) is that of `system` at
   (fx, fy), conjugated or not; at (-fx, fy) it is the same, times -1 if `odd`.
 */
typedef struct eda_mirrored {
  size_t system;
  int32_t conjugate, odd;
} eda_mirrored;

enum { EDA_RESIDUALS = 2 };

/* A sum of coherent systems: intensity = sum over s of weight[s] |E_s|^2, E_s
   the mask seen through the transfer function of s. */
typedef struct eda_systems {
  size_t count;
  const double *weight;
  double band;           /* transfer is zero beyond it, 1/nm */
  double intensity_band; /* of the intensity, 1/nm: 2 NA / wavelength */
  /* Fill out[2 * i], out[2 * i + 1] with re, im of the transfer function of
     system s at the frequencies (fx[i], fy), i < n. [any] */
  void (*transfer)(const void *self, size_t s, const double *fx, double fy,
                   size_t n, float *out);
  const void *self;
  /* The transmission of the mask is offset + scale * (its spectrum), complex;
     1 for scale and 0 for offset where it is as given. */
  double offset[2], scale[2];
  /* What is left of a sum that was cut off: so many more systems (at most
     EDA_RESIDUALS) from number `count` on, each squared by itself and filtered
     before it is added: the spectrum of the square of system count + k at
     (fx[i], fy) is multiplied by out[i], the same for -fx and -fy. [any] */
  size_t residuals;
  void (*residual)(const void *self, size_t k, const double *fx, double fy,
                   size_t n, float *out);
  /* How system s is mirrored; NULL if it is not known. `transfer` is
     then asked for fx >= 0 and fy >= 0 only: a quarter of the work. [any] */
  eda_mirrored (*mirror)(const void *self, size_t s);
} eda_systems;

/* All functions are [any]; those that take a context spread their work over its
   threads and give the same bits for any number of them, and on all processors
   with AVX2 and FMA (eda/simd.h). A result is the caller's, who clears it; it
   is zeroed on failure. Frames without area or too large for a field are
   refused with OPC_INVALID; OPC_CANCELLED once the user stops the work. */

/* The spectrum of a mask up to `band`, 1/nm: clear, dark in `shapes` (merged,
   in units of `grid` nm; those that leave the frame come in again on the other
   side). Exact but for single precision: the shapes are laid on a raster
   through the antiderivative of a B-spline, which is divided out again. Edges
   may have any angle (imaging/raster.c tells the source). */
OPC_EXPORT int eda_mask_spectrum(const opc_context *context,
                                 const eda_shapes *shapes, double grid,
                                 eda_frame frame, double band,
                                 eda_spectrum *out, opc_error *error);

/* The intensity of a mask through a sum of coherent systems (a source by Abbe,
   or the kernels of Hopkins' transmission cross coefficients), as a field on a
   grid of at most `step` nm (0: 32 nm). */
OPC_EXPORT int eda_coherent_sum(const opc_context *context,
                                const eda_spectrum *mask,
                                const eda_systems *systems, double step,
                                eda_field *out, opc_error *error);

/* How F, the integral over a frame of weight * intensity, changes with the
   mask: the rate at which F grows with the area (nm^2) of what is added to its
   shapes at a place. `weight` and *out, which gets its grid, have values at
   their nodes; both sides of the grid are even and have more nodes than the
   mask's spectrum has frequencies within the systems' band. Residuals are left
   out. OPC_INVALID for systems with `mirror` and for other grids. [any] */
OPC_EXPORT int eda_coherent_gradient(const opc_context *context,
                                     const eda_spectrum *mask,
                                     const eda_systems *systems,
                                     const eda_field *weight, eda_field *out,
                                     opc_error *error);

/* What an image of a mask takes at least, with models of that band (1/nm): the
   points of its Fourier transforms, and bytes, its spectrum and itself among
   them; and how many of these are itself. */
typedef struct eda_image_size {
  double columns, rows, bytes, field;
} eda_image_size;
OPC_EXPORT eda_image_size eda_image_forecast(eda_frame frame, double band);

/* How much clear field (nm) around a layout keeps what its frame repeats from
   changing its image by more than `error`, clear field 1, with a model of that
   band (1/nm): sqrt(0.05 / error) / band. What light from a distance adds falls
   as its inverse square. Measured: long lines, rows of transistors and a block,
   margins of 0.5 to 4 um against 16 um, for sigma 0.3 to 0.9, a ring, and 80 nm
   out of focus; the worst of them reach it, a block stays at a third. Half the
   factor is too little for a ring; double costs 1.3 um at 1e-4. [any] */
OPC_EXPORT double eda_margin(double band, double error);

/* The values of a field at n points (nm). */
OPC_EXPORT void eda_field_sample(const eda_field *field, const double *x,
                                 const double *y, size_t n, double *out);

/* Contours of value 0: closed lines of points in nm, the positive side on
   the left, one after another: line i has the points start[i] ..
   start[i+1]-1, as x, y pairs. Points lie where the contour crosses the
   lines of a grid of `step` nm. Only what lies in `window`; lines are cut
   there along its border. *points and *start ([*count + 1]) are freed with
   free(); NULL on failure: OPC_INVALID for a window of too many steps,
   OPC_CANCELLED. Marching squares (Lorensen, Cline 1987), each point then
   found on the field, to 1e-3 nm. */
OPC_EXPORT int eda_contours(const opc_context *context, const eda_field *field,
                            eda_frame window, double step, double **points,
                            uint32_t **start, size_t *count, opc_error *error);

/* Free the array and zero the struct. */
OPC_EXPORT void eda_spectrum_clear(eda_spectrum *spectrum);
OPC_EXPORT void eda_field_clear(eda_field *field);

/* A field times a factor, a new one. */
OPC_EXPORT eda_field eda_field_scaled(const eda_field *field, double factor);

/* The values of a field and of its derivatives along x and y (1/nm) at n
   points; each array but x and y may be NULL. */
OPC_EXPORT void eda_field_gradient(const eda_field *field, const double *x,
                                   const double *y, size_t n, double *value,
                                   double *dx, double *dy);

/* The next four work in place. A `sigma` or `step` that is no length is refused
   with OPC_INVALID; the field then stays as it is.

   Convolve a field with a Gaussian of standard deviation `sigma` (nm, 0: as
   it is) in both directions, around the period. */
OPC_EXPORT int eda_field_diffuse(const opc_context *context, eda_field *field,
                                 double sigma, opc_error *error);

/* The same function on a grid of at most `step` nm, which may be finer or
   coarser. What has no period longer than two of either grid's steps is
   cut off. */
OPC_EXPORT int eda_field_resample(const opc_context *context, eda_field *field,
                                  double step, opc_error *error);

/* From coefficients to the values at the nodes (x0 + i dx, y0 + j dy), in
   their place, and from such values to the coefficients of the field that
   goes through them. */
OPC_EXPORT void eda_field_samples(const opc_context *context, eda_field *field);
OPC_EXPORT void eda_field_from_samples(const opc_context *context,
                                       eda_field *field);

/* The nearest sign change of a field on the line through (x, y), nm, along x
   (axis 0) or y (1): its distance from that point, nm, positive towards larger
   coordinates, within +-reach; NAN if there is none. Close pairs are not
   missed: the signs of the spline's Bernstein coefficients tell where there may
   be any. */
OPC_EXPORT double eda_field_edge(const eda_field *field, int axis, double x,
                                 double y, double reach);

/* The placement error of an edge whose site is (x, y): along the line through
   it parallel to `axis` to the next sign change, nm, at most `reach` away.
   Where the field is positive that lies outwards (`out`: +1 or -1 along the
   axis) and the error is positive; else inwards, and negative. NAN if there is
   none. */
OPC_EXPORT double eda_field_epe(const eda_field *field, int axis, int out,
                                double x, double y, double reach);

#ifdef __cplusplus
}
#endif
#endif
