/* SPDX-License-Identifier: BSD-3-Clause */
/* Faulty inputs of whole flows: message, exit code, and no output file. Also
   tests notes on transistors in all layout formats. */
#include <string.h>

#include "tests/flow.h"

#define LIGHT "--set", "mask.fine=1e-3", "--set", "mask.margin=1 um"

/* ---- notes on transistors ---- */

/* A transistor with a note (goal: 5 % more Ion), placed in four orientations.
   One of the placements has another note at the top level. */
static const char noted[] =
    "DS 1 1 10; 9 device; L CA; B 460 300 230 150;\n"
    "L CP; P 200 -200 265 -200 265 500 200 500;\n"
    "L CC; B 60 60 60 150; B 60 60 400 150; 94 weight=2,ion=1.05 230 150 XN; "
    "DF;\n"
    "DS 2 1 10; 9 top; L CW; B 100 100 6000 6000; C 1 T 0 0; C 1 M X T 3000 "
    "0;\n"
    "C 1 R 0 1 T 0 3000; C 1 R 0 -1 M Y T 3000 3000; 94 ion=0.97 3150 3230 XN; "
    "DF;\n"
    "C 2; E\n";

static char *noted_layout(const char *use, const char *file, int numbers) {
  return g_strdup_printf(
      "layout={ use: %s, file: %s, layers: { poly: %s, active: %s, contact: "
      "%s, "
      "nwell: %s, notes: %s } }",
      use, file, numbers ? "9/0" : "CP", numbers ? "1/0" : "CA",
      numbers ? "10/0" : "CC", numbers ? "3/0" : "CW", numbers ? "63/5" : "XN");
}

/* Read the column ion_after, sorted by x of the transistors. */
static void read_ion(const char *run, double ion[4]) {
  g_autoptr(GBytes) text = bytes(run, "gates.csv");
  g_auto(GStrv) lines = g_strsplit(g_bytes_get_data(text, NULL), "\n", -1);
  g_assert_cmpuint(g_strv_length(lines), ==, 6);
  for (int i = 0; i < 4; i++) {
    g_auto(GStrv) field = g_strsplit(lines[i + 1], ",", -1);
    ion[i] = g_ascii_strtod(field[8], NULL);
  }
}

static void test_notes(void) {
  g_autofree char *cif = place("noted.cif"), *convert = place("noted.yaml");
  g_autofree char *files = place("noted");
  g_assert_true(g_file_set_contents(cif, noted, -1, NULL));
  g_autofree char *read = noted_layout("read.cif", cif, 0);
  const char *layers =
      "layers: { poly: 9/0, active: 1/0, contact: 10/0, "
      "nwell: 3/0, notes: 63/5 }";
  g_autofree char *text = g_strdup_printf(
      "opcflow: 1\nname: noted\nsteps:\n  layout: %s\n"
      "  gds: { use: write.gds, layout: '${layout}', file: n.gds, %s }\n"
      "  oasis: { use: write.oasis, layout: '${layout}', file: n.oas, %s }\n",
      strchr(read, '{'), layers, layers);
  g_assert_true(g_file_set_contents(convert, text, -1, NULL));
  g_assert_cmpint(opcflow(NULL, "run", convert, "--output", files, NULL), ==,
                  0);
  g_autofree char *gds = place("noted/n.gds"), *oasis = place("noted/n.oas");
  g_autofree char *from_gds = noted_layout("read.gds", gds, 1);
  g_autofree char *from_oasis = noted_layout("read.oasis", oasis, 1);
  const char *sets[] = {read, from_gds, from_oasis};
  const char *runs[] = {"note-cif", "note-gds", "note-oasis"};
  g_autofree char *flow = source_path("flows/newton.yaml");
  for (int i = 0; i < 3; i++) {
    g_autofree char *out = place(runs[i]);
    g_assert_cmpint(opcflow(NULL, "run", flow, LIGHT, "--set", sets[i], "--set",
                            "require.mask.ion_max=6 %", "--output", out, NULL),
                    ==, 0);
    expect_equal("note-cif", runs[i], "gates.csv");
  }
  double ion[4];
  read_ion("note-gds", ion);
  for (int i = 0; i < 4; i++)
    g_assert_cmpfloat_with_epsilon(ion[i], i == 3 ? -3 : 5, 0.6);
}

/* A note with an invalid word is an error. A table of goals overrides a
   note. */
