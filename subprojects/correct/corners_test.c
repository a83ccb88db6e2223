/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests corners of dose, focus and mask error against the closed form of lines
   blurred by a Gaussian. */
#include <correct/corners.h>

#include "models_test.h"

enum { GATES = 2, DOSES = 3, FOCI = 2, MASKS = 3, ALL = DOSES * FOCI * MASKS };

static const double dose_of[] = {-6, 0, 5}, focus_of[] = {0, 60},
                    mask_of[] = {-2, 0, 3};

/* ---- a model with focus, and with a fine image ---- */

/* Return the blur, which grows with the defocus, and the error of a fast
   image. */
static double cut_off_at(double defocus) {
  return cut_off * (1 + defocus * defocus / 1e4);
}

static double excess;
static int fine_images, cheap_images;

static void transfer_at(const void *self, size_t s, const double *fx, double fy,
                        size_t n, float *out) {
  const double *c = self;
  (void)s;
  for (size_t i = 0; i < n; i++) {
    double r = (fx[i] * fx[i] + fy * fy) * *c * *c;
    out[2 * i] = (float)exp(-r);
    out[2 * i + 1] = 0;
  }
}

static int image_of(const eda_spectrum *mask, double defocus, double more,
                    eda_field *out, opc_error *error) {
  static const double one = 1;
  const double c = cut_off_at(defocus);
  const eda_kernels kernels = {.count = 1,
                               .weight = &one,
                               .band = limit,
                               .intensity_band = 2 * limit,
                               .transfer = transfer_at,
                               .self = &c,
                               .scale = {1, 0}};
  int code = eda_coherent_sum(NULL, mask, &kernels, 0, out, error);
  for (int i = 0; !code && i < out->nx * out->ny; i++)
    out->coefficients[i] += (float)more;
  return code;
}

static int cheap(const void *self, int layer, const eda_spectrum *mask,
                 eda_field *out, opc_error *error) {
  (void)self, (void)layer;
  cheap_images++;
  return image_of(mask, 0, excess, out, error);
}

static int cheap_at(const void *self, int layer, const eda_spectrum *mask,
                    double defocus, eda_field *out, opc_error *error) {
  (void)self, (void)layer;
  cheap_images++;
  return image_of(mask, defocus, 2 * excess, out, error);
}

static int fine_at(const void *self, int layer, const eda_spectrum *mask,
                   double defocus, double wanted, eda_field *out,
                   opc_error *error) {
  (void)self, (void)layer, (void)wanted;
  fine_images++;
  return image_of(mask, defocus, 0, out, error);
}

static const eda_litho with_focus = {.prepare = prepare_nothing,
                                     .band = model_band,
                                     .image = cheap,
                                     .image_at = cheap_at};
static const eda_litho with_fine = {.prepare = prepare_nothing,
                                    .band = model_band,
                                    .image = cheap,
                                    .image_at = cheap_at,
                                    .image_fine = fine_at};

/* ---- closed forms ---- */

static double normal(double x) { return erfc(-x / sqrt(2)) / 2; }

/* Return the printed width of a line: the width of the region in which dose *
   (1 - covered)^2 is below 0.6. `covered` is the part of the Gaussian that the
   line covers. */
static double printed(double drawn, double dose, double defocus, double by) {
  double sigma = cut_off_at(defocus) / (M_PI * sqrt(2)), low = 0, high = drawn;
  double half = drawn / 2 + by;
  for (int i = 0; i < 60; i++) {
    double x = (low + high) / 2;
    double a = 1 - normal((x + half) / sigma) + normal((x - half) / sigma);
    if ((1 + dose / 100) * a * a < 0.6)
      low = x;
    else
      high = x;
  }
  return 2 * low;
}

static double ion_of(size_t gate, size_t k, double bias) {
  double dose = dose_of[k % DOSES];
  double focus = focus_of[k / DOSES % FOCI];
  double by = mask_of[k / DOSES / FOCI];
  const eda_gates *g = eda_gates_sample();
  return 1e-6 * printed(g->width[gate], dose, focus, by) /
         printed(g->length[gate] + bias, dose, focus, by);
}

