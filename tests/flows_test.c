/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs shipped flows by the command. Figures must be reached, and results must
   not depend on the number of threads and the orientation of a cell. */
#include <eda/runs.h>
#include <math.h>
#include <string.h>

#include "tests/flow.h"
#include "tests/run_folder.h"

/* PV band of a clip of ICCAD 2013 by score.iccad, which does not use the SRAF
   model. Model-based SRAF must reduce the band by at least 15 %, and no SRAF
   may print. */
static void test_assists_of_the_model(void) {
  g_autofree char *clips = find_data("clips");
  if (!clips) return;
  g_autofree char *flow = source_path("flows/iccad.yaml");
  g_autofree char *clip =
      g_strdup_printf("layout.file=%s/iccad2013/M1_test10.glp", clips);
  static const char *const names[] = {"without", "with"};
  g_auto(GStrv) set = g_new0(char *, 4 + 1);
  for (int k = 0; k < 4; k++)
    set[k] = g_strdup_printf(
        "%s.litho.%s=%s/kernels/%s/scales.txt", k < 2 ? "mask" : "score",
        k % 2 ? "defocus" : "focus", clips, k % 2 ? "defocus" : "focus");
  for (int k = 0; k < 2; k++) {
    g_autofree char *out = place(names[k]);
    opcflow(NULL, "run", flow, "--set", clip, "--set", set[0], "--set", set[1],
            "--set", set[2], "--set", set[3], "--set",
            k ? "mask.search.most=60" : "mask.search.most=0", "--output", out,
            NULL);
    g_assert_cmpfloat(metric(names[k], "score", "extra"), ==, 0);
    g_assert_cmpfloat(metric(names[k], "score", "epe"), <=, 1);
  }
  double without = metric("without", "score", "pvb");
  g_assert_cmpfloat(metric("with", "mask", "assists"), >, 5);
  g_assert_cmpfloat(metric("with", "score", "pvb"), <, 0.85 * without);
}

static void test_demo(void) {
  g_autofree char *flow = source_path("flows/demo.yaml"), *out = place("demo");
  g_autofree char *errors = NULL;
  g_assert_cmpint(opcflow(&errors, "run", flow, "--output", out, NULL), ==, 0);
  /* Only one line for each long step is printed. */
  g_auto(GStrv) lines = g_strsplit(errors, "\n", -1);
  g_assert_cmpuint(g_strv_length(lines), <=, 4 + 1);
  for (int i = 0; lines[i] && *lines[i]; i++)
    g_assert_true(g_str_has_prefix(lines[i], "["));
  g_assert_cmpfloat(metric("demo", "mask", "transistors"), ==, 4);
  g_assert_cmpfloat(metric("demo", "mask", "ion_max_drawn"), >, 5);
  g_assert_cmpfloat(metric("demo", "mask", "ion_max"), <=, 0.5);
  g_assert_cmpfloat(metric("demo", "mask", "failed"), ==, 0);
  g_assert_cmpfloat(metric("demo", "mask", "violations"), ==, 0);
  const char *files[] = {"mask.gds",  "gates.csv", "metrics.json",
                         "flow.yaml", "mask.png",  "manifest.json"};
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    g_autoptr(GBytes) content = bytes("demo", files[i]);
    g_assert_cmpuint(g_bytes_get_size(content), >, 0);
  }
}

/* The resolved flow of a run reproduces the masks and figures. */
static void test_resolved(void) {
  g_autofree char *flow = place("demo/flow.yaml"), *out = place("again");
  g_assert_cmpint(opcflow(NULL, "run", flow, "--output", out, NULL), ==, 0);
  expect_equal("demo", "again", "gates.csv");
  expect_equal("demo", "again", "mask.gds");
}

/* A less accurate model, which executes the same code in less time. */
#define LIGHT "--set", "mask.fine=1e-3", "--set", "mask.margin=1 um"

/* Settings on an emulated processor: no further kernels, no picture. */
#define SHORT \
  "--set", "mask.fine=3e-3", "--set", "mask.margin=1 um", "--set", "picture=~"

