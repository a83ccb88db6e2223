/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests scatter bars beside the two gates of the sample. With these optics,
   scatter bars of 8 nm and more print. Those of 6 nm transmit 0.68 of the
   light. */
#include <correct/assists.h>

#include "models_test.h"

static int begin_moves(void *self, const eda_feedback *f, opc_error *error) {
  (void)self, (void)f, (void)error;
  return OPC_OK;
}

/* Set the first length to 60 nm, less 1 nm for each iteration. */
static int update_moves(void *self, const eda_feedback *f, eda_moves *m,
                        int *done, opc_error *error) {
  (void)self, (void)error;
  m->l[0] = -(int32_t)f->iteration - 1;
  *done = f->iteration >= 2;
  return OPC_OK;
}

static int cut_layer(void *self, const eda_gates *g, int layer, eda_cuts *cuts,
                     opc_error *error) {
  static const eda_point from[] = {{0, 0}, {60, 0}, {60, 1000}, {0, 1000}};
  static const double site[] = {30, 0, 60, 500, 30, 1000, 0, 500};
  static const uint32_t start[] = {0, 4};
  (void)self, (void)g, (void)error;
  if (layer == EDA_POLY)
    *cuts =
        (eda_cuts){.polygons = 1, .start = start, .from = from, .site = site};
  return OPC_OK;
}

static const eda_synthesizer mover = {.begin = begin_moves,
                                      .update = update_moves};
static const eda_synthesizer cutter = {
    .begin = begin_moves, .update = update_moves, .cut = cut_layer};

static int run_step(loop *l, const eda_synthesizer *s, gate_srafs srafs,
                    opc_error *error) {
  *l = (loop){.host = &host,
              .gates = eda_gates_sample(),
              .extractor = MODULE(&extractor, NULL),
              .max_iterations = 10,
              .ion_limit = 0.5,
              .assists = srafs,
              .drivers[MAIN].module = MODULE(s, NULL)};
  eda_printer_init(&l->printer, NULL, l->gates, MODULE(&litho, NULL),
                   MODULE(&resist, NULL), 500);
  return correct_loop_run(l, error);
}

static gate_srafs set_rules(int rows, double width, double margin) {
  return (gate_srafs){.rows = rows,
                      .width = width,
                      .distance = 150,
                      .space = 90,
                      .min_length = 100,
                      .overhang = 120,
                      .margin = margin};
}

/* Compare with rectangles computed by hand: gates at y 100..300 and 600..900 of
   a line at x 0..60. The scatter bars of the longer gate are placed first;
   those of the shorter gate end 90 nm before them. */
static void test_places(void) {
  static const eda_box want[] = {{-156, 480, -150, 1020},
                                 {210, 480, 216, 1020},
                                 {-156, -20, -150, 390},
                                 {210, -20, 216, 390}};
  loop l;
  opc_error error = {0};
  g_assert_false(run_step(&l, &mover, set_rules(1, 6, 0.02), &error));
  eda_boxes srafs = l.now.assists[EDA_POLY];
  g_assert_cmpuint(srafs.count, ==, 4);
  for (int i = 0; i < 4; i++) {
    int found = 0;
    for (int k = 0; k < 4; k++)
      found |= !memcmp(&srafs.box[k], &want[i], sizeof want[i]);
    g_assert_true(found);
  }
  /* The scatter bars are in the mask, beside the line, one part of which is 3
     nm shorter. */
  int64_t line = 60 * 1000 - 3 * 200, all = 6 * 2 * (540 + 410);
  g_assert_cmpint(eda_area2(&l.mask[EDA_POLY]), ==, 2 * (line + all));
  g_string_truncate(published, 0);
  g_assert_false(correct_assists_report(&l, &error));
  g_assert_cmpstr(published->str, ==, "assists assists_dropped ");
  g_assert_cmpuint(l.assists.dropped, ==, 0);
  correct_loop_clear(&l);
  g_assert_false(run_step(&l, &mover, set_rules(2, 6, 0.02), &error));
  g_assert_cmpuint(l.now.assists[EDA_POLY].count, ==, 8);
  correct_loop_clear(&l);
}

/* Scatter bars that print, or nearly print, are removed from the mask. */
static void test_dropped(void) {
  loop l;
  opc_error error = {0};
  for (int k = 0; k < 2; k++) {
    g_assert_false(run_step(
        &l, &mover, k ? set_rules(1, 6, 0.1) : set_rules(1, 8, 0.01), &error));
    g_assert_cmpuint(l.assists.dropped, ==, 4);
    g_assert_cmpuint(l.now.assists[EDA_POLY].count, ==, 0);
    g_assert_cmpint(eda_area2(&l.mask[EDA_POLY]), ==,
                    2 * (60 * 1000 - 3 * 200));
    correct_loop_clear(&l);
  }
}

static void test_none(void) {
  loop l;
  opc_error error = {0};
  g_assert_false(run_step(&l, &mover, set_rules(0, 6, 0.02), &error));
  g_assert_cmpuint(l.now.assists[EDA_POLY].count, ==, 0);
  g_string_truncate(published, 0);
  g_assert_false(correct_assists_report(&l, &error));
  g_assert_cmpstr(published->str, ==, "");
  correct_loop_clear(&l);
}

static void test_refused(void) {
  loop l;
  opc_error error = {0};
  g_assert_cmpint(run_step(&l, &cutter, set_rules(1, 6, 0.02), &error), ==,
                  OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "dissects the poly layer"));
  correct_loop_clear(&l);
  g_assert_cmpint(run_step(&l, &mover, set_rules(1, 0.3, 0.02), &error), ==,
                  OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "at least the mask grid"));
  correct_loop_clear(&l);
  /* The scatter bars would extend from 150 nm beside the line to 500 nm beside
     the active, beyond the margin. */
  g_assert_cmpint(run_step(&l, &mover, set_rules(1, 550, 0.02), &error), ==,
                  OPC_OK);
  correct_loop_clear(&l);
  g_assert_cmpint(run_step(&l, &mover, set_rules(1, 551, 0.02), &error), ==,
                  OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "increase 'margin'"));
  correct_loop_clear(&l);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  published = g_string_new(NULL);
  g_test_add_func("/assists/places", test_places);
  g_test_add_func("/assists/dropped", test_dropped);
  g_test_add_func("/assists/none", test_none);
  g_test_add_func("/assists/refused", test_refused);
  int failed = g_test_run();
  g_string_free(published, TRUE);
  return failed;
}
