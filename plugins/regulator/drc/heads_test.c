/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests heads of line ends and desired extensions, with a printed image that
   follows the heads and the line ends. */
#include "chip_test.h"

/* The printed extension of a line end grows by 0.7 nm per nm of length and by 3
   nm per nm of the head's width. The regulator first increases the length until
   the spacing of 40 nm is used, and then widens the head. */
static void test_heads(void) {
  static const struct {
    const char *parameters;
    int32_t gap, length;
    int widens;
  } cases[] = {
      {"{ min_extension: 20 nm, want_extension: 40 nm, max_head: 10 nm }", 80,
       40, 1},
      {"{ min_extension: 20 nm, want_extension: 40 nm }", 80, 40, 0},
      {"{ min_extension: 20 nm, want_extension: 30 nm, max_head: 10 nm }", 120,
       0, 0},
      {"{ min_extension: 38 nm, max_head: 10 nm }", 80, 40, 1},
  };
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    g_autoptr(opc_module) m = drc_make(cases[k].parameters);
    chip c = {0};
    add_end(&c, cases[k].gap);
    chip_begin(&c);
    for (int i = 0; i < 16; i++) {
      c.extension[0] = INFINITY;
      c.extension[1] = 2 + 0.7 * c.end[1] + 3 * head_width(&c);
      chip_print(&c, line_ends);
      chip_follow(&c);
      chip_judge(m, &c);
    }
    if (cases[k].length) {
      g_assert_cmpint(c.end[1], >=, cases[k].length - 2);
      g_assert_cmpint(c.end[1], <=, cases[k].length);
    }
    g_assert_cmpint(head_width(&c) > 0, ==, cases[k].widens);
    if (cases[k].widens) {
      g_assert_cmpfloat(c.extension[1], >=, 38);
      g_assert_cmpint(head_width(&c), <=, 6);
    }
    g_assert_cmpuint(c.veto[0], ==, 0);
    chip_end(&c);
  }
}

/* Requests of the synthesizer apply in all iterations. A request extends the
   line end, and widens the head if the length is limited, never by more than
   requested. */
static void test_requested(void) {
  for (int k = 0; k < 3; k++) {
    g_autoptr(opc_module) m = drc_make("{ min_extension: 20 nm }");
    const double want[2] = {0, 38}, wide[2] = {0, k == 2 ? 2 : 10};
    chip c = {0};
    add_end(&c, 80);
    chip_begin(&c);
    if (k) c.p.want_extension = want, c.p.want_head = wide;
    for (int i = 0; i < 20; i++) {
      c.p.iteration = 10 + (uint32_t)i;
      c.extension[0] = INFINITY;
      c.extension[1] = 2 + 0.7 * c.end[1] + 3 * head_width(&c);
      chip_print(&c, line_ends);
      chip_follow(&c);
      chip_judge(m, &c);
    }
    if (k)
      g_assert_cmpint(c.end[1], >=, 38);
    else
      g_assert_cmpfloat(c.extension[1], <, 25);
    if (k == 1) g_assert_cmpfloat(c.extension[1], >=, 38);
    g_assert_cmpint(head_width(&c), <=, k ? k == 2 ? 2 : 6 : 0);
    g_assert_cmpint(head_width(&c) > 0, ==, k > 0);
    chip_end(&c);
  }
}

/* Extensions beyond `min_extension` are not attempted if a neighbour prints
   within 30 nm, or after the synthesizer has moved its lengths. */
static void test_desired_extension(void) {
  for (int k = 0; k < 3; k++) {
    g_autoptr(opc_module) m = drc_make(
        "{ min_extension: 20 nm, want_extension: 40 nm, max_head: 10 nm }");
    chip c = {0};
    add_end(&c, 300);
    chip_begin(&c);
    c.extension[0] = INFINITY;
    c.extension[1] = k == 1 ? 195 : 25; /* in case 1, the line end prints 25 nm
                                           before the other line */
    if (k == 1) c.extension[1] = 39.5, c.drawn[1] = 100;
    chip_print(&c, line_ends);
    if (k == 1) { /* the other line prints nearby */
      c.extension[1] = 195;
      chip_print(&c, line_ends);
      c.extension[1] = 39.5;
    }
    c.p.iteration = k == 2 ? 3 : 0;
    chip_judge(m, &c);
    g_assert_cmpint(c.end[1] > 0, ==, k == 0);
    chip_end(&c);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/heads", test_heads);
  g_test_add_func("/regulator/asked", test_requested);
  g_test_add_func("/regulator/desired-extension", test_desired_extension);
  return g_test_run();
}