/* Byte-identical results for any number of threads. */
static void test_threads(void) {
  g_autofree char *flow = source_path("flows/demo.yaml");
  for (int threads = 1; threads <= 4; threads++) {
    g_autofree char *name = g_strdup_printf("threads%d", threads);
    g_autofree char *number = g_strdup_printf("%d", threads),
                    *out = place(name);
    g_assert_cmpint(opcflow(NULL, "run", flow, LIGHT, "--threads", number,
                            "--output", out, NULL),
                    ==, 0);
    expect_equal("threads1", name, "gates.csv");
    expect_equal("threads1", name, "mask.gds");
  }
}

/* A NAND2 with horizontal gates equals the rotated cell: deviations of the
   uncorrected transistors are equal. */
static void test_orientation(void) {
  g_autofree char *flow = source_path("flows/demo.yaml"),
                  *out = place("turned");
  g_autofree char *file = source_path("data/cells65/nand2h.cif");
  g_autofree char *set = g_strdup_printf("layout.file=%s", file);
  g_assert_cmpint(
      opcflow(NULL, "run", flow, "--set", set, "--output", out, NULL), ==, 0);
  const char *figures[] = {"ion_mean_drawn", "ion_max_drawn"};
  for (size_t i = 0; i < G_N_ELEMENTS(figures); i++)
    g_assert_cmpfloat(fabs(metric("turned", "mask", figures[i]) -
                           metric("demo", "mask", figures[i])),
                      <, 0.02);
  g_assert_cmpfloat(metric("turned", "mask", "ion_max"), <=, 0.5);
}

/* Check the page of a mask by classes: its pictures have all transistors, and
   its table has a row for each class. */
static void expect_page(const char *file, double transistors, double classes) {
  g_autofree char *path = place(file);
  JsonNode *root;
  g_autofree char *page = read_page(path, &root);
  JsonArray *runs =
      json_object_get_array_member(json_node_get_object(root), "runs");
  JsonObject *run = json_array_get_object_element(runs, 0);
  JsonObject *view = json_object_get_object_member(run, "view");
  JsonObject *tables = json_object_get_object_member(run, "tables");
  JsonObject *gates = json_object_get_object_member(tables, "gates");
  JsonArray *columns = json_object_get_array_member(gates, "columns");
  double sum = 0;
  for (guint k = 0; k < json_array_get_length(columns); k++) {
    JsonObject *c = json_array_get_object_element(columns, k);
    if (strcmp(json_object_get_string_member(c, "name"), "count") != 0)
      continue;
    JsonArray *values = json_object_get_array_member(c, "values");
    for (guint i = 0; i < json_array_get_length(values); i++)
      sum += json_array_get_double_element(values, i);
  }
  g_assert_cmpfloat(sum, ==, transistors);
  g_assert_cmpfloat(json_object_get_double_member(gates, "rows"), ==, classes);
  g_assert_cmpfloat(json_object_get_double_member(view, "transistors"), ==,
                    transistors);
  g_assert_true(json_object_has_member(view, "classes"));
  json_node_unref(root);
}

/* A mask by classes (transistors with equal environments share a mask) is
   written with the layer numbers of a flat mask. If the file is read by these
   numbers and simulated flat, the figures equal those of the classes. */
