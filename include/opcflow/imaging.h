/* SPDX-License-Identifier: BSD-3-Clause */
/* Fields, mask spectra, and the services that turn one into the other.

   Everything is periodic: a frame is the period. The clear field has the
   intensity 1; masks are dark where shapes are drawn (chrome lines, positive
   resist). */
#ifndef OPCFLOW_IMAGING_H
#define OPCFLOW_IMAGING_H

#include <opcflow/geometry.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The period: lower left corner and sides, nm. Frozen. */
typedef struct opc_frame {
  double x0, y0, width, height;
} opc_frame;

/* A smooth real function of the plane as a periodic quintic B-spline: value at
   (x, y) = sum c[i, j] b((x - x0) / dx - i) b((y - y0) / dy - j), b centred.
   c[i, j] = coefficients[j * nx + i]. A constant added to all coefficients is
   added to the function; sums and multiples of functions are those of their
   coefficients. Frozen. */
typedef struct opc_field {
  opc_frame frame;
  int32_t nx, ny;            /* dx = width / nx, dy = height / ny */
  float *coefficients;       /* from host->alloc */
} opc_field;

/* The Fourier coefficients of a mask's transmission for frequencies of at most
   `band` (1/nm): t(x, y) = sum a[k, l] exp(2 pi i (k (x - x0) / width +
   l (y - y0) / height)). The mask is real, so only k >= 0 is there:
   re, im of a[k, l] are data[2 * ((l mod rows) * columns + k)] and the next,
   0 <= k < columns, |l| <= (rows - 1) / 2. Zero beyond the band. Frozen. */
typedef struct opc_spectrum {
  opc_frame frame;
  double band;
  int32_t columns, rows;     /* rows is odd */
  float *data;               /* from host->alloc */
} opc_spectrum;

/* Since 1.2. The transfer function of a system at (fx, -fy) is that of `system` at
   (fx, fy), conjugated or not; at (-fx, fy) it is the same, times -1 if `odd`. */
typedef struct opc_mirrored {
  size_t system;
  int32_t conjugate, odd;
} opc_mirrored;

/* A sum of coherent systems: intensity = sum over s of weight[s] |E_s|^2, E_s
   the mask seen through the transfer function of s. */
typedef struct opc_systems {
  size_t size;               /* sizeof(opc_systems) */
  size_t count;
  const double *weight;
  double band;               /* transfer is zero beyond it, 1/nm */
  double intensity_band;     /* of the intensity, 1/nm: 2 NA / wavelength */
  /* Fill out[2 * i], out[2 * i + 1] with re, im of the transfer function of
     system s at the frequencies (fx[i], fy), i < n. [any] */
  void (*transfer)(const void *self, size_t s, const double *fx, double fy,
                   size_t n, float *out);
  const void *self;
  /* The transmission of the mask is offset + scale * (its spectrum), complex;
     1 for scale and 0 for offset where it is as given. */
  double offset[2], scale[2];
  /* If residual is not NULL, one more system, number `count`, is squared by
     itself and filtered before it is added: its spectrum at (fx[i], fy) is
     multiplied by out[i]. What is left of a sum that was cut off. [any] */
  void (*residual)(const void *self, const double *fx, double fy, size_t n,
                   float *out);
  /* Since 1.2. How system s is mirrored; NULL if it is not known. `transfer` is
     then asked for fx >= 0 and fy >= 0 only: a quarter of the work. [any] */
  opc_mirrored (*mirror)(const void *self, size_t s);
} opc_systems;

/* All [any]. */
struct opc_imaging_service {
  size_t size;

  /* The spectrum of a mask: clear, dark in `shapes` (merged, in units of
     `grid` nm; those that leave the frame come in again on the other side).
     Exact but for single precision: the shapes are laid on a raster through
     the antiderivative of a B-spline, which is divided out again. Edges may
     have any angle. */
  int (*mask_spectrum)(const opc_host *host, const opc_shapes *shapes,
                       double grid, opc_frame frame, double band,
                       opc_spectrum *out, opc_error *error);

  /* The image of a mask through a sum of coherent systems, as a field on a
     grid of at most `step` nm (0: 32 nm). */
  int (*coherent_sum)(const opc_host *host, const opc_spectrum *mask,
                      const opc_systems *systems, double step, opc_field *out,
                      opc_error *error);

  /* The values of a field at n points (nm). */
  void (*sample)(const opc_field *field, const double *x, const double *y,
                 size_t n, double *out);

  /* Contours of value 0: closed lines of points in nm, the positive side on
     the left, one after another: line i has the points start[i] ..
     start[i+1]-1, as x, y pairs. Points lie where the contour crosses the
     lines of a grid of `step` nm. Only what lies in `window`; lines are cut
     there along its border. Both arrays are freed with host->free. */
  int (*contours)(const opc_host *host, const opc_field *field,
                  opc_frame window, double step, double **points,
                  uint32_t **start, size_t *count, opc_error *error);

  /* host->free of the array in it; the struct is cleared. */
  void (*release_spectrum)(const opc_host *host, opc_spectrum *spectrum);
  void (*release_field)(const opc_host *host, opc_field *field);

  /* The values of a field and of its derivatives along x and y (1/nm) at n
     points; each array but x and y may be NULL. */
  void (*gradient)(const opc_field *field, const double *x, const double *y,
                   size_t n, double *value, double *dx, double *dy);

  /* All below work in place. On failure the field is lost but still there to
     be released.

     Convolve a field with a Gaussian of standard deviation `sigma` (nm, 0: as
     it is) in both directions, around the period. */
  int (*diffuse)(const opc_host *host, opc_field *field, double sigma,
                 opc_error *error);

  /* The same function on a grid of at most `step` nm, which may be finer or
     coarser. What has no period longer than two of either grid's steps is
     cut off. */
  int (*resample)(const opc_host *host, opc_field *field, double step,
                  opc_error *error);

  /* From coefficients to the values at the nodes (x0 + i dx, y0 + j dy), in
     their place, and from such values to the coefficients of the field that
     goes through them. */
  int (*samples)(const opc_host *host, opc_field *field, opc_error *error);
  int (*from_samples)(const opc_host *host, opc_field *field,
                      opc_error *error);

  /* Since 1.1. The nearest sign change of a field on the line through (x, y)
     along x (axis 0) or y (1): its distance from that point, nm, positive
     towards larger coordinates, within +-reach; NAN if there is none. [any] */
  double (*edge)(const opc_field *field, int axis, double x, double y,
                 double reach);
};

#ifdef __cplusplus
}
#endif
#endif
