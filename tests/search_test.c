/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the step `search` by the command. The results are compared with
   separate runs of the same flow at each setting. */
#include <math.h>
#include <string.h>

#include "tests/flow.h"

/* ---- help ---- */

static void run_good(const char *flow, const char *run, const char *option,
                     const char *value) {
  g_autofree char *errors = NULL;
  int code = option ? opcflow(&errors, "run", flow, "--output", run, option,
                              value, NULL)
                    : opcflow(&errors, "run", flow, "--output", run, NULL);
  if (code) g_error("'%s': exit code %d: %s", run, code, errors);
}

static void expect_same(const char *a, const char *b, const char *c,
                        const char *d) {
  g_autofree char *one = g_build_filename(folder, a, b, NULL);
  g_autofree char *other = g_build_filename(folder, c, d, NULL);
  char *text[2];
  gsize n[2];
  g_assert_true(g_file_get_contents(one, &text[0], &n[0], NULL));
  g_assert_true(g_file_get_contents(other, &text[1], &n[1], NULL));
  if (n[0] != n[1] || memcmp(text[0], text[1], n[0]))
    g_error("'%s' and '%s' differ", one, other);
  g_free(text[0]);
  g_free(text[1]);
}

/* ---- flows ---- */

/* Return the inner flow, which corrects a NAND2 by EPE-OPC. */
static char *inner_text(void) {
  g_autofree char *cif = source_path("data/cells65/nand2.cif");
  g_autofree char *devices = source_path("data/devices/ptm65.yaml");
  return g_strdup_printf(
      "opcflow: 1\nname: inner\nsteps:\n"
      "  layout:\n    use: read.cif\n    file: %s\n"
      "    layers: { poly: CP, active: CA, contact: CC, nwell: CW }\n"
      "  gates: { use: segment.transistors, layout: ${layout}, grid: 1 nm }\n"
      /* An accurate model would change the figures of a shared run. */
      "  mask:\n    use: correct\n    gates: ${gates}\n    fine: off\n"
      "    litho: { use: litho.hopkins, wavelength: 193 nm, na: 0.75, sigma: "
      "0.75 }\n"
      "    resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 "
      "nm } }\n"
      "    extractor: { use: extractor.plain, devices: %s }\n"
      "    synthesizer: { use: synthesizer.epe, fragment: 20 nm }\n"
      "  cost: { use: cost.fracture, mask: ${mask} }\n"
      "  gds: { use: write.gds, mask: ${mask}, file: mask.gds }\n"
      "variants:\n  few: { mask.max_iterations: 2 }\n",
      cif, devices);
}

#define HEAD                                                    \
  "opcflow: 1\nname: outer\nsteps:\n  best:\n    use: search\n" \
  "    flow: inner.yaml\n"
#define GDS "  gds: { use: write.gds, mask: ${best}, file: mask.gds }\n"
#define AXES                                          \
  "    sweep:\n"                                      \
  "      mask.synthesizer.fragment: [14 nm, 40 nm]\n" \
  "      mask.max_iterations: { from: 1, to: 3, step: 1 }\n"
#define ALONG "    along: { mask.max_iterations: mask.history.iteration }\n"
#define LEAST "    minimise: mask.ion_mean\n"

enum { LENGTHS = 2, MOVES = 3, ALL = LENGTHS * MOVES };
static const char *const lengths[LENGTHS] = {"14 nm", "40 nm"};

/* Return the figures of separate runs in the folders alone-L-M; the runs are
   made once. */
static const double *alone(void) {
  static double figure[ALL];
  if (figure[0] > 0) return figure;
  for (int i = 0; i < ALL; i++) {
    g_autofree char *run = g_strdup_printf("alone-%d", i);
    g_autofree char *flow = g_strdup_printf("alone-%d.yaml", i);
    g_autofree char *text = g_strdup_printf(
        "opcflow: 1\nextends: inner.yaml\nsteps:\n  mask: { max_iterations: "
        "%d, synthesizer: { fragment: %s } }\n",
        i % MOVES + 1, lengths[i / MOVES]);
    write_file(flow, text);
    run_good(flow, run, NULL, NULL);
    figure[i] = metric(run, "mask", "ion_mean");
  }
  return figure;
}

