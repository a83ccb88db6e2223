/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests that the calibrated threshold prints its anchor to size; thresholds and
   line widths are compared with an independent simulation of the same
   optics. */
#include "../lines_test.h"

#include <string.h>

#define prepared(parameters, litho) \
  lines_resist("resist.threshold", parameters, litho)

static void test_anchor(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  g_autoptr(opc_module) drawn = prepared("{}", litho);
  eda_field f = lines_print(litho, drawn, EDA_POLY, 65, 250);
  g_assert_cmpfloat(fabs(lines_width(&f) - 65), <, 0.002);
  eda_field_clear(&f);
  g_autoptr(opc_module) wider = prepared("{ anchor: { cd: 71 nm } }", litho);
  f = lines_print(litho, wider, EDA_POLY, 65, 250);
  g_assert_cmpfloat(fabs(lines_width(&f) - 71), <, 0.002);
  eda_field_clear(&f);
}

/* Return the threshold, which is the level set of a dark image. */
static double threshold_of(opc_module *resist, int layer) {
  const eda_resist *develop = resist->functions;
  opc_error error;
  eda_field f = {.frame = {0, 0, 100, 100}, .nx = 16, .ny = 16};
  f.coefficients = eda_alloc(256, sizeof(float));
  g_assert_cmpint(develop->print(resist->self, layer, &f, &error), ==, OPC_OK);
  double value = lines_value(&f, 0);
  eda_field_clear(&f);
  return value;
}

/* Test that thresholds do not depend on the truncation of the fast simulation,
   against other code: the exact sum over the three disks of Hopkins'
   coefficient. */
static void test_truth(void) {
  static const char *const cut[] = {"{}", "{ kernels: 3 }", "{ error: 5e-4 }"};
  for (size_t i = 0; i < G_N_ELEMENTS(cut); i++) {
    g_autoptr(opc_module) litho = lines_litho(cut[i]);
    g_autoptr(opc_module) resist = prepared("{}", litho);
    double poly = threshold_of(resist, EDA_POLY);
    double active = threshold_of(resist, EDA_ACTIVE);
    g_test_message("%s: %.6f, %.6f", cut[i], poly, active);
    g_assert_cmpfloat(fabs(poly - 0.40394), <, 2e-5);
    g_assert_cmpfloat(fabs(active - 0.27115), <, 2e-5);
  }
}

/* Test thresholds and widths through pitch against a prototype with other code
   (sums of the exact cross coefficient over tiles). */
static void test_through_pitch(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  g_autoptr(opc_module) resist = prepared("{}", litho);
  /* Far from the line, the level set equals the threshold minus the clear
     field. */
  eda_field f = lines_print(litho, resist, EDA_POLY, 65, 4000);
  double threshold = 1 + lines_value(&f, 2000);
  g_test_message("dense anchor: threshold %.4f", threshold);
  g_assert_cmpfloat(fabs(threshold - 0.404), <, 0.003);
  eda_field_clear(&f);
  const double pitch[] = {220, 320, 500, 1500}, cd[] = {62.9, 67.1, 70.7, 73.7};
  for (int i = 0; i < 4; i++) {
    f = lines_print(litho, resist, EDA_POLY, 65, pitch[i]);
    g_test_message("pitch %g: %.2f nm, expected %.1f", pitch[i],
                   lines_width(&f), cd[i]);
    g_assert_cmpfloat(fabs(lines_width(&f) - cd[i]), <, 0.3);
    eda_field_clear(&f);
  }
  f = lines_print(litho, resist, EDA_ACTIVE, 1000, 5000);
  double active = 1 + lines_value(&f, 2500);
  g_test_message("edge of a wide active: threshold %.4f", active);
  g_assert_cmpfloat(fabs(active - 0.265), <, 0.01);
  g_assert_cmpfloat(fabs(lines_width(&f) - 1000), <, 0.002);
  eda_field_clear(&f);
}

