/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "litho": required functions, tests of a plugin, and the template of a
   new one. */
#include <eda/litho.h>
#include <math.h>
#include <string.h>

#include "../try.h"
#include "templates.h"

/* Number of tested layers. Flows may have more layers than poly and active. */
enum { LAYERS = 3 };

/* Allowed deviation from the clear-field intensity 1. Models with truncated
   kernels deviate by about 1e-3. */
static const double clear_tolerance = 0.02;
/* Plausible intensities, relative to the clear field. Truncated kernels cause
   slightly negative intensities; interference of partially coherent light
   raises the intensity, to at most 2 at an edge. */
static const double darkest = -0.05, brightest = 3;
/* Allowed difference between the intensities of the same mask in two frames.
   The image is periodic, and the copies of the shapes are 1.5 um away. */
static const double frame_tolerance = 0.05;

/* Errors requested from image_fine, relative to the clear field. Two images may
   differ by the sum of the errors and `rounding`, for single precision. */
static const double coarse_error = 2e-3, fine_error = 5e-4, rounding = 2e-5;

/* ---- calls ---- */

static int image_call(opc_inspector *in, const opc_module *m, int layer,
                      const eda_spectrum *mask, double defocus,
                      eda_field *out) {
  const eda_litho *o = m->functions;
  opc_error error = {0};
  const char *before = eda_enter(in->context, m, &error);
  int code = defocus == 0
                 ? o->image(m->self, layer, mask, out, &error)
                 : o->image_at(m->self, layer, mask, defocus, out, &error);
  opc_leave(in->context, before);
  return try_went_well(in, defocus == 0 ? "image" : "image_at", code, &error);
}

static int call_fine(opc_inspector *in, const opc_module *m, int layer,
                     const eda_spectrum *mask, double wanted, eda_field *out) {
  const eda_litho *o = m->functions;
  opc_error error = {0};
  const char *before = eda_enter(in->context, m, &error);
  int code = o->image_fine(m->self, layer, mask, 0, wanted, out, &error);
  opc_leave(in->context, before);
  return try_went_well(in, "image_fine", code, &error);
}

static void try_image(opc_inspector *in, const opc_module *m, int layer,
                      const eda_spectrum *mask, double defocus) {
  eda_field field = {0};
  if (image_call(in, m, layer, mask, defocus, &field))
    try_field(in, "image", "intensity", &field, &mask->frame);
  eda_field_clear(&field);
}

/* Compute the intensity of a layer (see try_mask) at PLACES points of a line
   through the transistors. Return 0 on failure. */
enum { PLACES = 64 };

static int spectrum_sample(opc_inspector *in, const opc_module *m, int layer,
                           const eda_frame *frame, double *value) {
  const eda_litho *o = m->functions;
  eda_spectrum mask;
  eda_field field = {0};
  opc_error error = {0};
  double x[PLACES], y[PLACES];
  for (int i = 0; i < PLACES; i++) {
    x[i] = -400 + 900.0 * i / (PLACES - 1);
    y[i] = 200 + 500.0 * i / (PLACES - 1);
  }
  if (!try_mask(in, layer, frame, o->band(m->self), &mask)) return 0;
  int good =
      image_call(in, m, layer < 0 ? EDA_POLY : layer, &mask, 0, &field) &&
      !eda_check_field(&field, frame, "intensity", &error);
  if (good) eda_field_sample(&field, x, y, PLACES, value);
  eda_field_clear(&field);
  eda_spectrum_clear(&mask);
  return good;
}

/* ---- requirements of images ---- */

static void try_clear_field(opc_inspector *in, const opc_module *m) {
  double value[PLACES];
  if (!spectrum_sample(in, m, TRY_EMPTY, &try_frame, value)) return;
  /* If the layer has a dark-field mask, the shapes are clear. */
  if (fabs(value[0]) <= clear_tolerance &&
      !spectrum_sample(in, m, TRY_FULL, &try_frame, value))
    return;
  for (int i = 0; i < PLACES; i++)
    if (!(fabs(value[i] - 1) <= clear_tolerance)) {
      in->find(in, "image: the intensity of the clear field is %g, expected 1",
               value[i]);
      return;
    }
}