static int least_of(const double *figure, int n) {
  int best = 0;
  for (int i = 1; i < n; i++)
    if (figure[i] < figure[best]) best = i;
  return best;
}

/* Read the figures of settings.csv. */
static void read_figures(const char *run, int n, double *figure) {
  g_autofree char *text = read_file(run, "settings.csv");
  g_auto(GStrv) lines = g_strsplit(text, "\r\n", -1);
  g_assert_cmpuint(g_strv_length(lines), ==, n + 2);
  for (int i = 0; i < n; i++) {
    g_auto(GStrv) cells = g_strsplit(lines[i + 1], ",", -1);
    g_assert_cmpint(atoi(cells[0]), ==, i + 1);
    figure[i] = *cells[3] ? g_ascii_strtod(cells[3], NULL) : NAN;
  }
}

/* ---- tests ---- */

/* Searches with and without shared runs equal the separate runs: figures are
   bit-identical, and the mask is the same. */
static void test_truth(void) {
  const double *truth = alone();
  int best = least_of(truth, ALL);
  g_autofree char *winner = g_strdup_printf("alone-%d", best);
  static const char *const names[] = {"shared", "single"};
  for (int k = 0; k < 2; k++) {
    g_autofree char *flow = g_strdup_printf("%s.yaml", names[k]);
    write_file(flow, k ? HEAD AXES LEAST GDS : HEAD AXES ALONG LEAST GDS);
    run_good(flow, names[k], NULL, NULL);
    double figure[ALL];
    read_figures(names[k], ALL, figure);
    for (int i = 0; i < ALL; i++) g_assert_true(figure[i] == truth[i]);
    g_assert_true(metric(names[k], "best", "least") == truth[best]);
    g_assert_true(metric(names[k], "best", "setting") == best + 1);
    g_assert_true(metric(names[k], "best", "settings") == ALL);
    g_assert_true(metric(names[k], "best", "runs") == (k ? ALL : LENGTHS));
    expect_same(names[k], "mask.gds", winner, "mask.gds");
    expect_same(names[k], "best/gates.csv", winner, "gates.csv");
  }
}

/* Two layers are simulated at the start and after each displacement. */
static void test_simulations(void) {
  alone();
  double single = 0;
  for (int i = 0; i < ALL; i++) {
    g_autofree char *run = g_strdup_printf("alone-%d", i);
    single += metric(run, "mask", "simulations");
  }
  g_autofree char *winner = g_strdup_printf("alone-%d", least_of(alone(), ALL));
  double again = metric(winner, "mask", "simulations");
  double shared = metric("alone-2", "mask", "simulations") +
                  metric("alone-5", "mask", "simulations");
  g_assert_true(metric("single", "best", "simulations") == single + again);
  g_assert_true(metric("shared", "best", "simulations") == shared + again);
  g_assert_cmpfloat(shared, <, single);
}

/* Files with one and four threads are identical. */
static void test_threads(void) {
  run_good("shared.yaml", "one", "--threads", "1");
  run_good("shared.yaml", "four", "--threads", "4");
  static const char *const files[] = {"settings.csv",   "best.csv",
                                      "metrics.json",   "mask.gds",
                                      "best/gates.csv", "best/history.csv"};
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++)
    expect_same("one", files[i], "four", files[i]);
}

/* Parameters of other plugins, another figure, maximisation, a variant, and
   another plugin in a slot. */
