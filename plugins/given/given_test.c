/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests that a mask that is written and read again has bit-identical figures:
   as a layout in memory, by the shipped flows through GDSII, and in the text
   format of a contest. Also tests masks that must be rejected. */
#include <eda/eda.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "tests/data.h"
#include "tests/shapes.h"
#include "tests/step.h"

#define MODELS(litho)                                               \
  "litho: { " litho                                                 \
  " }, resist: { use: resist.threshold, anchor: { line: 65 nm, "    \
  "pitch: 250 nm } }, extractor: { use: extractor.plain, devices: " \
  "'%s/data/devices/ptm65.yaml' }%s"

/* ---- masks and modules ---- */

static opc_module *make_sample(const char *id, const char *more) {
  opc_error error = {0};
  g_autofree char *models = g_strdup_printf(
      MODELS("use: litho.hopkins, kernels: 4"), g_getenv("OPCFLOW_SOURCE"), "");
  g_autofree char *map =
      g_strdup_printf("{ %s, margin: 1000 nm%s }", models, more);
  opc_module *m = opc_test_module(id, map, &error);
  if (!m) g_error("%s: %s", id, error.message);
  return m;
}

/* Return a layout of `unit` nm with shifted and scaled shapes as its layers. */
static eda_layout *layout_of(const eda_gates *g, const eda_shapes *shapes,
                             double unit, int32_t times, int32_t by) {
  opc_error error = {0};
  eda_layout *l = eda_layout_new(unit, &error);
  int32_t cell = eda_layout_cell(l, "FROM_ELSEWHERE", &error);
  for (size_t k = 0; k < g->layers; k++) {
    int32_t layer = eda_layout_layer(l, g->layer[k], &error);
    for (size_t i = 0; i < shapes[k].count; i++) {
      uint32_t from = shapes[k].start[i], n = shapes[k].start[i + 1] - from;
      g_autofree eda_point *p = g_new(eda_point, n);
      for (uint32_t j = 0; j < n; j++)
        p[j] = (eda_point){times * shapes[k].points[from + j].x + by,
                           times * shapes[k].points[from + j].y};
      g_assert_false(eda_layout_add_polygon(l, cell, layer, p, n, &error));
    }
  }
  return l;
}

#define BOTH ", layers: { poly: poly, active: active }"
/* The same layers by expressions. */
#define COMBINED ", layers: { poly: poly + (active & poly), active: (active) }"
#define QUICK ", fine: off" BOTH

static opc_module *given(const eda_gates *g, const eda_layout *layout,
                         const char *more) {
  opc_module *m = make_sample("given", more);
  opc_test_input(m, "gates", (void *)g);
  opc_test_input(m, "mask_layout", (void *)layout);
  return m;
}

/* ---- equal figures ---- */

static void expect_same(const char *what, const double *a, const double *b) {
  for (size_t i = 0; i < eda_gates_sample()->count; i++)
    if (a[i] != b[i])
      g_error("%s of gate %zu: %.17g, %.17g", what, i, a[i], b[i]);
}

static void check_same(const char *fine, int before_too) {
  const eda_gates *g = eda_gates_sample();
  g_autofree char *loop = g_strdup_printf(
      ", synthesizer: { use: synthesizer.epe }, max_iterations: 4%s", fine);
  opc_module *correct = make_sample("correct", loop);
  opc_test_input(correct, "gates", (void *)g);
  eda_mask *mask = run_step(correct);
  double worse = opc_test_metric("worse"), space = opc_test_metric("mask_edge");
  double mean = opc_test_metric("ion_mean"),
         off = opc_test_metric("ioff_total");
  g_assert_cmpfloat(
      shapes_difference(&mask->shapes[EDA_POLY], &g->drawn[EDA_POLY]), >, 0);
  eda_layout *layout = layout_of(g, mask->shapes, 0.25, 4, 0);
  g_autofree char *more = g_strdup_printf(COMBINED "%s", fine);
  opc_module *m = given(g, layout, more);
  eda_mask *out = run_step(m);
  for (size_t k = 0; k < g->layers; k++)
    g_assert_cmpfloat(shapes_difference(&mask->shapes[k], &out->shapes[k]), ==,
                      0);
  expect_same("Ion", mask->after.ion, out->after.ion);
  expect_same("Ioff", mask->after.ioff, out->after.ioff);
  expect_same("area", mask->after.area, out->after.area);
  expect_same("drawn Ion", mask->design.ion, out->design.ion);
  if (before_too) expect_same("Ion before", mask->before.ion, out->before.ion);
  for (size_t i = 0; i < g->count; i++) /* the drawn figures are computed by
                                           another model: see verification.h */
    g_assert_cmpfloat(fabs(mask->before.ion[i] / out->before.ion[i] - 1), <,
                      2e-3);
  g_assert_true(opc_test_metric("ion_mean") == mean);
  g_assert_true(opc_test_metric("ioff_total") == off);
  g_assert_true(opc_test_metric("worse") == worse);
  g_assert_true(opc_test_metric("mask_edge") == space);
  g_assert_true(opc_test_metric("snapped") == 0);
  release_sample(m, out);
  eda_layout_free(layout);
  release_sample(correct, mask);
}

