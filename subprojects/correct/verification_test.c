/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the verification by an accurate model that differs from the fast one by
   a known field. Results are compared with independent simulations of the
   accurate model. */
#include <correct/fine.h>
#include "models_test.h"

/* ---- a synthesizer with the drawn Ion as target ---- */

typedef struct mover {
  int32_t spoil; /* wrong bias that transistor 1 gets instead of the correct
                    bias */
} mover;

static int begin_moves(void *self, const eda_feedback *f, opc_error *error) {
  (void)self, (void)error;
  g_assert_cmpfloat(*f->ion_limit, ==, 3); /* the limit of the loop is passed
                                              on */
  return OPC_OK;
}

/* Apply half of the missing printed length, because a step of the mask has a
   larger effect on the printed length. */
static int update_moves(void *self, const eda_feedback *f, eda_moves *m,
                        int *done, opc_error *error) {
  const mover *s = self;
  (void)error;
  *done = 1;
  for (size_t i = 0; i < f->gates->count; i++) {
    double d = f->printed->ion[i] / f->design->ion[i] - 1;
    int32_t step =
        (int32_t)lround(0.5 * f->gates->length[i] * d / f->gates->grid);
    if (i == 1 && s->spoil) step = s->spoil - m->l[i];
    m->l[i] += step;
    if (step) *done = 0;
  }
  return OPC_OK;
}

static const eda_synthesizer moving = {.begin = begin_moves,
                                       .update = update_moves};

/* ---- the loop ---- */

static const eda_litho with_fine = {.prepare = prepare_nothing,
                                    .band = model_band,
                                    .image = model_image,
                                    .image_fine = image_fine};
static const double fine_is = 1e-4;

/* Set fine_adds[n] for accurate simulation n; the last value applies to
   all later simulations. */
static void let_add(size_t n, const double *heights) {
  for (size_t i = 0; i < FINE_PRINTS; i++)
    fine_adds[i] = heights[MIN(i, n - 1)];
  fine_prints[0] = fine_prints[1] = 0;
}
#define ADD(...)                                            \
  let_add(sizeof((double[]){__VA_ARGS__}) / sizeof(double), \
          (const double[]){__VA_ARGS__})

static const opc_module *regulator;
static double aim; /* standard deviation of Ion that accurate simulations may
                      cause, %; 0: the error is `fine` */

static int checked; /* loop.checked */

static int try_to_run(loop *l, const eda_litho *model, double fine,
                      int32_t spoil, int64_t iterations, opc_error *error) {
  mover s = {spoil};
  *l = (loop){.host = &host,
              .gates = eda_gates_sample(),
              .extractor = MODULE(&extractor, NULL),
              .regulator = regulator,
              .max_iterations = iterations,
              .checked = checked,
              .hold = 1,
              .ion_limit = 3,
              .fine_change = aim,
              .drivers[MAIN].module = MODULE(&moving, &s)};
  eda_printer_init(&l->printer, NULL, l->gates, MODULE(model, NULL),
                   MODULE(&resist, NULL), 300);
  l->printer.fine = fine;
  warnings = 0;
  return correct_loop_run(l, error);
}

static void run_step(loop *l, const eda_litho *model, double fine,
                     int32_t spoil, int64_t iterations) {
  opc_error error = {0};
  g_assert_cmpint(try_to_run(l, model, fine, spoil, iterations, &error), ==,
                  OPC_OK);
}

/* ---- the truth ---- */

/* Measure Ion of a mask by the model that adds `height` to poly, with an
   independent printer, whose level sets are reduced by the wave. */
static void measure_truth(const loop *l, const eda_shapes *mask, double height,
                          double *ion) {
  opc_error error = {0};
  eda_printer p;
  eda_measurement m;
  eda_printer_init(&p, NULL, l->gates, MODULE(&litho, NULL),
                   MODULE(&resist, NULL), 300);
  eda_measurement_init(&m, l->gates->count);
  g_assert_cmpint(eda_printer_prepare(&p, &error), ==, OPC_OK);
  g_assert_cmpint(eda_printer_print(&p, l->gates->corrected, mask, &error), ==,
                  OPC_OK);
  for (size_t k = 0; k < 2; k++) {
    double by = k == EDA_POLY ? height : l->printer.fine > 0 ? fine_adds[0] : 0;
    for (int j = 0; j < p.print[k].ny; j++)
      for (int i = 0; i < p.print[k].nx; i++)
        p.print[k].coefficients[j * p.print[k].nx + i] -=
            (float)wave(by, i, p.print[k].nx);
  }
  g_assert_cmpint(eda_measure(NULL, l->gates, p.print, MODULE(&extractor, NULL),
                              &m, &error),
                  ==, OPC_OK);
  memcpy(ion, m.performance.ion, 2 * sizeof *ion);
  eda_measurement_clear(&m);
  eda_printer_clear(&p);
}