static void test_others(void) {
  write_file(
      "others.yaml", HEAD
      "    variant: few\n    set:\n"
      "      mask.synthesizer: { use: synthesizer.dpb, ion_limit: 0.5 % }\n"
      "    sweep: { mask.litho.na: [0.7, 0.75, 0.8] }\n"
      "    maximise: cost.shots\n    mask: mask\n" GDS);
  g_autofree char *errors = NULL;
  int code = opcflow(&errors, "run", "others.yaml", "--output", "others", NULL);
  if (code) g_error("%s", errors);
  double figure[3] = {0};
  g_autofree char *text = read_file("others", "settings.csv");
  g_auto(GStrv) lines = g_strsplit(text, "\r\n", -1);
  int greatest = 0;
  for (int i = 0; i < 3; i++) {
    g_auto(GStrv) cells = g_strsplit(lines[i + 1], ",", -1);
    figure[i] = g_ascii_strtod(cells[2], NULL);
    if (figure[i] > figure[greatest]) greatest = i;
  }
  g_assert_true(metric("others", "best", "greatest") == figure[greatest]);
  g_assert_true(metric("others", "best", "setting") == greatest + 1);
  g_autofree char *run = g_strdup_printf("na-%d", greatest);
  g_autofree char *flow = g_strdup_printf("na-%d.yaml", greatest);
  g_autofree char *alone_text = g_strdup_printf(
      "opcflow: 1\nextends: inner.yaml\nsteps:\n  mask: { max_iterations: 2, "
      "litho: { na: %g }, synthesizer: { use: synthesizer.dpb, ion_limit: 0.5 "
      "%% "
      "} }\n",
      0.7 + 0.05 * greatest);
  write_file(flow, alone_text);
  run_good(flow, run, NULL, NULL);
  g_assert_true(metric(run, "cost", "shots") == figure[greatest]);
  expect_same("others", "mask.gds", run, "mask.gds");
}

/* Failed settings are reported and cannot be the best. */
static void test_failing(void) {
  write_file("failing.yaml", HEAD
             "    set: { mask.max_iterations: 1 }\n    sweep:\n"
             "      mask.synthesizer.fragment: [40 nm, 10 nm]\n"
             "      mask.synthesizer.min_edge: [5 nm, 20 nm]\n" LEAST GDS);
  run_good("failing.yaml", "failing", NULL, NULL);
  double figure[4];
  read_figures("failing", 4, figure);
  g_assert_true(isnan(figure[3]));
  g_assert_true(metric("failing", "best", "failed") == 1);
  g_autofree char *text = read_file("failing", "settings.csv");
  g_assert_nonnull(
      strstr(text, "'min_edge' is 20 nm, expected at most 'fragment', 10 nm"));
}

/* The resolved flow runs from another folder. File names are relative to the
   flow that contains the names. The manifest lists files and plugins of the
   inner flow. */
static void test_resolved(void) {
  g_autofree char *cif = source_path("data/cells65/nand2.cif"), *text = NULL;
  g_assert_true(g_file_get_contents(cif, &text, NULL, NULL));
  g_autofree char *sub = place("sub");
  g_assert_cmpint(g_mkdir_with_parents(sub, 0777), ==, 0);
  write_file("sub/mine.cif", text);
  write_file("sub/outer.yaml",
             "opcflow: 1\nsteps:\n  best:\n    use: search\n"
             "    flow: ../inner.yaml\n    set: { layout.file: mine.cif }\n"
             "    sweep: { mask.max_iterations: [0, 1] }\n" LEAST GDS);
  run_good("sub/outer.yaml", "first", NULL, NULL);
  g_autofree char *flow = g_build_filename("first", "flow.yaml", NULL);
  run_good(flow, "second", NULL, NULL);
  expect_same("first", "settings.csv", "second", "settings.csv");
  expect_same("first", "mask.gds", "second", "mask.gds");
  g_autofree char *manifest = read_file("second", "manifest.json");
  g_assert_nonnull(strstr(manifest, "sub/mine.cif\""));
  g_assert_nonnull(strstr(manifest, "inner.yaml\""));
  g_assert_nonnull(strstr(manifest, "\"synthesizer.epe\""));
  g_autofree char *best = g_build_filename("first", "best", "flow.yaml", NULL);
  run_good(best, "third", NULL, NULL);
  g_assert_true(metric("third", "mask", "ion_mean") ==
                metric("first", "best", "least"));
  /* --set changes the inner flow. */
  g_autofree char *other = source_path("data/cells65/nor2.cif");
  g_autofree char *set = g_strdup_printf("best.set.layout.file=%s", other);
  run_good("sub/outer.yaml", "nor2", "--set", set);
  g_assert_true(metric("nor2", "best", "least") !=
                metric("first", "best", "least"));
}