static void test_chip_numbers(void) {
  static const char *const equal[] = {"transistors", "failed", "outside"};
  g_autofree char *chip = source_path("flows/chip.yaml"),
                  *devices = source_path("data/devices/ptm65.yaml");
  g_autofree char *good = g_strdup_printf(
      "opcflow: 1\nname: numbers\nextends: %s\nsteps:\n"
      "  file: { use: write.oasis, mask: '${mask}', file: chip.oas }\n"
      "  page: { use: report.html, mask: '${mask}', file: page.html }\n",
      chip);
  g_autofree char *back = g_strdup_printf(
      "opcflow: 1\nname: back\nextends: %s\nrequire: ~\nsteps:\n"
      "  gates: { use: segment.transistors, layout: '${layout}', grid: 1 nm }\n"
      "  file: { use: read.oasis, file: numbers/chip.oas, layers: { poly: 9/0, "
      "active: 1/0 } }\n"
      "  mask: ~\n"
      "  again: { use: given, gates: '${gates}', mask_layout: '${file}', "
      "layers: "
      "{ poly: poly, active: active }, litho: { use: litho.hopkins, "
      "wavelength: "
      "193 nm, na: 0.75, sigma: 0.75 }, resist: { use: resist.threshold, "
      "anchor: { line: 65 nm, pitch: 250 nm } }, extractor: { use: "
      "extractor.plain, devices: %s }, fine: off, margin: 4 um }\n",
      chip, devices);
  write_file("numbers.yaml", good);
  g_assert_cmpint(opcflow(NULL, "check", "numbers.yaml", NULL), ==, 0);
  g_assert_cmpint(opcflow(NULL, "run", "numbers.yaml", "--set", "mask.fine=off",
                          "--set", "require=~", "--output", "numbers", NULL),
                  ==, 0);
  write_file("back.yaml", back);
  g_assert_cmpint(opcflow(NULL, "run", "back.yaml", "--output", "back", NULL),
                  ==, 0);
  for (size_t i = 0; i < G_N_ELEMENTS(equal); i++)
    g_assert_cmpfloat(metric("back", "again", equal[i]), ==,
                      metric("numbers", "mask", equal[i]));
  g_assert_cmpfloat(fabs(metric("back", "again", "ion_mean") -
                         metric("numbers", "mask", "ion_mean")),
                    <, 0.1);
  g_assert_cmpfloat(fabs(metric("back", "again", "ion_max") -
                         metric("numbers", "mask", "ion_max")),
                    <, 0.3);
  expect_page("numbers/page.html", metric("back", "again", "transistors"),
              metric("numbers", "mask", "prints"));
}

/* `check` reports wrong layers in the steps that write a mask, before the
   correction runs. */
static void test_mask_layers(void) {
  g_autofree char *demo = source_path("flows/demo.yaml");
  g_autofree char *errors = NULL, *more = NULL;
  g_autofree char *flow = g_strdup_printf(
      "opcflow: 1\nname: layers\nextends: %s\nsteps:\n"
      "  good: { use: write.gds, mask: '${mask}', layers: { poly: 7/0 }, file: "
      "a.gds }\n"
      "  bad: { use: write.oasis, mask: '${mask}', layers: { layout: 1/0 }, "
      "file: b.oas }\n",
      demo);
  write_file("layers.yaml", flow);
  g_assert_cmpint(opcflow(&errors, "check", "layers.yaml", NULL), ==, 2);
  g_assert_cmpstr(errors, ==,
                  "layers.yaml:6:53: step 'bad' (write.oasis): 'layout': a "
                  "mask has the layers poly, active, contact, poly_drawn and "
                  "active_drawn\n");
  g_assert_cmpint(
      opcflow(&more, "check", "layers.yaml", "--set", "bad=~", NULL), ==, 0);
}

/* NAND2_X1 of the NanGate library, scaled to L = 65 nm. */
static void test_nangate(void) {
  g_autofree char *file = find_data("nangate45/NangateOpenCellLibrary.gds");
  if (!file) return;
  g_autofree char *flow = source_path("flows/dpb.yaml"),
                  *out = place("nangate");
  g_autofree char *set = g_strdup_printf("layout.file=%s", file);
  g_assert_cmpint(
      opcflow(NULL, "run", flow, "--set", set, "--set", "layout.scale=1.3",
              "--set", "layout.top=NAND2_X1", "--output", out, NULL),
      ==, 0);
  g_assert_cmpfloat(metric("nangate", "mask", "transistors"), ==, 4);
  g_assert_cmpfloat(metric("nangate", "mask", "ion_max"), <=, 0.5);
}