static double deviation_of(const loop *l, const double *ion, size_t i) {
  return fabs(eda_deviation(ion[i], l->design.ion[i]));
}

/* Check that the figures equal those of the model with `height`, and differ
   from those with `other`. */
static void expect_result(const loop *l, double height, double other) {
  double fine[2], cheap[2];
  measure_truth(l, l->mask, height, fine);
  measure_truth(l, l->mask, other, cheap);
  for (size_t i = 0; i < 2; i++) {
    double ion = l->measured.performance.ion[i];
    g_assert_cmpfloat(fabs(ion / fine[i] - 1), <, 1e-5);
    g_assert_cmpfloat(fabs(ion / cheap[i] - 1), >, 1e-3);
  }
  for (size_t k = 0; k < 2; k++)
    g_assert_true(l->printer.is_fine[k] == (l->printer.fine > 0));
}

/* ---- the tests ---- */

/* There is one accurate simulation after the first displacements and one at the
   end. A layer without displacements requires the first one only. The figures
   of the drawn mask are accurate, too. */
static void test_end(void) {
  loop l;
  double before[2];
  ADD(0.03);
  run_step(&l, &with_fine, fine_is, 0, 10);
  expect_result(&l, 0.03, 0);
  g_assert_cmpint(fine_prints[EDA_POLY], ==, 2);
  g_assert_cmpint(fine_prints[EDA_ACTIVE], ==, 1);
  g_assert_cmpuint(l.printer.fine_simulations, ==, 3);
  /* The history has one line for each mask: the drawn mask, the first displaced
     mask and so on. */
  const history_line *line = l.history.line, *last = line + l.history.count - 1;
  g_assert_cmpuint(l.history.count, ==, l.printer.simulations - 1);
  for (size_t i = 0; i < l.history.count; i++)
    g_assert_cmpstr(line[i].model, ==,
                    i == 1 || line + i == last ? "fine" : "cheap");
  g_assert_true(last->print.ion_mean == l.summary.ion_mean);
  measure_truth(&l, l.gates->drawn, 0.03, before);
  for (size_t i = 0; i < 2; i++) {
    g_assert_cmpfloat(fabs(l.before.ion[i] / before[i] - 1), <, 1e-5);
    g_assert_cmpfloat(deviation_of(&l, l.before.ion, i), >, 10);
    g_assert_cmpfloat(deviation_of(&l, l.measured.performance.ion, i), <, 3);
  }
  correct_loop_clear(&l);
}

/* If the caller verifies the mask, the loop ends with a fast simulation. The
   difference of the models makes the figures accurate. */
static void test_checked(void) {
  loop l;
  double truth[2];
  ADD(0.03);
  checked = 1;
  run_step(&l, &with_fine, fine_is, 0, 10);
  checked = 0;
  g_assert_cmpint(fine_prints[EDA_POLY], ==, 1);
  g_assert_cmpint(fine_prints[EDA_ACTIVE], ==, 1);
  measure_truth(&l, l.mask, 0.03, truth);
  for (size_t i = 0; i < 2; i++) {
    g_assert_cmpfloat(fabs(l.measured.performance.ion[i] / truth[i] - 1), <,
                      1e-4);
    g_assert_cmpfloat(deviation_of(&l, l.measured.performance.ion, i), <, 3);
  }
  correct_loop_clear(&l);
}

/* ---- accuracy ---- */

/* Return the sensitivity of Ion, % per clear field, of a gate of this length or
   width in nm. An edge of one Gaussian kernel prints where the amplitude, a
   normal distribution of `s` nm, is the root of the threshold. The displacement
   of the edge is the change of intensity divided by the slope of the intensity
   at the edge. */
static double sensitivity_of(double size) {
  const double s = cut_off / G_PI / sqrt(2), z = 0.754089, a = sqrt(0.6);
  double slope = 2 * a * exp(-z * z / 2) / sqrt(2 * G_PI) / s;
  return 100 * 2 / slope / size;
}

/* The errors of the accurate models are those that change Ion by the given
   amount. */
