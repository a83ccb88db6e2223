/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulations by a litho model whose images are known: constants that depend on
   the clear area of the mask, the layer and the other arguments. The resist
   subtracts a threshold. Faulty models are refused. */
#include <eda/memory.h>
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <string.h>

/* ---- models ---- */

enum { NX = 4, NY = 3, LAYERS = 2 };

/* Faults of the litho model. */
enum {
  GOOD,
  FAILS,
  OTHER_FRAME,
  NO_VALUES,
  NOT_FINITE,
  MORE_NODES,
  NO_BAND,
  ENDLESS_BAND,
  FAILS_TO_PREPARE
};

static int fault;
static double wanted_last, na_last, sigma_last;
static int resist_fails, resist_calls;
static const eda_gates *resist_drawn;

/* Return the mean transmission of a mask. */
static double clear_of(const eda_spectrum *mask) { return mask->data[0]; }

static int image_set(const eda_spectrum *mask, double value, eda_field *out,
                     opc_error *error) {
  if (fault == FAILS) return opc_fail(error, OPC_IO, "lens", "no image");
  *out = (eda_field){.frame = mask->frame, .nx = NX, .ny = NY};
  if (fault == OTHER_FRAME) out->frame.width += 1;
  if (fault == MORE_NODES) out->nx++;
  if (fault == NO_VALUES) return OPC_OK;
  size_t n = (size_t)out->nx * NY;
  out->coefficients = eda_alloc(n, sizeof(float));
  for (size_t i = 0; i < n; i++) out->coefficients[i] = (float)value;
  if (fault == NOT_FINITE) out->coefficients[n - 1] = NAN;
  return OPC_OK;
}

static int model_prepare(void *self, opc_error *error) {
  (void)self;
  return fault == FAILS_TO_PREPARE ? opc_fail(error, OPC_IO, NULL, "no lens")
                                   : OPC_OK;
}

static double model_band(const void *self) {
  (void)self;
  return fault == NO_BAND ? 0 : fault == ENDLESS_BAND ? (double)INFINITY : 0.01;
}

static int model_image(const void *self, int layer, const eda_spectrum *mask,
                       eda_field *out, opc_error *error) {
  (void)self;
  return image_set(mask, clear_of(mask) + layer, out, error);
}

static int model_image_at(const void *self, int layer, const eda_spectrum *mask,
                          double defocus, eda_field *out, opc_error *error) {
  (void)self;
  return image_set(mask, clear_of(mask) + layer + defocus / 100, out, error);
}

/* The fast image lacks 0.1 and a hundredth of the clear area. */
static int model_fine(const void *self, int layer, const eda_spectrum *mask,
                      double defocus, double wanted, eda_field *out,
                      opc_error *error) {
  (void)self;
  wanted_last = wanted;
  return image_set(mask, 1.01 * clear_of(mask) + 0.1 + layer + defocus / 100,
                   out, error);
}

static int model_optics(const void *self, int layer, const eda_spectrum *mask,
                        double na, double sigma, double defocus, double wanted,
                        eda_field *out, opc_error *error) {
  (void)self;
  na_last = na;
  sigma_last = sigma;
  wanted_last = wanted;
  return image_set(mask, layer + defocus, out, error);
}

static int model_gradient(const void *self, int layer, const eda_spectrum *mask,
                          double defocus, const eda_field *weight,
                          eda_field *out, opc_error *error) {
  (void)self;
  return image_set(mask, layer + defocus + weight->coefficients[0], out, error);
}

static eda_scanner model_scanner(const void *self) {
  (void)self;
  return (eda_scanner){193, 0.75};
}

static const eda_litho full = {.prepare = model_prepare,
                               .band = model_band,
                               .image = model_image,
                               .image_at = model_image_at,
                               .image_fine = model_fine,
                               .gradient = model_gradient,
                               .scanner = model_scanner,
                               .image_optics = model_optics};
static const eda_litho least = {
    .prepare = model_prepare, .band = model_band, .image = model_image};

/* Call the litho model as a calibration does; a failure of the model is also
   one of the resist. */
