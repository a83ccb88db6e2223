/* SPDX-License-Identifier: BSD-3-Clause */
/* Wrapper of a litho model that checks the results. The simulation of printed
   images calls the model, and so does the calibration of a resist. This file
   separates faults of the model from faults of the resist. */
#include <eda/print.h>
#include <math.h>
#include <string.h>

#include "gates/fence.h"

/* Store the first failure in m->fault; safe when several threads call the
   model. */
static int model_keep_failure(eda_model *m, int code, opc_error *error) {
  if (!eda_blame(error, code, "litho")) return OPC_OK;
  if (!__atomic_exchange_n(&m->failed, 1, __ATOMIC_SEQ_CST)) m->fault = *error;
  return error->code;
}

static const eda_litho *inner_model(const eda_model *m) {
  return m->litho->functions;
}

static int model_prepare(void *self, opc_error *error) {
  eda_model *m = self;
  const char *before = eda_enter(m->context, m->litho, error);
  int code = inner_model(m)->prepare(m->litho->self, error);
  double band = code ? 1 : inner_model(m)->band(m->litho->self);
  opc_leave(m->context, before);
  if (!(band > 0) || !isfinite(band))
    code = opc_fail(error, OPC_FAILED, NULL, "the band is %g 1/nm", band);
  return model_keep_failure(m, code, error);
}

static double model_band(const void *self) {
  const eda_model *m = self;
  const char *before = opc_enter(m->context, m->litho->id);
  double value = inner_model(m)->band(m->litho->self);
  opc_leave(m->context, before);
  return value;
}

/* Check the image or gradient `out` that the plugin returned, and leave the
   plugin. */
static int take_image(eda_model *m, int code, const char *before,
                      const eda_spectrum *mask, eda_field *out,
                      opc_error *error) {
  if (!code) code = eda_check_field(out, &mask->frame, "intensity", error);
  /* Writing guard words here accesses the values before opc_leave, so that a
     crash by an invalid pointer is attributed to the plugin. */
  if (!code) fence_field(out);
  opc_leave(m->context, before);
  return model_keep_failure(m, code, error);
}

static eda_scanner model_scanner(const void *self) {
  const eda_model *m = self;
  const char *before = opc_enter(m->context, m->litho->id);
  eda_scanner value = inner_model(m)->scanner(m->litho->self);
  opc_leave(m->context, before);
  return value;
}

static int model_image(const void *self, int layer, const eda_spectrum *mask,
                       eda_field *out, opc_error *error) {
  eda_model *m = (eda_model *)self;
  memset(out, 0, sizeof *out);
  const char *before = eda_enter(m->context, m->litho, error);
  int code = inner_model(m)->image(m->litho->self, layer, mask, out, error);
  return take_image(m, code, before, mask, out, error);
}

static int image_at(const void *self, int layer, const eda_spectrum *mask,
                    double defocus, eda_field *out, opc_error *error) {
  eda_model *m = (eda_model *)self;
  if (defocus == 0) return model_image(self, layer, mask, out, error);
  memset(out, 0, sizeof *out);
  const char *before = eda_enter(m->context, m->litho, error);
  int code = inner_model(m)->image_at(m->litho->self, layer, mask, defocus, out,
                                      error);
  return take_image(m, code, before, mask, out, error);
}

static int image_fine(const void *self, int layer, const eda_spectrum *mask,
                      double defocus, double wanted, eda_field *out,
                      opc_error *error) {
  eda_model *m = (eda_model *)self;
  memset(out, 0, sizeof *out);
  if (m->fine > 0 && m->fine < wanted) wanted = m->fine;
  const char *before = eda_enter(m->context, m->litho, error);
  int code = inner_model(m)->image_fine(m->litho->self, layer, mask, defocus,
                                        wanted, out, error);
  return take_image(m, code, before, mask, out, error);
}

static int image_optics(const void *self, int layer, const eda_spectrum *mask,
                        double na, double sigma, double defocus, double wanted,
                        eda_field *out, opc_error *error) {
  eda_model *m = (eda_model *)self;
  memset(out, 0, sizeof *out);
  const char *before = eda_enter(m->context, m->litho, error);
  int code = inner_model(m)->image_optics(m->litho->self, layer, mask, na,
                                          sigma, defocus, wanted, out, error);
  return take_image(m, code, before, mask, out, error);
}

static int model_gradient(const void *self, int layer, const eda_spectrum *mask,
                          double defocus, const eda_field *weight,
                          eda_field *out, opc_error *error) {
  eda_model *m = (eda_model *)self;
  memset(out, 0, sizeof *out);
  const char *before = eda_enter(m->context, m->litho, error);
  int code = inner_model(m)->gradient(m->litho->self, layer, mask, defocus,
                                      weight, out, error);
  return take_image(m, code, before, mask, out, error);
}

/* Check that the spectrum of a mask from the plugin has frame `f`, a size
   consistent with the band, and finite values. */
static int check_spectrum(const eda_spectrum *s, const eda_frame *f,
                          opc_error *error) {
  const eda_frame *g = &s->frame;
  if (!s->data || g->x0 != f->x0 || g->y0 != f->y0 || g->width != f->width ||
      g->height != f->height || !(s->band > 0) ||
      !(s->columns == floor(f->width * s->band) + 1) ||
      !(s->rows == 2 * floor(f->height * s->band) + 1))
    return opc_fail(error, OPC_FAILED, NULL,
                    "the spectrum of a mask has %d x %d frequencies and the "
                    "band %g 1/nm, for a frame of %g x %g nm",
                    s->columns, s->rows, s->band, f->width, f->height);
  size_t n = 2 * (size_t)s->columns * (size_t)s->rows;
  for (size_t i = 0; i < n; i++)
    if (!isfinite(s->data[i]))
      return opc_fail(error, OPC_FAILED, NULL,
                      "the spectrum of a mask is not finite");
  return OPC_OK;
}

static int model_transform(const void *self, const eda_shapes *mask,
                           double grid, eda_frame frame, eda_spectrum *out,
                           opc_error *error) {
  eda_model *m = (eda_model *)self;
  memset(out, 0, sizeof *out);
  const char *before = eda_enter(m->context, m->litho, error);
  int code =
      inner_model(m)->transform(m->litho->self, mask, grid, frame, out, error);
  if (!code) code = check_spectrum(out, &frame, error);
  opc_leave(m->context, before);
  return model_keep_failure(m, code, error);
}

int eda_litho_spectrum(const opc_context *context, const opc_module *litho,
                       const eda_shapes *mask, double grid, eda_frame frame,
                       eda_spectrum *out, opc_error *error) {
  const eda_litho *l = litho->functions;
  if (l->transform)
    return l->transform(litho->self, mask, grid, frame, out, error);
  return eda_mask_spectrum(context, mask, grid, frame, l->band(litho->self),
                           out, error);
}

void eda_model_init(eda_model *m, const opc_context *context,
                    const opc_module *litho) {
  *m = (eda_model){.litho = litho, .context = context};
  const eda_litho *there = inner_model(m);
  m->functions =
      (eda_litho){.prepare = model_prepare,
                  .band = model_band,
                  .image = model_image,
                  .image_at = there->image_at ? image_at : NULL,
                  .image_fine = there->image_fine ? image_fine : NULL,
                  .transform = there->transform ? model_transform : NULL,
                  .gradient = there->gradient ? model_gradient : NULL,
                  .scanner = there->scanner ? model_scanner : NULL,
                  .image_optics = there->image_optics ? image_optics : NULL};
  m->module = (opc_module){&m->functions, m, litho->id};
}