/* Test given thresholds; layers other than active follow poly. */
static void test_given(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  g_autoptr(opc_module) resist =
      prepared("{ threshold: 0.3, active_threshold: 0.2 }", litho);
  for (int layer = 0; layer < 3; layer++) {
    eda_field f = {.frame = {0, 0, 100, 100}, .nx = 16, .ny = 16};
    f.coefficients = eda_alloc(256, sizeof(float));
    opc_error error;
    const eda_resist *develop = resist->functions;
    g_assert_cmpint(develop->print(resist->self, layer, &f, &error), ==,
                    OPC_OK);
    g_assert_cmpfloat(
        fabs(lines_value(&f, 3) - (layer == EDA_ACTIVE ? 0.2 : 0.3)), <, 1e-6);
    eda_field_clear(&f);
  }
}

/* ---- an anchor from gates ---- */

/* Return rows of lines along x or y: each row { count, length, pitch }, nm. */
static eda_gates *rows_of(const int (*row)[3], size_t rows, uint8_t axis) {
  size_t n = 0, i = 0;
  for (size_t k = 0; k < rows; k++) n += (size_t)row[k][0];
  eda_gates *g = eda_gates_new(2, n);
  g->grid = 0.5;
  for (size_t k = 0; k < rows; k++)
    for (int at = 0; at < row[k][0]; at++, i++) {
      int32_t x = 2 * at * row[k][2], y = (int32_t)k * 2000;
      eda_box b = {x, y, x + 2 * row[k][1], y + 2000};
      if (axis != EDA_X) b = (eda_box){b.y0, b.x0, b.y1, b.x1};
      g->box[i] = b;
      g->axis[i] = axis;
      g->length[i] = row[k][1];
    }
  return g;
}

/* Assert that an anchor from gates and an anchor from the same numbers have
   bit-identical results. */
static void check_gates(const int (*row)[3], size_t rows, uint8_t axis,
                        const char *left, const char *numbers,
                        const char *expected) {
  g_autoptr(opc_module) litho =
      lines_litho("{ wavelength: 248 nm, na: 0.7, sigma: 0.6 }");
  g_autoptr(opc_module) same = prepared(numbers, litho);
  opc_error error;
  g_autoptr(opc_module) m = opc_test_module("resist.threshold", left, &error);
  g_assert_nonnull(m);
  eda_gates *gates = rows_of(row, rows, axis);
  opc_test_input(m, "anchor.gates", gates);
  opc_test_forget();
  const eda_resist *resist = m->functions;
  for (int again = 0; again < 2; again++)
    g_assert_cmpint(resist->prepare(m->self, litho, &error), ==, OPC_OK);
  if (!strstr(opc_test_log(), expected))
    g_error("'%s' is not in: %s", expected, opc_test_log());
  eda_field a = lines_print(litho, m, EDA_POLY, 150, 430);
  eda_field b = lines_print(litho, same, EDA_POLY, 150, 430);
  size_t n = (size_t)a.nx * (size_t)a.ny * sizeof *a.coefficients;
  g_assert_cmpmem(a.coefficients, n, b.coefficients, n);
  eda_field_clear(&a);
  eda_field_clear(&b);
  eda_gates_free(gates);
}

#define GATES "gates: '${gates}'"

