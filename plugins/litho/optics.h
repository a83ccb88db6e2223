/* SPDX-License-Identifier: BSD-3-Clause */
/* Scanner of the imaging models: source, pupil, transmission of the mask, and
   the parameters that declare them. */
#pragma once

#include <eda/litho.h>
#include <opcflow/plugin.h>

/* ---- parameters ---- */

/* Shapes of the source. Radii are relative to the numerical aperture. */
enum {
  OPTICS_CIRCULAR,   /* disk of radius sigma */
  OPTICS_ANNULAR,    /* ring from sigma_in to sigma */
  OPTICS_DIPOLE,     /* two disks of radius (sigma - sigma_in) / 2 */
  OPTICS_QUADRUPOLE, /* four disks of radius (sigma - sigma_in) / 2; with
                        rotation 0 on the axes */
  OPTICS_QUASAR,     /* four sectors of an annulus, of angle `opening` */
  OPTICS_LIST        /* parameter points: x1, y1, weight1, x2, ... */
};

/* Polarisation: scalar wave, or polarised field (vector.h). Directions are
   those in the pupil. */
enum {
  OPTICS_SCALAR,
  OPTICS_UNPOLARISED, /* half along x, half along y, incoherent */
  OPTICS_POLARISED_X,
  OPTICS_POLARISED_Y,
  OPTICS_TANGENTIAL, /* perpendicular to the direction from the centre to the
                        source point: azimuthal, TE */
  OPTICS_RADIAL      /* along the direction from the centre: TM */
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
  double wavelength, na, index; /* wavelength, nm; numerical aperture;
                                   refractive index of the medium */
  int polarisation;
  double resist_index; /* refractive index of the resist, for polarised light */
  int resist_index_given;
  int source;
  double sigma, sigma_in;   /* radii of the source, in units of the pupil's
                               radius */
  double opening, rotation; /* angle of a pole, and rotation, degrees */
  opc_reals points;         /* for OPTICS_LIST */
  double defocus;           /* distance of the wafer from the focus, nm */
  opc_reals zernike;        /* waves, fringe (University of Arizona) order, from
                               Z1 */
  struct {
    int dark; /* 1: dark field */
    double transmission, phase;
  } mask[2];              /* of poly and of active */
  int given[OPTICS_USES]; /* 1: set by the flow */
  int zernike_given;

  /* The members below are set by optics_check. */
  double cutoff; /* NA / wavelength, 1/nm */
  /* Real and imaginary part of the amplitude behind the background and behind
     the drawn features, of the masks of poly (0) and active (1). A binary
     clear-field mask has the background 1 and the features 0. */
  double background[2][2], feature[2][2];
} optics;

/* Parameters of a plugin whose instance has the type `state` and a member
   `optics`. Use in the array of parameters:
     static const opc_parameter parameters[] = {OPTICS_PARAMETERS(state), ...};
 */
/* clang-format off */ /* clang-format would nest the elements */
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
   .summary = "refractive index of the resist, for polarised light; with the " \
              "index of the medium, the image is above the resist",           \
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

/* Check the values and set the derived members. Call from opc_plugin.check.
   Return OPC_OK, or OPC_INVALID if a value is out of range, values contradict
   each other, or the source does not use a given parameter. */
int optics_check(optics *o, opc_error *error);

/* Return the scanner for eda_litho.scanner. */
static inline eda_scanner optics_scanner(const optics *o) {
  return (eda_scanner){o->wavelength, o->na};
}

/* Log a warning if the light is scalar and the NA too large for scalar light.
 */
void optics_warn(const optics *o, const opc_host *host);

/* optics_is_radial: return 1 if the optics are rotationally symmetric: circular
   or annular source, no polarisation along x or y, and only rotationally
   symmetric Zernike terms. optics_is_real: return 1 if the pupil is real: in
   focus, without Zernike terms. */
int optics_is_radial(const optics *o);
int optics_is_real(const optics *o);

/* Return the largest radius of the source. */
double optics_source_radius(const optics *o);

/* Return the source as n points: x, y, weight of each. There is one point for
   each cell of a square grid of `spacing`, in units of the cutoff, with a
   corner of cells at the origin. The point is the centroid of the part of the
   cell inside the source, and its weight is proportional to the area of that
   part. For OPTICS_LIST, the listed points are returned. The sum of weights
   is 1. Return NULL if the source is too thin for the spacing. The caller frees
   the array with free(). */
double *optics_source_points(const optics *o, double spacing, size_t *n);

/* Compute the pupil at (fx, fy): 0 beyond radius 1, else exp(i phase). The
   phase is the exact (not paraxial) defocus in the medium minus the defocus on
   the axis, plus the Zernike terms. `defocus`, nm, is added to optics.defocus.
 */
void optics_pupil(const optics *o, double defocus, double fx, double fy,
                  double *re, double *im);

/* Return 1 if all masks are real: binary, or with a phase of 0 or 180 degrees.
 */
int optics_real_masks(const optics *o);

/* Compute the complex coefficients of the amplitude transmission a + b * mask.
   `mask` is 0 in drawn features and 1 elsewhere. In the spectrum, a applies at
   zero frequency only. */
void optics_amplitudes(const optics *o, int layer, double a[2], double b[2]);