static void test_bad_note(void) {
  g_autofree char *cif = place("noted.cif"), *bad = place("bad-note.cif");
  g_autofree char *wishes = place("wishes.csv"),
                  *flow = source_path("flows/newton.yaml");
  g_auto(GStrv) parts = g_strsplit(noted, "weight", -1);
  g_autofree char *text = g_strjoinv("wieght", parts), *errors = NULL;
  g_assert_true(g_file_set_contents(bad, text, -1, NULL));
  g_autofree char *set = noted_layout("read.cif", bad, 0),
                  *out = place("bad-note");
  g_assert_cmpint(
      opcflow(&errors, "run", flow, "--set", set, "--output", out, NULL), ==,
      2);
  g_assert_nonnull(strstr(errors,
                          "note of 'device#0:1': unknown word 'wieght', "
                          "did you mean 'weight'?"));
  g_assert_true(g_file_set_contents(cif, noted, -1, NULL));
  g_assert_true(g_file_set_contents(wishes, "transistor, ion\ndevice#0:1, 1\n",
                                    -1, NULL));
  g_autofree char *good = noted_layout("read.cif", cif, 0),
                  *over = place("over");
  g_autofree char *file = g_strdup_printf("mask.synthesizer.wishes=%s", wishes);
  g_assert_cmpint(
      opcflow(NULL, "run", flow, LIGHT, "--set", good, "--set", file, "--set",
              "require.mask.ion_max=6 %", "--output", over, NULL),
      ==, 0);
  double ion[4];
  read_ion("over", ion);
  g_assert_cmpfloat_with_epsilon(ion[0], 0, 0.6);
  g_assert_cmpfloat_with_epsilon(ion[1], 5, 0.6);
}

/* ---- bad input ---- */

static void assert_exit(int want, const char *say, const char *set) {
  g_autofree char *flow = source_path("flows/demo.yaml"), *out = place("bad");
  g_autofree char *errors = NULL;
  int code = opcflow(&errors, "run", flow, "--set", set, "--output", out, NULL);
  if (code != want || !strstr(errors, say))
    g_error("--set %s: exit code %d, want %d; '%s' is not in:\n%s", set, code,
            want, say, errors);
  g_assert_false(g_file_test(out, G_FILE_TEST_EXISTS));
}

static void test_bad_input(void) {
  assert_exit(5, "nowhere.cif", "layout.file=nowhere.cif");
  assert_exit(2, "XY", "layout.layers.poly=XY");
  assert_exit(2, "did you mean 'ion_limit'",
              "mask.synthesizer.ion_limti=0.5 %");
  assert_exit(3, "litho.hopkin", "mask.litho.use=litho.hopkin");
}

static void simulate_evil(const char *name, const char *parameter,
                          const char *path, const char *say) {
  g_autofree char *file = g_strdup_printf("flows/%s.yaml", name);
  g_autofree char *flow = source_path(file), *out = place("evil"),
                  *errors = NULL;
  g_autofree char *set = g_strdup_printf("%s=%s", parameter, path);
  int code = opcflow(&errors, "run", flow, "--set", set, "--output", out, NULL);
  g_test_message("%s", errors);
  if (code != 2 || !strstr(errors, say))
    g_error("exit code %d, want 2; '%s' is not in:\n%s", code, say, errors);
  g_assert_false(g_file_test(out, G_FILE_TEST_EXISTS));
}

/* In all flows that simulate, model files with commands or includes are
   rejected with the place of the fault. No command runs and no file is
   written. */
static void test_model_files(void) {
  static const struct {
    const char *text, *say;
  } evil[] = {
      {"\n.control\nshell touch %s\n.endc\n", "evil.pm:29:1: '.control' is"},
      {"\r\n\t.CONTROL\r\nshell touch %s\r\n", "evil.pm:29:2: '.CONTROL' is"},
      {"shell touch %s\n", "evil.pm:28:1: 'shell' is refused"},
      {".csparam x=`touch %s`\n", "evil.pm:28:1: '.csparam' is refused"},
      {".param x=\"`touch %s`\" y=`a`\n", "evil.pm:28:1: a '`'"},
      {"a1 [x] [y] m\n.model m d_process(process_file=\"%s\")\n",
       "evil.pm:28:1: 'a1' is refused"},
      {".model m filesource(file=\"%s\")\n", "evil.pm:28:10: models of kind"},
      {".options rawfile=%s\n", "evil.pm:28:10: option 'rawfile'"},
      {".include '../../%s'\n", "evil.pm:28:10: "},
      {".include /etc/hostname\n", "evil.pm:28:10: '/etc/hostname' is outside"},
      {".lib '/dev/zero' tt\n", "evil.pm:28:6: '/dev/zero' is outside"}};
  if (!plugin_available("devices.ngspice")) return;
  g_autofree char *own = source_path("data/devices/opcflow65.pm"), *card = NULL;
  g_autofree char *path = place("evil.pm"), *made = place("made");
  g_assert_true(g_file_get_contents(own, &card, NULL, NULL));
  for (size_t i = 0; i < G_N_ELEMENTS(evil); i++) {
    g_auto(GStrv) parts = g_strsplit(evil[i].text, "%s", -1);
    g_autofree char *more = g_strjoinv(made, parts);
    g_autofree char *text = g_strconcat(card, more, NULL);
    g_assert_true(g_file_set_contents(path, text, -1, NULL));
    simulate_evil("devices", "devices.card", path, evil[i].say);
    if (!i) simulate_evil("circuit", "circuit.models", path, evil[i].say);
    g_assert_false(g_file_test(made, G_FILE_TEST_EXISTS));
  }
}

