/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests pictures of synthetic settings: shades, rings and curves at known
   positions. */
#include <cairo.h>
#include <eda/settings.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

/* ---- settings ---- */

static const double lengths[] = {10, 12, 14}, counts[] = {1, 2};
static const char *const length_texts[] = {"10 nm", "12 nm", "14 nm"};
static const char *const count_texts[] = {"1", "2"};
static const eda_setting both[] = {
    {"mask.synthesizer.fragment", "nm", 3, lengths, length_texts},
    {"mask.max_iterations", NULL, 2, counts, count_texts}};

static eda_settings settings(const double *figure, size_t n_parameters,
                             size_t count, size_t best) {
  return (eda_settings){.n_parameters = n_parameters,
                        .parameters = both,
                        .count = count,
                        .figure = figure,
                        .name = "mask.ion_mean",
                        .unit = "%",
                        .best = best};
}

static int draw_sample(eda_settings *s, const char *mapping, opc_error *error) {
  g_autoptr(opc_module) m = opc_test_module("draw.surface", mapping, error);
  g_assert_nonnull(m);
  opc_test_input(m, "settings", s);
  void *none[1];
  return opc_test_run(m, none, error);
}

/* ---- pixels ---- */

static cairo_surface_t *picture(const char *name) {
  g_autofree char *path = g_build_filename(opc_test_folder(), name, NULL);
  cairo_surface_t *s = cairo_image_surface_create_from_png(path);
  g_assert_cmpint(cairo_surface_status(s), ==, CAIRO_STATUS_SUCCESS);
  return s;
}

static unsigned pixel(cairo_surface_t *s, double x, double y) {
  const unsigned char *data = cairo_image_surface_get_data(s);
  ptrdiff_t at =
      (ptrdiff_t)y * cairo_image_surface_get_stride(s) + 4 * (ptrdiff_t)x;
  return (unsigned)(data[at] + data[at + 1] + data[at + 2]);
}

/* Positions of cells, found from the edges of the plot: the first and last dark
   columns of a row. */
typedef struct cells {
  double left, top, width, height;
} cells;

static gboolean is_paper(cairo_surface_t *s, int x, int y) {
  return pixel(s, x, y) == 3 * 255;
}

/* Find the largest block without paper around its middle. */
static cells find_cells(cairo_surface_t *s) {
  int x = cairo_image_surface_get_width(s) / 2;
  int y = cairo_image_surface_get_height(s) / 2;
  int x0 = x, x1 = x, y0 = y, y1 = y;
  while (!is_paper(s, x0 - 1, y)) x0--;
  while (!is_paper(s, x1 + 1, y)) x1++;
  while (!is_paper(s, x, y0 - 1)) y0--;
  while (!is_paper(s, x, y1 + 1)) y1++;
  return (cells){x0 + 1, y0 + 1, x1 - x0 - 1, y1 - y0 - 1};
}

/* Return the shade at a quarter of the cell, outside of the ring in the
   middle. */
static unsigned shade(cairo_surface_t *s, const cells *c, int i, int k) {
  return pixel(s, c->left + c->width * (i + 0.25) / 3,
               c->top + c->height * (1 - (k + 0.25) / 2));
}

/* ---- tests ---- */

/* Larger figures are lighter; the best one has a ring. */
static void test_map(void) {
  const double figure[] = {6, 3, 5, 1, 4, 2};
  eda_settings s = settings(figure, 2, 6, 3);
  opc_error error;
  g_assert_cmpint(draw_sample(&s, "{ file: map.png }", &error), ==, OPC_OK);
  cairo_surface_t *p = picture("map.png");
  g_assert_cmpint(cairo_image_surface_get_width(p), ==, 1000);
  cells c = find_cells(p);
  g_assert_cmpfloat(c.width, >, 700);
  g_assert_cmpfloat(c.left, >, 40); /* the labels of the axis */
  for (int i = 0; i < 6; i++)
    for (int k = 0; k < 6; k++)
      if (figure[i] < figure[k])
        g_assert_cmpuint(shade(p, &c, i / 2, i % 2), <,
                         shade(p, &c, k / 2, k % 2));
  double x = c.left + c.width / 2, y = c.top + c.height / 4;
  double radius = 0.55 * 1000 / 60;
  unsigned inside = pixel(p, x, y), on = pixel(p, x + radius, y);
  g_assert_cmpuint(inside, ==, shade(p, &c, 1, 1));
  g_assert_cmpuint(on, >, inside + 100);
  cairo_surface_destroy(p);
}

/* The middle one of three parameters has its best value. */
static void test_between(void) {
  const double figure[] = {9, 9, 3, 4, 9, 9, 5, 1, 9, 9, 6, 7};
  const eda_setting three[] = {both[0], both[1], both[1]};
  eda_settings s = settings(figure, 3, 12, 7);
  s.parameters = three;
  opc_error error;
  g_assert_cmpint(draw_sample(&s, "{ file: between.png }", &error), ==, OPC_OK);
  cairo_surface_t *p = picture("between.png");
  cells c = find_cells(p);
  static const int ascending[][2] = {{1, 1}, {0, 0}, {0, 1},
                                     {1, 0}, {2, 0}, {2, 1}};
  for (size_t i = 1; i < G_N_ELEMENTS(ascending); i++)
    g_assert_cmpuint(shade(p, &c, ascending[i - 1][0], ascending[i - 1][1]), <,
                     shade(p, &c, ascending[i][0], ascending[i][1]));
  cairo_surface_destroy(p);
}