static void test_same(void) {
  check_same(", fine: 1e-3", 0);
  check_same(", fine: off", 1);
}

/* The drawn layout as a mask has the drawn figures. Transistors of a worse mask
   are counted. */
static void test_worse(void) {
  const eda_gates *g = eda_gates_sample();
  eda_layout *layout = layout_of(g, g->drawn, 1, 1, 0);
  opc_module *m = given(g, layout, QUICK);
  eda_mask *out = run_step(m);
  expect_same("Ion", out->before.ion, out->after.ion);
  g_assert_true(opc_test_metric("worse") == 0);
  g_assert_true(opc_test_metric("lost") == 0);
  release_sample(m, out);
  eda_layout_free(layout);
  eda_shapes thick[2];
  opc_error error = {0};
  g_assert_false(eda_shapes_grow(&g->drawn[EDA_POLY], 15, &thick[0], &error));
  g_assert_false(eda_shapes_grow(&g->drawn[EDA_ACTIVE], 0, &thick[1], &error));
  layout = layout_of(g, thick, 1, 1, 0);
  m = given(g, layout, QUICK);
  out = run_step(m);
  g_assert_true(opc_test_metric("worse") == 2);
  g_assert_cmpfloat(out->after.ion[0], <, 0.9 * out->before.ion[0]);
  release_sample(m, out);
  eda_layout_free(layout);
  for (int k = 0; k < 2; k++) eda_shapes_clear(&thick[k]);
}

/* ---- rejected input ---- */

/* Check that the run succeeds and logs these words. */
static void expect_logged(eda_layout *layout, const char *more,
                          const char *const *words) {
  opc_module *m = given(eda_gates_sample(), layout, more);
  eda_mask *out = run_step(m);
  for (; *words; words++)
    if (!strstr(opc_test_log(), *words))
      g_error("'%s' is not in:\n%s", *words, opc_test_log());
  release_sample(m, out);
  eda_layout_free(layout);
}

static void expect_refused(eda_layout *layout, const char *more,
                           const char *parameter, const char *words) {
  opc_error error = {0};
  void *outputs[1];
  opc_module *m = given(eda_gates_sample(), layout, more);
  opc_test_forget();
  g_assert_cmpint(opc_test_run(m, outputs, &error), !=, OPC_OK);
  g_assert_cmpstr(error.parameter, ==, parameter);
  if (!strstr(error.message, words))
    g_error("'%s' instead of '%s'", error.message, words);
  opc_test_module_free(m);
  eda_layout_free(layout);
}

#define WORDS(...) \
  (const char *const[]) { __VA_ARGS__, NULL }

static void test_logged(void) {
  const eda_gates *g = eda_gates_sample();
  expect_logged(layout_of(g, g->drawn, 1, 1, 300), QUICK,
                WORDS("covers nothing of the drawn shapes",
                      "the mask seems displaced by (300, 0) nm",
                      "2 of 2 transistors do not print"));
  expect_logged(layout_of(g, g->drawn, 0.5, 1, 0), QUICK,
                WORDS("the mask is 0.5 times as large: check the 'scale'"));
  expect_logged(layout_of(g, g->drawn, 0.5, 2, 1), QUICK,
                WORDS("the grid of 1 nm moved", "by 0.5 nm at most"));
  g_assert_true(opc_test_metric("snapped_worst") == 0.5);
  expect_logged(layout_of(g, g->drawn, 1, 1, 0),
                ", fine: off, layers: { poly: poly }",
                WORDS("'layers' does not name 'active': the drawn shapes are "
                      "the mask of this layer"));
}

static eda_layout *empty_layout(void) {
  opc_error error = {0};
  eda_layout *l = eda_layout_new(1, &error);
  int32_t cell = eda_layout_cell(l, "EMPTY", &error);
  eda_layout_layer(l, "poly", &error);
  int32_t slanted = eda_layout_layer(l, "slanted", &error);
  const eda_point p[] = {{0, 0}, {50, 0}, {20, 30}};
  g_assert_false(eda_layout_add_polygon(l, cell, slanted, p, 3, &error));
  return l;
}

