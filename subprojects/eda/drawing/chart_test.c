/* SPDX-License-Identifier: BSD-3-Clause */
/* Charts and legends, read back from files: colours at known positions, and
   equal files. */
#include <eda/drawing.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static char *folder;
static const eda_colour red = EDA_COLOUR(0xff0000);

static char *path_of(const char *name) {
  return g_build_filename(folder, name, NULL);
}

/* Return a chart of 0 .. 10 nm and 1 uA .. 1 A with a line through its decades
   that has a gap. */
static eda_chart chart_on(const eda_paper *paper) {
  return (eda_chart){.paper = paper,
                     .left = 100,
                     .top = 50,
                     .width = 400,
                     .height = 300,
                     .title = "title",
                     .x = {.low = 0, .high = 10, .title = "length, nm"},
                     .y = {.low = 1e-6, .high = 1, .log = 1, .unit = "A"}};
}

static void chart_draw(const char *path) {
  static const double x[] = {0, 2, 4, 6, 8, 10};
  static const double y[] = {1e-6, 1e-5, 1e-4, NAN, 1e-2, 0.1};
  opc_error error;
  eda_paper *paper = eda_paper_open(path, 600, 420, 15, &error);
  if (!paper) g_error("%s", error.message);
  eda_chart c = chart_on(paper);
  eda_chart_axes(&c);
  eda_chart_line(&c, red, 3, 0, x, y, 6);
  eda_ring(paper, eda_chart_x(&c, 8), eda_chart_y(&c, 1e-5));
  g_assert_cmpint(eda_paper_close(paper, OPC_OK, &error), ==, OPC_OK);
}

static uint32_t pixel(cairo_surface_t *s, double x, double y) {
  const unsigned char *data = cairo_image_surface_get_data(s);
  uint32_t value;
  memcpy(&value,
         data + (ptrdiff_t)y * cairo_image_surface_get_stride(s) +
             4 * (ptrdiff_t)x,
         4);
  return value & 0xffffff;
}

static void test_places(void) {
  g_autofree char *path = path_of("places.png");
  chart_draw(path);
  cairo_surface_t *s = cairo_image_surface_create_from_png(path);
  g_assert_cmpint(cairo_surface_status(s), ==, CAIRO_STATUS_SUCCESS);
  /* A decade of the line is 50 pixels high and 80 wide. */
  g_assert_cmphex(pixel(s, 140, 325), ==, 0xff0000);
  g_assert_cmphex(pixel(s, 220, 275), ==, 0xff0000);
  g_assert_cmphex(pixel(s, 300, 225), ==, 0xffffff); /* the gap is white */
  g_assert_cmphex(pixel(s, 460, 125), ==, 0xff0000);
  /* The frame is sharp and has the colour of ink. */
  g_assert_cmphex(pixel(s, 99, 333), ==, 0x202020);
  g_assert_cmphex(pixel(s, 98, 333), ==, 0xffffff);
  g_assert_cmphex(pixel(s, 500, 333), ==, 0x202020);
  cairo_surface_destroy(s);
}

static int brightness(uint32_t colour) {
  return (int)((colour >> 16) + (colour >> 8 & 255) + (colour & 255));
}

static int is_near(uint32_t a, uint32_t b) {
  for (int shift = 0; shift <= 16; shift += 8)
    if (abs((int)(a >> shift & 255) - (int)(b >> shift & 255)) > 16) return 0;
  return 1;
}

/* A heat map: the brightness rises with the figure, in the map and in the scale
   beside the map; a cell without a figure is grey with a cross. A band fills
   its area only, between figures. */