static void test_how_fine(void) {
  const eda_gates *g = eda_gates_sample();
  opc_error error = {0};
  eda_printer p;
  eda_printer_init(&p, NULL, g, MODULE(&with_fine, NULL), MODULE(&resist, NULL),
                   300);
  p.fine = fine_is;
  g_assert_cmpint(eda_printer_prepare(&p, &error), ==, OPC_OK);
  g_assert_cmpint(eda_printer_print(&p, g->corrected, g->drawn, &error), ==,
                  OPC_OK);
  /* The standard deviation of an error is a quarter of the largest error. The
     narrower gate determines the error. */
  double poly = sensitivity_of(60) / 4, active = sensitivity_of(200) / 4;
  const struct {
    double change;
    double fine[2]; /* poly and active */
  } cases[] = {{0, {0, 0}},
               {1.03 * 2e-4 * poly, {2e-4, 5e-4}},
               {0.97 * 2e-4 * poly, {1e-4, 5e-4}},
               {1.03 * 5e-4 * active, {1e-4, 5e-4}},
               {0.97 * 5e-4 * active, {1e-4, 2e-4}},
               {1, {5e-4, 5e-4}},
               {1e-9, {5e-5, 5e-5}}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_assert_cmpint(
        correct_fine_by_layer(&p, &host, g, MODULE(&extractor, NULL),
                              cases[i].change, &error),
        ==, OPC_OK);
    for (int k = 0; k < 2; k++)
      g_assert_cmpfloat(p.fine_of[k], ==, cases[i].fine[k]);
  }
  eda_printer_clear(&p);
  /* An error that the flow sets applies to all layers. Otherwise each layer has
     an error of its own. */
  g_assert_cmpfloat(correct_fine_change("1e-4", 0.5), ==, 0);
  g_assert_cmpfloat(correct_fine_change("off", 0.5), ==, 0);
  g_assert_cmpfloat(correct_fine_change(NULL, 0.5), ==, 0.02);
}

/* A loop simulates each layer with the error computed for it. */
static void test_by_layer(void) {
  loop l;
  ADD(0.03);
  aim = 1.2 * 2e-4 * sensitivity_of(60) / 4;
  fine_errors[EDA_POLY] = 2e-4;
  fine_errors[EDA_ACTIVE] = 5e-4;
  run_step(&l, &with_fine, fine_is, 0, 10);
  expect_result(&l, 0.03, 0);
  g_assert_cmpint(fine_prints[EDA_POLY], ==, 2);
  correct_loop_clear(&l);
  fine_errors[EDA_POLY] = fine_errors[EDA_ACTIVE] = fine_is;
  aim = 0;
}

/* The accurate model changes at the end: the loop continues until the accurate
   model agrees. Without the verification, the loop would end earlier. */
static void test_goes_on(void) {
  loop l, without;
  ADD(0.02);
  run_step(&without, &with_fine, fine_is, 0, 20);
  ADD(0.02, 0.25);
  run_step(&l, &with_fine, fine_is, 0, 20);
  expect_result(&l, 0.25, 0.02);
  for (size_t i = 0; i < 2; i++)
    g_assert_cmpfloat(deviation_of(&l, l.measured.performance.ion, i), <, 3);
  g_assert_cmpint(fine_prints[EDA_POLY], ==, 3);
  g_assert_cmpuint(l.iterations, >, without.iterations);
  correct_loop_clear(&without);
  g_assert_cmpint(warnings, ==, 0);
  /* If no displacement follows, the mask is reported without another
     iteration. */
  ADD(0.02, 0.25);
  run_step(&without, &with_fine, fine_is, 0, 2);
  correct_loop_clear(&l);
  expect_result(&without, 0.25, 0.02);
  g_assert_cmpint(warnings, ==, 1);
  correct_loop_clear(&without);
}

/* If the accurate and the fast model never agree, the loop ends after the
   largest number of verifications. */
static void test_bound(void) {
  loop l;
  ADD(0.02, 0.25, 0.02, 0.25, 0.02, 0.25);
  run_step(&l, &with_fine, fine_is, 0, 60);
  expect_result(&l, 0.25, 0.02);
  g_assert_cmpint(fine_prints[EDA_POLY], ==, 1 + VERIFICATIONS);
  correct_loop_clear(&l);
}

/* Behaviours of a regulator. It reports a violation from a given accurate
   simulation onwards, until it has displaced a line end; or it displaces the
   line end after each simulation without effect. */