/* A flip-flop with little space at line ends. Gates are widened where the poly
   continues, but not where a thin line end would reach the channel. If both
   sides had the same displacement of W, the worst gate would leak three times
   its drawn Ioff. */
static void test_flip_flop(void) {
  g_autofree char *file = find_data("nangate45/NangateOpenCellLibrary.gds");
  if (!file) return;
  g_autofree char *flow = source_path("flows/newton.yaml"),
                  *out = place("flipflop");
  g_autofree char *set = g_strdup_printf("layout.file=%s", file);
  g_assert_cmpint(
      opcflow(NULL, "run", flow, "--set", set, "--set", "layout.scale=1.3",
              "--set", "layout.top=DFF_X1", "--output", out, NULL),
      ==, 0);
  g_assert_cmpfloat(metric("flipflop", "mask", "ion_max"), <=, 0.5);
  g_assert_cmpfloat(metric("flipflop", "mask", "ioff_max"), <=, 30);
}

/* Verifies a mask by the models of the correction, and by other models. */
static void test_verify(void) {
  g_autofree char *flow = place("verify.yaml"), *out = place("verify");
  g_autofree char *demo = source_path("flows/demo.yaml");
  g_autofree char *devices = source_path("data/devices/ptm65.yaml");
  g_autofree char *text = g_strdup_printf(
      "opcflow: 1\nname: verify\nextends: %s\nsteps:\n"
      "  same:\n    use: verify\n    mask: ${mask}\n"
      "    litho: { use: litho.hopkins, wavelength: 193 nm, na: 0.75, sigma: "
      "0.75 }\n"
      "    resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 "
      "nm } }\n"
      "    extractor: { use: extractor.plain, devices: %s }\n"
      "  other:\n    use: verify\n    mask: ${same}\n"
      "    litho: { use: litho.abbe, wavelength: 193 nm, na: 0.75, sigma: 0.75 "
      "}\n"
      "    resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 "
      "nm } }\n"
      "    extractor: { use: extractor.plain, devices: %s }\n",
      demo, devices, devices);
  g_assert_true(g_file_set_contents(flow, text, -1, NULL));
  g_assert_cmpint(opcflow(NULL, "run", flow, "--output", out, NULL), ==, 0);
  const char *figures[] = {"ion_mean", "ion_max",   "ion_stdv", "area_mean",
                           "area_max", "ioff_mean", "failed"};
  for (size_t i = 0; i < G_N_ELEMENTS(figures); i++) /* bit-identical */
    g_assert_true(metric("verify", "same", figures[i]) ==
                  metric("verify", "mask", figures[i]));
  g_assert_true(metric("verify", "same", "ion_change_max") == 0);
  g_assert_cmpfloat(metric("verify", "other", "ion_change_mean"), >, 0);
  g_assert_cmpfloat(metric("verify", "other", "ion_change_max"), <, 4);
  g_assert_cmpfloat(metric("verify", "other", "failed"), ==, 0);
}

/* ---- the other shipped flows ---- */

/* Run flows/NAME.yaml into a folder of that name, with up to two settings. */
static void run_ready(const char *name, const char *set, const char *more) {
  g_autofree char *file = g_strdup_printf("flows/%s.yaml", name);
  g_autofree char *flow = source_path(file), *out = place(name);
  g_assert_cmpint(
      opcflow(NULL, "run", flow, "--output", out, set ? "--set" : NULL, set,
              more ? "--set" : NULL, more, NULL),
      ==, 0);
}

static void expect_file(const char *run, const char *file, gsize least) {
  g_autoptr(GBytes) content = bytes(run, file);
  g_assert_cmpuint(g_bytes_get_size(content), >, least);
}