static void test_field(void) {
  static const char *const labels[] = {"a", "b"};
  static const double figures[] = {0, 4, NAN, 2}; /* [x * 2 + y] */
  static const double x[] = {-0.5, 0.5, 1.5}, low[] = {0, 0, NAN},
                      high[] = {0.5, 0.5, 0.5};
  g_autofree char *path = path_of("field.png");
  opc_error error;
  eda_paper *paper = eda_paper_open(path, 600, 420, 15, &error);
  g_assert_nonnull(paper);
  eda_chart c = chart_on(paper);
  const eda_axis of = {.low = 0, .high = 4};
  eda_axis_label(&c.x, labels, 2);
  c.y = (eda_axis){.low = 0};
  eda_axis_label(&c.y, labels, 2);
  eda_chart_field(&c, &of, figures);
  eda_chart_band(&c, red, x, low, high, 3);
  eda_ring(paper, 30, 30); /* outside of the chart */
  g_assert_cmpint(eda_paper_close(paper, OPC_OK, &error), ==, OPC_OK);
  cairo_surface_t *s = cairo_image_surface_create_from_png(path);
  g_assert_true(is_near(pixel(s, 38, 30), 0xd94019));
  /* The cells are 200 pixels wide and 150 high; the second row is above. */
  uint32_t least = pixel(s, 180, 330), most = pixel(s, 180, 100),
           middle = pixel(s, 380, 60);
  g_assert_cmphex(pixel(s, 380, 330), ==, 0xcccccc);
  g_assert_true(is_near(pixel(s, 400, 275), 0x202020)); /* the cross */
  /* The scale is 22 pixels from the map, 1.3 sizes of the font wide. */
  g_assert_true(is_near(pixel(s, 530, 349), least));
  g_assert_true(is_near(pixel(s, 530, 51), most));
  g_assert_true(is_near(pixel(s, 530, 199), middle));
  g_assert_cmpint(brightness(most), >, brightness(middle) + 100);
  g_assert_cmpint(brightness(middle), >, brightness(least) + 100);
  /* 60 % of red over the figure, above 0 and below 0.5. */
  uint32_t over = pixel(s, 180, 240), red_part = over >> 16;
  g_assert_cmpuint(red_part, ==,
                   (uint32_t)lround(0.6 * 255 + 0.4 * (least >> 16)));
  g_assert_cmphex(pixel(s, 180, 290), ==, least);
  g_assert_cmphex(pixel(s, 480, 240), ==, 0xcccccc);
  cairo_surface_destroy(s);
}

/* Files do not depend on earlier pictures of the process. */
static void test_equal_files(void) {
  static const char *const names[] = {"a.png", "a.svg", "a.pdf", "a.PDF"};
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++) {
    g_autofree char *path = path_of(names[i]);
    char *text[2];
    gsize size[2];
    for (int k = 0; k < 2; k++) {
      chart_draw(path);
      g_assert_true(g_file_get_contents(path, &text[k], &size[k], NULL));
    }
    g_assert_cmpmem(text[0], size[0], text[1], size[1]);
    g_free(text[0]);
    g_free(text[1]);
  }
}

static void test_axes(void) {
  const double values[] = {3, NAN, -1, 2};
  eda_axis a = {0};
  eda_axis_fit(&a, values, 4);
  g_assert_cmpfloat(a.low, ==, -1);
  g_assert_cmpfloat(a.high, ==, 3);
  g_assert_cmpfloat(eda_axis_place(&a, 1), ==, 0.5);
  eda_axis_widen(&a, 0.25, 0.1);
  g_assert_cmpfloat(a.low, ==, -2);
  g_assert_cmpfloat(a.high, ==, 4);
  eda_axis_fit(&a, values + 1, 1);
  eda_axis_widen(&a, 0, 1);
  g_assert_cmpfloat(a.low, ==, -1);
  g_assert_cmpfloat(a.high, ==, 1);
  a = (eda_axis){.low = 1, .high = 100, .log = 1};
  g_assert_cmpfloat(fabs(eda_axis_place(&a, 10) - 0.5), <, 1e-12);
  eda_axis_widen(&a, 0.5, 0);
  g_assert_cmpfloat(fabs(a.high - 1000), <, 1e-9);
}

/* Entries that do not fit continue on the next line; hostile texts are
   truncated. */
static void test_legend(void) {
  opc_error error;
  g_autofree char *path = path_of("legend.svg");
  g_autofree char *hostile = g_strnfill(5000, 'W');
  hostile[3] = (char)0xff;
  hostile[5] = '\n';
  eda_paper *paper = eda_paper_open(path, 200, 0, 10, &error);
  g_assert_nonnull(paper);
  for (int pass = 0; pass < 2; pass++) {
    eda_legend l;
    eda_legend_init(&l, paper, 0);
    eda_legend_add(&l, NULL, "one");
    g_assert_cmpfloat(l.height, ==, 16);
    eda_legend_add(&l, NULL, "two");
    g_assert_cmpfloat(l.height, ==, 16);
    eda_legend_add(&l, &(eda_sign){.kind = EDA_SIGN_FILL, .colour = red}, "%s",
                   hostile);
    g_assert_cmpfloat(l.height, ==, 32);
    if (!pass) eda_paper_cut(paper, 50);
  }
  g_assert_cmpint(eda_paper_close(paper, OPC_OK, &error), ==, OPC_OK);
}