static void try_range(opc_inspector *in, const opc_module *m) {
  double value[PLACES], other[PLACES];
  if (!spectrum_sample(in, m, EDA_POLY, &try_frame, value)) return;
  for (int i = 0; i < PLACES; i++)
    if (value[i] < darkest || value[i] > brightest) {
      in->find(
          in, "image: the intensity %g is not between 0 and a few clear fields",
          value[i]);
      return;
    }
  if (!spectrum_sample(in, m, EDA_POLY, &try_other_frame, other)) return;
  for (int i = 0; i < PLACES; i++)
    if (fabs(value[i] - other[i]) > frame_tolerance) {
      in->find(in,
               "image: the same mask has the intensity %g in one frame and %g "
               "in another",
               value[i], other[i]);
      return;
    }
}

/* Check that two images of a mask by image_fine differ by at most the requested
   errors, and that a defocused image is valid. */
static void try_fine(opc_inspector *in, const opc_module *m, int layer,
                     const eda_spectrum *mask) {
  const eda_litho *o = m->functions;
  eda_field field[2] = {{.nx = 0}}, away = {0};
  opc_error error = {0};
  double x[PLACES], y[PLACES], value[2][PLACES];
  for (int i = 0; i < PLACES; i++) {
    x[i] = mask->frame.x0 + mask->frame.width * i / PLACES;
    y[i] = mask->frame.y0 + mask->frame.height * (i * 5 % PLACES) / PLACES;
  }
  for (int k = 0; k < 2; k++) {
    if (call_fine(in, m, layer, mask, k ? fine_error : coarse_error,
                  &field[k]) &&
        !eda_check_field(&field[k], &mask->frame, "intensity", &error))
      eda_field_sample(&field[k], x, y, PLACES, value[k]);
    else
      value[k][0] = NAN;
    try_field(in, "image_fine", "intensity", &field[k], &mask->frame);
  }
  double allowed = coarse_error + fine_error + rounding;
  for (int i = 0; i < PLACES && !isnan(value[0][0] + value[1][0]); i++)
    if (!(fabs(value[0][i] - value[1][i]) <= allowed)) {
      in->find(in,
               "image_fine: the intensity for the error %g is %g, for the "
               "error %g %g",
               coarse_error, value[0][i], fine_error, value[1][i]);
      break;
    }
  if (o->image_at && try_went_well(in, "image_fine",
                                   o->image_fine(m->self, layer, mask, 50,
                                                 coarse_error, &away, &error),
                                   &error))
    try_field(in, "image_fine", "intensity", &away, &mask->frame);
  for (int k = 0; k < 2; k++) eda_field_clear(&field[k]);
  eda_field_clear(&away);
}

/* Check that image_optics without other optics computes the image of
   image_fine, within the requested errors. */
static void try_optics(opc_inspector *in, const opc_module *m, int layer,
                       const eda_spectrum *mask) {
  const eda_litho *o = m->functions;
  eda_field field[2] = {{.nx = 0}};
  opc_error error = {0};
  const char *before = eda_enter(in->context, m, &error);
  int code = o->image_optics(m->self, layer, mask, NAN, NAN, 0, coarse_error,
                             &field[0], &error);
  opc_leave(in->context, before);
  if (!try_went_well(in, "image_optics", code, &error)) return;
  if (!eda_check_field(&field[0], &mask->frame, "intensity", &error) &&
      o->image_fine && call_fine(in, m, layer, mask, coarse_error, &field[1])) {
    double x = mask->frame.x0, y = mask->frame.y0, value[2];
    for (int k = 0; k < 2; k++)
      eda_field_sample(&field[k], &x, &y, 1, &value[k]);
    if (!(fabs(value[0] - value[1]) <= 2 * coarse_error + rounding))
      in->find(in,
               "image_optics: the intensity without other optics is %g, by "
               "image_fine %g",
               value[0], value[1]);
  }
  try_field(in, "image_optics", "intensity", &field[0], &mask->frame);
  eda_field_clear(&field[0]);
  eda_field_clear(&field[1]);
}

/* Check the spectrum of a mask by the model's own transform, and that `image`
   accepts the spectrum. */