static void test_gates(void) {
  /* Most gates are longer; the smallest pitch of short gates is not the most
   frequent pitch; short gates with a long gate between them are no neighbours.
 */
  static const int rows[][3] = {
      {5, 150, 430}, {2, 150, 360}, {9, 500, 780}, {1, 150, 0}};
  static const int alone[][3] = {{1, 150, 0}, {3, 500, 780}};
  for (int axis = EDA_X; axis <= EDA_Y; axis++)
    check_gates(rows, 4, (uint8_t)axis, "{ anchor: { " GATES " } }",
                "{ anchor: { line: 150 nm, pitch: 430 nm } }",
                "anchor: 150 nm lines at 430 nm, from the layout's gates (8 of "
                "the shortest; 4 of 5 pitches between them)");
  check_gates(rows, 4, EDA_X, "{ anchor: { " GATES ", pitch: 0 nm } }",
              "{ anchor: { line: 150 nm, pitch: 0 nm } }", "150 nm lines at 0");
  check_gates(rows, 4, EDA_X, "{ anchor: { " GATES ", line: 180 nm } }",
              "{ anchor: { line: 180 nm, pitch: 430 nm } }", "180 nm lines");
  check_gates(rows, 4, EDA_X, "{ anchor: { " GATES ", cd: 140 nm } }",
              "{ anchor: { line: 150 nm, pitch: 430 nm, cd: 140 nm } }", "");
  check_gates(alone, 2, EDA_X, "{ anchor: { " GATES " } }",
              "{ anchor: { line: 150 nm, pitch: 450 nm } }",
              "pitch is assumed to be three lines");
  check_gates(rows, 4, EDA_X,
              "{ anchor: { " GATES
              " }, table: [430 nm, 150 nm, 900 nm, 158 "
              "nm] }",
              "{ anchor: { line: 150 nm }, table: [430 nm, 150 nm, 900 nm, "
              "158 nm] }",
              "line 150 nm, pitch 900 nm");
  /* Values that are given replace those of the gates. */
  check_gates(rows, 4, EDA_X,
              "{ anchor: { " GATES ", line: 130 nm, pitch: 310 nm } }",
              "{ anchor: { line: 130 nm, pitch: 310 nm } }", "poly prints");
  g_assert_null(strstr(opc_test_log(), "from the layout"));
}

/* Test the default anchor: the printed transistors or, if unknown, k1 of 65 nm
   at 250 nm pitch, 193 nm and NA 0.75: 65 * 0.75 / 193 * 248 / 0.7 = 89.5 and
   344.2 nm. An anchor of other optics or another process causes a warning. */
static void test_open(void) {
  static const int rows[][3] = {{5, 150, 430}, {4, 150, 430}};
  static const struct {
    const char *left, *numbers, *expected;
    int drawn;
  } cases[] = {
      {"{}", "{ anchor: { line: 150 nm, pitch: 430 nm } }",
       "anchor: 150 nm lines at 430 nm, from the layout's gates (9 of", 1},
      {"{ anchor: { pitch: 310 nm } }",
       "{ anchor: { line: 150 nm, pitch: 310 nm } }", "150 nm lines at 310", 1},
      {"{}", "{ anchor: { line: 89 nm, pitch: 344 nm } }",
       "89 nm lines at 344 nm, from wavelength / NA = 354.3 nm", 0},
      {"{ anchor: { line: 67 nm, pitch: 430 nm } }",
       "{ anchor: { line: 67 nm, pitch: 430 nm } }",
       "'anchor': 67 nm are 0.19 of wavelength / NA", 1},
      {"{ anchor: { line: 190 nm, pitch: 430 nm } }",
       "{ anchor: { line: 190 nm, pitch: 430 nm } }",
       "the shortest gate of the layout has 150 nm: check that", 1},
      {"{ anchor: { line: 120 nm, pitch: 430 nm } }",
       "{ anchor: { line: 120 nm, pitch: 430 nm } }", NULL, 1}};
  g_autoptr(opc_module) litho =
      lines_litho("{ wavelength: 248 nm, na: 0.7, sigma: 0.6 }");
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) same = prepared(cases[i].numbers, litho);
    opc_error error;
    g_autoptr(opc_module) m =
        opc_test_module("resist.threshold", cases[i].left, &error);
    eda_gates *gates = rows_of(rows, 2, EDA_X);
    const eda_resist *resist = m->functions;
    if (cases[i].drawn) resist->drawn(m->self, gates);
    opc_test_forget();
    g_assert_cmpint(resist->prepare(m->self, litho, &error), ==, OPC_OK);
    g_test_message("%s", opc_test_log());
    if (cases[i].expected)
      g_assert_nonnull(strstr(opc_test_log(), cases[i].expected));
    else
      g_assert_null(strstr(opc_test_log(), "anchor"));
    for (int layer = 0; layer < 2; layer++)
      g_assert_cmpfloat(threshold_of(m, layer), ==, threshold_of(same, layer));
    eda_gates_free(gates);
  }
}