static void test_circuit(void) {
  if (!plugin_available("circuit.ngspice")) return;
  run_ready("circuit", NULL, NULL);
  g_assert_cmpfloat(metric("circuit", "circuit", "transitions"), ==, 4);
  g_assert_cmpfloat(metric("circuit", "circuit", "unmeasured"), ==, 0);
  g_assert_cmpfloat(metric("circuit", "circuit", "tp_worst_before"), >, 10);
  /* Ion is within 0.5 %. The gate areas, which determine the gate charge, are
     larger by 1.6 and 2.8 %. */
  g_assert_cmpfloat(metric("circuit", "circuit", "tp_worst"), <, 2);
  expect_file("circuit", "circuit.png", 1000);
  expect_file("circuit", "delays.csv", 100);
}

/* Margins of the memory cell: with matched Ion, with additionally matched
   areas, and with corrected L only, as simulated in the thesis. */
static void test_margins(void) {
  if (!plugin_available("circuit.ngspice")) return;
  g_autofree char *flow = source_path("flows/circuit.yaml"),
                  *out = place("margins");
  g_assert_cmpint(
      opcflow(NULL, "run", flow, "--variant", "sram", "--variant", "sram_area",
              "--variant", "sram_length", "--output", out, NULL),
      ==, 0);
  const char *sides[] = {"snm_left_worst", "snm_right_worst"};
  for (int k = 0; k < 2; k++) {
    g_assert_cmpfloat(metric("margins/sram", "circuit", sides[k]), >, 3);
    g_assert_cmpfloat(metric("margins/sram_area", "circuit", sides[k]), <, 1);
    g_assert_cmpfloat(metric("margins/sram_length", "circuit", sides[k]), <, 1);
  }
  g_assert_cmpfloat(metric("margins/sram", "circuit", "cells"), ==, 32);
}

/* One correction of three layers: transistors and metal are within their
   limits, and one file has all layers. */
static void test_metal(void) {
  run_ready("metal", NULL, NULL);
  g_assert_cmpfloat(metric("metal", "mask", "ion_max"), <, 0.1);
  g_assert_cmpfloat(metric("metal", "mask", "epe_mean"), <, 2);
  g_assert_cmpfloat(metric("metal", "mask", "violations"), ==, 0);
  g_autoptr(GBytes) cost = bytes("metal", "cost.csv");
  g_assert_nonnull(strstr(g_bytes_get_data(cost, NULL), "metal1,"));
}

/* Start the demo under processor emulation. Return 0 if no emulator is
   available, or under a sanitizer. Emulated kernels take a minute, so that the
   processors are emulated concurrently. */
static GPid start_emulated(const char *processor, const char *run) {
  g_autofree char *qemu = g_find_program_in_path("qemu-x86_64");
  g_autofree char *out = place(run), *flow = source_path("flows/demo.yaml");
  g_autofree char *command =
      g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL);
  const char *argv[] = {qemu,  "-cpu",      processor, command,    "run", flow,
                        SHORT, "--threads", "1",       "--output", out,   NULL};
#if defined(__SANITIZE_ADDRESS__) || !defined(__x86_64__)
  return 0;
#endif
  if (!qemu) return 0;
  GPid pid = 0;
  g_autoptr(GError) error = NULL;
  g_spawn_async(NULL, (char **)argv, NULL,
                G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_STDOUT_TO_DEV_NULL |
                    G_SPAWN_STDERR_TO_DEV_NULL,
                NULL, NULL, &pid, &error);
  g_assert_no_error(error);
  return pid;
}

static void expect_success(GPid pid) {
  int status;
  g_assert_cmpint(waitpid(pid, &status, 0), ==, pid);
  g_assert_cmpint(status, ==, 0);
}

/* Results with AVX-512 (if available) are bit-identical to those with AVX2 and
   FMA. Without FMA, FFTW and the C library use other algorithms: currents and
   areas differ by less than 1e-5 (the figures are deviations in %), and the
   mask is equal. */
