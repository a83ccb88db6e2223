/* SPDX-License-Identifier: BSD-3-Clause */
/* What every scalar imaging model needs to know of the scanner: the source,
   the pupil and the mask's transmission, with the parameters that declare
   them. Compiled into each litho plugin that uses it. */
#ifndef OPCFLOW_LITHO_OPTICS_H
#define OPCFLOW_LITHO_OPTICS_H

#include <opcflow/imaging.h>

/* ---- parameters ---- */

/* Declare these first, in this order, then those of the plugin's own:
     static const opc_parameter parameters[] = {OPTICS_PARAMETERS, ...};
   and number the plugin's own from OPTICS_COUNT. */
enum {
  OPTICS_WAVELENGTH, OPTICS_NA, OPTICS_INDEX,
  OPTICS_SOURCE, OPTICS_SIGMA, OPTICS_SIGMA_IN, OPTICS_OPENING, OPTICS_ROTATION,
  OPTICS_POINTS, OPTICS_DEFOCUS, OPTICS_ZERNIKE,
  OPTICS_POLY_TONE, OPTICS_POLY_TRANSMISSION, OPTICS_POLY_PHASE,
  OPTICS_ACTIVE_TONE, OPTICS_ACTIVE_TRANSMISSION, OPTICS_ACTIVE_PHASE,
  OPTICS_COUNT
};

/* Fringe Zernike terms that there are, Z1 to Z37. */
enum { OPTICS_TERMS = 37 };

#define OPTICS_PARAMETERS                                                      \
  [OPTICS_WAVELENGTH] = {.name = "wavelength", .type = OPC_REAL,               \
                         .flags = OPC_ABOVE, .unit = "nm",                     \
                         .preset = "193 nm",                                   \
                         .summary = "wavelength of the light in vacuum"},      \
  [OPTICS_NA] = {.name = "na", .type = OPC_REAL,                               \
                 .flags = OPC_ABOVE | OPC_AT_MOST, .preset = "0.75",           \
                 .min = 0, .max = 1.35,                                        \
                 .summary = "numerical aperture, at most the index"},          \
  [OPTICS_INDEX] = {.name = "index", .type = OPC_REAL,                         \
                    .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "1",        \
                    .min = 1, .max = 2,                                        \
                    .summary = "refractive index of the medium over the "      \
                               "wafer: 1 for air, 1.44 for water"},            \
  [OPTICS_SOURCE] = {.name = "source", .type = OPC_CHOICE,                     \
                     .preset = "circular",                                     \
                     .choices = "circular|annular|dipole|quadrupole|quasar|"   \
                                "points",                                      \
                     .summary = "shape of the source"},                        \
  [OPTICS_SIGMA] = {.name = "sigma", .type = OPC_REAL,                         \
                    .flags = OPC_ABOVE | OPC_AT_MOST, .preset = "0.75",        \
                    .min = 0, .max = 1,                                        \
                    .summary = "outer radius of the source over that of the "  \
                               "pupil"},                                       \
  [OPTICS_SIGMA_IN] = {.name = "sigma_in", .type = OPC_REAL,                   \
                       .flags = OPC_AT_LEAST | OPC_BELOW, .min = 0, .max = 1,  \
                       .summary = "inner radius of an annular, dipole, "       \
                                  "quadrupole or quasar source"},              \
  [OPTICS_OPENING] = {.name = "opening", .type = OPC_REAL,                     \
                      .flags = OPC_ABOVE | OPC_AT_MOST, .unit = "deg",         \
                      .preset = "30 deg", .min = 0, .max = 90,                 \
                      .summary = "angle that each pole of a quasar covers"},   \
  [OPTICS_ROTATION] = {.name = "rotation", .type = OPC_REAL, .unit = "deg",    \
                       .preset = "0 deg",                                      \
                       .summary = "of the poles, counter-clockwise; 0 deg: "   \
                                  "on the axes, those of a dipole on x"},      \
  [OPTICS_POINTS] = {.name = "points", .type = OPC_REALS,                      \
                     .summary = "x, y and weight of each point of a source "   \
                                "given so, the pupil's radius 1"},             \
  [OPTICS_DEFOCUS] = {.name = "defocus", .type = OPC_REAL, .unit = "nm",       \
                      .preset = "0 nm",                                        \
                      .summary = "distance of the wafer from the focus"},      \
  [OPTICS_ZERNIKE] = {.name = "zernike", .type = OPC_REALS,                    \
                      .summary = "aberrations in waves, fringe terms from "    \
                                 "Z1, at most 37"},                            \
  OPTICS_MASK(POLY, "poly"), OPTICS_MASK(ACTIVE, "active")