/* Colours repeat after six layers, and are interpolated between stops. */
static void test_colours(void) {
  static const struct {
    double t;
    uint32_t diverging, sequential;
  } cases[] = {{-1, 0x2166ac, 0x081d58},     {0, 0x2166ac, 0x081d58},
               {0.0625, 0x327db8, 0x172976}, {0.5, 0xffffff, 0x41b6c4},
               {0.9375, 0xc43c3c, 0xf6fcc5}, {1, 0xb2182b, 0xffffd9},
               {7, 0xb2182b, 0xffffd9},      {NAN, 0x2166ac, 0x081d58}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    uint32_t a = eda_colour_packed(eda_diverging(cases[i].t)),
             b = eda_colour_packed(eda_sequential(cases[i].t));
    for (int shift = 0; shift <= 16; shift += 8) {
      g_assert_cmpint(abs((int)(a >> shift & 255) -
                          (int)(cases[i].diverging >> shift & 255)),
                      <=, 1);
      g_assert_cmpint(abs((int)(b >> shift & 255) -
                          (int)(cases[i].sequential >> shift & 255)),
                      <=, 1);
    }
  }
  g_assert_cmphex(eda_colour_packed(red), ==, 0xff0000);
  g_assert_cmphex(eda_colour_packed(eda_layer_fill(0)), ==, 0xdedede);
  g_assert_cmphex(eda_colour_packed(eda_layer_outline(1)), ==, 0x009e73);
  g_assert_cmphex(eda_colour_packed(eda_layer_contour(2)), ==, 0x5c1f42);
  for (size_t k = 0; k < 6; k++) {
    uint32_t fill = eda_colour_packed(eda_layer_fill(k)),
             line = eda_colour_packed(eda_layer_outline(k)),
             contour = eda_colour_packed(eda_layer_contour(k));
    g_assert_cmphex(eda_colour_packed(eda_layer_fill(k + 6)), ==, fill);
    g_assert_cmphex(eda_colour_packed(eda_layer_outline(k + 12)), ==, line);
    g_assert_cmphex(eda_colour_packed(eda_layer_contour(k + 6)), ==, contour);
    g_assert_cmpint(brightness(fill), >, brightness(line) + 100);
    g_assert_cmpint(brightness(line), >, brightness(contour) + 100);
  }
}

/* Symbols of legends, one below the other, with a font of 10 pixels: the base
   line is 11 pixels below the upper end of an entry. */