static void test_refused(void) {
  const eda_gates *g = eda_gates_sample();
  expect_refused(
      empty_layout(), ", fine: off, layers: { poly: poly }", "layers.poly",
      "layer 'poly' of cell 'EMPTY' is empty, expected the shapes of a mask");
  expect_refused(empty_layout(), ", fine: off, layers: { poly: other }",
                 "layers.poly", "no layer 'other'");
  expect_refused(empty_layout(), ", fine: off, layers: { poly: poly - }",
                 "layers.poly", "expected a layer or '(' at character 7");
  expect_refused(empty_layout(), ", fine: off, layers: { metal: poly }",
                 "layers.metal", "no layer of this name");
  expect_refused(empty_layout(),
                 ", fine: off, top: NONE, layers: { poly: poly }", "top",
                 "no cell 'NONE'");
  expect_refused(empty_layout(), ", fine: off, layers: { poly: slanted }",
                 "layers.poly", "(");
  expect_refused(layout_of(g, g->drawn, 1000, 1, 0), QUICK, "layers.poly",
                 "the mask is 1000 times as large");
  expect_refused(layout_of(g, g->drawn, 1, 1, 5000), QUICK, "layers.poly",
                 "the mask seems displaced by (5000, 0) nm");
}

/* ---- through files ---- */

static char *source(const char *name) {
  return g_build_filename(g_getenv("OPCFLOW_SOURCE"), name, NULL);
}

static void opcflow(const char *first, ...) {
  g_autoptr(GPtrArray) argv = g_ptr_array_new_with_free_func(g_free);
  g_autoptr(GError) error = NULL;
  g_autofree char *err = NULL;
  int status;
  va_list args;
  g_ptr_array_add(argv,
                  g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL));
  va_start(args, first);
  for (const char *a = first; a; a = va_arg(args, const char *))
    g_ptr_array_add(argv, g_strdup(a));
  va_end(args);
  g_ptr_array_add(argv, NULL);
  g_spawn_sync(NULL, (char **)argv->pdata, NULL, G_SPAWN_STDOUT_TO_DEV_NULL,
               NULL, NULL, NULL, &err, &status, &error);
  g_assert_no_error(error);
  if (status) g_error("%s", err);
}

/* Return the rows of a run's table as fields, the first row with the column
   names. */
static GPtrArray *table(const char *run_folder, const char *name) {
  g_autofree char *path =
      g_build_filename(opc_test_folder(), run_folder, name, NULL);
  g_autofree char *text = NULL;
  g_autoptr(GError) error = NULL;
  g_file_get_contents(path, &text, NULL, &error);
  g_assert_no_error(error);
  GPtrArray *rows = g_ptr_array_new_with_free_func((GDestroyNotify)g_strfreev);
  g_auto(GStrv) lines = g_strsplit(g_strchomp(text), "\n", -1);
  for (char **l = lines; *l; l++)
    g_ptr_array_add(rows, g_strsplit(g_strchomp(*l), ",", -1));
  return rows;
}

/* Check that all columns of `a` that `b` has are equal. Returns their
   number. */
static int same_columns(GPtrArray *a, GPtrArray *b, const char *but) {
  char **mine = a->pdata[0], **other = b->pdata[0];
  int same = 0;
  g_assert_cmpuint(a->len, ==, b->len);
  for (int i = 0; mine[i]; i++) {
    int j = 0;
    while (other[j] && strcmp(mine[i], other[j]) != 0) j++;
    if (!other[j] || !strcmp(mine[i], but)) continue;
    for (guint r = 1; r < a->len; r++)
      g_assert_cmpstr(((char **)a->pdata[r])[i], ==, ((char **)b->pdata[r])[j]);
    same++;
  }
  return same;
}

/* An EPE mask, written by one flow and read back by the other. */
static void test_flows(void) {
  g_autofree char *epe = source("flows/epe.yaml"),
                  *back = source("flows/given.yaml"),
                  *cell = source("data/cells65/nand2.cif");
  g_autofree char *layout = g_strdup_printf(
      "layout={ use: read.cif, file: '%s', layers: { poly: CP, active: CA, "
      "contact: CC, nwell: CW } }",
      cell);
  g_autofree char *ours = g_build_filename(opc_test_folder(), "epe", NULL),
                  *theirs = g_build_filename(opc_test_folder(), "given", NULL);
  g_autofree char *file = g_strdup_printf("other.file=%s/mask.gds", ours);
  opcflow("run", epe, "--set", layout, "--set", "picture=~", "--output", ours,
          NULL);
  opcflow("run", back, "--set", layout, "--set", file, "--set", "picture=~",
          "--output", theirs, NULL);
  static const struct {
    const char *name, *but;
    int columns;
  } tables[] = {{"gates.csv", "ion_before (%)", 15},
                {"cost.csv", "", 11},
                {"mask_rules.csv", "", 8}};
  for (size_t k = 0; k < G_N_ELEMENTS(tables); k++) {
    g_autoptr(GPtrArray) a = table("epe", tables[k].name);
    g_autoptr(GPtrArray) b = table("given", tables[k].name);
    g_assert_cmpuint(a->len, >, 2);
    g_assert_cmpint(same_columns(a, b, tables[k].but), ==, tables[k].columns);
  }
}

