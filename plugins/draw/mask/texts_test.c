/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the texts of a picture. An .svg file has one element for each
   character, which names the glyph: equal characters of a font have equal
   glyphs, and other characters other glyphs. */
#include "sample_test.h"

/* Check that the characters of the picture are those of `title`, then those of
   `want` in another font. */
static void expect_text(drawing *d, const char *more, const char *title,
                        const char *want) {
  static const char use[] = "<use xlink:href=\"#glyph";
  opc_error error;
  g_autofree char *all = g_strdup_printf(
      "{ file: a.svg, width: 4000, insets: 0, scale: 4 %%, " WINDOW "%s }",
      more);
  if (draw_sample(d, all, &error)) g_error("%s", error.message);
  g_autofree char *path = g_build_filename(opc_test_folder(), "a.svg", NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  const char *const parts[] = {title, want};
  const char *at = text;
  for (int f = 0; f < 2; f++) {
    long glyph_of[128] = {0};
    g_autofree char *character_of = g_new0(char, 1000);
    for (const char *c = parts[f]; *c; c++) {
      char *end;
      at = strstr(at, use);
      if (!at) g_error("no '%s'", c);
      at += strlen(use);
      g_assert_cmpint(strtol(at, &end, 10), ==, f);
      long glyph = -strtol(end, NULL, 10);
      g_assert_cmpint(glyph, <, 1000);
      long *known = &glyph_of[(int)*c];
      if (!*known && !character_of[glyph]) {
        *known = glyph;
        character_of[glyph] = *c;
      }
      if (*known != glyph) g_error("the picture differs at '%s'", c);
    }
  }
  if (strstr(at, use)) g_error("text after '%s'", want);
}

#define DRAWN "|Ion deviation| as drawn: mean 20.00, max 20.00 %"
#define AFTER "after 7 iterations: mean 1.50, max 2.00 %"
#define SCALE "100 nm-4 %+4 %"

/* The title, the layers, the scales, and marks that the picture has. */
static void test_texts(void) {
  static const eda_violation violation = {"space", 0, 500, 500, 1, 2};
  drawing d;
  make_sample(&d);
  expect_text(
      &d, "", "ISLAND",
      "2 transistors" DRAWN AFTER
      "poly as drawnpoly maskprinted polyactive as drawnactive mask" SCALE
      "Ion deviation after correction");
  expect_text(&d, ", state: before", "ISLAND",
              "2 transistors" DRAWN AFTER "poly as drawnactive as drawn" SCALE
              "Ion deviation as drawn; 2 beyond");
  eda_field drawn[LAYERS] = {[EDA_ACTIVE] = d.print[EDA_POLY]};
  d.mask.drawn_print = drawn;
  expect_text(&d, ", state: difference", "ISLAND",
              "2 transistors" DRAWN AFTER
              "poly as drawnpoly maskprinted polyactive as drawnactive mask"
              "active printed as drawn" SCALE
              "|Ion deviation|, after minus before: below 0 is better; 2 "
              "beyond");
  d.mask.drawn_print = NULL;
  rectangle(&d.drawn[CONTACT], 200, 200, 220, 220);
  rectangle(&d.drawn[METAL], 700, 700, 720, 720);
  d.drawn_shapes[CONTACT] = d.drawn[CONTACT].shapes;
  d.drawn_shapes[METAL] = d.drawn[METAL].shapes;
  d.flags[1] = EDA_PRINT_OPEN;
  d.mask.iterations = 1;
  d.mask.violations = (eda_violation *)&violation;
  d.mask.n_violations = 1;
  expect_text(&d, "", "ISLAND",
              "2 transistors" DRAWN
              "after 1 iteration: mean 1.50, max 2.00 %"
              "poly as drawnpoly maskprinted polyactive as drawnactive mask"
              "contact" SCALE
              "Ion deviation after correctiondoes not print "
              "wellviolated rule (1)");
  d.corrected[METAL] = 1;
  d.mask.iterations = 0;
  d.mask.n_violations = 0;
  d.flags[1] = 0;
  d.gates.count = 1;
  expect_text(&d, "", "ISLAND",
              "1 transistor" DRAWN
              "by this mask: mean 2.00, max 2.00 %"
              "poly as drawnpoly maskprinted polyactive as drawnactive mask"
              "contactmetal1 as drawn" SCALE "Ion deviation after correction");
  d.gates.count = 0;
  expect_text(&d, "", "ISLAND",
              "0 transistors"
              "poly as drawnpoly maskprinted polyactive as drawnactive mask"
              "contactmetal1 as drawn100 nm");
  drawing_clear(&d);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/texts/texts", test_texts);
  return g_test_run();
}
