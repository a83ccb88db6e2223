/* SPDX-License-Identifier: BSD-3-Clause */
/* The calibrated threshold prints its anchor to size; thresholds and line
   widths against an independent simulation of the same optics. */
#include "core/plugin/testing.h"

#include <math.h>
#include <string.h>

static const opc_host *host;

/* The level set of a vertical line of `width` at x = 0 in a grating. */
static opc_field print_line(opc_module *litho, opc_module *resist, int layer,
                            double width, double pitch) {
  const opc_litho *model = litho->plugin->operations;
  const opc_resist *develop = resist->plugin->operations;
  opc_frame f = {-pitch / 2, 0, pitch, pitch};
  int32_t x = (int32_t)lround(width * 500), top = (int32_t)lround(pitch * 1000);
  opc_point points[] = {{-x, 0}, {x, 0}, {x, top}, {-x, top}};
  uint32_t start[] = {0, 4};
  opc_shapes line = {1, start, points, NULL};
  opc_spectrum mask;
  opc_field field;
  opc_error error;
  g_assert_cmpint(host->imaging->mask_spectrum(host, &line, 1e-3, f,
                                               model->band(litho->self), &mask,
                                               &error), ==, OPC_OK);
  g_assert_cmpint(model->image(litho->self, layer, &mask, &field, &error), ==, OPC_OK);
  host->imaging->release_spectrum(host, &mask);
  g_assert_cmpint(develop->print(resist->self, layer, &field, &error), ==, OPC_OK);
  return field;
}

static double value_at(const opc_field *f, double x) {
  double y = 10, v;
  host->imaging->sample(f, &x, &y, 1, &v);
  return v;
}

/* The printed width of the line at x = 0. */
static double width_of(const opc_field *f) {
  double low = 0, high = f->frame.width / 2;
  for (int i = 0; i < 50; i++) {
    double middle = (low + high) / 2;
    if (value_at(f, middle) > 0) low = middle;
    else high = middle;
  }
  return 2 * low;
}

static opc_module *prepared(const char *parameters, opc_module *litho) {
  opc_error error;
  opc_module *m = opc_test_module("resist.threshold", parameters, &error);
  g_assert_nonnull(m);
  const opc_resist *resist = m->plugin->operations;
  g_assert_cmpint(resist->prepare(m->self, litho, &error), ==, OPC_OK);
  return m;
}

static opc_module *hopkins(void) {
  opc_error error;
  opc_module *m = opc_test_module("litho.hopkins", "{ kernels: 94 }", &error);
  g_assert_nonnull(m);
  const opc_litho *litho = m->plugin->operations;
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
  return m;
}

static void test_anchor(void) {
  g_autoptr(opc_module) litho = hopkins();
  g_autoptr(opc_module) drawn = prepared("{}", litho);
  opc_field f = print_line(litho, drawn, OPC_POLY, 65, 250);
  g_assert_cmpfloat(fabs(width_of(&f) - 65), <, 0.002);
  host->imaging->release_field(host, &f);
  g_autoptr(opc_module) wider = prepared("{ anchor: { cd: 71 nm } }", litho);
  f = print_line(litho, wider, OPC_POLY, 65, 250);
  g_assert_cmpfloat(fabs(width_of(&f) - 71), <, 0.002);
  host->imaging->release_field(host, &f);
}

/* Thresholds and widths through pitch as a prototype with other code (tile
   sums of the exact cross coefficient) gave them. */
static void test_through_pitch(void) {
  g_autoptr(opc_module) litho = hopkins();
  g_autoptr(opc_module) resist = prepared("{}", litho);
  /* Far from the line the level is the threshold less the clear field. */
  opc_field f = print_line(litho, resist, OPC_POLY, 65, 4000);
  double threshold = 1 + value_at(&f, 2000);
  g_test_message("dense anchor: threshold %.4f", threshold);
  g_assert_cmpfloat(fabs(threshold - 0.404), <, 0.003);
  host->imaging->release_field(host, &f);
  const double pitch[] = {220, 320, 500, 1500}, cd[] = {62.9, 67.1, 70.7, 73.7};
  for (int i = 0; i < 4; i++) {
    f = print_line(litho, resist, OPC_POLY, 65, pitch[i]);
    g_test_message("pitch %g: %.2f nm, expected %.1f", pitch[i], width_of(&f), cd[i]);
    g_assert_cmpfloat(fabs(width_of(&f) - cd[i]), <, 0.3);
    host->imaging->release_field(host, &f);
  }
  f = print_line(litho, resist, OPC_ACTIVE, 1000, 5000);
  double active = 1 + value_at(&f, 2500);
  g_test_message("edge of a wide active: threshold %.4f", active);
  g_assert_cmpfloat(fabs(active - 0.265), <, 0.01);
  g_assert_cmpfloat(fabs(width_of(&f) - 1000), <, 0.002);
  host->imaging->release_field(host, &f);
}

static void test_given(void) {
  g_autoptr(opc_module) litho = hopkins();
  g_autoptr(opc_module) resist =
      prepared("{ threshold: 0.3, active_threshold: 0.2 }", litho);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    opc_field f = {.frame = {0, 0, 100, 100}, .nx = 16, .ny = 16};
    f.coefficients = host->alloc(host, 256, sizeof(float));
    opc_error error;
    const opc_resist *develop = resist->plugin->operations;
    g_assert_cmpint(develop->print(resist->self, layer, &f, &error), ==, OPC_OK);
    g_assert_cmpfloat(fabs(value_at(&f, 3) - (layer == OPC_POLY ? 0.3 : 0.2)), <,
                      1e-6);
    host->imaging->release_field(host, &f);
  }
}

/* An anchor that the optics cannot resolve, and one without space. */
static void test_refused(void) {
  g_autoptr(opc_module) litho = hopkins();
  opc_error error;
  g_autoptr(opc_module) fine = opc_test_module(
      "resist.threshold", "{ anchor: { line: 50 nm, pitch: 100 nm } }", &error);
  g_assert_nonnull(fine);
  const opc_resist *resist = fine->plugin->operations;
  g_assert_cmpint(resist->prepare(fine->self, litho, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "anchor");
  g_assert_nonnull(strstr(error.message, "cannot be printed"));
  g_assert_null(opc_test_module(
      "resist.threshold", "{ anchor: { line: 250 nm, pitch: 250 nm } }", &error));
  g_assert_nonnull(strstr(error.message, "no space between its lines"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_test_host();
  g_test_add_func("/threshold/anchor", test_anchor);
  g_test_add_func("/threshold/through-pitch", test_through_pitch);
  g_test_add_func("/threshold/given", test_given);
  g_test_add_func("/threshold/refused", test_refused);
  return g_test_run();
}