static void try_transform(opc_inspector *in, const opc_module *m) {
  const eda_litho *o = m->functions;
  const eda_gates *g = eda_gates_sample();
  eda_spectrum mask = {0}, usual;
  opc_error error = {0};
  int code = o->transform(m->self, &g->drawn[EDA_POLY], g->grid, try_frame,
                          &mask, &error);
  if (!try_mask(in, EDA_POLY, &try_frame, o->band(m->self), &usual)) return;
  if (try_went_well(in, "transform", code, &error)) {
    if (!mask.data || mask.columns != usual.columns || mask.rows != usual.rows)
      in->find(in,
               "transform: a mask has %d x %d frequencies, expected %d x %d "
               "from the band",
               mask.columns, mask.rows, usual.columns, usual.rows);
    else
      try_image(in, m, EDA_POLY, &mask, 0);
  }
  eda_spectrum_clear(&mask);
  eda_spectrum_clear(&usual);
}

/* ---- several callers ---- */

/* Masks of the tested layers, and their images: those by `image`, then those by
   `image_fine` if the model has this function. */
typedef struct images {
  const opc_module *m;
  eda_spectrum mask[LAYERS];
  eda_field field[2 * LAYERS];
} images;

static int same_image(void *data, size_t i) {
  const images *all = data;
  const eda_litho *o = all->m->functions;
  const eda_field *was = &all->field[i];
  const eda_spectrum *mask = &all->mask[i % LAYERS];
  int layer = (int)(i % LAYERS);
  eda_field field = {0};
  opc_error error = {0};
  int code = i < LAYERS ? o->image(all->m->self, layer, mask, &field, &error)
                        : o->image_fine(all->m->self, layer, mask, 0,
                                        coarse_error, &field, &error);
  int same = !code && field.nx == was->nx && field.ny == was->ny &&
             !memcmp(field.coefficients, was->coefficients,
                     (size_t)field.nx * (size_t)field.ny * sizeof(float));
  eda_field_clear(&field);
  return same;
}

static void try_callers(opc_inspector *in, const opc_module *m) {
  const eda_litho *o = m->functions;
  images all = {.m = m};
  int good = 1;
  size_t n = o->image_fine ? 2 * LAYERS : LAYERS;
  for (int i = 0; i < LAYERS && good; i++)
    good = try_mask(in, i, &try_frame, o->band(m->self), &all.mask[i]) &&
           image_call(in, m, i, &all.mask[i], 0, &all.field[i]);
  for (int i = 0; i < LAYERS && good && o->image_fine; i++)
    good =
        call_fine(in, m, i, &all.mask[i], coarse_error, &all.field[LAYERS + i]);
  if (good && !try_at_once(n, same_image, &all))
    in->find(in,
             "image returns different bits while other threads call the "
             "function, although declared [any]");
  for (int i = 0; i < LAYERS; i++) {
    eda_spectrum_clear(&all.mask[i]);
    eda_field_clear(&all.field[i]);
    eda_field_clear(&all.field[LAYERS + i]);
  }
}

/* ---- all ---- */

static void exercise(const opc_module *m, opc_inspector *in) {
  const eda_litho *o = m->functions;
  opc_error error = {0};
  const char *before = eda_enter(in->context, m, &error);
  int code = o->prepare(m->self, &error);
  opc_leave(in->context, before);
  if (!try_went_well(in, "prepare", code, &error)) return;
  before = eda_enter(in->context, m, &error);
  double band = o->band(m->self);
  opc_leave(in->context, before);
  if (!(band > 0) || !isfinite(band)) {
    in->find(in, "the band is %g 1/nm", band);
    return;
  }
  for (int layer = 0; layer < LAYERS; layer++) {
    eda_spectrum mask;
    if (!try_mask(in, layer, &try_frame, band, &mask)) return;
    try_image(in, m, layer, &mask, 0);
    if (o->image_at) try_image(in, m, layer, &mask, 50);
    if (o->image_fine) try_fine(in, m, layer, &mask);
    if (o->image_optics) try_optics(in, m, layer, &mask);
    eda_spectrum_clear(&mask);
  }
  if (o->transform) try_transform(in, m);
  try_clear_field(in, m);
  try_range(in, m);
  try_callers(in, m);
}

/* ---- entry ---- */

static const opc_function required[] = {OPC_FUNCTION(eda_litho, prepare),
                                        OPC_FUNCTION(eda_litho, band),
                                        OPC_FUNCTION(eda_litho, image)};
OPC_KIND("litho", eda_litho, "litho models: aerial image of a mask");
