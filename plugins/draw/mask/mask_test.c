/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the picture of a mask made by hand: colours at known positions. */
#include <unistd.h>

#include "sample_test.h"

/* ---- the picture ---- */

static double pixels_per_nm(const picture *m, double nm) {
  return (m->right - m->left + 1) / nm;
}

/* Return the pixel of a position in a window that begins at (0, 0). */
static uint32_t pixel_at(const picture *m, double window, double x, double y) {
  double scale = pixels_per_nm(m, window);
  return pixel(m, m->left + (int)floor(x * scale),
               m->bottom - (int)floor(y * scale));
}

static double brightness(uint32_t c) {
  return ((c >> 16 & 255) + (c >> 8 & 255) + (c & 255)) / 3.0;
}

/* ---- tests ---- */

static void check_fills(const picture *m) {
  g_assert_cmphex(pixel_at(m, SIDE, 20, 20), ==, 0xffffff);
  g_assert_cmphex(pixel_at(m, SIDE, 980, 500), ==, 0xffffff);
  uint32_t poly = pixel_at(m, SIDE, 500, 200),
           active = pixel_at(m, SIDE, 200, 600);
  g_assert_cmphex(poly, !=, active);
  g_assert_cmpfloat(brightness(poly), >, 200);
  g_assert_cmpfloat(brightness(active), >, 200);
  g_assert_cmphex(pixel_at(m, SIDE, 500, 800), ==, poly);
  g_assert_cmphex(pixel_at(m, SIDE, 800, 400), ==, active);
  /* The first transistor is at the end of a scale of 2 %, the second in the
     middle of its lower half. Brewer's colours. */
  g_assert_cmphex(pixel_at(m, SIDE, 480, 400), ==, 0xb2182b);
  g_assert_cmphex(pixel_at(m, SIDE, 520, 600), ==, 0x92c5de);
}

/* Return the darkest pixel near a position, along x. */
static double darkest_near(const picture *m, double x, double y, int reach,
                           int *where) {
  double scale = pixels_per_nm(m, SIDE), least = 256;
  int centre = m->left + (int)floor(x * scale);
  int row = m->bottom - (int)floor(y * scale);
  for (int i = -reach; i <= reach; i++) {
    double b = brightness(pixel(m, centre + i, row));
    if (b >= least) continue;
    least = b;
    *where = i;
  }
  return least;
}

/* Check the contour where the cosine is -1/2, darker than a mask. */
static void check_print(const picture *m) {
  int where;
  g_assert_cmpfloat(darkest_near(m, 1000.0 / 3, 500, 8, &where), <, 100);
  g_assert_cmpint(ABS(where), <=, 1);
  g_assert_cmpfloat(darkest_near(m, 2000.0 / 3, 500, 8, &where), <, 100);
  g_assert_cmpint(ABS(where), <=, 1);
}

static void check_lines(const picture *m) {
  int where;
  /* The left edges of the poly and active masks are thin and of two hues. */
  g_assert_cmpfloat(darkest_near(m, 430, 870, 3, &where), <, 160);
  g_assert_cmpint(ABS(where), <=, 1);
  g_assert_cmpfloat(darkest_near(m, 120, 650, 3, &where), <, 160);
  g_assert_cmpint(ABS(where), <=, 1);
  uint32_t poly = pixel_at(m, SIDE, 430, 870),
           active = pixel_at(m, SIDE, 120, 650);
  g_assert_cmpuint(poly >> 16, >, poly & 255);     /* orange */
  g_assert_cmpuint(active >> 16, <, active & 255); /* green */
  check_print(m);
}

/* Check the scale bar, the longest dark run below the window: a sixth of the
   window, rounded down to 1, 2 or 5. */
static void check_bar(const picture *m, double window, double nm) {
  int longest = 0;
  for (int y = m->bottom + 2; y < m->height; y++)
    for (int x = 0, run = 0; x < m->width; x++) {
      run = brightness(pixel(m, x, y)) < 60 ? run + 1 : 0;
      longest = MAX(longest, run);
    }
  double want = nm * pixels_per_nm(m, window);
  g_assert_cmpfloat(fabs(longest - want), <=, 3);
}

