/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads an SDF file with OpenSTA and compares the arrivals of a chain of gates.
   Skipped if OpenSTA (sta) is missing. */
#include <eda/sdf.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char library_text[] =
    "library (l) {\n delay_model : table_lookup;\n time_unit : \"1ps\";\n"
    " capacitive_load_unit (1, ff);\n cell (INV) {\n"
    "  pin (A) { direction : input; capacitance : 1; }\n"
    "  pin (Y) { direction : output; function : \"!A\";\n"
    "   timing () { related_pin : \"A\"; timing_sense : negative_unate;\n"
    "    cell_rise (scalar) { values (\"1\"); }\n"
    "    cell_fall (scalar) { values (\"1\"); }\n"
    "    rise_transition (scalar) { values (\"1\"); }\n"
    "    fall_transition (scalar) { values (\"1\"); }\n   }\n  }\n }\n}\n";

static const char circuit_text[] =
    "module top (a, z);\n input a;\n output z;\n wire n;\n"
    " INV U1 (.A(a), .Y(n));\n INV \\2/U$[3].x (.A(n), .Y(z));\nendmodule\n";

static const char script_text[] =
    "read_liberty l.lib\nread_verilog top.v\nlink_design top\n"
    "create_clock -name c -period 1000\nset_input_delay 0 -clock c a\n"
    "set_output_delay 0 -clock c z\n"
    "set_operating_conditions -analysis_type on_chip_variation\n"
    "read_sdf top.sdf\n"
    "foreach delay {min max} { foreach edge {rise fall} {\n"
    "report_checks -path_delay $delay -${edge}_to z -digits 4\n} }\nexit\n";

static void file_write(const char *folder, const char *name, const char *text) {
  g_autofree char *path = g_build_filename(folder, name, NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
}

static void test_opensta(void) {
  const double none[] = {NAN, NAN, NAN};
  eda_sdf_arc arc[] = {
      {"INV", "U1", "A", "Y", {{11, 13, 17.25}, {20, 30, 41.5}}},
      {"INV", "2/U$[3].x", "A", "Y", {{5, 6, 7.125}, {100, 200, 301}}}};
  g_autofree char *there = g_find_program_in_path("sta");
  opc_error error = {0};
  if (!there) {
    g_test_skip("OpenSTA (sta) is not installed");
    return;
  }
  g_autofree char *folder = g_dir_make_tmp("sdf-XXXXXX", NULL);
  g_autofree char *sdf = g_build_filename(folder, "top.sdf", NULL);
  file_write(folder, "l.lib", library_text);
  file_write(folder, "top.v", circuit_text);
  file_write(folder, "sta.tcl", script_text);
  g_assert_false(eda_sdf_write(sdf, "top", "test", 1.1, 27, 2, arc, &error));
  const char *const argv[] = {"sta", "-no_splash", "-exit", "sta.tcl", NULL};
  g_autofree char *out = NULL;
  g_autofree char *words = NULL;
  g_assert_true(g_spawn_sync(folder, (char **)argv, NULL, G_SPAWN_SEARCH_PATH,
                             NULL, NULL, &out, &words, NULL, NULL));
  /* Output z rises: U1 falls, then 2/U$[3].x rises; and the reverse. */
  const double want[] = {11 + 100, 20 + 5, 17.25 + 301, 41.5 + 7.125};
  const char *at = out;
  for (int k = 0; k < 4; k++) {
    at = strstr(at, "data arrival time");
    if (!at) g_error("OpenSTA reports no path: %s %s", out, words);
    const char *number = at;
    while (number > out && number[-1] != '\n') number--;
    double got = strtod(number, NULL);
    if (!(fabs(got - want[k]) < 1e-3)) g_error("%g is not %g", got, want[k]);
    at = strstr(at + 1, "data arrival time") + 1; /* the second is negative */
  }
  /* An edge without a delay has an empty entry. */
  memcpy(arc[0].delay[0], none, sizeof none);
  g_assert_false(eda_sdf_write(sdf, "top", "test", 1.1, 27, 1, arc, &error));
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(sdf, &text, NULL, NULL));
  g_assert_nonnull(strstr(text, "(IOPATH A Y (20.000:30.000:41.500) ())"));
  for (const char *const *name =
           (const char *const[]){"l.lib", "top.v", "sta.tcl", "top.sdf", NULL};
       *name; name++) {
    g_autofree char *path = g_build_filename(folder, *name, NULL);
    g_unlink(path);
  }
  g_rmdir(folder);
  arc[0].delay[1][2] = INFINITY;
  g_assert_cmpint(eda_sdf_write(sdf, "top", "test", 1, 27, 1, arc, &error), ==,
                  OPC_FAILED);
  g_assert_cmpstr(error.message, ==,
                  "the delay of 'U1' from 'A' to 'Y' is not finite");
  arc[0].delay[1][2] = 41.5;
  g_assert_cmpint(
      eda_sdf_write("/nowhere/x.sdf", "top", "test", 1, 27, 1, arc, &error), ==,
      OPC_IO);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/sdf/opensta", test_opensta);
  return g_test_run();
}