#define OPTICS_MASK(id, layer)                                                 \
  [OPTICS_##id##_TONE] = {.name = layer ".tone", .type = OPC_CHOICE,           \
                          .preset = "clear", .choices = "clear|dark",          \
                          .summary = "field of the " layer " mask: clear with "\
                                     "dark features, or dark with clear ones"},\
  [OPTICS_##id##_TRANSMISSION] = {.name = layer ".transmission",               \
                                  .type = OPC_REAL,                            \
                                  .flags = OPC_AT_LEAST | OPC_AT_MOST,         \
                                  .unit = "%", .preset = "0 %", .min = 0,      \
                                  .max = 100,                                  \
                                  .summary = "of its dark parts, intensity; "  \
                                             "0 % for a binary mask"},         \
  [OPTICS_##id##_PHASE] = {.name = layer ".phase", .type = OPC_REAL,           \
                           .unit = "deg", .preset = "180 deg",                 \
                           .summary = "of the light through its dark parts"}

enum {
  OPTICS_CIRCULAR,     /* disk of radius sigma */
  OPTICS_ANNULAR,      /* sigma_in to sigma */
  OPTICS_DIPOLE,       /* two disks of radius (sigma - sigma_in) / 2 */
  OPTICS_QUADRUPOLE,   /* four such disks, on the axes at rotation 0 */
  OPTICS_QUASAR,       /* four sectors of an annulus, `opening` wide */
  OPTICS_LIST          /* points: x1, y1, weight1, x2, ... */
};

/* ---- the optics ---- */

/* Frequencies below are in units of the cutoff NA / wavelength. */
typedef struct optics {
  double wavelength, na, index;     /* nm, 1, 1 */
  double cutoff;                    /* 1/nm */
  int source;
  double sigma, sigma_in;           /* of the pupil's radius */
  double opening, rotation;         /* degrees */
  const double *points;             /* of OPTICS_LIST, 3 * n_points */
  size_t n_points;
  double defocus;                   /* nm */
  const double *zernike;            /* waves, fringe (University of Arizona)
                                       order, from Z1 */
  size_t n_zernike;
  /* Amplitude of the clear and the drawn parts of a layer's mask, real and
     imaginary: 1 and 0 for a binary clear-field mask. */
  double background[2][2], feature[2][2];
} optics;

/* Read the values; 0 and *error (with the parameter at fault) if they do not
   fit together: NA above the index, a source outside the pupil or empty, an
   inner radius above the outer one. */
int optics_create(const opc_host *host, const opc_value *values, optics *out,
                  opc_error *error);

/* Is everything a radial function: circular or annular source, no Zernike
   terms but rotationally symmetric ones? And is the pupil real (in focus, no
   terms at all)? */
int optics_is_radial(const optics *o);
int optics_is_real(const optics *o);

/* The largest radius of the source. */
double optics_source_radius(const optics *o);

/* The source as a point for each cell of a square grid of `spacing` (in units
   of the cutoff, the origin a corner of four cells), at the centroid of the
   part of its cell within the source and weighted by that part; weights sum to
   1. x, y, weight interleaved, free() it; NULL if there is no memory. An
   OPTICS_LIST is given as it is, normalised. */
double *optics_source_points(const optics *o, double spacing, size_t *n);

/* The pupil at (fx, fy): 0 beyond radius 1, else exp(i phase): defocus in the
   medium, exact (not paraxial), less its value on the axis, and the Zernike
   terms. `defocus` nm is added to that of the optics. */
void optics_pupil(const optics *o, double defocus, double fx, double fy,
                  double *re, double *im);

/* Is the layer's mask real (binary, or with a phase of 0 or 180 degrees)? */
int optics_real_mask(const optics *o, int layer);

/* The transmission is a + b * (mask as given): complex a (at zero frequency
   only) and b. */
void optics_amplitudes(const optics *o, int layer, double a[2], double b[2]);

#endif