static void test_png(void) {
  static const int widths[] = {1600, 600};
  for (size_t i = 0; i < G_N_ELEMENTS(widths); i++) {
    drawing d;
    opc_error error;
    make_sample(&d);
    g_autofree char *mapping = g_strdup_printf(
        "{ " WINDOW ", width: %d, file: island.png }", widths[i]);
    g_assert_cmpint(draw_sample(&d, mapping, &error), ==, OPC_OK);
    picture m = load_picture("island.png", 0.5);
    g_assert_cmpint(m.width, ==, widths[i]);
    g_assert_cmpint(m.bottom - m.top, ==, m.right - m.left); /* a square */
    g_assert_cmpint(m.right - m.left, >, 9 * widths[i] / 10);
    check_fills(&m);
    check_lines(&m);
    check_bar(&m, SIDE, 100);
    cairo_surface_destroy(m.surface);
    drawing_clear(&d);
  }
}

/* The window fills the picture. */
static void test_window(void) {
  drawing d;
  opc_error error;
  make_sample(&d);
  g_assert_cmpint(
      draw_sample(&d,
                  "{ window: [0 nm, 0 nm, 500 nm, 250 nm], width: 800, "
                  "file: part.png }",
                  &error),
      ==, OPC_OK);
  picture m = load_picture("part.png", 0.5);
  g_assert_cmpint(abs(m.right - m.left - 2 * (m.bottom - m.top)), <=, 2);
  g_assert_cmphex(pixel_at(&m, 500, 400, 200), ==, 0xffffff);
  g_assert_cmphex(pixel_at(&m, 500, 480, 150), !=, 0xffffff);
  g_assert_cmphex(pixel_at(&m, 500, 480, 90), ==, 0xffffff);
  check_bar(&m, 500, 50);
  cairo_surface_destroy(m.surface);
  /* A millionth of the window, inside a bar, has one colour. */
  g_assert_cmpint(draw_sample(&d,
                              "{ window: [200 nm, 600 nm, 201 nm, 601 nm], "
                              "width: 1000, file: deep.png }",
                              &error),
                  ==, OPC_OK);
  m = load_picture("deep.png", 0.5);
  for (int i = 0; i < 15; i++)
    g_assert_cmphex(pixel_at(&m, 1, 0.01 + 0.07 * i, 0.01 + 0.07 * i), ==,
                    pixel_at(&m, 1, 0.5, 0.5));
  g_assert_cmphex(pixel_at(&m, 1, 0.5, 0.5), !=, 0xffffff);
  cairo_surface_destroy(m.surface);
  drawing_clear(&d);
}

/* Without a window, the picture shows the whole layout with a margin. */
static void test_all(void) {
  drawing d;
  opc_error error;
  make_sample(&d);
  g_assert_cmpint(draw_sample(&d, "{}", &error), ==, OPC_OK);
  picture m = load_picture("mask.png", 0.5);
  g_assert_cmpint(m.width, ==, 1600);
  check_fills(&m); /* 100 nm around 100 .. 900, as with an equal window */
  cairo_surface_destroy(m.surface);
  drawing_clear(&d);
}

/* Transistors that fail, have no current, or are beyond the scale. */
static void test_failing(void) {
  drawing d;
  opc_error error;
  make_sample(&d);
  d.after[0] = 0;
  d.flags[0] = EDA_PRINT_OPEN;
  d.design[1] = 0;
  g_assert_cmpint(draw_sample(&d, "{ " WINDOW ", file: failing.png }", &error),
                  ==, OPC_OK);
  picture m = load_picture("failing.png", 0.5);
  g_assert_cmphex(pixel_at(&m, SIDE, 480, 400), ==, 0x2166ac);
  g_assert_cmpfloat(brightness(pixel_at(&m, SIDE, 500, 400)), <,
                    60); /* the cross */
  uint32_t unknown = pixel_at(&m, SIDE, 500, 600);
  g_assert_cmphex(unknown >> 16, ==, unknown & 255); /* grey */
  cairo_surface_destroy(m.surface);
  d.flags[0] = EDA_PRINT_NOTCH; /* a note, not a failure */
  g_assert_cmpint(draw_sample(&d, "{ " WINDOW ", file: failing.png }", &error),
                  ==, OPC_OK);
  m = load_picture("failing.png", 0.5);
  g_assert_cmpfloat(brightness(pixel_at(&m, SIDE, 500, 400)), >, 60);
  cairo_surface_destroy(m.surface);
  drawing_clear(&d);
}

/* Count the pixels of a colour from a row downwards. */
static int count_colour(const picture *m, int from, uint32_t colour) {
  int n = 0;
  for (int y = from; y < m->height; y++)
    for (int x = 0; x < m->width; x++) n += pixel(m, x, y) == colour;
  return n;
}