static void test_signs(void) {
  static const struct {
    eda_sign sign;
    double width;
  } cases[] = {
      {{.kind = EDA_SIGN_FILL, .colour = EDA_COLOUR(0xff0000)}, 16},
      {{.kind = EDA_SIGN_LINE,
        .colour = EDA_COLOUR(0xff0000),
        .line = 1,
        .dash = 4,
        .behind = EDA_COLOUR(0x0000ff),
        .behind_line = 3},
       16},
      {{.kind = EDA_SIGN_LINE, .colour = EDA_COLOUR(0xff0000), .line = 3}, 16},
      {{.kind = EDA_SIGN_CROSS, .colour = EDA_COLOUR(0xff0000)}, 16},
      {{.kind = EDA_SIGN_RING}, 12},
      {{.kind = EDA_SIGN_BAR, .size = 30}, 30},
      {{.kind = EDA_SIGN_RAMP, .ramp = eda_diverging, .low = "", .high = ""},
       80}};
  enum { N = G_N_ELEMENTS(cases), STEP = 20, BASE = 11 };
  opc_error error;
  g_autofree char *path = path_of("signs.png");
  eda_paper *paper = eda_paper_open(path, 200, N * STEP, 10, &error);
  g_assert_nonnull(paper);
  int m = (int)paper->margin;
  g_assert_cmpfloat(paper->margin, ==, m);
  for (int k = 0; k < N; k++) {
    eda_legend l;
    eda_legend_init(&l, paper, STEP * k);
    eda_legend_add(&l, &cases[k].sign, "%s", "");
    g_assert_cmpfloat(l.x, ==, m + cases[k].width + 5 + 16);
    g_assert_cmpfloat(l.height, ==, 16);
  }
  g_assert_cmpint(eda_paper_close(paper, OPC_OK, &error), ==, OPC_OK);
  cairo_surface_t *s = cairo_image_surface_create_from_png(path);
  /* Pixel (x, y) relative to the left end of the base line of entry k. */
#define PIXEL(k, x, y) pixel(s, m + (x), STEP * (k) + BASE + (y))
  /* A box of 16 by 9 with its outline. */
  g_assert_cmphex(PIXEL(0, 8, -4), ==, 0xff0000);
  g_assert_cmphex(PIXEL(0, 1, -7), ==, 0xff0000);
  g_assert_cmphex(PIXEL(0, 15, 0), ==, 0xff0000);
  g_assert_cmphex(PIXEL(0, 0, -4), ==, 0x9a9a9a);
  g_assert_cmphex(PIXEL(0, 16, -4), ==, 0x9a9a9a);
  g_assert_cmphex(PIXEL(0, 8, -8), ==, 0x9a9a9a);
  g_assert_cmphex(PIXEL(0, 8, 1), ==, 0x9a9a9a);
  g_assert_cmphex(PIXEL(0, 17, -4), ==, 0xffffff);
  g_assert_cmphex(PIXEL(0, 8, 2), ==, 0xffffff);
  /* Red dashes of 4 pixels over a blue line. */
  g_assert_cmphex(PIXEL(1, 1, -4), ==, 0xff0000);
  g_assert_cmphex(PIXEL(1, 5, -4), ==, 0x0000ff);
  g_assert_cmphex(PIXEL(1, 9, -4), ==, 0xff0000);
  g_assert_cmphex(PIXEL(1, 9, -3), ==, 0x0000ff);
  g_assert_cmphex(PIXEL(1, 15, -5), ==, 0x0000ff);
  g_assert_cmphex(PIXEL(1, 16, -4), ==, 0xffffff);
  g_assert_cmphex(PIXEL(1, 9, -6), ==, 0xffffff);
  g_assert_cmphex(PIXEL(2, 5, -4), ==, 0xff0000);
  g_assert_cmphex(PIXEL(2, 5, -3), ==, 0xff0000);
  /* Both diagonals of the box. */
  g_assert_cmpint(brightness(PIXEL(3, 8, -4)), <, 200);
  g_assert_cmpint(brightness(PIXEL(3, 1, -7)), <, 240);
  g_assert_cmpint(brightness(PIXEL(3, 1, 0)), <, 240);
  g_assert_cmphex(PIXEL(3, 3, -4), ==, 0xff0000);
  /* A ring of radius 5.5 around (6, -3.5). */
  g_assert_cmphex(PIXEL(4, 6, -4), ==, 0xffffff);
  g_assert_true(is_near(PIXEL(4, 11, -4), 0xd94019));
  g_assert_true(is_near(PIXEL(4, 0, -4), 0xd94019));
  g_assert_cmpint(brightness(PIXEL(4, 6, -9)), <, 420);
  g_assert_cmpint(brightness(PIXEL(4, 6, -7)), >, 700);
  g_assert_cmphex(PIXEL(4, 14, -4), ==, 0xffffff);
  /* A bar of 30 pixels with ends that point upwards. */
  g_assert_cmphex(PIXEL(5, 1, -3), ==, 0x202020);
  g_assert_cmphex(PIXEL(5, 28, -3), ==, 0x202020);
  g_assert_cmphex(PIXEL(5, 15, -4), ==, 0xffffff);
  g_assert_cmphex(PIXEL(5, 32, -3), ==, 0xffffff);
  g_assert_cmpint(brightness(PIXEL(5, 0, -4)), <, 500);
  g_assert_cmpint(brightness(PIXEL(5, 30, -4)), <, 500);
  g_assert_cmpint(brightness(PIXEL(5, 0, -2)), >, 700);
  /* A ramp of 70 pixels, 5 pixels from the label. */
  g_assert_true(is_near(PIXEL(6, 6, -4), 0x2166ac));
  g_assert_true(is_near(PIXEL(6, 40, -4), 0xffffff));
  g_assert_true(is_near(PIXEL(6, 74, -4), 0xb2182b));
  g_assert_cmphex(PIXEL(6, 5, -4), ==, 0x9a9a9a);
  g_assert_cmphex(PIXEL(6, 75, -4), ==, 0x9a9a9a);
  g_assert_cmphex(PIXEL(6, 77, -4), ==, 0xffffff);
  cairo_surface_destroy(s);
}

