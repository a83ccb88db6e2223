/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the three files as read by KLayout: names and areas of layers,
   styles, markers by category. Without KLayout the files are checked
   directly. */
#include <eda/eda.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

/* Script for the program (klayout -zz) and for KLayout's Python module. */
static const char script[] =
    "try:\n"
    "  import pya as k, pya as lay\n"
    "except ImportError:\n"
    "  import klayout.db as k, klayout.lay as lay\n"
    "import sys, os\n"
    "folder = os.environ['RUN']\n"
    "l = k.Layout(); l.read(folder + '/run.oas')\n"
    "top = l.top_cell()\n"
    "print('top', top.name, l.dbu)\n"
    "for i in l.layer_indexes():\n"
    "  n = l.get_info(i)\n"
    "  r = k.Region(top.begin_shapes_rec(i))\n"
    "  print('layer', n.name, n.layer, n.datatype, r.merged().area() * l.dbu * "
    "l.dbu * 1e6)\n"
    "import collections\n"
    "db = lay.ReportDatabase('') if hasattr(lay, 'ReportDatabase') else "
    "__import__('klayout.rdb').rdb.ReportDatabase('')\n"
    "db.load(folder + '/run.lyrdb')\n"
    "print('cell', db.top_cell_name)\n"
    "found = collections.Counter(db.category_by_id(i.category_id()).path()"
    ".replace(' ', '_') for i in db.each_item())\n"
    "print(*('%s=%d' % c for c in sorted(found.items())))\n"
    "print('categories', sum(1 for c in db.each_category()))\n"
    "for i in db.each_item():\n"
    "  v = [x for x in i.each_value()]\n"
    "  b = v[0].box() if v[0].is_box() else None\n"
    "  print('box %g %g %g %g' % (b.left, b.bottom, b.right, b.top))\n"
    "v = lay.LayoutView()\n"
    "v.show_layout(l, False) if hasattr(v, 'show_layout') else None\n"
    "v.load_layer_props(folder + '/run.lyp')\n"
    "it = v.begin_layers()\n"
    "while not it.at_end():\n"
    "  p = it.current()\n"
    "  if not p.has_children():\n"
    "    print('look', p.name, p.source.split('@')[0].split(' ')[-1], '%06x' % "
    "(p.eff_frame_color(True) & 0xffffff))\n"
    "  it.next()\n"
    "print('end')\n";

static opc_module *module(const char *id, const char *map) {
  opc_error error = {0};
  opc_module *m = opc_test_module(id, map, &error);
  if (!m) g_error("%s: %s", id, error.message);
  return m;
}

/* Return a mask with moved edges and both printed images. */
static opc_module *mask_correct(eda_mask **mask) {
  opc_error error = {0};
  void *out[1];
  g_autofree char *map = g_strdup_printf(
      "{ litho: { use: litho.hopkins, kernels: 4 }, resist: { use: "
      "resist.threshold, anchor: { line: 65 nm, pitch: 250 nm } }, extractor: "
      "{ use: extractor.plain, devices: '%s/data/devices/ptm65.yaml' }, fine: "
      "off, margin: 1000 nm, synthesizer: { use: synthesizer.dpb }, "
      "max_iterations: 3 }",
      g_getenv("OPCFLOW_SOURCE"));
  opc_module *m = module("correct", map);
  opc_test_input(m, "gates", (void *)eda_gates_sample());
  if (opc_test_run(m, out, &error)) g_error("%s", error.message);
  *mask = out[0];
  return m;
}

static void write_files(eda_mask *mask, const char *map) {
  opc_error error = {0};
  opc_module *m = module("write.klayout", map);
  opc_test_input(m, "mask", mask);
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  opc_test_module_free(m);
}

static char *content(const char *name) {
  g_autofree char *path = g_build_filename(opc_test_folder(), name, NULL);
  char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  return text;
}

static char *program_spawn(const char *const *argv) {
  char *out = NULL, *err = NULL;
  int status = -1;
  g_auto(GStrv) environment =
      g_environ_setenv(g_get_environ(), "RUN", opc_test_folder(), TRUE);
  environment =
      g_environ_setenv(environment, "QT_QPA_PLATFORM", "offscreen", TRUE);
  gboolean ran =
      g_spawn_sync(NULL, (char **)argv, environment, G_SPAWN_SEARCH_PATH, NULL,
                   NULL, &out, &err, &status, NULL);
  /* Warnings of KLayout count as failures. */
  if (ran && status == 0 && g_str_has_suffix(out, "end\n") && !*err) {
    g_free(err);
    return out;
  }
  if (ran) g_test_message("%s: %s, %s", argv[0], out, err);
  g_free(out);
  g_free(err);
  return NULL;
}

/* Return the answer of KLayout's Python module, which starts faster, or of the
   program; NULL if both are missing. */
static char *ask_klayout(void) {
  g_autofree char *path = g_build_filename(opc_test_folder(), "ask.py", NULL);
  const char *const by_program[] = {"klayout", "-zz", "-r", path, NULL};
  const char *const by_module[] = {"python3", path, NULL};
  const char *const has_module[] = {"python3", "-c",
                                    "import klayout.lay; print('end')", NULL};
  g_assert_true(g_file_set_contents(path, script, -1, NULL));
  g_autofree char *program = g_find_program_in_path("klayout");
  g_autofree char *module_there = program_spawn(has_module);
  if (!program && !module_there) return NULL;
  char *out = program_spawn(module_there ? by_module : by_program);
  if (!out) g_error("KLayout does not read the files");
  return out;
}

