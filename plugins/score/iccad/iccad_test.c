/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the figures of images in which nothing prints, or everything. Also
   compares the figures of the contest's first clip, as drawn, with those of
   another program. */
#include <eda/gates.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

#include <math.h>
#include <string.h>

/* The box (0, 0) to (200, 60), as drawn shape and as mask, on a grid of 1
   nm. */
static eda_point points[] = {{0, 0}, {200, 0}, {200, 60}, {0, 60}};
static uint32_t start[] = {0, 4};
static eda_shapes drawn[] = {{1, start, points, NULL}};
static const eda_gates gates = {
    .grid = 1, .extent = {0, 0, 200, 60}, .layers = 1, .drawn = drawn};
static eda_mask mask = {.gates = &gates, .shapes = drawn};

static opc_module *score_module(const char *more) {
  opc_error error;
  g_autofree char *p = g_strdup_printf("{ %s }", more);
  opc_module *m = opc_test_module("score.iccad", p, &error);
  if (!m) g_error("%s", error.message);
  return m;
}

static void assert_value(const char *column, double value) {
  g_assert_cmpfloat(opc_test_number("iccad", column, 0), ==, value);
}

/* Write a kernel that passes little more than the mean, so that the image is
   dark everywhere. Return the path. */
static char *write_kernel(void) {
  /* 3 x 3: 1 in the centre, and 0.001 beside it. */
  static const uint8_t kernel[24 + 72] = {
      [3] = 3, [7] = 3, [11] = 2, [56] = 0x3f, 0x80, [64] = 0x3a, 0x83};
  g_autofree char *file = g_build_filename(opc_test_folder(), "fh0.bin", NULL);
  char *scales = g_build_filename(opc_test_folder(), "scales.txt", NULL);
  g_assert_true(
      g_file_set_contents(file, (const char *)kernel, sizeof kernel, NULL));
  g_assert_true(g_file_set_contents(scales, "1\n1\n", -1, NULL));
  return scales;
}

/* Test that bright features do not print without light, and dark ones print
   everywhere. An edge of 200 nm has sites at 40 and 80 nm from both ends, an
   edge of 60 nm has one at its centre. */
static void test_extremes(void) {
  g_autofree char *kernel = write_kernel();
  for (int all = 0; all < 2; all++) {
    g_autofree char *p = g_strdup_printf(
        "tile: 1024 nm, defocus: 0 nm, litho: { use: litho.kernels, period: "
        "1024 nm, focus: '%s' }, resist: { use: resist.threshold, tone: %s, "
        "threshold: 0.5, active_threshold: 0.5 }",
        kernel, all ? "dark" : "bright");
    g_autoptr(opc_module) m = score_module(p);
    opc_error error;
    opc_test_input(m, "mask", &mask);
    if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
    assert_value("sites", 10);
    assert_value("epe_inner", all ? 0 : 10);
    assert_value("epe_outer", all ? 10 : 0);
    assert_value("l2", all ? 1024 * 1024 - 200 * 60 : 200 * 60);
    assert_value("pvb", 0);
    assert_value("shots", 1);
    assert_value("lost", all ? 0 : 3);
    assert_value("bridged", 0);
    g_assert_cmpfloat(opc_test_metric("epe"), ==, 10);
  }
}

static void test_refused(void) {
  g_autoptr(opc_module) m = score_module(
      "tile: 128 nm, litho: { use: litho.hopkins }, resist: { use: "
      "resist.threshold, threshold: 0.4, active_threshold: 0.4 }");
  opc_error error;
  opc_test_input(m, "mask", &mask);
  g_assert_cmpint(opc_test_run(m, NULL, &error), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "too large"));
}

/* Test the clip as drawn: a program that rasters the clip and sums over
   frequencies has L2 114,711 and a band of 43,707 nm^2. */
static void test_clip(void) {
  g_autofree char *folder = find_data("clips");
  if (!folder) return;
  opc_error error;
  void *layout[1], *edges[1];
  g_autofree char *file =
      g_strdup_printf("{ file: '%s/iccad2013/M1_test1.glp' }", folder);
  g_autoptr(opc_module) read = opc_test_module("read.glp", file, &error);
  g_autoptr(opc_module) segment =
      opc_test_module("segment.edges", "{ layer: M1 }", &error);
  g_assert_cmpint(opc_test_run(read, layout, &error), ==, OPC_OK);
  opc_test_input(segment, "layout", layout[0]);
  g_assert_cmpint(opc_test_run(segment, edges, &error), ==, OPC_OK);
  g_autofree char *p = g_strdup_printf(
      "litho: { use: litho.kernels, focus: '%s/kernels/focus/scales.txt', "
      "defocus: '%s/kernels/defocus/scales.txt' }, resist: { use: "
      "resist.threshold, tone: bright, threshold: 0.225, active_threshold: "
      "0.225 }",
      folder, folder);
  g_autoptr(opc_module) m = score_module(p);
  const eda_gates *g = edges[0];
  eda_mask drawn_mask = {.gates = g, .shapes = g->drawn};
  opc_test_input(m, "mask", &drawn_mask);
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  double l2 = opc_test_number("iccad", "l2", 0);
  double pvb = opc_test_number("iccad", "pvb", 0);
  g_assert_cmpfloat(fabs(pvb - 43707), <=, 60);
  g_assert_cmpfloat(fabs(l2 - 114711), <=, 60);
  opc_test_release(segment, edges);
  opc_test_release(read, layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/iccad/extremes", test_extremes);
  g_test_add_func("/iccad/refused", test_refused);
  g_test_add_func("/iccad/clip", test_clip);
  return g_test_run();
}
