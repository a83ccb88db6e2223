/* SPDX-License-Identifier: BSD-3-Clause */
/* Scanner of the imaging models: source, pupil, transmission of the mask, and
   the parameters that declare them. */
#pragma once

#include <eda/litho.h>
#include <opcflow/plugin.h>

/* ---- parameters ---- */

enum {
  OPTICS_CIRCULAR,   /* disk of radius sigma */
  OPTICS_ANNULAR,    /* sigma_in to sigma */
  OPTICS_DIPOLE,     /* two disks of radius (sigma - sigma_in) / 2 */
  OPTICS_QUADRUPOLE, /* four such disks, on the axes at rotation 0 */
  OPTICS_QUASAR,     /* four sectors of an annulus, `opening` wide */
  OPTICS_LIST        /* parameter points: x1, y1, weight1, x2, ... */
};

/* Polarisation: scalar wave, or a field polarised in a direction in the pupil
   (vector.h). */
enum {
  OPTICS_SCALAR,
  OPTICS_UNPOLARISED, /* half along x, half along y, incoherent */
  OPTICS_POLARISED_X,
  OPTICS_POLARISED_Y,
  OPTICS_TANGENTIAL, /* across the direction from the centre to the source
                        point: azimuthal, TE */
  OPTICS_RADIAL      /* along that direction: TM */
};

/* Parameters that only some sources use. */
enum {
  OPTICS_SIGMA,
  OPTICS_SIGMA_IN,
  OPTICS_OPENING,
  OPTICS_ROTATION,
  OPTICS_POINTS,
  OPTICS_USES
};

/* Number of fringe Zernike terms, Z1 to Z37. */
enum { OPTICS_TERMS = 37 };

/* Settings of the scanner. Frequencies are in units of the cutoff NA /
   wavelength. */
typedef struct optics {
  double wavelength, na, index; /* nm, 1, 1 */
  int polarisation;
  double resist_index; /* for polarised light */
  int resist_index_given;
  int source;
  double sigma, sigma_in;   /* in units of the pupil's radius */
  double opening, rotation; /* degrees */
  opc_reals points;         /* for OPTICS_LIST */
  double defocus;           /* nm */
  opc_reals zernike;        /* waves, fringe (University of Arizona) order, from
                               Z1 */
  struct {
    int dark; /* 1: dark field */
    double transmission, phase;
  } mask[2];              /* of poly and of active */
  int given[OPTICS_USES]; /* 1: set by the flow */
  int zernike_given;

  /* Set by optics_check. */
  double cutoff; /* 1/nm */
  /* Amplitude of the clear and the drawn parts of a mask, real and imaginary: 1
     and 0 for a binary clear-field mask. */
  double background[2][2], feature[2][2];
} optics;

/* The parameters of a plugin whose instance has the type `state` and a member
   `optics`, for its array:
     static const opc_parameter parameters[] = {OPTICS_PARAMETERS(state), ...};
 */
/* clang-format off */ /* it takes the elements for nested ones */
#define OPTICS_PARAMETERS(state)                                              \
  {.name = "wavelength", .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "nm",  \
   .preset = "193 nm", .summary = "wavelength of the light in vacuum",        \
   OPC_FIELD(state, optics.wavelength)},                                      \
  {.name = "na", .type = OPC_REAL, .flags = OPC_ABOVE | OPC_AT_MOST,          \
   .preset = "0.75", .min = 0, .max = 1.35,                                   \
   .summary = "numerical aperture, at most the index",                        \
   OPC_FIELD(state, optics.na)},                                              \
  {.name = "index", .type = OPC_REAL, .flags = OPC_AT_LEAST | OPC_AT_MOST,    \
   .preset = "1", .min = 1, .max = 2,                                         \
   .summary = "refractive index of the medium over the wafer: 1 for air, "    \
              "1.44 for water",                                               \
   OPC_FIELD(state, optics.index)},                                           \
  {.name = "polarisation", .type = OPC_CHOICE, .preset = "scalar",            \
   .choices = "scalar|unpolarised|x|y|tangential|radial",                     \
   .summary = "model of the light: scalar wave, or field with a polarisation "\
              "in the pupil, required above NA 0.9",                          \
   OPC_FIELD(state, optics.polarisation)},                                    \
  {.name = "resist_index", .type = OPC_REAL,                                  \
   .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "1.7", .min = 1, .max = 3,  \
   .summary = "refractive index of the resist, for polarised light; that of " \
              "the medium: image above the resist",                           \
   OPC_FIELD(state, optics.resist_index),                                     \
   .given = offsetof(state, optics.resist_index_given)},                      \
  {.name = "source", .type = OPC_CHOICE, .preset = "circular",                \
   .choices = "circular|annular|dipole|quadrupole|quasar|points",             \
   .summary = "shape of the source", OPC_FIELD(state, optics.source)},        \
  {.name = "sigma", .type = OPC_REAL, .flags = OPC_ABOVE | OPC_AT_MOST,       \
   .preset = "0.75", .min = 0, .max = 1,                                      \
   .summary = "outer radius of the source relative to that of the pupil",     \
   OPC_FIELD(state, optics.sigma), OPTICS_GIVEN(state, OPTICS_SIGMA)},        \
  {.name = "sigma_in", .type = OPC_REAL, .flags = OPC_AT_LEAST | OPC_BELOW,   \
   .min = 0, .max = 1,                                                        \
   .summary = "inner radius of an annular, dipole, quadrupole or quasar "     \
              "source",                                                       \
   OPC_FIELD(state, optics.sigma_in), OPTICS_GIVEN(state, OPTICS_SIGMA_IN)},  \
  {.name = "opening", .type = OPC_REAL, .flags = OPC_ABOVE | OPC_AT_MOST,     \
   .unit = "deg", .preset = "30 deg", .min = 0, .max = 90,                    \
   .summary = "angle covered by each pole of a quasar",                       \
   OPC_FIELD(state, optics.opening), OPTICS_GIVEN(state, OPTICS_OPENING)},    \
  {.name = "rotation", .type = OPC_REAL, .unit = "deg", .preset = "0 deg",    \
   .summary = "rotation of the poles, counter-clockwise; 0 deg: on the axes, "\
              "a dipole on x",                                                \
   OPC_FIELD(state, optics.rotation), OPTICS_GIVEN(state, OPTICS_ROTATION)},  \
  {.name = "points", .type = OPC_REALS,                                       \
   .summary = "x, y and weight of each source point, in units of the pupil's "\
              "radius",                                                       \
   OPC_FIELD(state, optics.points), OPTICS_GIVEN(state, OPTICS_POINTS)},      \
  {.name = "defocus", .type = OPC_REAL, .unit = "nm", .preset = "0 nm",       \
   .summary = "distance of the wafer from the focus",                         \
   OPC_FIELD(state, optics.defocus)},                                         \
  {.name = "zernike", .type = OPC_REALS,                                      \
   .summary = "aberrations in waves, fringe terms from Z1, at most 37",       \
   OPC_FIELD(state, optics.zernike),                                          \
   .given = offsetof(state, optics.zernike_given)},                           \
  OPTICS_MASK(state, "poly", "poly and all layers after active", 0),          \
  OPTICS_MASK(state, "active", "active", 1)