static picture draw_and_load(drawing *d, const char *more) {
  opc_error error;
  g_autofree char *map = g_strdup_printf("{ %s, file: state.png }", more);
  if (draw_sample(d, map, &error)) g_error("%s", error.message);
  return load_picture("state.png", 0.5);
}

/* Check the colours of both transistors. */
static void check_gates(drawing *d, const char *more, uint32_t first,
                        uint32_t second) {
  g_autofree char *map = g_strdup_printf(WINDOW ", %s", more);
  picture m = draw_and_load(d, map);
  g_assert_cmphex(pixel_at(&m, SIDE, 480, 400), ==, first);
  g_assert_cmphex(pixel_at(&m, SIDE, 520, 600), ==, second);
  cairo_surface_destroy(m.surface);
}

/* +2 and -1 % after correction, -20 % as drawn, on scales with these values at
   stops. */
static void test_states(void) {
  drawing d;
  make_sample(&d);
  check_gates(&d, "scale: auto", 0xb2182b, 0x92c5de);
  check_gates(&d, "scale: 4 %", 0xf4a582, 0xd1e5f0);
  check_gates(&d, "scale: 0.5 %", 0xb2182b, 0x2166ac);
  check_gates(&d, "state: before", 0x2166ac, 0x2166ac);
  d.after[1] = d.after[0]; /* 2 minus 20 */
  check_gates(&d, "state: difference, scale: 36 %", 0x92c5de, 0x92c5de);
  drawing_clear(&d);
}

/* The drawn mask has its own print and no outline. */
static void test_drawn_print(void) {
  drawing d;
  int where;
  make_sample(&d);
  eda_field drawn[LAYERS] = {[EDA_POLY] = d.print[EDA_POLY]};
  d.print[EDA_POLY] = (eda_field){0};
  d.mask.drawn_print = drawn;
  picture m = draw_and_load(&d, WINDOW ", state: before");
  check_print(&m);
  g_assert_cmpfloat(darkest_near(&m, 430, 200, 4, &where), >, 250);
  cairo_surface_destroy(m.surface);
  m = draw_and_load(&d, WINDOW ", state: after");
  g_assert_cmpfloat(darkest_near(&m, 430, 200, 4, &where), <, 200);
  cairo_surface_destroy(m.surface);
  d.print[EDA_POLY] = drawn[EDA_POLY];
  drawing_clear(&d);
}

/* In a window of 10 um a gate has a few pixels; in an inset, hundreds. */
static void test_insets(void) {
  static const char window[] = "window: [0 nm, 0 nm, 10 um, 10 um], width: 600";
  drawing d;
  make_sample(&d);
  picture with = draw_and_load(&d, window);
  g_autofree char *none = g_strdup_printf("%s, insets: 0", window);
  picture without = draw_and_load(&d, none);
  g_assert_cmpint(with.height - without.height, >, 600 / 5);
  /* 100 x 200 nm of 1000 nm and 140 pixels. */
  g_assert_cmpint(count_colour(&with, with.bottom + 2, 0xb2182b), >, 200);
  g_assert_cmpint(count_colour(&without, without.bottom + 2, 0xb2182b), <, 60);
  cairo_surface_destroy(with.surface);
  cairo_surface_destroy(without.surface);
  drawing_clear(&d);
}

/* One violation has a ring; with very many, the layout stays visible. */
static void test_violations(void) {
  enum { MANY = 20000 };
  drawing d;
  make_sample(&d);
  g_autofree eda_violation *v = g_new0(eda_violation, MANY);
  for (int i = 0; i < MANY; i++) {
    int x = i % 100, y = i / 100;
    v[i] = (eda_violation){"extension", -1, 5 + 10 * x, 5 + 5 * y, 0, 0};
  }
  v[0].x = 200, v[0].y = 600;
  d.mask.violations = v;
  d.mask.n_violations = 1;
  picture m = draw_and_load(&d, WINDOW);
  g_assert_cmpint(count_colour(&m, m.top, 0xd94019), >, 50);
  cairo_surface_destroy(m.surface);
  m = draw_and_load(&d, WINDOW ", state: before"); /* no violations before
                                                      correction */
  g_assert_cmpint(count_colour(&m, m.top, 0xd94019), ==, 0);
  cairo_surface_destroy(m.surface);
  d.mask.n_violations = MANY;
  m = draw_and_load(&d, WINDOW);
  int white = count_colour(&m, m.top, 0xffffff);
  g_assert_cmpint(white, >, (m.right - m.left) * (m.bottom - m.top) / 4);
  cairo_surface_destroy(m.surface);
  drawing_clear(&d);
}