/* ---- refused flows ---- */

/* Check that `check` and `run` reject a flow. */
static void assert_refused(const char *text, const char *want) {
  write_file("bad.yaml", text);
  g_autofree char *errors = NULL, *again = NULL;
  int code = opcflow(&errors, "check", "bad.yaml", NULL);
  if (code != 2 || strcmp(errors, want))
    g_error("exit code %d, want 2 and\n%s\nnot\n%s", code, want, errors);
  g_assert_cmpint(opcflow(&again, "run", "bad.yaml", "--output", "bad", NULL),
                  ==, 2);
  g_autofree char *out = place("bad");
  g_assert_false(g_file_test(out, G_FILE_TEST_EXISTS));
}

static void test_refused(void) {
  assert_refused(HEAD AXES "    minimise: mask.ion_maen\n",
                 "bad.yaml:10:15: step 'best' (search): 'mask' (correct) has "
                 "no metric 'ion_maen', did you mean 'ion_mean'?\n");
  assert_refused(HEAD AXES "    minimise: msak.ion_mean\n",
                 "bad.yaml:10:15: step 'best' (search): 'msak' does not exist "
                 "in 'inner.yaml', did you mean 'mask'?\n");
  assert_refused(HEAD AXES "    minimise: ion_mean\n",
                 "bad.yaml:10:15: step 'best' (search): 'ion_mean' does not "
                 "name a metric, expected 'step.metric'\n");
  assert_refused(HEAD AXES,
                 "bad.yaml:4:3: step 'best' (search): a search requires one of "
                 "'minimise', 'maximise' and 'weights'\n");
  assert_refused(HEAD LEAST,
                 "bad.yaml:4:3: step 'best' (search): a search requires a "
                 "'sweep', here or in 'inner.yaml'\n");
  assert_refused(HEAD "    sweep: { mask.synthesizer.fragmnt: [1 nm] }\n" LEAST,
                 "bad.yaml:7:14: unknown parameter 'fragmnt' of "
                 "'synthesizer.epe', did you mean 'fragment'?\n");
  assert_refused(
      HEAD "    sweep: { mask.max_iterations: [1, x] }\n" LEAST,
      "bad.yaml:7:39: 'max_iterations' must be a whole number, found 'x'\n");
  assert_refused(
      HEAD "    set: { layuot.file: a }\n" AXES LEAST,
      "bad.yaml:7:12: unknown step 'layuot', did you mean 'layout'?\n");
  assert_refused(HEAD "    variant: fwe\n" AXES LEAST,
                 "bad.yaml:7:14: unknown variant 'fwe', did you mean 'few'?\n");
  assert_refused(
      HEAD AXES LEAST
      "    along: { mask.max_iteration: mask.history.iteration }\n",
      "bad.yaml:11:14: step 'best' (search): 'mask.max_iteration' is not a "
      "swept parameter, did you mean 'mask.max_iterations'?\n");
  assert_refused(
      HEAD AXES LEAST
      "    along: { mask.synthesizer.fragment: mask.history.iteration }\n",
      "bad.yaml:11:14: step 'best' (search): 'mask.synthesizer.fragment' "
      "requires increasing numbers without units to share a run\n");
  assert_refused(HEAD AXES LEAST
                 "    along: { mask.max_iterations: mask.history }\n",
                 "bad.yaml:11:14: step 'best' (search): 'mask.history' does "
                 "not name a column, expected 'step.table.column'\n");
  assert_refused(HEAD AXES "    minimise: cost.shots\n",
                 "bad.yaml:4:3: step 'best' (search): step 'cost' "
                 "(cost.fracture) makes no mask: 'mask' must name the step "
                 "whose mask is the output, such as 'mask'\n");
  assert_refused(HEAD "    sweep: { gds.file: [a.gds, b.gds] }\n" LEAST,
                 "bad.yaml:7:14: step 'best' (search): 'gds.file' has no "
                 "effect: step 'gds' runs after the step of the metric\n");
}