#define OPTICS_GIVEN(state, use) .given = offsetof(state, optics.given[use])

#define OPTICS_MASK(state, layer, what, number)                               \
  {.name = layer ".tone", .type = OPC_CHOICE, .preset = "clear",              \
   .choices = "clear|dark",                                                   \
   .summary = "field of the mask of " what ": clear with dark features, or "  \
              "dark with clear ones",                                         \
   OPC_FIELD(state, optics.mask[number].dark)},                               \
  {.name = layer ".transmission", .type = OPC_REAL,                           \
   .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "%", .preset = "0 %",         \
   .min = 0, .max = 100,                                                      \
   .summary = "intensity transmission of dark parts; 0 %: binary mask",       \
   OPC_FIELD(state, optics.mask[number].transmission)},                       \
  {.name = layer ".phase", .type = OPC_REAL, .unit = "deg",                   \
   .preset = "180 deg",                                                       \
   .summary = "phase of the light through dark parts",                        \
   OPC_FIELD(state, optics.mask[number].phase)}
/* clang-format on */

/* ---- the optics ---- */

/* Check the values and set the derived members. Return OPC_INVALID in these
   cases: the NA exceeds the index; the source is empty or outside the pupil;
   its inner radius exceeds the outer one; a parameter is given that the source
   does not use. For the `check` function of plugins. */
int optics_check(optics *o, opc_error *error);

/* Return the scanner as the contract of the kind requires (eda/litho.h). */
static inline eda_scanner optics_scanner(const optics *o) {
  return (eda_scanner){o->wavelength, o->na};
}

/* Log a warning if the image is scalar at an NA too large for it. */
void optics_warn(const optics *o, const opc_host *host);

/* Return 1 if the optics are rotationally symmetric: circular or annular
   source, no polarisation along x or y, no Zernike terms except rotationally
   symmetric ones. The second function returns 1 if the pupil is real (in focus,
   no terms). */
int optics_is_radial(const optics *o);
int optics_is_real(const optics *o);

/* Return the largest radius of the source. */
double optics_source_radius(const optics *o);

/* Return the source as points (x, y, weight interleaved). There is one point
   for each cell of a square grid of `spacing` (in units of the cutoff, the
   origin a corner of four cells). A point is the centroid of the part of its
   cell inside the source, weighted by the area of that part; weights sum to 1.
   Points of an OPTICS_LIST are returned as listed, with normalised weights.
   NULL if the source is too thin for such cells. Free the result with
   free(). */
double *optics_source_points(const optics *o, double spacing, size_t *n);

/* Compute the pupil at (fx, fy): 0 beyond radius 1, else exp(i phase). The
   phase is the exact (not paraxial) defocus in the medium minus its value on
   the axis, plus the Zernike terms. `defocus` nm is added to that of the
   optics. */
void optics_pupil(const optics *o, double defocus, double fx, double fy,
                  double *re, double *im);

/* Return 1 if all masks are real: binary, or with a phase of 0 or 180
   degrees. */
int optics_real_masks(const optics *o);

/* Compute the complex coefficients of the transmission a + b * (mask as given);
   a applies at zero frequency only. */
void optics_amplitudes(const optics *o, int layer, double a[2], double b[2]);