/* ---- a synthesizer that shortens all gates and records its input ---- */

static int32_t wanted_bias;
static double seen[GATES];

static int begin_moves(void *self, const eda_feedback *f, opc_error *error) {
  (void)self, (void)f, (void)error;
  return OPC_OK;
}

static int update_moves(void *self, const eda_feedback *f, eda_moves *m,
                        int *done, opc_error *error) {
  (void)self, (void)error;
  for (int i = 0; i < GATES; i++) {
    seen[i] = f->printed->ion[i];
    g_assert_cmpuint(f->flags[i], ==, 0);
    m->l[i] = wanted_bias;
  }
  *done = f->iteration > 0;
  return OPC_OK;
}

static const eda_synthesizer mover = {.begin = begin_moves,
                                      .update = update_moves};

/* ---- the loop ---- */

static corners_request corners_weights(const double *weight) {
  return (corners_request){{dose_of, DOSES},
                           {focus_of, FOCI},
                           {mask_of, MASKS},
                           {weight, weight ? ALL : 0},
                           .free = 1};
}

static int run_on(const eda_gates *gates, loop *l, const eda_litho *model,
                  corners_request w, double fine, opc_error *error) {
  *l = (loop){.host = &host,
              .gates = gates,
              .extractor = MODULE(&extractor, NULL),
              .max_iterations = 10,
              .ion_limit = 0.5,
              .corners.request = w,
              .drivers[MAIN].module = MODULE(&mover, NULL)};
  eda_printer_init(&l->printer, NULL, l->gates, MODULE(model, NULL),
                   MODULE(&resist, NULL), 300);
  l->printer.fine = fine;
  g_assert_false(correct_corners_check(&w, error));
  return correct_loop_run(l, error);
}

static int run_step(loop *l, const eda_litho *model, corners_request w,
                    double fine, opc_error *error) {
  return run_on(eda_gates_sample(), l, model, w, fine, error);
}

static void check_near(double got, double want, double part) {
  if (!(fabs(got / want - 1) <= part)) g_error("%.8g, not %.8g", got, want);
}

static double mean_of_gate(size_t gate, const double *weight, double bias) {
  double sum = 0, all = 0;
  for (size_t k = 0; k < ALL; k++) {
    sum += weight[k] * log(ion_of(gate, k, bias));
    all += weight[k];
  }
  return exp(sum / all);
}

/* single precision */
static const double close_to = 2e-6;

static void check_figures(const loop *l, const double *weight, double bias) {
  for (size_t i = 0; i < GATES; i++) {
    for (size_t k = 0; k < ALL; k++)
      check_near(l->corners.corner[k].measured.performance.ion[i],
                 ion_of(i, k, bias), close_to);
    check_near(l->measured.performance.ion[i], mean_of_gate(i, weight, bias),
               close_to);
    check_near(l->corners.nominal.ion[i], ion_of(i, 1 + DOSES * FOCI, bias),
               close_to);
    check_near(l->before.ion[i], ion_of(i, 1 + DOSES * FOCI, 0), close_to);
  }
}

/* ---- tests ---- */

static void test_figures(void) {
  loop l;
  opc_error error = {0};
  double weight[ALL];
  for (size_t k = 0; k < ALL; k++) weight[k] = (double)(k % 5);
  wanted_bias = -6;
  g_assert_false(run_step(&l, &with_focus, corners_weights(weight), 0, &error));
  check_figures(&l, weight, -6);
  for (size_t i = 0; i < GATES; i++)
    check_near(seen[i], mean_of_gate(i, weight, -6), close_to);
  g_string_truncate(published, 0);
  g_assert_false(correct_corners_report(&l, &error));
  g_assert_cmpstr(published->str, ==,
                  "corners[18] all_corners[1] corners_ion_sd "
                  "corners_ion_worst corners_leakage corners_failed ");
  correct_loop_clear(&l);
}