/* Poly and active do not overlap. */
static void test_no_transistor(void) {
  g_autofree char *cif = place("apart.cif");
  g_assert_true(g_file_set_contents(
      cif,
      "L CP; B 10 100 0 0; L CA; B 50 20 500 0; L CC; B 8 8 500 0; "
      "L CW; B 200 200 500 0; E\n",
      -1, NULL));
  g_autofree char *set = g_strdup_printf("layout.file=%s", cif);
  assert_exit(2, "no transistor", set);
}

static void test_truncated(void) {
  g_autofree char *whole = NULL, *flow = source_path("flows/dpb.yaml");
  g_autofree char *demo = source_path("flows/demo.yaml"), *run = place("demo");
  g_autofree char *mask = place("demo/mask.gds"), *cut = place("cut.gds");
  gsize length;
  g_assert_cmpint(opcflow(NULL, "run", demo, "--output", run, NULL), ==, 0);
  g_assert_true(g_file_get_contents(mask, &whole, &length, NULL));
  g_assert_true(
      g_file_set_contents(cut, whole, (gssize)(length / 2 | 1), NULL));
  g_autofree char *set = g_strdup_printf("layout.file=%s", cut), *errors = NULL;
  g_autofree char *out = place("truncated");
  g_assert_cmpint(
      opcflow(&errors, "run", flow, "--set", set, "--output", out, NULL), ==,
      5);
  g_test_message("%s", errors);
  g_assert_nonnull(strstr(errors, "cut.gds"));
  g_assert_nonnull(strstr(errors, "byte"));
}

/* If the scale is wrong, but everything else is correct, the layout prints and
   is corrected as far as possible. */
static void test_wrong_scale(void) {
  g_autofree char *flow = source_path("flows/demo.yaml"), *errors = NULL;
  g_autofree char *run = place("scale");
  g_assert_cmpint(opcflow(&errors, "run", flow, "--output", run, "--set",
                          "layout.scale=3", "--quiet", NULL),
                  ==, 1);
  g_assert_nonnull(strstr(errors, "check the 'scale' of the layout"));
  g_assert_nonnull(strstr(errors, "'mask.outside' is 4, expected at most 0\n"));
}

static void test_typo(void) {
  g_autofree char *flow = place("typo.yaml"), *errors = NULL;
  g_assert_true(g_file_set_contents(
      flow, "opcflow: 1\nname: typo\nsteps:\n  layout:\n    use: read.cfi\n",
      -1, NULL));
  g_assert_cmpint(opcflow(&errors, "run", flow, NULL), ==, 3);
  g_assert_nonnull(strstr(errors, "typo.yaml:5:"));
  g_assert_nonnull(strstr(errors, "did you mean 'read.cif'"));
}

/* Settings of the segmentation are refused if `correct` takes gates. */
static void test_settings_of_gates(void) {
  static const char *const set[] = {
      "mask.top=A", "mask.flavours={ lvt: LVTN }", "mask.also={ metal1: M1 }",
      "mask.overhang=100 nm", "mask.line_end=100 nm"};
  g_autofree char *flow = source_path("flows/demo.yaml");
  for (size_t i = 0; i < G_N_ELEMENTS(set); i++) {
    g_autofree char *errors = NULL;
    g_assert_cmpint(opcflow(&errors, "check", flow, "--set", set[i], NULL), ==,
                    2);
    g_assert_nonnull(strstr(errors, "' requires 'layout'"));
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  begin_flows();
  g_test_add_func("/inputs/settings-of-gates", test_settings_of_gates);
  g_test_add_func("/inputs/notes", test_notes);
  g_test_add_func("/inputs/bad-note", test_bad_note);
  g_test_add_func("/inputs/bad-input", test_bad_input);
  g_test_add_func("/inputs/model-files", test_model_files);
  g_test_add_func("/inputs/no-transistor", test_no_transistor);
  g_test_add_func("/inputs/truncated", test_truncated);
  g_test_add_func("/inputs/wrong-scale", test_wrong_scale);
  g_test_add_func("/inputs/typo", test_typo);
  return run_flows();
}