static int resist_prepare(void *self, const opc_module *litho,
                          opc_error *error) {
  (void)self;
  const eda_litho *l = litho->functions;
  eda_spectrum mask;
  eda_shapes none = {0};
  eda_field out = {0};
  eda_frame frame = {0, 0, 300, 200};
  resist_calls++;
  g_assert_cmpint(
      eda_litho_spectrum(NULL, litho, &none, 1, frame, &mask, error), ==, 0);
  int code = l->image_fine
                 ? l->image_fine(litho->self, 0, &mask, 0, 0.01, &out, error)
                 : l->image(litho->self, 0, &mask, &out, error);
  eda_spectrum_clear(&mask);
  eda_field_clear(&out);
  if (code) return opc_fail(error, OPC_FAILED, "level", "not calibrated");
  return resist_fails ? opc_fail(error, OPC_INVALID, "level", "no level")
                      : OPC_OK;
}

static int resist_print(const void *self, int layer, eda_field *field,
                        opc_error *error) {
  (void)self, (void)error;
  for (int i = 0; i < field->nx * field->ny; i++)
    field->coefficients[i] -= 0.5F + (float)layer;
  return resist_fails ? opc_fail(error, OPC_FAILED, NULL, "not developed")
                      : OPC_OK;
}

static void resist_drawn_of(void *self, const eda_gates *gates) {
  (void)self;
  resist_drawn = gates;
}

static const eda_resist developing = {
    .prepare = resist_prepare, .print = resist_print, .drawn = resist_drawn_of};
static const opc_module litho_full = {&full, NULL, "litho.full"},
                        litho_least = {&least, NULL, "litho.least"},
                        resist = {&developing, NULL, "resist.developing"};

/* ---- masks ---- */

/* A mask of one box in both layers. The frame has 660 by 1200 nm. */
typedef struct box_mask {
  eda_point points[4];
  uint32_t start[2];
  eda_shapes shapes[LAYERS];
} box_mask;

static const double whole = 660.0 * 1200;

static box_mask mask_of(int32_t width, int32_t height) {
  return (box_mask){
      .points = {{0, 0}, {width, 0}, {width, height}, {0, height}},
      .start = {0, 4}};
}

static const eda_shapes *shapes_of(box_mask *m) {
  for (int k = 0; k < LAYERS; k++)
    m->shapes[k] = (eda_shapes){1, m->start, m->points, NULL};
  return m->shapes;
}

static void printer_make(eda_printer *p, const opc_module *litho) {
  fault = GOOD;
  resist_fails = 0;
  eda_printer_init(p, NULL, eda_gates_sample(), litho, &resist, 100);
}

static void printer_prepare(eda_printer *p) {
  opc_error error;
  if (eda_printer_prepare(p, &error)) g_error("%s", error.message);
}

static void expect_field(const eda_field *f, double value) {
  g_assert_cmpint(f->nx, ==, NX);
  g_assert_cmpint(f->ny, ==, NY);
  for (int i = 0; i < NX * NY; i++)
    g_assert_cmpfloat_with_epsilon(f->coefficients[i], value, 1e-5);
}

/* ---- tests ---- */

static void test_frame(void) {
  eda_printer p;
  printer_make(&p, &litho_full);
  const eda_frame want = {-300, -100, 660, 1200};
  g_assert_cmpmem(&p.frame, sizeof want, &want, sizeof want);
  g_assert_cmpuint(p.layers, ==, LAYERS);
  /* Two more fields are kept for accurate simulations. */
  eda_image_size one = eda_image_forecast(want, 0.01),
                 two = eda_printer_forecast(&p, 2);
  g_assert_cmpfloat(two.bytes, ==, 2 * one.bytes);
  g_assert_cmpfloat(two.field, ==, 2 * one.field);
  g_assert_cmpfloat(two.columns, ==, one.columns);
  p.fine = 1e-3;
  two = eda_printer_forecast(&p, 2);
  g_assert_cmpfloat(two.bytes, ==, 2 * (one.bytes + 2 * one.field));
  fault = NO_BAND;
  g_assert_cmpfloat(eda_printer_forecast(&p, 2).bytes, ==, 0);
  eda_printer_clear(&p);
  printer_make(&p, &litho_least);
  p.fine = 1e-3;
  g_assert_cmpfloat(eda_printer_forecast(&p, 1).bytes, ==, one.bytes);
  eda_printer_clear(&p);
}