/* Faults of the inner flow are reported with the place in the inner flow. A
   search whose inner flow contains a search of the same flow is rejected. Some
   faults are found only by instances. */
static void test_inner_faults(void) {
  write_file("wrong.yaml",
             "opcflow: 1\nextends: inner.yaml\nsteps:\n  mask:\n"
             "    synthesizer: { fragmnt: 3 nm }\n");
  assert_refused(
      "opcflow: 1\nsteps:\n  best:\n    use: search\n    flow: wrong.yaml\n"
      "    sweep: { mask.max_iterations: [1] }\n" LEAST,
      "wrong.yaml:5:20: unknown parameter 'fragmnt' of 'synthesizer.epe', did "
      "you "
      "mean 'fragment'?\n");
  assert_refused(
      "opcflow: 1\nsteps:\n  best:\n    use: search\n    flow: bad.yaml\n"
      "    sweep: { mask.max_iterations: [1] }\n" LEAST,
      "bad.yaml:3:3: 'search' cannot be used here: inner flows may be nested "
      "only twice\n"
      "bad.yaml:6:14: unknown step 'mask'\n");
  assert_refused(
      HEAD "    set: { mask.synthesizer.min_edge: 50 nm }\n" AXES LEAST,
      "bad.yaml:4:3: step 'best' (search): bad.yaml:7:39: 'mask.synthesizer' "
      "(synthesizer.epe): 'min_edge' is 50 nm, expected at most 'fragment', 14 "
      "nm (and 1 "
      "more)\n");
}

/* A missing table is detected after the first run. */
static void test_no_table(void) {
  static const char *const columns[][2] = {
      {"mask.hisotry.iteration",
       "bad.yaml:10:12: step 'best' (search): 'mask' published no table "
       "'hisotry', did you mean 'history'?"},
      {"mask.history.iteratoin",
       "bad.yaml:10:12: step 'best' (search): table 'history' of 'mask' has no "
       "column of numbers 'iteratoin', did you mean 'iteration'?"}};
  for (size_t i = 0; i < 2; i++) {
    g_autofree char *text = g_strdup_printf(
        HEAD AXES "    along: { mask.max_iterations: %s }\n" LEAST,
        columns[i][0]);
    write_file("bad.yaml", text);
    g_autofree char *errors = NULL;
    g_assert_cmpint(opcflow(&errors, "run", "bad.yaml", NULL), ==, 2);
    if (!strstr(errors, columns[i][1]))
      g_error("'%s' is not in:\n%s", columns[i][1], errors);
  }
}

/* An inner step that fails at all settings is reported with its place. */
static void test_all_fail(void) {
  write_file("empty.cif", "DS 1; L CP; B 100 100 0 0; DF; C 1; E\n");
  write_file("bad.yaml",
             HEAD "    set: { layout.file: empty.cif }\n" AXES LEAST);
  g_autofree char *errors = NULL;
  int code = opcflow(&errors, "run", "bad.yaml", NULL);
  g_assert_cmpint(code, !=, 0);
  if (!strstr(errors, "bad.yaml:4:3: step 'best' (search): inner.yaml:"))
    g_error("%s", errors);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  begin_flows();
  g_autofree char *text = inner_text();
  write_file("inner.yaml", text);
  g_test_add_func("/search/truth", test_truth);
  g_test_add_func("/search/simulations", test_simulations);
  g_test_add_func("/search/threads", test_threads);
  g_test_add_func("/search/others", test_others);
  g_test_add_func("/search/failing", test_failing);
  g_test_add_func("/search/resolved", test_resolved);
  g_test_add_func("/search/refused", test_refused);
  g_test_add_func("/search/inner-faults", test_inner_faults);
  g_test_add_func("/search/no-table", test_no_table);
  g_test_add_func("/search/all-fail", test_all_fail);
  return run_flows();
}