/* Count coloured pixels in a region; text and frames have none. */
static int count_coloured(cairo_surface_t *s, int x0, int y0, int x1, int y1) {
  const unsigned char *data = cairo_image_surface_get_data(s);
  int n = 0;
  for (int y = y0; y < y1; y++)
    for (int x = x0; x < x1; x++) {
      const unsigned char *at =
          data + (ptrdiff_t)y * cairo_image_surface_get_stride(s) + 4 * x;
      n += at[0] != at[1] || at[1] != at[2];
    }
  return n;
}

/* A curve extends from its first to its last dot. */
static void test_curve(void) {
  const double figure[] = {3, 2, 1};
  eda_settings s = settings(figure, 1, 3, 2);
  opc_error error;
  g_assert_cmpint(draw_sample(&s, "{ file: falling.png }", &error), ==, OPC_OK);
  cairo_surface_t *p = picture("falling.png");
  int w = cairo_image_surface_get_width(p);
  int h = cairo_image_surface_get_height(p);
  g_assert_cmpint(count_coloured(p, w / 5, 6 * h / 10, w / 2, h), ==, 0);
  g_assert_cmpint(count_coloured(p, 6 * w / 10, h / 8, w, h / 2), ==, 0);
  g_assert_cmpint(count_coloured(p, w / 5, h / 8, w / 2, h / 2), >, 300);
  cairo_surface_destroy(p);
}

/* A setting without a figure is grey; the others are unchanged. */
static void test_missing(void) {
  const double figure[] = {6, 3, NAN, 1, 4, 2};
  eda_settings s = settings(figure, 2, 6, 3);
  opc_error error;
  g_assert_cmpint(draw_sample(&s, "{ file: missing.png, scale: log }", &error),
                  ==, OPC_OK);
  cairo_surface_t *p = picture("missing.png");
  cells c = find_cells(p);
  unsigned grey = pixel(p, c.left + c.width / 2, c.top + c.height * 0.55);
  g_assert_cmpuint(grey, ==, 3 * 204);
  cairo_surface_destroy(p);
}

/* Equal settings give equal files, in every format. */
static void test_formats(void) {
  const double figure[] = {6, 3, 5};
  eda_settings s = settings(figure, 1, 3, 1);
  static const char *const ends[] = {"png", "svg", "pdf"};
  for (size_t i = 0; i < G_N_ELEMENTS(ends); i++) {
    char *text[2];
    gsize length[2];
    for (int k = 0; k < 2; k++) {
      opc_error error;
      g_autofree char *name = g_strdup_printf("curve%d.%s", k, ends[i]);
      g_autofree char *mapping = g_strdup_printf("{ file: %s }", name);
      g_autofree char *path = g_build_filename(opc_test_folder(), name, NULL);
      g_assert_cmpint(draw_sample(&s, mapping, &error), ==, OPC_OK);
      g_assert_true(g_file_get_contents(path, &text[k], &length[k], NULL));
    }
    g_assert_cmpmem(text[0], length[0], text[1], length[1]);
    g_free(text[0]);
    g_free(text[1]);
  }
}

static void assert_refused(const double *figure, const char *mapping,
                           const char *parameter) {
  eda_settings s = settings(figure, 2, 6, 0);
  opc_error error;
  g_assert_cmpint(draw_sample(&s, mapping, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, parameter);
}

static void test_refused(void) {
  const double zero[] = {0, 3, 5, 1, 4, 2};
  const double none[] = {NAN, NAN, NAN, NAN, NAN, NAN};
  const double wild[] = {1, INFINITY, 1, 1, 1, 1};
  assert_refused(zero, "{ scale: log }", "scale");
  assert_refused(none, "{}", "settings");
  assert_refused(wild, "{}", "settings");
  eda_settings few = settings(wild, 2, 5, 0);
  opc_error fault;
  g_assert_cmpint(draw_sample(&few, "{}", &fault), ==, OPC_INVALID);
  g_assert_nonnull(strstr(fault.message, "5 values for 6 settings"));
  opc_error error;
  g_assert_null(opc_test_module("draw.surface", "{ file: a.jpg }", &error));
  g_assert_nonnull(strstr(error.message, ".png, .svg or .pdf"));
}

/* Equal figures, and a scale over many decades. */
static void test_scales(void) {
  const double equal[] = {2, 2, 2, 2, 2, 2};
  const double wide[] = {1e-200, 1, 1e10, 1e100, 1e200, 1e-3};
  const double below[] = {-3, 3, 5, 1, 4, 2};
  const double *all[] = {equal, wide, below};
  for (size_t i = 0; i < 3; i++)
    for (int log = 0; log < 2; log++) {
      if (i == 2 && log) continue;
      eda_settings s = settings(all[i], 2, 6, 0);
      opc_error error;
      g_autofree char *mapping = g_strdup_printf(
          "{ file: s%zu%d.png, scale: %s }", i, log, log ? "log" : "linear");
      g_assert_cmpint(draw_sample(&s, mapping, &error), ==, OPC_OK);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/surface/map", test_map);
  g_test_add_func("/surface/between", test_between);
  g_test_add_func("/surface/curve", test_curve);
  g_test_add_func("/surface/missing", test_missing);
  g_test_add_func("/surface/formats", test_formats);
  g_test_add_func("/surface/refused", test_refused);
  g_test_add_func("/surface/scales", test_scales);
  return g_test_run();
}
