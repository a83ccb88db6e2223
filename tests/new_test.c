/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests `opcflow new`: each new plugin compiles without warnings, passes its
   test, loads, and runs in its flow. One plugin is built by its project
   files. */
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include <store/files.h>

static char *folder, *command;
static char *out, *err;

/* Run a program; return its exit code. */
static int program_call(const char *const *argv) {
  int status;
  g_autoptr(GError) error = NULL;
  g_clear_pointer(&out, g_free);
  g_clear_pointer(&err, g_free);
  g_spawn_sync(folder, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL,
               &out, &err, &status, &error);
  g_assert_no_error(error);
  g_assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

#define CALL(...) program_call((const char *const[]){__VA_ARGS__, NULL})

/* Compiler flags of this build. */
#ifdef __SANITIZE_ADDRESS__
#define SANITIZE "-fsanitize=address,undefined"
#define MESON_SANITIZE "-Db_sanitize=address,undefined"
#else
#define SANITIZE "-g"
#define MESON_SANITIZE "-Db_sanitize=none"
#endif

/* Compile a file of a plugin's folder against this uninstalled build; if
   `testing` is TRUE, as a test program. */
static void file_compile(const char *source, const char *object,
                         gboolean testing) {
  const char *build = g_getenv("OPCFLOW_BUILD");
  g_autofree char *script = g_strdup_printf(
      "cc -std=c99 -Wall -Wextra -Wshadow -Wmissing-prototypes "
      "-Werror " SANITIZE
      " %s %s -o %s $(PKG_CONFIG_PATH=%s/meson-uninstalled pkg-config "
      "--cflags --libs opcflow eda %s) -lm",
      testing ? "" : "-fPIC -shared -fvisibility=hidden", source, object, build,
      testing ? "opcflow-testing" : "");
  if (CALL("sh", "-c", script)) g_error("%s", err);
}

/* Run the test of the plugin. The test loads the plugin and the plugins of this
   build. */
static void run_test(const char *kind, const char *name) {
  g_autofree char *source = g_strdup_printf("%s/%s_test.c", kind, name);
  g_autofree char *program = g_strdup_printf("%s/%s_test", kind, name);
  g_autofree char *path =
      g_strdup_printf("OPCFLOW_PLUGIN_PATH=%s/%s:%s/plugins", folder, kind,
                      g_getenv("OPCFLOW_BUILD"));
  g_autofree char *whole = g_build_filename(folder, program, NULL);
  file_compile(source, program, TRUE);
  if (CALL("env", path, whole)) g_error("%s%s", out, err);
}

/* Run the flow of the plugin. The manifest of the run must list the plugin. */
static void run_flow(const char *kind, const char *object) {
  g_autofree char *flow = g_strdup_printf("%s/flow.yaml", kind);
  g_autofree char *output = g_strdup_printf("%s/run", kind);
  if (CALL(command, "run", flow, "--plugin-path", kind, "--output", output,
           "--json"))
    g_error("%s", err);
  g_autoptr(JsonNode) json = json_from_string(out, NULL);
  g_assert_nonnull(json);
  g_autofree char *manifest =
      g_build_filename(folder, output, "manifest.json", NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(manifest, &text, NULL, NULL));
  g_assert_nonnull(strstr(text, object));
}

static void test_plugin(gconstpointer data) {
  const char *kind = data;
  g_autofree char *id = g_strdup_printf("%s.mine_%s", kind, kind);
  g_autofree char *name = g_strdup_printf("mine_%s", kind);
  g_autofree char *source = g_strdup_printf("%s/%s.c", kind, name);
  g_autofree char *object = g_strdup_printf("%s/%s.so", kind, id);
  g_assert_cmpint(CALL(command, "new", "plugin", "--kind", kind, name, kind),
                  ==, 0);
  g_assert_nonnull(strstr(out, source));
  file_compile(source, object, FALSE);
  g_assert_cmpint(CALL(command, "inspect", id, "--plugin-path", kind), ==, 0);
  run_test(kind, name);
  if (!strcmp(kind, "command"))
    g_assert_cmpint(
        CALL(command, "mine_command", source, "--plugin-path", kind), ==, 0);
  else
    run_flow(kind, object);
  g_autofree char *build = g_build_filename(folder, kind, "meson.build", NULL);
  g_autofree char *recipe = NULL;
  g_assert_true(g_file_get_contents(build, &recipe, NULL, NULL));
  g_assert_null(strchr(recipe, '@'));
  g_assert_nonnull(strstr(recipe, id));
}

/* A synthesizer and its test have at most 80 lines. */
static void test_lines(void) {
  if (CALL("sh", "-c", "cat synthesizer/*.c | wc -l")) g_error("%s", err);
  g_assert_cmpint(atoi(out), <=, 80);
}

/* Return whether the new synthesizer passes its test with `work` as its
   function. The layout of the acceptance test has four transistors. */
static gboolean passes_with(const char *work) {
  g_autofree char *script = g_strdup_printf(
      "rm -rf poor && cp -r synthesizer poor && sed -i 's/[*]done = 1;/*done = "
      "1; if (f->gates->count == 4) { %s; return OPC_OK; }/' "
      "poor/mine_synthesizer.c",
      work);
  if (CALL("sh", "-c", script)) g_error("%s", err);
  file_compile("poor/mine_synthesizer.c",
               "poor/synthesizer.mine_synthesizer.so", FALSE);
  file_compile("poor/mine_synthesizer_test.c", "poor/test", TRUE);
  g_autofree char *path =
      g_strdup_printf("OPCFLOW_PLUGIN_PATH=%s/poor:%s/plugins", folder,
                      g_getenv("OPCFLOW_BUILD"));
  g_autofree char *program = g_build_filename(folder, "poor", "test", NULL);
  return !CALL("env", path, program);
}

/* The acceptance test rejects a method without effect, a method that makes
   transistors worse than drawn, and a method without end. */
static void test_acceptance(void) {
  g_assert_true(
      passes_with("moves->l[0] = moves->l[1] = moves->l[2] = "
                  "moves->l[3] = -2; *done = f->iteration > 0"));
  g_assert_false(passes_with("*done = 1"));
  g_assert_nonnull(strstr(out, "as drawn"));
  g_assert_false(
      passes_with("moves->l[0] = moves->l[1] = moves->l[2] = "
                  "moves->l[3] = 6; *done = f->iteration > 0"));
  g_assert_nonnull(strstr(out, "4 of 4 transistors are worse than drawn"));
  g_assert_false(passes_with("moves->l[0] = f->iteration % 2; *done = 0"));
  g_assert_nonnull(strstr(out, "not converged after 80 iterations"));
}

/* A new kind builds, tests its first plugin, and creates further plugins. */
static void test_kind(void) {
  g_autofree char *path =
      g_strdup_printf("%s/meson-uninstalled", g_getenv("OPCFLOW_BUILD"));
  if (CALL(command, "new", "plugin", "kind.writer")) g_error("%s", err);
  g_setenv("PKG_CONFIG_PATH", path, TRUE);
  if (CALL("meson", "setup", "writers", "kind.writer", MESON_SANITIZE,
           "-Db_lundef=false") ||
      CALL("meson", "test", "-C", "writers"))
    g_error("%s%s", out, err);
  if (CALL(command, "lint", "writers/writer.plain.so")) g_error("%s", out);
  if (CALL(command, "new", "plugin", "writer.mine", "--plugin-path", "writers"))
    g_error("%s", err);
  static const char script[] =
      "CFLAGS=-I$PWD/kind.writer meson setup writer writer.mine $0 "
      "-Db_lundef=false && ninja -C writer";
  if (CALL("sh", "-c", script, MESON_SANITIZE)) g_error("%s%s", out, err);
  g_unsetenv("PKG_CONFIG_PATH");
  if (CALL(command, "lint", "writer/writer.mine.so", "--plugin-path",
           "writers"))
    g_error("%s%s", out, err);
}

/* Build a new plugin by the commands in its README, against this build in place
   of an installation. */
static void test_project(void) {
  g_autofree char *path =
      g_strdup_printf("%s/meson-uninstalled", g_getenv("OPCFLOW_BUILD"));
  g_assert_cmpint(CALL(command, "new", "plugin", "synthesizer.whole"), ==, 0);
  g_setenv("PKG_CONFIG_PATH", path, TRUE);
  if (CALL("meson", "setup", "built", "synthesizer.whole", MESON_SANITIZE,
           "-Db_lundef=false") ||
      CALL("meson", "test", "-C", "built"))
    g_error("%s%s", out, err);
  g_unsetenv("PKG_CONFIG_PATH");
  g_assert_nonnull(strstr(out, "Ok:                 2"));
}

/* Return the largest deviation of a run's drive currents, %. */
static double worst(const char *run) {
  g_autofree char *path = g_build_filename(folder, run, "metrics.json", NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_assert_true(json_parser_load_from_file(parser, path, NULL));
  g_autoptr(JsonNode) found = json_path_query(
      "$.mask.ion_max.value", json_parser_get_root(parser), NULL);
  return json_array_get_double_element(json_node_get_array(found), 0);
}

/* The new synthesizer reduces the largest deviation from 18 % to less than 2.5
   %. */
static void test_synthesizer(void) {
  g_assert_cmpfloat(worst("synthesizer/run"), <, 2.5);
}

static void test_flow(void) {
  g_assert_cmpint(CALL(command, "new", "flow", "first.yaml", "--json"), ==, 0);
  g_autoptr(JsonNode) json = json_from_string(out, NULL);
  JsonArray *files =
      json_object_get_array_member(json_node_get_object(json), "files");
  g_assert_cmpuint(json_array_get_length(files), ==, 3);
  if (CALL(command, "run", "first.yaml", "--output", "first"))
    g_error("%s", err);
  g_assert_cmpfloat(worst("first"), <, 0.5);
  g_assert_cmpint(CALL(command, "new", "flow", "first.yaml"), ==, 5);
  g_assert_cmpstr(err, ==, "error: './first.yaml' exists\n");
  g_assert_cmpint(CALL(command, "new", "flow", "second.yaml"), ==, 0);
  g_assert_cmpstr(out, ==, "./second.yaml\n");
}

/* A user's process is found by its path, a shipped process by its name. */
static void test_process(void) {
  const char *source = g_getenv("OPCFLOW_SOURCE");
  g_autofree char *cell =
      g_build_filename(source, "data", "cells65", "sram4.gds", NULL);
  g_autofree char *cif =
      g_build_filename(source, "data", "cells65", "nand2.cif", NULL);
  g_assert_cmpint(
      CALL(command, "new", "flow", "--process", "own65", cell, "sram.yaml"), ==,
      0);
  g_assert_cmpstr(out, ==, "./sram.yaml\n");
  if (CALL(command, "check", "sram.yaml")) g_error("%s%s", out, err);
  g_assert_cmpint(
      CALL(command, "new", "flow", "--process", "own65", cell, "sram.yaml"), ==,
      5);
  g_assert_nonnull(strstr(err, "'./sram.yaml' exists; another file: "));
  g_autofree char *base = g_build_filename(folder, "base.yaml", NULL);
  g_assert_true(g_file_set_contents(
      base,
      "opcflow: 1\nsteps:\n  layout: { use: read.cif, layers: { poly: CP, "
      "active: CA, contact: CC, nwell: CW } }\n"
      "  gates: { use: segment.transistors, layout: '${layout}' }\n",
      -1, NULL));
  if (CALL(command, "new", "flow", "--process", "base.yaml", cif, "mine.yaml"))
    g_error("%s", err);
  if (CALL(command, "run", "mine.yaml", "--output", "mine")) g_error("%s", err);
  g_assert_cmpint(CALL(command, "new", "flow", "--process", "base.yaml", cif),
                  ==, 0);
  g_assert_cmpstr(out, ==, "./flow.yaml\n");
  if (CALL(command, "check")) g_error("%s", err); /* checks flow.yaml */
  g_assert_cmpint(
      CALL(command, "new", "flow", "--process", "mine.yaml", cif, "no.yaml"),
      ==, 2);
  g_assert_nonnull(strstr(err, "has no input file left to set"));
  g_assert_cmpint(CALL(command, "new", "flow", "--process", "own56", cell), ==,
                  2);
  g_assert_nonnull(
      strstr(err, "no process 'own56', did you mean 'own65'?; known: "));
  g_assert_cmpint(CALL(command, "new", "flow", "--process", "own65", "none"),
                  ==, 5);
  g_assert_cmpstr(err, ==, "error: 'none': no such file\n");
  g_assert_cmpint(
      CALL(command, "new", "flow", "--process", "own65", "/dev/null"), ==, 5);
  g_assert_nonnull(strstr(err, "not a regular file"));
  /* The folder of the user has no plugins. */
  g_autofree char *mine =
      g_build_filename(folder, "home", "opcflow", "flows", "processes", NULL);
  g_autofree char *copy = g_build_filename(mine, "homely.yaml", NULL);
  g_autofree char *text = NULL;
  g_assert_cmpint(g_mkdir_with_parents(mine, 0700), ==, 0);
  g_assert_true(g_file_get_contents(base, &text, NULL, NULL));
  g_assert_true(g_file_set_contents(copy, text, -1, NULL));
  static const char script[] =
      "unset OPCFLOW_NO_SYSTEM_PLUGINS; XDG_DATA_HOME=$PWD/home \"$0\" "
      "new flow --process homely \"$1\" homely.yaml";
  if (CALL("sh", "-c", script, command, cif)) g_error("%s", err);
}

/* A flow for several layouts, named one by one or by their folder, runs the
   process for each. */
static void test_several(void) {
  g_autofree char *cells =
      g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data", "cells65", NULL);
  static const char script[] =
      "mkdir -p several empty && cp \"$0/nand2.cif\" \"$0/nor2.cif\" several "
      "&& mv several/nor2.cif several/NOR2.CIF && echo > several/README";
  if (CALL("sh", "-c", script, cells)) g_error("%s", err);
  if (CALL(command, "new", "flow", "--process", "base.yaml", "several",
           "all.yaml"))
    g_error("%s", err);
  g_assert_cmpstr(out, ==, "./all.yaml\n");
  if (CALL(command, "check", "all.yaml")) g_error("%s%s", out, err);
  if (CALL(command, "run", "all.yaml", "--output", "all"))
    g_error("%s%s", out, err);
  if (CALL("test", "-s", "all/each/nand2/base/manifest.json") ||
      CALL("test", "-s", "all/each/NOR2/base/manifest.json"))
    g_error("a run is missing");
  if (CALL(command, "new", "flow", "--process", "base.yaml",
           "several/nand2.cif", "several/NOR2.CIF", "several/two.yaml"))
    g_error("%s", err);
  if (CALL(command, "check", "several/two.yaml")) g_error("%s%s", out, err);
  g_assert_cmpint(CALL(command, "new", "flow", "--process", "base.yaml",
                       "several", "all.yaml"),
                  ==, 5);
  g_assert_nonnull(strstr(err, "base.yaml several ... NAME.yaml'"));
  g_assert_cmpint(
      CALL(command, "new", "flow", "--process", "base.yaml", "empty"), ==, 5);
  g_assert_nonnull(strstr(err, "the folder 'empty' has no input, expected"));
  g_assert_cmpint(CALL(command, "new", "flow", "--process", "base.yaml",
                       "several", "none.cif", "x.yaml"),
                  ==, 5);
  g_assert_cmpstr(err, ==, "error: 'none.cif': no such file\n");
  g_assert_cmpint(CALL("test", "-e", "x.yaml"), ==, 1);
}

/* For each shipped process, a comparison of layouts passes the check with all
   cases and methods; one comparison runs. */
static void test_comparison(void) {
  static const char *const all[] = {"ihp130", "nangate45", "nangate45-at-65",
                                    "sky130", "own65"};
  g_autofree char *cell = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data",
                                           "cells65", "sram4.gds", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    if (CALL("rm", "-f", "comparison.yaml", "comparison-methods.yaml"))
      g_error("%s", err);
    if (CALL(command, "new", "comparison", "--process", all[i], cell))
      g_error("%s", err);
    g_assert_cmpstr(out, ==, "./comparison.yaml\n./comparison-methods.yaml\n");
    if (CALL(command, "check", "--quick", "comparison.yaml"))
      g_error("%s: %s%s", all[i], out, err);
  }
  if (CALL(command, "run", "comparison.yaml", "--set",
           "compare.methods=[newton, dpb]", "--output", "compared"))
    g_error("%s%s", out, err);
  if (CALL("test", "-s", "compared/experiment.csv") ||
      CALL("test", "-s", "compared/report.html"))
    g_error("a file of the run is missing");
  g_assert_cmpint(
      CALL(command, "new", "comparison", "--process", "own65", cell), ==, 5);
  g_assert_nonnull(strstr(err, "comparison.yaml' exists"));
  g_assert_cmpint(CALL(command, "new", "comparison", cell), ==, 2);
  g_assert_nonnull(strstr(err, "needs --process NAME and files"));
  g_assert_cmpint(
      CALL(command, "new", "comparison", "--process", "own65", "none"), ==, 5);
  g_assert_nonnull(strstr(err, "'none': no such file"));
  /* A flow without a correction. */
  if (CALL("rm", "comparison.yaml", "comparison-methods.yaml"))
    g_error("%s", err);
  g_assert_cmpint(
      CALL(command, "new", "comparison", "--process", "base.yaml", cell), ==,
      2);
  g_assert_nonnull(strstr(err, "has no mask.litho, which a process requires"));
  g_assert_cmpint(CALL("test", "-e", "comparison.yaml"), ==, 1);
}

/* A relative data folder of the user is ignored. No plugin in the working
   folder is loaded. */
static void test_relative_data(void) {
  static const char script[] =
      "mkdir -p home/opcflow/plugins && echo none >home/opcflow/plugins/"
      "litho.mine.so; unset OPCFLOW_NO_SYSTEM_PLUGINS; "
      "XDG_DATA_HOME=$1home \"$0\" inspect litho.mine";
  g_autofree char *here = g_strconcat(folder, "/", NULL);
  g_assert_cmpint(CALL("sh", "-c", script, command, here), !=, 0);
  g_assert_nonnull(strstr(err, "cannot use '"));
  g_assert_cmpint(CALL("sh", "-c", script, command, ""), !=, 0);
  g_assert_nonnull(strstr(err, "unknown plugin 'litho.mine'"));
}

/* All shipped flows can be extended: all files that the flows name exist. */
static void test_shipped(void) {
  static const char *const all[] = {"ihp130", "nangate45", "nangate45-at-65",
                                    "own65", "sky130"};
  g_autofree char *cell = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data",
                                           "cells65", "sram4.gds", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    g_autofree char *file = g_strconcat(all[i], "-shipped.yaml", NULL);
    g_assert_cmpint(
        CALL(command, "new", "flow", "--process", all[i], cell, file), ==, 0);
    if (CALL(command, "check", "--quick", file)) g_error("%s%s", out, err);
  }
}