/* The spectrum of a mask is that of the frame; level sets are images minus the
   threshold; images are kept only on request. */
static void test_fast(void) {
  opc_error error;
  eda_printer p;
  box_mask mask = mask_of(100, 200);
  const eda_shapes *shapes = shapes_of(&mask);
  double clear = 1 - 20000 / whole;
  printer_make(&p, &litho_least);
  p.fine = 1e-3;
  printer_prepare(&p);
  g_assert_cmpfloat(p.fine, ==, 0); /* the model has no accurate images */
  g_assert_true(resist_drawn == eda_gates_sample());
  eda_spectrum s;
  g_assert_cmpint(eda_printer_spectrum(&p, shapes, &s, &error), ==, OPC_OK);
  g_assert_cmpfloat_with_epsilon(s.data[0], clear, 1e-6);
  g_assert_cmpint(s.columns, ==, 7);
  g_assert_cmpint(s.rows, ==, 25);
  eda_spectrum_clear(&s);
  if (eda_printer_print(&p, (uint8_t[]){1, 1}, shapes, &error))
    g_error("%s", error.message);
  for (int k = 0; k < LAYERS; k++) {
    expect_field(&p.print[k], clear - 0.5);
    g_assert_null(p.image[k].coefficients);
    g_assert_cmpint(p.is_fine[k], ==, 0);
  }
  g_assert_cmpuint(p.simulations, ==, 2);
  g_assert_cmpint(eda_printer_refine(&p, (uint8_t[]){1, 1}, shapes, &error), ==,
                  OPC_OK);
  g_assert_cmpuint(p.fine_simulations, ==, 0);
  p.keeps = 1;
  box_mask other = mask_of(200, 200);
  g_assert_cmpint(
      eda_printer_print(&p, (uint8_t[]){0, 1}, shapes_of(&other), &error), ==,
      OPC_OK);
  g_assert_cmpuint(p.simulations, ==, 3);
  double now = 1 - 40000 / whole;
  expect_field(&p.print[0], clear - 0.5);
  expect_field(&p.print[1], now - 0.5);
  expect_field(&p.image[1], now + 1);
  g_assert_null(p.image[0].coefficients);
  eda_field dose;
  g_assert_cmpint(eda_printer_at_dose(&p, 1, 1.25, &dose, &error), ==, OPC_OK);
  expect_field(&dose, 1.25 * (now + 1) - 1.5);
  expect_field(&p.image[1], now + 1);
  eda_field_clear(&dose);
  eda_printer_clear(&p);
}

/* Fast images are corrected by the difference of the last accurate image. */
static void test_fine(void) {
  opc_error error;
  eda_printer p;
  box_mask one = mask_of(100, 200), two = mask_of(300, 600);
  double a = 1 - 20000 / whole, b = 1 - 180000 / whole;
  const uint8_t both[] = {1, 1}, first[] = {1, 0};
  printer_make(&p, &litho_full);
  p.fine = 1e-3;
  p.defocus = 50;
  printer_prepare(&p);
  g_assert_cmpfloat(wanted_last, ==, 1e-3); /* not the 0.01 of the resist */
  p.fine_of[1] = 5e-4;
  g_assert_false(eda_printer_print(&p, both, shapes_of(&one), &error));
  expect_field(&p.print[0], a + 0.5 - 0.5);
  g_assert_false(eda_printer_refine(&p, first, shapes_of(&one), &error));
  g_assert_cmpfloat(wanted_last, ==, 1e-3);
  g_assert_cmpuint(p.fine_simulations, ==, 1);
  g_assert_true(p.is_fine[0] && !p.is_fine[1]);
  expect_field(&p.print[0], 1.01 * a + 0.1 + 0.5 - 0.5);
  expect_field(&p.difference[0], 0.01 * a + 0.1);
  g_assert_false(eda_printer_refine(&p, both, shapes_of(&one), &error));
  g_assert_cmpfloat(wanted_last, ==, 5e-4);
  g_assert_cmpuint(p.fine_simulations, ==, 2); /* layer 0 was accurate */
  g_assert_false(eda_printer_print(&p, both, shapes_of(&two), &error));
  g_assert_true(!p.is_fine[0] && !p.is_fine[1]);
  expect_field(&p.print[0], b + 0.01 * a + 0.1);
  expect_field(&p.print[1], b + 0.01 * a + 0.1);
  expect_field(&p.image[1], b + 0.01 * a + 0.1 + 1.5);
  g_assert_false(eda_printer_refine(&p, both, shapes_of(&two), &error));
  expect_field(&p.print[1], 1.01 * b + 0.1);
  expect_field(&p.difference[1], 0.01 * b + 0.1);
  /* An earlier image with the present difference. */
  eda_field early = eda_field_scaled(&p.image[0], 0);
  g_assert_false(eda_printer_correct(&p, 0, &early, &error));
  expect_field(&early, 0.01 * b + 0.1 - 0.5);
  eda_field_clear(&early);
  g_assert_cmpuint(p.simulations, ==, 4);
  g_assert_cmpuint(p.fine_simulations, ==, 4);
  /* Another number of nodes. */
  fault = MORE_NODES;
  g_assert_cmpint(eda_printer_print(&p, first, shapes_of(&one), &error), ==,
                  OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "litho");
  g_assert_cmpstr(error.message, ==,
                  "two images of one frame have 5 x 3 and 4 x 3 nodes");
  eda_printer_clear(&p);
  g_assert_null(p.print);
}