/* Test the default of active: 1000 nm at 193 nm, NA 0.75, here 3.886 * 248 /
   0.7 = 1377 nm. */
static void test_wide(void) {
  g_autoptr(opc_module) litho =
      lines_litho("{ wavelength: 248 nm, na: 0.7, sigma: 0.6 }");
  g_autoptr(opc_module) open = prepared("{}", litho);
  g_autoptr(opc_module) same =
      prepared("{ active_anchor: { line: 1377 nm } }", litho);
  g_autoptr(opc_module) other =
      prepared("{ active_anchor: { line: 1000 nm } }", litho);
  double a = threshold_of(open, EDA_ACTIVE);
  g_assert_cmpfloat(a, ==, threshold_of(same, EDA_ACTIVE));
  g_assert_cmpfloat(a, !=, threshold_of(other, EDA_ACTIVE));
}

static void test_bad_gates(void) {
  static const int none[][3] = {{0, 0, 0}}, close[][3] = {{3, 150, 430}};
  g_autoptr(opc_module) litho = lines_hopkins();
  opc_error error;
  for (int k = 0; k < 2; k++) {
    g_autoptr(opc_module) m =
        opc_test_module("resist.threshold",
                        k ? "{ anchor: { " GATES ", pitch: 150 nm } }"
                          : "{ anchor: { " GATES " } }",
                        &error);
    eda_gates *gates = rows_of(k ? close : none, 1, EDA_X);
    opc_test_input(m, "anchor.gates", gates);
    const eda_resist *resist = m->functions;
    g_assert_cmpint(resist->prepare(m->self, litho, &error), ==, OPC_INVALID);
    g_assert_cmpstr(
        error.message, ==,
        k ? "'anchor', lines of 150 nm at 150 nm: no space remains between the "
            "lines"
          : "no transistor defines the anchor; set 'anchor' in numbers");
    eda_gates_free(gates);
  }
}