static void test_processors(void) {
  GPid haswell = start_emulated("Haswell", "haswell");
  if (!haswell) {
    g_test_skip("no qemu-x86_64, or a build that it cannot run");
    return;
  }
  GPid nehalem = start_emulated("Nehalem", "nehalem");
  g_autofree char *flow = source_path("flows/demo.yaml"),
                  *out = place("native");
  g_assert_cmpint(opcflow(NULL, "run", flow, SHORT, "--output", out, NULL), ==,
                  0);
  expect_success(haswell);
  expect_success(nehalem);
  const char *files[] = {"gates.csv", "history.csv", "metrics.json",
                         "mask.gds"};
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++)
    expect_equal("native", "haswell", files[i]);
  expect_equal("native", "nehalem", "mask.gds");
  const char *figures[] = {"ion_mean", "ion_max", "area_mean", "ioff_mean"};
  for (size_t i = 0; i < G_N_ELEMENTS(figures); i++) {
    g_assert_cmpfloat_with_epsilon(metric("nehalem", "mask", figures[i]),
                                   metric("native", "mask", figures[i]), 1e-3);
  }
}

static void test_netlist(void) {
  run_ready("netlist", NULL, NULL);
  g_assert_cmpfloat(metric("netlist", "netlist", "transistors"), ==, 4);
  g_autoptr(GBytes) text = bytes("netlist", "nand2.sp");
  g_assert_nonnull(
      strstr(g_bytes_get_data(text, NULL),
             ".subckt nand2 A B Y VDD VSS\nMN1 VSS A X VSS nmos w="));
}

/* Errors of three extractors against transistors of several widths, to which
   the table of weights in data/devices was fitted. */
static void test_gamma(void) {
  run_ready("gamma", NULL, NULL);
  g_assert_cmpfloat(metric("gamma", "plain", "ion_max"), >, 15);
  g_assert_cmpfloat(metric("gamma", "gamma", "ion_max"), <, 2);
  g_assert_cmpfloat(metric("gamma", "widths", "ion_max"), <, 0.01);
  g_autoptr(GBytes) printed = bytes("gamma", "gamma.printed.csv");
  g_assert_nonnull(strstr(g_bytes_get_data(printed, NULL), "half_bitcell"));
  g_autofree char *made = place("gamma/fit.csv"),
                  *kept = source_path("data/devices/ptm65-gamma.csv");
  g_autofree char *one = NULL, *other = NULL;
  g_assert_true(g_file_get_contents(made, &one, NULL, NULL));
  g_assert_true(g_file_get_contents(kept, &other, NULL, NULL));
  g_assert_cmpstr(one, ==, other);
}

static void test_models(void) {
  g_autofree char *flow = source_path("flows/models.yaml"),
                  *out = place("models");
  g_assert_cmpint(opcflow(NULL, "run", flow, "--output", out, "--set",
                          "picture.second.litho.error=1e-2", NULL),
                  ==, 0);
  g_assert_cmpfloat(metric("models", "picture", "max"), >, 0);
  g_assert_cmpfloat(metric("models", "picture", "max"), <, 5);
  expect_file("models", "image.png", 1000);
}

static void test_window(void) {
  run_ready("window", "window.dose=[-4 %, 0 %, 4 %]",
            "window.defocus=[-80 nm, 0 nm, 80 nm]");
  g_assert_cmpfloat(metric("window", "window", "exposure_latitude"), >, 3);
  g_assert_cmpfloat(metric("window", "window", "failed_max"), ==, 0);
  expect_file("window", "process_window.csv", 100);
}

/* A table of two widths is computed; the flow of the full table reuses the
   results. */
static void test_characterize(void) {
  run_ready("characterize", "table.lengths=[65 nm]",
            "table.widths=[300 nm, 450 nm]");
  g_autofree char *table = place("characterize/init_adjust.csv");
  g_autofree char *set =
      g_strdup_printf("mask.synthesizer.init_adjust_table=%s", table);
  g_autofree char *flow = source_path("flows/demo.yaml"),
                  *out = place("adjusted");
  g_assert_cmpint(
      opcflow(NULL, "run", flow, LIGHT, "--set", set, "--output", out, NULL),
      ==, 0);
  g_assert_cmpfloat(metric("adjusted", "mask", "ion_max"), <=, 0.5);
}