/* Other functions of the model receive all arguments. */
static void test_others(void) {
  opc_error error;
  eda_printer p;
  eda_spectrum s;
  eda_field out, weight;
  box_mask one = mask_of(100, 200);
  printer_make(&p, &litho_full);
  const eda_litho *l = p.litho.module.functions;
  void *self = p.litho.module.self;
  g_assert_cmpstr(p.litho.module.id, ==, "litho.full");
  g_assert_false(eda_printer_spectrum(&p, shapes_of(&one), &s, &error));
  g_assert_cmpfloat(l->scanner(self).wavelength, ==, 193);
  g_assert_cmpfloat(l->scanner(self).na, ==, 0.75);
  g_assert_false(l->image_optics(self, 1, &s, 0.9, 0.4, 7, 1e-4, &out, &error));
  expect_field(&out, 8);
  g_assert_true(na_last == 0.9 && sigma_last == 0.4 && wanted_last == 1e-4);
  weight = eda_field_scaled(&out, 0.5);
  eda_field_clear(&out);
  g_assert_false(l->gradient(self, 1, &s, 20, &weight, &out, &error));
  expect_field(&out, 1 + 20 + 4);
  eda_field_clear(&out);
  g_assert_false(l->image_at(self, 1, &s, 0, &out, &error));
  expect_field(&out, 2 - 20000 / whole);
  eda_field_clear(&out);
  g_assert_false(l->image_at(self, 1, &s, -100, &out, &error));
  expect_field(&out, 1 - 20000 / whole);
  eda_field_clear(&out);
  eda_field_clear(&weight);
  eda_spectrum_clear(&s);
  eda_printer_clear(&p);
  printer_make(&p, &litho_least);
  l = p.litho.module.functions;
  g_assert_true(!l->image_at && !l->image_fine && !l->transform &&
                !l->gradient && !l->scanner && !l->image_optics);
  eda_printer_clear(&p);
}

/* Faults of the litho model are attributed to it, also if the resist calls the
   model; faults of the resist to the resist. */