/* Test an anchor that the optics cannot resolve, and one without space. */
static void test_refused(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  opc_error error;
  g_autoptr(opc_module) fine = opc_test_module(
      "resist.threshold", "{ anchor: { line: 50 nm, pitch: 100 nm } }", &error);
  g_assert_nonnull(fine);
  const eda_resist *resist = fine->functions;
  g_assert_cmpint(resist->prepare(fine->self, litho, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "anchor");
  g_assert_nonnull(strstr(error.message, "cannot be printed"));
  g_assert_null(opc_test_module("resist.threshold",
                                "{ anchor: { line: 250 nm, pitch: 250 nm } }",
                                &error));
  g_assert_nonnull(strstr(error.message, "no space between the lines"));
}

/* Test that diffusion damps a wave by the transform of the Gaussian. */
static void test_diffusion(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  g_autoptr(opc_module) resist = prepared(
      "{ threshold: 0.4, active_threshold: 0.2, diffusion: 25 nm }", litho);
  const opc_host *host = opc_test_host();
  const eda_resist *develop = resist->functions;
  opc_error error;
  eda_field f = {.frame = {0, 0, 600, 600}, .nx = 24, .ny = 24};
  f.coefficients = eda_alloc(576, sizeof(float));
  for (int i = 0; i < 576; i++)
    f.coefficients[i] = (float)(0.5 + 0.3 * cos(M_PI * (i % 24) / 6));
  eda_field_from_samples(host->context, &f);
  g_assert_cmpint(develop->print(resist->self, EDA_POLY, &f, &error), ==,
                  OPC_OK);
  double left = 0.3 * exp(-2 * pow(M_PI * 25 / 300, 2));
  for (double x = 0; x < 600; x += 17) {
    double want = 0.4 - 0.5 - left * cos(M_PI * x / 150);
    g_assert_cmpfloat(fabs(lines_value(&f, x) - want), <, 2e-5);
  }
  eda_field_clear(&f);
  /* The image of the anchor is diffused as well. */
  g_autoptr(opc_module) anchored = prepared("{ diffusion: 25 nm }", litho);
  f = lines_print(litho, anchored, EDA_POLY, 65, 250);
  g_assert_cmpfloat(fabs(lines_width(&f) - 65), <, 0.002);
  eda_field_clear(&f);
}

static void test_no_diffusion(void) {
  lines_check_diffusion("resist.threshold");
}

static const double pitches[] = {220, 250, 400, 1000},
                    wanted[] = {64, 65.5, 68, 70};

static double squares(opc_module *litho, opc_module *resist) {
  double sum = 0;
  for (int i = 0; i < 4; i++) {
    eda_field f = lines_print(litho, resist, EDA_POLY, 65, pitches[i]);
    sum += pow(lines_width(&f) - wanted[i], 2);
    eda_field_clear(&f);
  }
  return sum;
}

/* Test that the threshold of a table minimises the sum of squares: thresholds
   on both sides at equal distances have equally larger sums. A table in a file
   has the same result. */
static void test_table(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  opc_test_forget();
  g_autoptr(opc_module) fitted = prepared(
      "{ table: [220 nm, 64 nm, 250 nm, 65.5 nm, 400 nm, 68 nm, 1000 nm, 70 "
      "nm] }",
      litho);
  g_test_message("%s", opc_test_log());
  g_assert_nonnull(
      strstr(opc_test_log(), "poly, line 65 nm, pitch 250 nm: prints "));
  double threshold = threshold_of(fitted, EDA_POLY),
         least = squares(litho, fitted);
  double beside[2], h = 0.0005;
  for (int side = 0; side < 2; side++) {
    g_autofree char *mapping =
        g_strdup_printf("{ threshold: %.9f }", threshold + (side ? h : -h));
    g_autoptr(opc_module) other = prepared(mapping, litho);
    beside[side] = squares(litho, other);
    g_assert_cmpfloat(beside[side], >, least);
  }
  g_test_message("threshold %.5f: %.4f nm^2, beside it %.4f and %.4f nm^2",
                 threshold, least, beside[0], beside[1]);
  g_assert_cmpfloat(fabs(beside[1] - beside[0]), <,
                    0.1 * (beside[0] + beside[1] - 2 * least));
  g_autofree char *path = g_build_filename(opc_test_folder(), "t.csv", NULL);
  g_assert_true(g_file_set_contents(
      path, "pitch,cd\n220,64\n250,65.5\n400,68\n1000,70", -1, NULL));
  g_autofree char *mapping = g_strdup_printf("{ table_file: %s }", path);
  g_autoptr(opc_module) same = prepared(mapping, litho);
  g_assert_cmpfloat(squares(litho, same), ==, least);
}

/* Test a bright line of a dark field: bright areas print. */
static void test_bright(void) {
  g_autoptr(opc_module) litho =
      lines_litho("{ kernels: 94, poly: { tone: dark } }");
  g_autoptr(opc_module) resist = prepared(
      "{ tone: bright, anchor: { line: 120 nm, pitch: 300 nm, cd: 118 nm }, "
      "active_threshold: 0.2 }",
      litho);
  eda_field f = lines_print(litho, resist, EDA_POLY, 120, 300);
  g_assert_cmpfloat(lines_value(&f, 0), >, 0);
  g_assert_cmpfloat(lines_value(&f, 150), <, 0);
  g_assert_cmpfloat(fabs(lines_width(&f) - 118), <, 0.002);
  eda_field_clear(&f);
  lines_refused("resist.threshold", "{ tone: dark, active_threshold: 0.2 }",
                litho, "cannot be printed");
  lines_refused(
      "resist.threshold",
      "{ diffusion: 600 nm, anchor: { line: 120 nm, pitch: 300 nm } }", litho,
      "after 'diffusion' of 600 nm");
}

static void test_bad_tables(void) {
  static const struct {
    const char *text, *why;
  } files[] = {
      {"", "' has no rows"},
      {"# only this\n", "' has no rows"},
      {"pitch,cd\n", "' has no rows"},
      {"pitch,width\n", ":1:7: unknown column 'width'"},
      {"pitch,cd,cd\n", ":1:10: duplicate column: 'cd'"},
      {"cd\n1\n", ":1:1: missing column 'pitch'"},
      {"pitch,cd\n250,65\n\n250;65\n", ":4:1: not a number: '250;65'"},
      {"pitch,cd\n"
       "250,65,3\n",
       ":2:8: unexpected field: '3'"},
      {"pitch,cd\n250\n", ":2:4: not a number: ''"},
      {"pitch,cd\n250,nan\n", ":2:5: not a number: 'nan'"},
      {"pitch,cd\n250,0\n", ":2:1: widths must be above 0"},
      {"pitch,cd\n-250,65\n", ":2:1: a pitch must be"},
      {"pitch,cd\n60,65\n", ":2:1: no space remains between"},
      {"pitch,cd\n"
       "813718,65\n",
       ":2:1: lines and pitches must be at most 100 um"},
      {"line,pitch,cd\n65,250,65\n,250,65\n", ":3:1: not a number: ''"}};
  g_autoptr(opc_module) litho = lines_litho("{}");
  g_autofree char *path = g_build_filename(opc_test_folder(), "bad.csv", NULL);
  g_autofree char *mapping = g_strdup_printf("{ table_file: %s }", path);
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    g_assert_true(g_file_set_contents(path, files[i].text, -1, NULL));
    lines_refused("resist.threshold", mapping, litho, files[i].why);
  }
  g_assert_true(g_file_set_contents(path, "pitch,cd\0\n", 10, NULL));
  lines_refused("resist.threshold", mapping, litho,
                "is not a text file: byte 8 is 0");
  lines_refused("resist.threshold", "{ table: [250 nm] }", litho,
                "pairs of a pitch");
  lines_refused("resist.threshold", "{ table: [60 nm, 65 nm] }", litho,
                "no space remains between");
  lines_refused("resist.threshold",
                "{ threshold: 0.3, table: [250 nm, 65 nm] }", litho,
                "no effect");
  lines_refused("resist.threshold", "{ table: [130 nm, 65 nm] }", litho,
                "line 65 nm, pitch 130 nm cannot be printed");
  g_autofree char *both =
      g_strdup_printf("{ table_file: %s, table: [250 nm, 65 nm] }", path);
  lines_refused("resist.threshold", both, litho, "exclude each other");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/threshold/anchor", test_anchor);
  g_test_add_func("/threshold/gates", test_gates);
  g_test_add_func("/threshold/open", test_open);
  g_test_add_func("/threshold/wide", test_wide);
  g_test_add_func("/threshold/bad_gates", test_bad_gates);
  g_test_add_func("/threshold/truth", test_truth);
  g_test_add_func("/threshold/through-pitch", test_through_pitch);
  g_test_add_func("/threshold/given", test_given);
  g_test_add_func("/threshold/refused", test_refused);
  g_test_add_func("/threshold/diffusion", test_diffusion);
  g_test_add_func("/threshold/no-diffusion", test_no_diffusion);
  g_test_add_func("/threshold/table", test_table);
  g_test_add_func("/threshold/bright", test_bright);
  g_test_add_func("/threshold/bad-tables", test_bad_tables);
  return g_test_run();
}