/* ---- expected content ---- */

static double area_of(const eda_gates *g, const eda_shapes *s) {
  return (double)eda_area2(s) / 2 * g->grid * g->grid;
}

/* Return the area of a printed image, by contours on another grid than in the
   file. */
static double area_printed(const eda_field *print) {
  double *p, area = 0;
  uint32_t *start;
  size_t n;
  opc_error error;
  g_assert_false(
      eda_contours(NULL, print, print->frame, 4, &p, &start, &n, &error));
  for (size_t i = 0; i < n; i++)
    for (uint32_t k = start[i], end = start[i + 1]; k < end; k++) {
      uint32_t to = k + 1 < end ? k + 1 : start[i];
      area += (p[2 * k] * p[2 * to + 1] - p[2 * to] * p[2 * k + 1]) / 2;
    }
  free(p);
  free(start);
  return area;
}

static void expect_layer(const char *answer, const char *name, int number,
                         double area, double within) {
  g_autofree char *key = g_strdup_printf("layer %s %d 0 ", name, number);
  const char *line = strstr(answer, key);
  if (!line) g_error("no '%s' in:\n%s", key, answer);
  double there = g_ascii_strtod(line + strlen(key), NULL);
  g_test_message("%s: %g nm^2, expected %g", name, there, area);
  g_assert_cmpfloat(fabs(there / area - 1), <=, within);
}

static void assert_contains(const char *text, const char *part) {
  if (!strstr(text, part)) g_error("no '%s' in:\n%s", part, text);
}

static const eda_violation violations[] = {
    {"extension; the layout's 'edge' <is> in the way", 1, 30, -150, 12.5, 40},
    {"extension", -1, 100, 100, 20, 40},
    {"bridging: poly", 0, 10, 10, 3, 25}};

static void test_klayout(void) {
  eda_mask *mask;
  void *out[1];
  opc_module *m = mask_correct(&mask);
  const eda_gates *g = mask->gates;
  eda_mask_set_violations(mask, violations, G_N_ELEMENTS(violations));
  write_files(mask, "{ worst: 1 }");
  g_autofree char *answer = ask_klayout();
  if (answer) {
    assert_contains(answer, "top ");
    g_autofree char *cell = g_strdup_printf("cell %s\n", g->name);
    assert_contains(answer, cell);
    expect_layer(answer, "poly.mask", 9, area_of(g, &mask->shapes[0]), 1e-9);
    expect_layer(answer, "active.mask", 1, area_of(g, &mask->shapes[1]), 1e-9);
    expect_layer(answer, "poly.drawn", 109, area_of(g, &g->drawn[0]), 1e-9);
    expect_layer(answer, "active.drawn", 101, area_of(g, &g->drawn[1]), 1e-9);
    /* Chords of 10 nm cut corners. */
    expect_layer(answer, "poly.after", 309, area_printed(&mask->print[0]),
                 1.5e-3);
    expect_layer(answer, "active.after", 301, area_printed(&mask->print[1]),
                 1.5e-3);
    expect_layer(answer, "poly.before", 209,
                 area_printed(&mask->drawn_print[0]), 1.5e-3);
    expect_layer(answer, "active.before", 201,
                 area_printed(&mask->drawn_print[1]), 1.5e-3);
    assert_contains(
        answer,
        "\n'worst_Ioff'=1 'worst_Ion'=1 'worst_area'=1 violations.bridging=1 "
        "violations.extension=2\ncategories 5\n");
    assert_contains(answer, "\nbox 0.05 0.05 0.15 0.15\n"); /* um */
    assert_contains(answer, "look poly.mask 9/0 e07000\n");
    assert_contains(answer, "look active.after 301/0 00402e\n");
    g_assert_null(strstr(answer, "holes"));
  } else {
    g_test_skip("neither klayout nor its module for python3");
  }
  out[0] = mask;
  opc_test_release(m, out);
  opc_test_module_free(m);
}

/* Test that the markers of a transistor have the figures of gates.csv. */
static void test_markers(void) {
  eda_mask *mask;
  void *out[1];
  opc_module *m = mask_correct(&mask);
  write_files(mask, "{}");
  g_autofree char *text = content("run.lyrdb");
  for (size_t i = 0; i < mask->gates->count; i++) {
    g_autofree char *figure =
        g_strdup_printf("Ion %+.3f %% (as drawn %+.3f %%)",
                        100 * (mask->after.ion[i] / mask->design.ion[i] - 1),
                        100 * (mask->before.ion[i] / mask->design.ion[i] - 1));
    assert_contains(text, figure);
  }
  /* A transistor that does not print is marked as such, without figures. */
  mask->flags[0] |= EDA_PRINT_OPEN;
  write_files(mask, "{}");
  g_autofree char *now = content("run.lyrdb");
  assert_contains(now, "does not print&apos;</category>");
  g_autofree char *lost = g_strdup_printf(
      "Ion %+.3f %% (", 100 * (mask->after.ion[0] / mask->design.ion[0] - 1));
  g_assert_null(strstr(now, lost));
  out[0] = mask;
  opc_test_release(m, out);
  opc_test_module_free(m);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/klayout/files", test_klayout);
  g_test_add_func("/klayout/markers", test_markers);
  return g_test_run();
}