/* Default weights are a normal distribution along each axis. */
static void test_weights(void) {
  loop l;
  opc_error error = {0};
  double weight[ALL];
  for (size_t k = 0; k < ALL; k++) {
    double d = dose_of[k % DOSES] / 6, f = focus_of[k / DOSES % FOCI] / 60;
    double m = mask_of[k / DOSES / FOCI] / 3;
    weight[k] = exp(-1.5 * (d * d + f * f + m * m));
  }
  wanted_bias = 0;
  g_assert_false(run_step(&l, &with_focus, corners_weights(NULL), 0, &error));
  check_figures(&l, weight, 0);
  correct_loop_clear(&l);
}

/* With a bound of Ion, the common deviation of two transistors of a type is not
   corrected, and the remaining difference is bounded. The deviations of these
   transistors differ by 0.6 %. */
static void test_limit(void) {
  static const double limits[] = {0, 0.2, 50};
  uint8_t same[] = {EDA_NMOS, EDA_NMOS};
  eda_gates pair = *eda_gates_sample();
  double pull[GATES], weight[ALL];
  loop l;
  opc_error error = {0};
  wanted_bias = 0;
  pair.type = same;
  for (size_t k = 0; k < ALL; k++) weight[k] = 1 + (double)(k % 5);
  for (size_t i = 0; i < GATES; i++)
    pull[i] = log(mean_of_gate(i, weight, 0) / ion_of(i, 1 + DOSES * FOCI, 0));
  double apart = (pull[0] - pull[1]) / 2;
  g_assert_cmpfloat(fabs(apart), >, 0.003);
  for (size_t k = 0; k < G_N_ELEMENTS(limits); k++) {
    double most = log1p(limits[k] / 100), own = CLAMP(apart, -most, most);
    corners_request w = corners_weights(weight);
    w.free = 0;
    w.ion_cost = limits[k];
    g_assert_false(run_on(&pair, &l, &with_focus, w, 0, &error));
    for (size_t i = 0; i < GATES; i++)
      check_near(l.measured.performance.ion[i],
                 l.corners.nominal.ion[i] * exp(i ? -own : own), close_to);
    correct_loop_clear(&l);
    /* The deviation of the only transistor of a type equals the mean of its
       type and is not corrected. */
    g_assert_false(run_step(&l, &with_focus, w, 0, &error));
    for (size_t i = 0; i < GATES; i++)
      check_near(l.measured.performance.ion[i], l.corners.nominal.ion[i],
                 1e-12);
    correct_loop_clear(&l);
  }
}

/* A correction at the nominal corner alone equals a correction without
   corners. */
static void test_nominal(void) {
  static const double zero = 0;
  loop a, b;
  opc_error error = {0};
  wanted_bias = -3;
  corners_request none = {.dose = {0}}, one = {.dose = {&zero, 1}};
  g_assert_false(run_step(&a, &with_focus, none, 0, &error));
  g_assert_false(run_step(&b, &with_focus, one, 0, &error));
  for (size_t i = 0; i < GATES; i++) {
    g_assert_true(a.measured.performance.ion[i] == b.corners.nominal.ion[i]);
    check_near(b.measured.performance.ion[i], a.measured.performance.ion[i],
               1e-12);
  }
  correct_loop_clear(&a);
  correct_loop_clear(&b);
}

/* Fast images have an error that differs with the focus; the figures are those
   of the accurate images. */
static void test_fine(void) {
  loop l;
  opc_error error = {0};
  double weight[ALL];
  for (size_t k = 0; k < ALL; k++) weight[k] = 1;
  wanted_bias = -6;
  excess = 0.02;
  fine_images = cheap_images = 0;
  g_assert_false(
      run_step(&l, &with_fine, corners_weights(weight), 1e-4, &error));
  for (size_t i = 0; i < GATES; i++)
    for (size_t k = 0; k < ALL; k++)
      check_near(l.corners.corner[k].measured.performance.ion[i],
                 ion_of(i, k, -6), close_to);
  /* Accurate simulations after the first displacements: two layers, each mask
     error at each focus. The final images are already accurate. */
  g_assert_cmpint(fine_images, ==, 2 * FOCI * MASKS);
  g_assert_cmpuint(l.printer.fine_simulations, ==, fine_images);
  g_assert_cmpuint(l.printer.simulations, ==, cheap_images);
  excess = 0;
  correct_loop_clear(&l);
}