/* Check all flows in a folder of the tree, with all variants. `needs` lists the
   flows that require a file of the user; the other flows run without further
   files. */
static void check_folder(const char *place, const char *needs) {
  g_autofree char *path =
      g_build_filename(g_getenv("OPCFLOW_SOURCE"), place, NULL);
  g_autoptr(GDir) dir = g_dir_open(path, 0, NULL);
  guint flows = 0;
  for (const char *n; (n = g_dir_read_name(dir));) {
    if (!g_str_has_suffix(n, ".yaml")) continue;
    g_autofree char *flow = g_build_filename(path, n, NULL);
    if (CALL(command, "check", flow)) g_error("%s: %s%s", flow, out, err);
    if (g_str_has_prefix(out, "needs ") && !g_pattern_match_simple(needs, n))
      g_error("%s does not run alone: %s", flow, out);
    flows++;
  }
  g_assert_cmpuint(flows, >=, 5);
}

static void test_shipped_checks(void) {
  check_folder("flows", "iccad.yaml");
  check_folder("flows/processes", "*");
  check_folder("flows/scanners", "*");
}

/* The check reports a flow or a variant that requires a file. With --variant,
   other variants are not checked. */
static void test_needs(void) {
  g_autofree char *file = g_build_filename(folder, "needs.yaml", NULL);
  g_assert_true(g_file_set_contents(
      file,
      "opcflow: 1\nsteps:\n  layout: { use: read.gds }\nvariants:\n"
      "  more: { other: { use: read.cif } }\n  bad: { layout.scael: 2 }\n",
      -1, NULL));
  g_assert_cmpint(CALL(command, "check", "needs.yaml"), ==, 2);
  g_assert_cmpstr(out, ==,
                  "requires --set layout.file=FILE, The GDSII file\n"
                  "more: requires --set other.file=FILE, The CIF file\n");
  g_assert_nonnull(strstr(err, "'scael'"));
  g_assert_cmpint(CALL(command, "check", "--variant", "more", "needs.yaml"), ==,
                  0);
  g_assert_cmpstr(out, ==,
                  "more: requires --set layout.file=FILE, The GDSII file\n"
                  "more: requires --set other.file=FILE, The CIF file\n");
  g_assert_cmpint(CALL(command, "check", "--variant", "base", "needs.yaml"), ==,
                  0);
  g_assert_cmpint(CALL(command, "check", "--variant", "mor", "needs.yaml"), ==,
                  2);
  g_assert_nonnull(strstr(err, "did you mean 'more'?"));
}