enum { STAYS, MENDS, TRIES };
static struct {
  const char *rule;
  int from, does, sent;
} broken;

static int repair_rule(void *self, const eda_printed *p, eda_ruling *r,
                       opc_error *error) {
  (void)self, (void)p, (void)error;
  if (!broken.does || fine_prints[EDA_POLY] < broken.from) return OPC_OK;
  broken.sent = broken.does == MENDS;
  r->end[0] = 8 * fine_prints[EDA_POLY];
  return OPC_OK;
}

static int violations(void *self, const eda_printed *p, eda_violation *v,
                      size_t capacity, size_t *count, opc_error *error) {
  (void)self, (void)p, (void)error;
  g_assert_cmpuint(capacity, >, 1);
  v[0] = (eda_violation){.rule = broken.rule, .gate = -1};
  *count = fine_prints[EDA_POLY] >= broken.from && !broken.sent;
  return OPC_OK;
}

/* The loop continues if only the final accurate simulation shows a violation
   that can be repaired. It ends if the violation has a stated cause or is
   older. */
static void test_rules(void) {
  static const eda_regulator mender = {.rule = repair_rule,
                                       .violations = violations};
  static const struct {
    const char *rule;
    int from, does, prints, end;
  } cases[] = {{"gap: could still move", 2, MENDS, 3, 16},
               {"gap; no space", 2, MENDS, 2, 0},
               {"gap: could still move", 0, TRIES, 2, 8},
               {"gap: could still move", 2, STAYS, 2, 0}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    loop l;
    broken.rule = cases[i].rule;
    broken.from = cases[i].from;
    broken.does = cases[i].does;
    broken.sent = 0;
    regulator = MODULE(&mender, NULL);
    ADD(0.03);
    run_step(&l, &with_fine, fine_is, 0, 60);
    regulator = NULL;
    g_assert_cmpint(fine_prints[EDA_POLY], ==, cases[i].prints);
    g_assert_cmpint(l.now.biases.end[0], ==, cases[i].end);
    g_assert_true(l.printer.is_fine[EDA_POLY]);
    correct_loop_clear(&l);
  }
}

/* If no edge is displaced, the drawn mask is verified. */
static void test_drawn(void) {
  loop l;
  ADD(0.03);
  run_step(&l, &with_fine, fine_is, 0, 0);
  expect_result(&l, 0.03, 0);
  for (size_t i = 0; i < 2; i++)
    g_assert_cmpfloat(fabs(l.before.ion[i] / l.measured.performance.ion[i] - 1),
                      <, 1e-5);
  g_assert_cmpuint(l.printer.fine_simulations, ==, 2);
  correct_loop_clear(&l);
}

/* A mask that the guard reverted is simulated with the accurate model. */
static void test_guard(void) {
  loop l;
  ADD(0.03);
  run_step(&l, &with_fine, fine_is, 45, 3);
  expect_result(&l, 0.03, 0);
  g_assert_cmpint(l.now.biases.l[1], <, 45);
  g_assert_cmpuint(l.guard.back, ==, 1);
  g_assert_cmpint(fine_prints[EDA_POLY], ==, 3);
  correct_loop_clear(&l);
}

/* The mask of a transistor reverted to drawn is slightly worse than the first
   difference predicts. This is not reported as a fault of a rule or a
   neighbour. */
static void test_margin(void) {
  loop l;
  ADD(0.03, 0.027);
  run_step(&l, &with_fine, fine_is, 45, 3);
  g_autofree char *verdict = correct_guard_verdict(&l.guard, 1);
  g_assert_cmpstr(verdict, ==, "reverted: its best mask");
  g_assert_cmpint(l.now.biases.l[1], ==, 0);
  double more = deviation_of(&l, l.measured.performance.ion, 1) -
                deviation_of(&l, l.before.ion, 1);
  g_assert_cmpfloat(more, >, 0.01);
  correct_loop_clear(&l);
}

/* Accurate images, or fast images after the first accurate image, have a
   different sampling grid. */
static int was_fine;

static int image_elsewhere(const void *self, int layer,
                           const eda_spectrum *mask, double defocus,
                           double wanted, eda_field *out, opc_error *error) {
  int code = image_fine(self, layer, mask, defocus, wanted, out, error);
  return code ? code : eda_field_resample(NULL, out, 8, error);
}