/* ---- a contest's mask ---- */

/* Write a mask in the contest's format. */
static char *write_clip(const eda_gates *g, const eda_shapes *s) {
  GString *text = g_string_new("BEGIN\nEQUIV  1  1000  MICRON  +X,+Y\n");
  g_string_append_printf(text, "CNAME %s\nLEVEL M1\n\nCELL %s PRIME\n", g->name,
                         g->name);
  for (size_t i = 0; i < s->count; i++) {
    g_string_append(text, "   PGON N M1 ");
    for (uint32_t k = s->start[i]; k < s->start[i + 1]; k++)
      g_string_append_printf(text, " %d %d", s->points[k].x, s->points[k].y);
    g_string_append(text, "\n");
  }
  g_string_append(text, "ENDMSG\n");
  char *path = g_build_filename(opc_test_folder(), "mask.glp", NULL);
  g_assert_true(g_file_set_contents(path, text->str, -1, NULL));
  g_string_free(text, TRUE);
  return path;
}

static opc_module *module(const char *id, const char *format, ...)
    G_GNUC_PRINTF(2, 3);
static opc_module *module(const char *id, const char *format, ...) {
  opc_error error = {0};
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *map = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  opc_module *m = opc_test_module(id, map, &error);
  if (!m) g_error("%s: %s", id, error.message);
  return m;
}

static void mask_score(const eda_mask *mask, const char *optics,
                       double out[4]) {
  static const char *const names[] = {"epe", "l2", "pvb", "shots"};
  opc_module *m = module("score.iccad", "{ %s }", optics);
  opc_error error = {0};
  opc_test_input(m, "mask", (void *)mask);
  opc_test_forget();
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  for (int i = 0; i < 4; i++) out[i] = opc_test_metric(names[i]);
  opc_test_module_free(m);
}

static void test_clip(void) {
  g_autofree char *kernels = find_data("clips/kernels");
  g_autofree char *target = find_data("clips/iccad2013/M1_test4.glp");
  if (!kernels || !target) return;
  g_autofree char *resist = g_strdup(
      "resist: { use: resist.threshold, tone: bright, threshold: 0.225, "
      "active_threshold: 0.225 }");
  g_autofree char *optics = g_strdup_printf(
      "litho: { use: litho.kernels, focus: '%s/focus/scales.txt', defocus: "
      "'%s/defocus/scales.txt' }, %s",
      kernels, kernels, resist);
  g_autofree char *models = g_strdup_printf(
      "%s, extractor: { use: extractor.plain, devices: "
      "'%s/data/devices/ptm65.yaml' }, margin: 400 nm",
      optics, g_getenv("OPCFLOW_SOURCE"));
  opc_module *read = module("read.glp", "{ file: '%s' }", target);
  eda_layout *clip = run_step(read);
  opc_module *edges = module("segment.edges", "{ layer: M1 }");
  opc_test_input(edges, "layout", clip);
  eda_gates *g = run_step(edges);
  opc_module *loop = module("correct",
                            "{ %s, max_iterations: 3, synthesizer: { use: "
                            "synthesizer.epe, fragment: 40 nm } }",
                            models);
  opc_test_input(loop, "gates", g);
  eda_mask *mask = run_step(loop);
  g_autofree char *path = write_clip(g, &mask->shapes[0]);
  opc_module *again = module("read.glp", "{ file: '%s' }", path);
  eda_layout *layout = run_step(again);
  opc_module *m = module("given", "{ %s, layers: { M1: M1 } }", models);
  opc_test_input(m, "gates", g);
  opc_test_input(m, "mask_layout", layout);
  eda_mask *out = run_step(m);
  double ours[4], theirs[4];
  mask_score(mask, optics, ours);
  mask_score(out, optics, theirs);
  g_assert_cmpmem(ours, sizeof ours, theirs, sizeof theirs);
  g_assert_cmpfloat(ours[1], >, 1000);
  release_sample(m, out);
  release_sample(again, layout);
  release_sample(loop, mask);
  release_sample(edges, g);
  release_sample(read, clip);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/given/same", test_same);
  g_test_add_func("/given/worse", test_worse);
  g_test_add_func("/given/logged", test_logged);
  g_test_add_func("/given/refused", test_refused);
  g_test_add_func("/given/flows", test_flows);
  g_test_add_func("/given/clip", test_clip);
  return g_test_run();
}
