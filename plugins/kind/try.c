/* SPDX-License-Identifier: BSD-3-Clause */
/* Masks and prints of the sample's transistors for the exercises of all kinds,
   and telling what is wrong with what a plugin hands back. */
#include "try.h"

const eda_frame try_frame = {-1000, -1000, 2500, 3000};

/* ---- telling ---- */

int try_went_well(opc_inspector *in, const char *what, int code,
                  opc_error *error) {
  if (!code) return 1;
  error->message[sizeof error->message - 1] = 0;
  if (code < OPC_INVALID || code > OPC_CANCELLED)
    in->find(in, "%s returned the unknown code %d", what, code);
  else if (!*error->message)
    in->find(in, "%s failed without a message", what);
  else
    in->note(in, "%s: %s", what, error->message);
  return 0;
}

int try_is_sound(opc_inspector *in, const char *what, int code,
                 const opc_error *error) {
  if (code) in->find(in, "%s: %s", what, error->message);
  return !code;
}

void try_field(opc_inspector *in, const char *function, const char *what,
               const eda_field *field, const eda_frame *frame) {
  opc_error error = {0};
  int code = eda_check_field(field, frame, what, &error);
  if (try_is_sound(in, function, code, &error))
    in->add(
        in, field->coefficients,
        (size_t)field->nx * (size_t)field->ny * sizeof *field->coefficients);
}

/* ---- a mask and a model ---- */

int try_mask(opc_inspector *in, int layer, double band, eda_spectrum *mask) {
  const eda_gates *g = eda_gates_sample();
  opc_error error = {0};
  size_t drawn = (size_t)layer < g->layers ? (size_t)layer : EDA_POLY;
  if (!eda_mask_spectrum(in->context, &g->drawn[drawn], g->grid, try_frame,
                         band, mask, &error))
    return 1;
  in->find(in, "a mask of its band of %g 1/nm: %s", band, error.message);
  return 0;
}

/* The transfer function at the frequency f is 1 / (1 + (cut f)^2)^2, cut in nm;
   at the limit (1/nm) it is 1/289 of its largest value. */
static const double cut = 120, limit = 4 / 120.0;

static int prepare(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static double band(const void *self) {
  (void)self;
  return limit;
}

static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  (void)self, (void)s;
  for (size_t i = 0; i < n; i++) {
    double r = (fx[i] * fx[i] + fy * fy) * cut * cut;
    out[2 * i] = (float)(1 / ((1 + r) * (1 + r)));
    out[2 * i + 1] = 0;
  }
}

static int image(const void *self, int layer, const eda_spectrum *mask,
                 eda_field *out, opc_error *error) {
  static const double one = 1;
  const opc_inspector *in = self;
  (void)layer;
  const eda_systems systems = {.count = 1,
                               .weight = &one,
                               .band = limit,
                               .intensity_band = 2 * limit,
                               .transfer = transfer,
                               .scale = {1, 0}};
  return eda_coherent_sum(in->context, mask, &systems, 0, out, error);
}

opc_module try_litho(const opc_inspector *in) {
  static const eda_litho functions = {
      .prepare = prepare, .band = band, .image = image};
  return (opc_module){&functions, (void *)in, "lint.litho"};
}

int try_print(opc_inspector *in, int layer, eda_field *intensity) {
  eda_spectrum mask;
  opc_error error = {0};
  if (!try_mask(in, layer, limit, &mask)) return 0;
  int code = image(in, layer, &mask, intensity, &error);
  eda_spectrum_clear(&mask);
  return try_is_sound(in, "the litho model of lint", code, &error);
}