/* A variant that requires a file is not a fault of the flow. Other faults of
   the variant are reported. */
static void test_variant_asks(void) {
  g_autofree char *file = g_build_filename(folder, "asks.yaml", NULL);
  const char *text =
      "opcflow: 1\nname: asks\nsteps:\n  layout: { use: read.cif, file: "
      "../none.cif }\n%s";
  g_autofree char *good = g_strdup_printf(
      text, "variants: { more: { other: { use: read.gds } } }\n");
  g_assert_true(g_file_set_contents(file, good, -1, NULL));
  (void)CALL(command, "check", "--quick", "asks.yaml");
  g_assert_nonnull(strstr(out, "more: requires --set other.file=FILE, "));
  g_assert_null(strstr(err, "required parameter"));
  g_autofree char *bad = g_strdup_printf(
      text, "variants: { more: { other: { use: read.gds, scael: 2 } } }\n");
  g_assert_true(g_file_set_contents(file, bad, -1, NULL));
  g_assert_cmpint(CALL(command, "check", "--quick", "asks.yaml"), ==, 2);
  g_assert_nonnull(strstr(err, "'scael' of 'read.gds'"));
  g_assert_null(strstr(err, "required parameter"));
  g_assert_cmpint(CALL(command, "run", "--variant", "more", "asks.yaml"), ==,
                  2);
}