/* A drawn contact layer and a corrected third layer have their own colours;
   other layers are not shown. */
static void test_layers(void) {
  drawing d;
  opc_error error;
  make_sample(&d);
  d.drawn_shapes[CONTACT] = d.drawn_shapes[METAL] = (eda_shapes){0};
  rectangle(&d.drawn[CONTACT], 120, 320, 180, 380);
  rectangle(&d.drawn[METAL], 20, 20, 380, 280);
  rectangle(&d.mask_of[METAL], 10, 10, 390, 290);
  d.drawn_shapes[CONTACT] = d.drawn[CONTACT].shapes;
  d.drawn_shapes[METAL] = d.drawn[METAL].shapes;
  g_assert_cmpint(draw_sample(&d, "{ " WINDOW ", file: layers.png }", &error),
                  ==, OPC_OK);
  picture m = load_picture("layers.png", 0.5);
  g_assert_cmphex(pixel_at(&m, SIDE, 150, 350), ==, 0xbcbcbc);
  g_assert_cmphex(pixel_at(&m, SIDE, 200, 150), ==, 0xffffff);
  int height = m.height;
  cairo_surface_destroy(m.surface);
  d.corrected[METAL] = 1;
  d.mask_shapes[METAL] = d.mask_of[METAL].shapes;
  d.print[METAL] = island(-1.8);
  g_assert_cmpint(draw_sample(&d, "{ " WINDOW ", file: layers.png }", &error),
                  ==, OPC_OK);
  m = load_picture("layers.png", 0.5);
  uint32_t metal = pixel_at(&m, SIDE, 200, 150),
           edge = pixel_at(&m, SIDE, 10, 150);
  int where;
  g_assert_cmphex(metal, !=, 0xffffff);
  g_assert_cmphex(metal, !=, pixel_at(&m, SIDE, 500, 200)); /* poly */
  g_assert_cmphex(metal, !=, pixel_at(&m, SIDE, 800, 600)); /* active */
  g_assert_cmpfloat(brightness(edge), <, brightness(metal) - 30);
  double least = acos(-0.8) / (2 * M_PI) *
                 SIDE; /* x of the contour of the third layer, at y = 500 */
  g_assert_cmpfloat(darkest_near(&m, least, 500, 8, &where), <, 100);
  g_assert_cmpint(ABS(where), <=, 1);
  g_assert_cmpint(m.height, >=,
                  height); /* the legend has a further line for the layer */
  cairo_surface_destroy(m.surface);
  drawing_clear(&d);
}

static void test_formats(void) {
  static const struct {
    const char *file, *begin;
  } formats[] = {{"a.png", "\x89PNG"},
                 {"a.svg", "<?xml"},
                 {"a.PDF", "%PDF-"},
                 {"sub/a.svg", "<?xml"}};
  drawing d;
  opc_error error;
  make_sample(&d);
  for (size_t i = 0; i < G_N_ELEMENTS(formats); i++) {
    g_autofree char *path =
        g_build_filename(opc_test_folder(), formats[i].file, NULL);
    g_autofree char *mapping = g_strdup_printf("{ file: %s }", formats[i].file);
    char *content[2];
    size_t size[2];
    for (int k = 0; k < 2; k++) { /* the same bytes each time */
      g_assert_cmpint(draw_sample(&d, mapping, &error), ==, OPC_OK);
      g_assert_true(g_file_get_contents(path, &content[k], &size[k], NULL));
      g_assert_true(g_str_has_prefix(content[k], formats[i].begin));
    }
    g_assert_cmpmem(content[0], size[0], content[1], size[1]);
    g_free(content[0]);
    g_free(content[1]);
  }
  drawing_clear(&d);
}

/* A malicious name, and a picture too narrow for it. */
static void test_names(void) {
  drawing d;
  opc_error error;
  make_sample(&d);
  g_autofree char *name = g_strnfill(5000, 'W');
  name[3] = (char)0xff;
  d.gates.name = name;
  g_assert_cmpint(draw_sample(&d, "{ width: 200, file: name.png }", &error), ==,
                  OPC_OK);
  picture m = load_picture("name.png", 0.5);
  for (int y = 0; y < m.height; y++)
    g_assert_cmphex(pixel(&m, m.width - 1, y), ==, 0xffffff);
  cairo_surface_destroy(m.surface);
  drawing_clear(&d);
}

/* ---- refusals ---- */