static void test_faults(void) {
  static const struct {
    int fault, resist, code;
    const char *parameter, *message;
  } cases[] = {
      {FAILS_TO_PREPARE, 0, OPC_IO, "litho", "no lens"},
      {NO_BAND, 0, OPC_FAILED, "litho", "the band is 0 1/nm"},
      {ENDLESS_BAND, 0, OPC_FAILED, "litho", "the band is inf 1/nm"},
      {FAILS, 0, OPC_IO, "litho.lens", "no image"},
      {NO_VALUES, 0, OPC_FAILED, "litho",
       "intensity is a field of 4 x 3 without values"},
      {OTHER_FRAME, 0, OPC_FAILED, "litho",
       "intensity has the frame (0, 0) 301 x 200 nm, but the mask has (0, 0) "
       "300 x 200 nm"},
      {NOT_FINITE, 0, OPC_FAILED, "litho", "intensity*"},
      {GOOD, 1, OPC_INVALID, "resist.level", "no level"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error;
    eda_printer p;
    printer_make(&p, i % 2 ? &litho_full : &litho_least);
    fault = cases[i].fault;
    resist_fails = cases[i].resist;
    g_assert_cmpint(eda_printer_prepare(&p, &error), ==, cases[i].code);
    g_assert_cmpstr(error.parameter, ==, cases[i].parameter);
    if (!g_pattern_match_simple(cases[i].message, error.message))
      g_error("%zu: %s", i, error.message);
    eda_printer_clear(&p);
  }
  opc_error error;
  eda_printer p;
  box_mask one = mask_of(100, 200);
  printer_make(&p, &litho_full);
  printer_prepare(&p);
  fault = NOT_FINITE;
  g_assert_cmpint(
      eda_printer_print(&p, (uint8_t[]){1, 0}, shapes_of(&one), &error), ==,
      OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "litho");
  eda_printer_clear(&p);
  printer_make(&p, &litho_full);
  printer_prepare(&p);
  resist_fails = 1;
  g_assert_cmpint(
      eda_printer_print(&p, (uint8_t[]){1, 0}, shapes_of(&one), &error), ==,
      OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "resist");
  g_assert_cmpstr(error.message, ==, "not developed");
  eda_printer_clear(&p);
}

/* A model with a function `transform`: each invalid spectrum is refused. */
static int spoiled;
static int model_transform(const void *self, const eda_shapes *mask,
                           double grid, eda_frame frame, eda_spectrum *out,
                           opc_error *error) {
  (void)self, (void)grid, (void)error;
  *out = (eda_spectrum){.frame = frame, .band = 0.01, .columns = 7, .rows = 25};
  if (spoiled != 1) out->data = eda_alloc(2 * 7 * 25, sizeof(float));
  if (out->data) out->data[0] = 0.25F * (float)mask->count;
  double *const of[] = {&out->frame.x0, &out->frame.y0, &out->frame.width,
                        &out->frame.height};
  if (spoiled >= 2 && spoiled < 6) *of[spoiled - 2] += 1;
  if (spoiled == 6) out->columns++;
  if (spoiled == 7) out->rows--;
  if (spoiled == 8) out->band = 0;
  if (spoiled == 9) out->band = 0.0107; /* 8 columns */
  if (spoiled == 10) out->data[2 * 7 * 25 - 1] = NAN;
  return OPC_OK;
}

static void test_transform(void) {
  opc_error error;
  eda_printer p;
  eda_spectrum s;
  box_mask one = mask_of(100, 200);
  eda_litho own = least;
  own.transform = model_transform;
  const opc_module module = {&own, NULL, "litho.own"};
  printer_make(&p, &module);
  for (spoiled = 0; spoiled <= 10; spoiled++) {
    int code = eda_printer_spectrum(&p, shapes_of(&one), &s, &error);
    g_assert_cmpint(code, ==, spoiled ? OPC_FAILED : OPC_OK);
    if (!code) g_assert_cmpfloat(s.data[0], ==, 0.25);
    if (code) g_assert_cmpstr(error.parameter, ==, "litho");
    if (spoiled == 6)
      g_assert_cmpstr(error.message, ==,
                      "the spectrum of a mask has 8 x 25 frequencies and the "
                      "band 0.01 1/nm, for a frame of 660 x 1200 nm");
    if (spoiled == 10)
      g_assert_cmpstr(error.message, ==,
                      "the spectrum of a mask is not finite");
    free(s.data);
  }
  /* The first fault is kept. */
  g_assert_cmpint(p.litho.failed, ==, 1);
  g_assert_nonnull(strstr(p.litho.fault.message, "7 x 25 frequencies"));
  eda_printer_clear(&p);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/printer/frame", test_frame);
  g_test_add_func("/printer/fast", test_fast);
  g_test_add_func("/printer/fine", test_fine);
  g_test_add_func("/printer/others", test_others);
  g_test_add_func("/printer/faults", test_faults);
  g_test_add_func("/printer/transform", test_transform);
  return g_test_run();
}