/* A scanner leaves further parameters open; the new flow lists these
   parameters. A layout in place of the name of the flow causes a hint. */
static void test_scanner(void) {
  const char *source = g_getenv("OPCFLOW_SOURCE");
  g_autofree char *cell =
      g_build_filename(source, "data", "cells65", "sram4.gds", NULL);
  g_autofree char *table =
      g_build_filename(source, "data", "devices", "ptm65.yaml", NULL);
  g_assert_cmpint(
      CALL(command, "new", "flow", "--process", "arf", cell, "arf.yaml"), ==,
      0);
  g_autofree char *text = NULL,
                  *made = g_build_filename(folder, "arf.yaml", NULL);
  g_assert_true(g_file_get_contents(made, &text, NULL, NULL));
  g_assert_nonnull(strstr(text, "--set mask.extractor.devices=FILE"));
  g_assert_cmpint(CALL(command, "run", "arf.yaml"), ==, 2);
  g_assert_nonnull(strstr(err, "required parameter 'devices'"));
  g_autofree char *devices =
      g_strconcat("mask.extractor.devices=", table, NULL);
  g_assert_cmpint(CALL(command, "run", "arf.yaml", "--set", devices), ==, 2);
  g_assert_nonnull(strstr(err, "no layer 'poly', but 3/0, 4/0, "));
  static const char layers[] =
      "layout.layers={ poly: 9/0, active: 1/0, nwell: 3/0, contact: 10/0 }";
  if (CALL(command, "run", "arf.yaml", "--log", "info", "--set", devices,
           "--set", layers))
    g_error("%s%s", out, err);
  g_assert_nonnull(strstr(err, "65 nm lines at 250 nm, from the layout's"));
  g_assert_cmpint(CALL(command, "new", "flow", cell), ==, 2);
  g_assert_nonnull(strstr(err, "opcflow new flow --process NAME"));
  g_assert_nonnull(strstr(err, "; known: arf, "));
}