static void assert_refused(const char *mapping, const char *parameter,
                           const char *reason) {
  opc_error error;
  g_autoptr(opc_module) m = opc_test_module("draw.mask", mapping, &error);
  g_assert_null(m);
  g_assert_cmpint(error.code, ==, OPC_INVALID);
  if (!strstr(error.message, parameter) || !strstr(error.message, reason))
    g_error("'%s' names neither '%s' nor '%s'", error.message, parameter,
            reason);
}

static void test_refused(void) {
  assert_refused("{ file: mask.jpg }", "'mask.jpg'", ".png, .svg or .pdf");
  assert_refused("{ file: png }", "'png'", ".png, .svg or .pdf");
  assert_refused("{ window: [0 nm, 0 nm, 1 um] }", "window",
                 "must be 4 lengths");
  assert_refused("{ window: [0 nm, 1 um, 1 um, 1 um] }", "window",
                 "at least 1 nm");
  assert_refused("{ window: [1 um, 0 nm, 0 nm, 1 um] }", "window",
                 "at least 1 nm");
  assert_refused("{ window: [-1e30 nm, 0 nm, 0 nm, 1 um] }", "window",
                 "outside of the range");
  assert_refused("{ width: 100 }", "width", "200");
  assert_refused("{ scale: 2 }", "scale", "a percentage above 0");
  assert_refused("{ scale: -2 % }", "scale", "a percentage above 0");
  assert_refused("{ scale: some }", "scale", "a percentage above 0");
  assert_refused("{ state: now }", "state", "before");
}

static void test_nothing_there(void) {
  drawing d;
  opc_error error;
  make_sample(&d);
  g_assert_cmpint(
      draw_sample(&d, "{ window: [2 um, 0 nm, 3 um, 1 um] }", &error), ==,
      OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "window");
  g_assert_nonnull(strstr(error.message, "(100, 100) to (900, 900) nm"));
  d.gates.extent = (eda_box){1, 1, 0, 0};
  g_assert_cmpint(draw_sample(&d, "{}", &error), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "cannot be drawn"));
  drawing_clear(&d);
}

/* Missing write permission. */
static void test_unwritable(void) {
  drawing d;
  opc_error error;
  make_sample(&d);
  g_autofree char *path = g_build_filename(opc_test_folder(), "dir.png", NULL);
  g_assert_cmpint(g_mkdir_with_parents(path, 0777), ==, 0);
  g_assert_cmpint(draw_sample(&d, "{ file: dir.png }", &error), ==, OPC_IO);
  g_assert_nonnull(strstr(error.message, "dir.png': Is a directory"));
  /* A full disk, in every format. */
  static const char *const full[] = {"full.png", "full.svg", "full.pdf"};
  for (size_t i = 0; i < G_N_ELEMENTS(full); i++) {
    g_autofree char *link = g_build_filename(opc_test_folder(), full[i], NULL);
    if (symlink("/dev/full", link)) g_error("no link '%s'", link);
    g_autofree char *mapping = g_strdup_printf("{ file: %s }", full[i]);
    g_assert_cmpint(draw_sample(&d, mapping, &error), ==, OPC_IO);
    g_assert_nonnull(strstr(error.message, "No space left on device"));
  }
  drawing_clear(&d);
}

/* A cancelled run leaves no file. */
static void test_cancelled(void) {
  drawing d;
  opc_error error;
  make_sample(&d);
  opc_test_cancel(TRUE);
  g_assert_cmpint(draw_sample(&d, "{ file: never.svg }", &error), ==,
                  OPC_CANCELLED);
  opc_test_cancel(FALSE);
  g_autofree char *path =
      g_build_filename(opc_test_folder(), "never.svg", NULL);
  g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
  drawing_clear(&d);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/mask/png", test_png);
  g_test_add_func("/mask/window", test_window);
  g_test_add_func("/mask/all", test_all);
  g_test_add_func("/mask/failing", test_failing);
  g_test_add_func("/mask/states", test_states);
  g_test_add_func("/mask/drawn-print", test_drawn_print);
  g_test_add_func("/mask/insets", test_insets);
  g_test_add_func("/mask/violations", test_violations);
  g_test_add_func("/mask/layers", test_layers);
  g_test_add_func("/mask/formats", test_formats);
  g_test_add_func("/mask/names", test_names);
  g_test_add_func("/mask/refused", test_refused);
  g_test_add_func("/mask/nothing-there", test_nothing_there);
  g_test_add_func("/mask/unwritable", test_unwritable);
  g_test_add_func("/mask/cancelled", test_cancelled);
  return g_test_run();
}