/* Measure the corrected poly of a loop with its active displaced by (x, y), by
   a new image. */
static void measure_displaced(const loop *l, int32_t x, int32_t y,
                              eda_measurement *out) {
  opc_error error = {0};
  eda_printer p;
  const uint8_t layers[] = {1, 1};
  eda_shapes *active = &l->mask[EDA_ACTIVE];
  eda_printer_init(&p, NULL, l->gates, MODULE(&with_focus, NULL),
                   MODULE(&resist, NULL), 300);
  for (int way = 1; way >= -1; way -= 2) {
    for (size_t i = 0; i < active->start[active->count]; i++) {
      active->points[i].x += way * x;
      active->points[i].y += way * y;
    }
    if (way < 0) break;
    g_assert_false(eda_printer_prepare(&p, &error));
    g_assert_false(eda_printer_print(&p, layers, l->mask, &error));
  }
  g_assert_false(eda_measure(NULL, l->gates, p.print, MODULE(&extractor, NULL),
                             out, &error));
  eda_printer_clear(&p);
}

/* Corners of overlay are as those of a mask with displaced active; regulators
   receive the smallest extension. */
static void test_overlay(void) {
  enum { X = 3, Y = 2 };
  static const double x[X] = {-200, 0, 25}, y[Y] = {0, 84};
  static const double dose[] = {0, 4};
  loop l;
  opc_error error = {0};
  eda_measurement m;
  eda_measurement_init(&m, GATES);
  wanted_bias = -6;
  corners_request w = {
      .dose = {dose, 2}, .overlay_x = {x, X}, .overlay_y = {y, Y}, .free = 1};
  g_assert_cmpuint(correct_corners_count(&w), ==, 2 * X * Y);
  g_assert_cmpuint(correct_corners_images(&w), ==, 1);
  g_assert_false(run_step(&l, &with_focus, w, 0, &error));
  double sum = 0, all = 0, least[2 * GATES], largest = 0;
  for (size_t i = 0; i < 2 * GATES; i++) least[i] = INFINITY;
  for (size_t k = 0; k < X * Y; k++) {
    const corner *c = &l.corners.corner[2 * k];
    double dx = x[k % X], dy = y[k / X];
    double r = dx * dx / (200 * 200) + dy * dy / (84 * 84);
    g_assert_true(c->overlay_x == dx && c->overlay_y == dy && c->dose == 0);
    g_assert_cmpfloat(
        fabs(c->weight / l.corners.corner[2].weight - exp(-1.5 * r)), <, 1e-9);
    measure_displaced(&l, (int32_t)dx, (int32_t)dy, &m);
    for (size_t i = 0; i < GATES; i++)
      check_near(c->measured.performance.ion[i], m.performance.ion[i], 1e-5);
    for (size_t i = 0; i < 2 * GATES; i++)
      least[i] = fmin(least[i], m.extension[i]);
    largest = fmax(largest,
                   fabs(m.performance.ion[1] / l.corners.nominal.ion[1] - 1));
  }
  for (size_t k = 0; k < l.corners.count; k++) {
    const corner *c = &l.corners.corner[k];
    sum += c->weight * log(c->measured.performance.ion[1]);
    all += c->weight;
  }
  check_near(l.measured.performance.ion[1], exp(sum / all), close_to);
  g_assert_cmpfloat(largest, >, 0.005);
  eda_printed p = correct_loop_printed(&l);
  for (size_t i = 0; i < 2 * GATES; i++)
    if (isinf(least[i]))
      g_assert_true(p.extension[i] == least[i]);
    else
      g_assert_cmpfloat(fabs(p.extension[i] - least[i]), <, 1e-2);
  eda_measurement_clear(&m);
  correct_loop_clear(&l);
}