static void test_refusals(void) {
  g_assert_cmpint(CALL(command, "new", "circle"), ==, 2);
  g_assert_cmpint(CALL(command, "new", "plugin"), ==, 2);
  g_assert_cmpint(CALL(command, "new", "plugin", "mine"), ==, 2);
  const char *kinds =
      "; kinds: command, extractor, kind, litho, loader, regulator, resist, "
      "step, "
      "synthesizer";
  g_autofree char *nameless = g_strconcat(
      "error: 'mine' has no kind: use 'opcflow new plugin KIND.mine'", kinds,
      "\n", NULL);
  g_assert_cmpstr(err, ==, nameless);
  g_assert_cmpint(CALL(command, "new", "plugin", "synthesizer"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "error: 'synthesizer' is a kind: give the plugin a name, for "
                  "example 'opcflow new plugin synthesizer.mine'\n");
  g_assert_cmpint(CALL(command, "new", "plugin", "foo.bar"), ==, 2);
  g_autofree char *unknown =
      g_strconcat("error: unknown kind 'foo'", kinds,
                  "; a step has any first word: '--kind step'\n", NULL);
  g_assert_cmpstr(err, ==, unknown);
  g_assert_cmpint(CALL(command, "new", "plugin", "command.run"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "error: 'opcflow run' is built in: a plugin 'command.run' "
                  "would never be called\n");
  g_assert_cmpint(CALL(command, "new", "plugin", "--kind", "lithos", "mine"),
                  ==, 2);
  g_autofree char *near = g_strconcat(
      "error: unknown kind 'lithos', did you mean 'litho'?", kinds, "\n", NULL);
  g_assert_cmpstr(err, ==, near);
  g_assert_cmpint(CALL(command, "new", "plugin", "litho.Mine"), ==, 2);
  g_assert_cmpint(CALL(command, "new", "plugin", "litho.mine", "litho"), ==, 5);
  g_assert_cmpstr(err, ==, "error: 'litho' exists\n");
}

int main(int argc, char **argv) {
  static const char *const kinds[] = {"litho",       "resist",    "extractor",
                                      "synthesizer", "regulator", "step",
                                      "command"};
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  command = g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
    g_autofree char *path = g_strconcat("/new/", kinds[i], NULL);
    g_test_add_data_func(path, kinds[i], test_plugin);
  }
  g_test_add_func("/new/corrects", test_synthesizer);
  g_test_add_func("/new/lines", test_lines);
  g_test_add_func("/new/acceptance", test_acceptance);
  g_test_add_func("/new/kind", test_kind);
  g_test_add_func("/new/project", test_project);
  g_test_add_func("/new/flow", test_flow);
  g_test_add_func("/new/process", test_process);
  g_test_add_func("/new/several", test_several);
  g_test_add_func("/new/comparison", test_comparison);
  g_test_add_func("/new/relative-data", test_relative_data);
  g_test_add_func("/new/shipped", test_shipped);
  g_test_add_func("/new/shipped-checks", test_shipped_checks);
  g_test_add_func("/new/needs", test_needs);
  g_test_add_func("/new/variant-asks", test_variant_asks);
  g_test_add_func("/new/scanner", test_scanner);
  g_test_add_func("/new/refusals", test_refusals);
  int code = g_test_run();
  opc_remove_tree(folder);
  return code;
}