static int image_then(const void *self, int layer, const eda_spectrum *mask,
                      double defocus, double wanted, eda_field *out,
                      opc_error *error) {
  was_fine = 1;
  return image_fine(self, layer, mask, defocus, wanted, out, error);
}

static int image_moved(const void *self, int layer, const eda_spectrum *mask,
                       eda_field *out, opc_error *error) {
  int code = model_image(self, layer, mask, out, error);
  return code || !was_fine ? code : eda_field_resample(NULL, out, 8, error);
}

static void test_grid(void) {
  const eda_litho wrong[] = {{.prepare = prepare_nothing,
                              .band = model_band,
                              .image = model_image,
                              .image_fine = image_elsewhere},
                             {.prepare = prepare_nothing,
                              .band = model_band,
                              .image = image_moved,
                              .image_fine = image_then}};
  for (size_t k = 0; k < G_N_ELEMENTS(wrong); k++) {
    loop l;
    opc_error error = {0};
    ADD(0.03);
    g_assert_cmpint(try_to_run(&l, &wrong[k], fine_is, 0, 10, &error), ==,
                    OPC_FAILED);
    g_assert_cmpstr(error.parameter, ==, "litho");
    g_assert_true(g_str_has_prefix(error.message, "two images of one frame "));
    correct_loop_clear(&l);
  }
}

/* Without an accurate model, or with "off", the loop uses fast simulations
   only. */
static void test_none(void) {
  loop l;
  ADD(0.03);
  for (int wanted = 0; wanted < 2; wanted++) {
    run_step(&l, wanted ? &litho : &with_fine, wanted ? fine_is : 0, 0, 10);
    expect_result(&l, 0, 0.03);
    g_assert_cmpuint(l.printer.fine_simulations, ==, 0);
    g_assert_null(l.printer.difference[EDA_POLY].coefficients);
    correct_loop_clear(&l);
  }
}

/* The resist is calibrated with the image error of accurate simulations, or
   with a smaller error if the resist requires a smaller one. */
static double asked, given;

static int image_given(const void *self, int layer, const eda_spectrum *mask,
                       double defocus, double wanted, eda_field *out,
                       opc_error *error) {
  (void)defocus;
  given = wanted;
  return model_image(self, layer, mask, out, error);
}

static int ask_printer(void *self, const opc_module *model, opc_error *error) {
  const eda_frame frame = {0, 0, 1000, 1000};
  const eda_litho *functions = model->functions;
  eda_shapes none = {0};
  eda_spectrum mask;
  eda_field field;
  (void)self;
  int code =
      eda_litho_spectrum(NULL, model, &none, 1, frame, &mask, error) ||
      functions->image_fine(model->self, 0, &mask, 0, asked, &field, error);
  eda_field_clear(&field);
  eda_spectrum_clear(&mask);
  return code;
}

static void test_calibration(void) {
  static const eda_litho there = {.prepare = prepare_nothing,
                                  .band = model_band,
                                  .image = model_image,
                                  .image_fine = image_given};
  static const eda_resist asking = {.prepare = ask_printer,
                                    .print = model_print};
  static const struct {
    double fine, asked, given;
  } cases[] = {{0, 1e-4, 1e-4}, {5e-5, 1e-4, 5e-5}, {1e-3, 1e-4, 1e-4}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    eda_printer p;
    opc_error error = {0};
    asked = cases[i].asked;
    eda_printer_init(&p, NULL, eda_gates_sample(), MODULE(&there, NULL),
                     MODULE(&asking, NULL), 300);
    p.fine = cases[i].fine;
    g_assert_cmpint(eda_printer_prepare(&p, &error), ==, OPC_OK);
    g_assert_cmpfloat(given, ==, cases[i].given);
    eda_printer_clear(&p);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/proof/how-fine", test_how_fine);
  g_test_add_func("/proof/by-layer", test_by_layer);
  g_test_add_func("/proof/end", test_end);
  g_test_add_func("/proof/checked", test_checked);
  g_test_add_func("/proof/goes-on", test_goes_on);
  g_test_add_func("/proof/bound", test_bound);
  g_test_add_func("/proof/rules", test_rules);
  g_test_add_func("/proof/drawn", test_drawn);
  g_test_add_func("/proof/guard", test_guard);
  g_test_add_func("/proof/margin", test_margin);
  g_test_add_func("/proof/grid", test_grid);
  g_test_add_func("/proof/none", test_none);
  g_test_add_func("/proof/calibration", test_calibration);
  return g_test_run();
}