/* Gates that are open at a corner are excluded from their mean there. */
static void test_lost(void) {
  static const double doses[] = {0, 150000};
  loop l;
  opc_error error = {0};
  wanted_bias = 0;
  corners_request w = {.dose = {doses, 2}};
  g_assert_false(run_step(&l, &with_focus, w, 0, &error));
  for (size_t i = 0; i < GATES; i++) {
    g_assert_cmpuint(l.measured.flags[i], ==, 0);
    g_assert_cmpuint(l.corners.corner[1].measured.flags[i] & EDA_PRINT_OPEN, !=,
                     0);
    check_near(l.measured.performance.ion[i], l.corners.nominal.ion[i], 1e-12);
  }
  warnings = 0;
  g_assert_false(correct_corners_report(&l, &error));
  g_assert_cmpint(warnings, ==, 1);
  correct_loop_clear(&l);
}

static void assert_refused(corners_request w, const eda_litho *model,
                           const char *why) {
  loop l;
  opc_error error = {0};
  int code = model ? run_step(&l, model, w, 0, &error)
                   : correct_corners_check(&w, &error);
  g_assert_cmpint(code, ==, OPC_INVALID);
  if (!strstr(error.message, why))
    g_error("'%s' does not say '%s'", error.message, why);
  if (model) correct_loop_clear(&l);
}

static void test_refused(void) {
  static const double some[] = {0, 1.5, 1.5}, low[] = {-100}, minus[] = {1, -1},
                      much[] = {1e308, 1e308};
  assert_refused((corners_request){.focus = {some, 2}}, &litho,
                 "has one focus only");
  assert_refused((corners_request){.mask_error = {some, 2}}, &with_focus,
                 "1.5 nm is no multiple of the mask grid of 1 nm");
  assert_refused((corners_request){.dose = {some, 3}}, NULL,
                 "contains 1.5 twice");
  assert_refused((corners_request){.dose = {low, 1}}, NULL,
                 "is -100, expected a value above -100");
  assert_refused((corners_request){.dose = {some, 2}, .weight = {some, 3}},
                 NULL, "3 weights for 2 corners");
  assert_refused((corners_request){.dose = {some, 2}, .weight = {minus, 2}},
                 NULL, "weight -1");
  assert_refused((corners_request){.dose = {some, 2}, .weight = {much, 2}},
                 NULL, "weight 1e+308");
  assert_refused((corners_request){.dose = {some, 1}, .weight = {some, 1}},
                 NULL, "all weights are 0");
  assert_refused((corners_request){.weight = {some, 1}}, NULL,
                 "1 weights for 0 corners");
  /* Values just inside and just outside the range of doses (%), foci (nm) and
     mask errors (nm). */
  static const double ends[][2] = {{-100, 1e6}, {-1e6, 1e6}, {-1e3, 1e6}};
  for (int k = 0; k < 3; k++)
    for (int up = 0; up < 2; up++)
      for (int out = 0; out < 2; out++) {
        double v = ends[k][up] * (1 + (out ? 1e-6 : -1e-6));
        corners_request w = {0};
        opc_error error = {0};
        *(k == 0   ? &w.dose
          : k == 1 ? &w.focus
                   : &w.mask_error) = (opc_reals){&v, 1};
        g_assert_cmpint(correct_corners_check(&w, &error), ==,
                        out ? OPC_INVALID : OPC_OK);
      }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  published = g_string_new(NULL);
  g_test_add_func("/corners/figures", test_figures);
  g_test_add_func("/corners/weights", test_weights);
  g_test_add_func("/corners/limit", test_limit);
  g_test_add_func("/corners/nominal", test_nominal);
  g_test_add_func("/corners/fine", test_fine);
  g_test_add_func("/corners/overlay", test_overlay);
  g_test_add_func("/corners/lost", test_lost);
  g_test_add_func("/corners/refused", test_refused);
  int failed = g_test_run();
  g_string_free(published, TRUE);
  return failed;
}