/* A flow that simulates by a card corrects with the table of this card. */
static void expect_one_card(const char *run) {
  g_autofree char *out = place(run), *text = NULL;
  g_autofree char *path = g_build_filename(out, "flow.yaml", NULL);
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  g_assert_nonnull(strstr(text, "opcflow65.pm"));
  g_assert_nonnull(strstr(text, "opcflow65.yaml"));
  g_assert_null(strstr(text, "ptm65.yaml"));
}

/* Path delays of a NAND2 for one switching input and for both inputs. Delays
   from separately simulated cells agree with ngspice on the whole circuit, as
   drawn and as printed. For two inputs, tables of a single input would be wrong
   by 23 and 80 %. */
static void test_timing(void) {
  if (!plugin_available("timing.characterize")) return;
  g_autofree char *flow = source_path("flows/timing.yaml"),
                  *cards = source_path("data/devices/opcflow65.pm");
  g_autofree char *set = g_strdup_printf("paths.models=%s", cards);
  const char *threads[] = {"1", "3"}, *runs[] = {"timing1", "timing3"};
  for (int i = 0; i < 2; i++) {
    g_autofree char *out = place(runs[i]);
    g_assert_cmpint(
        opcflow(NULL, "run", flow, "--output", out, "--threads", threads[i],
                "--no-cache", "--set", set, "--set", "paths.spice=12", NULL),
        ==, 0);
  }
  const char *files[] = {"cells.lib", "circuit.printed.sdf", "paths.csv",
                         "static_path.csv"};
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++)
    expect_equal(runs[0], runs[1], files[i]);
  expect_one_card(runs[0]);
  g_assert_cmpfloat(metric(runs[0], "paths", "spice_delays"), ==, 6);
  g_assert_cmpfloat(metric(runs[0], "paths", "spice_error_max"), <, 0.5);
  g_assert_cmpfloat(metric(runs[0], "paths", "spice_deviation_max"), <, 0.4);
  g_assert_cmpfloat(metric(runs[0], "paths", "lowest"), >, 0.5);
}

/* Delays of a mask by classes, whose NAND2 has four transistors of two classes,
   are those of the table of all transistors in its file (three decimals). */
static void test_timing_classes(void) {
  if (!plugin_available("timing.characterize")) return;
  g_autofree char *base = source_path("flows/timing.yaml"),
                  *flow = place("classes.yaml"), *out = place("classes"),
                  *again = place("table"), *path = place("table/paths.csv");
  g_autofree char *text = g_strdup_printf(
      "opcflow: 1\nextends: %s\nsteps:\n  gates: ~\n"
      "  mask: { gates: ~, layout: '${layout}', divide: environments, "
      "transistors: all.csv }\n"
      "  circuit: { gates: ~, mask: '${mask}' }\n",
      base);
  write_file("classes.yaml", text);
  g_assert_cmpint(opcflow(NULL, "run", flow, "--output", out, NULL), ==, 0);
  g_autofree char *set =
      g_strdup_printf("paths.prints={ all: %s/all.csv }", out);
  g_assert_cmpint(
      opcflow(NULL, "run", flow, "--output", again, "--set", set, NULL), ==, 0);
  opc_error error;
  eda_table *t = eda_table_read(path, &error);
  if (!t) g_error("%s", error.message);
  const double *mean = eda_table_numbers(t, (size_t)eda_table_find(t, "mean"));
  const double *most =
      eda_table_numbers(t, (size_t)eda_table_find(t, "highest"));
  g_assert_cmpfloat(mean[1], >, 0.5);
  g_assert_cmpfloat_with_epsilon(mean[2], mean[1], 3e-3);
  g_assert_cmpfloat_with_epsilon(most[2], most[1], 3e-3);
  eda_table_free(t);
}

/* A NAND2 with some transistors lengthened. The simulated delays agree with
   static timing, and no path exceeds the limit. ngspice and the device table
   agree with the predicted reduction of leakage. */