/* A heading is bold and larger; the font is then as before. */
static void test_heading(void) {
  opc_error error;
  g_autofree char *path = path_of("heading.png");
  eda_paper *paper = eda_paper_open(path, 200, 100, 10, &error);
  g_assert_nonnull(paper);
  cairo_text_extents_t before, after;
  cairo_text_extents(paper->cairo, "Heading", &before);
  g_assert_cmpfloat(eda_heading(paper, 50, "HHHH"), ==, 19);
  cairo_text_extents(paper->cairo, "Heading", &after);
  g_assert_cmpfloat(after.x_advance, ==, before.x_advance);
  g_assert_cmpfloat(after.height, ==, before.height);
  int m = (int)paper->margin;
  g_assert_cmpint(eda_paper_close(paper, OPC_OK, &error), ==, OPC_OK);
  cairo_surface_t *s = cairo_image_surface_create_from_png(path);
  /* Capital letters are about 10 pixels high above the base line at 62. */
  int top = 100, bottom = 0, left = 200, right = 0;
  for (int y = 0; y < 100; y++)
    for (int x = 0; x < 200; x++)
      if (brightness(pixel(s, x, y)) < 300) {
        top = MIN(top, y);
        bottom = MAX(bottom, y);
        left = MIN(left, x);
        right = MAX(right, x);
      }
  g_assert_cmpint(bottom, ==, 61);
  g_assert_cmpint(top, >=, 50);
  g_assert_cmpint(top, <=, 53);
  g_assert_cmpint(left, >=, m);
  g_assert_cmpint(left, <=, m + 3);
  g_assert_cmpint(right - left, >, 30);
  g_assert_cmpint(right - left, <, 56);
  cairo_surface_destroy(s);
}

/* A text that is too wide ends in "...". An .svg file has an element for each
   character, with the number of its glyph and its position. */
static void test_truncated(void) {
  static const char use[] = "<use xlink:href=\"#glyph0-";
  opc_error error;
  g_autofree char *path = path_of("truncated.svg");
  eda_paper *paper = eda_paper_open(path, 200, 40, 10, &error);
  g_assert_nonnull(paper);
  cairo_text_extents_t fits;
  cairo_text_extents(paper->cairo, "abc...", &fits);
  eda_text(paper, 20, 15, EDA_LEFT, INFINITY, "abc.defgh");
  eda_text(paper, 20, 30, EDA_LEFT, fits.x_advance + 0.5, "abc.defgh");
  g_assert_cmpint(eda_paper_close(paper, OPC_OK, &error), ==, OPC_OK);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  long glyph[15];
  const char *at = text;
  for (int i = 0; i < 15; i++) {
    at = strstr(at, use);
    g_assert_nonnull(at);
    at += strlen(use);
    glyph[i] = strtol(at, NULL, 10);
  }
  g_assert_null(strstr(at, use));
  for (int i = 0; i < 6; i++)
    g_assert_cmpint(glyph[9 + i], ==, glyph[MIN(i, 3)]);
}

static void test_refused(void) {
  opc_error error;
  g_assert_cmpint(eda_paper_check("a.jpg", "file", &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "file");
  g_assert_cmpint(eda_paper_check("a/png", "file", &error), ==, OPC_INVALID);
  g_assert_cmpint(eda_paper_check("a.Svg", "file", &error), ==, OPC_OK);
  g_assert_null(eda_paper_open(folder, 10, 10, 10, &error));
  g_assert_cmpint(error.code, ==, OPC_IO);
  /* An incomplete file is removed. */
  g_autofree char *path = path_of("begun.png");
  eda_paper *paper = eda_paper_open(path, 10, 10, 10, &error);
  g_assert_nonnull(paper);
  g_assert_cmpint(eda_paper_close(paper, OPC_CANCELLED, &error), ==,
                  OPC_CANCELLED);
  g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("eda-chart-XXXXXX", NULL);
  g_test_add_func("/chart/places", test_places);
  g_test_add_func("/chart/equal-files", test_equal_files);
  g_test_add_func("/chart/axes", test_axes);
  g_test_add_func("/chart/field", test_field);
  g_test_add_func("/chart/legend", test_legend);
  g_test_add_func("/chart/colours", test_colours);
  g_test_add_func("/chart/signs", test_signs);
  g_test_add_func("/chart/heading", test_heading);
  g_test_add_func("/chart/truncated", test_truncated);
  g_test_add_func("/chart/refused", test_refused);
  int code = g_test_run();
  GDir *dir = g_dir_open(folder, 0, NULL);
  for (const char *name; (name = g_dir_read_name(dir));) {
    g_autofree char *path = path_of(name);
    g_unlink(path);
  }
  g_dir_close(dir);
  g_rmdir(folder);
  return code;
}