static void test_slack(void) {
  if (!plugin_available("timing.characterize")) return;
  g_autofree char *flow = source_path("flows/slack.yaml");
  g_autofree char *out = place("slack");
  g_assert_cmpint(
      opcflow(NULL, "run", flow, "--variant", "balanced", "--variant",
              "without-balanced", "--output", out, NULL),
      ==, 0);
  const char *with = "slack/balanced", *without = "slack/without-balanced";
  double foreseen = metric(with, "slack", "leakage_change"),
         printed =
             100 * ((1 + metric(with, "rest", "leakage_mean") / 100) /
                        (1 + metric(without, "rest", "leakage_mean") / 100) -
                    1);
  expect_one_card(with);
  g_assert_cmpfloat(foreseen, <, -25);
  g_assert_cmpfloat(fabs(printed - foreseen), <, 2);
  g_assert_cmpfloat_with_epsilon(metric(with, "slack", "leakage_drawn"),
                                 1e9 * metric(with, "rest", "leakage"), 1.5);
  g_assert_cmpfloat(metric(without, "slack", "leakage_change"), ==, 0);
  g_assert_cmpfloat(metric(with, "slack", "latest"), <=,
                    metric(with, "slack", "drawn"));
  g_assert_cmpfloat(metric(with, "paths", "static_deviation"), <,
                    metric(without, "paths", "static_deviation") + 0.3);
}

/* The table of methods: the method with the smaller Ion deviation, at equal
   area, has the smaller delay deviation. */
static void test_timing_compare(void) {
  if (!plugin_available("timing.characterize")) return;
  g_autofree char *flow = source_path("flows/timing-compare.yaml"),
                  *out = place("timings");
  g_assert_cmpint(opcflow(NULL, "run", flow, "--output", out, "--set",
                          "compare.methods=[plain, dpb]", NULL),
                  ==, 0);
  g_assert_cmpfloat(metric("timings", "paths", "mean"), <, 0.1);
  g_autofree char *path = g_build_filename(out, "paths.csv", NULL);
  opc_error error;
  eda_table *t = eda_table_read(path, &error);
  if (!t) g_error("%s", error.message);
  g_assert_cmpuint(eda_table_rows(t), ==, 3);
  g_assert_cmpstr(eda_table_text(t, 2, 0), ==, "dpb");
  const double *mean = eda_table_numbers(t, (size_t)eda_table_find(t, "mean"));
  g_assert_cmpfloat(mean[2], >, 10 * mean[1]);
  eda_table_free(t);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  begin_flows();
  g_test_add_func("/flows/demo", test_demo);
  g_test_add_func("/flows/chip-numbers", test_chip_numbers);
  g_test_add_func("/flows/mask-layers", test_mask_layers);
  g_test_add_func("/flows/resolved", test_resolved);
  g_test_add_func("/flows/threads", test_threads);
  g_test_add_func("/flows/processors", test_processors);
  g_test_add_func("/flows/metal", test_metal);
  g_test_add_func("/flows/orientation", test_orientation);
  g_test_add_func("/flows/nangate", test_nangate);
  g_test_add_func("/flows/flip-flop", test_flip_flop);
  g_test_add_func("/flows/verify", test_verify);
  g_test_add_func("/flows/circuit", test_circuit);
  g_test_add_func("/flows/margins", test_margins);
  g_test_add_func("/flows/netlist", test_netlist);
  g_test_add_func("/flows/gamma", test_gamma);
  g_test_add_func("/flows/models", test_models);
  g_test_add_func("/flows/window", test_window);
  g_test_add_func("/flows/characterize", test_characterize);
  g_test_add_func("/flows/timing", test_timing);
  g_test_add_func("/flows/timing-classes", test_timing_classes);
  g_test_add_func("/flows/timing_compare", test_timing_compare);
  g_test_add_func("/flows/slack", test_slack);
  g_test_add_func("/flows/assists-of-the-model", test_assists_of_the_model);
  return run_flows();
}
