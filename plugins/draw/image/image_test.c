/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests images with closed forms and the distances of their contours, the
   distances with real optics, and colours at known positions of the picture. */
#include <eda/gates.h>
#include <eda/litho.h>
#include <eda/memory.h>
#include <math.h>
#include <string.h>

#include "../picture_test.h"

/* ---- gates: four vertical lines, in a field of 1000 x 1000 nm ---- */

enum { GATES = 4, SIDE = 1000 };
static const double pitch = 250, drawn = 65;

typedef struct lines {
  eda_point points[4 * GATES];
  uint32_t start[GATES + 1];
  eda_box box[GATES];
  uint8_t axis[GATES];
  double length[GATES], width[GATES], space[2 * GATES];
  eda_shapes layers[2]; /* as drawn */
  eda_gates gates;
} lines;

static char *const layer[] = {"poly", "active"};

static void make_sample(lines *l) {
  memset(l, 0, sizeof *l);
  for (int i = 0; i < GATES; i++) {
    int32_t x0 = (int32_t)(2 * (125 - drawn / 2 + pitch * i));
    int32_t x1 = x0 + (int32_t)(2 * drawn);
    eda_point p[] = {{x0, 0}, {x1, 0}, {x1, 2 * SIDE}, {x0, 2 * SIDE}};
    memcpy(l->points + 4 * i, p, sizeof p);
    l->start[i + 1] = 4 * (uint32_t)(i + 1);
    l->box[i] = (eda_box){x0, 800, x1, 1200};
    l->length[i] = drawn;
    l->width[i] = 200;
    l->space[2 * i] = l->space[2 * i + 1] = pitch - drawn;
  }
  l->layers[EDA_POLY] = (eda_shapes){GATES, l->start, l->points, NULL};
  l->gates = (eda_gates){.name = "LINES",
                         .layers = 2,
                         .layer = (char **)layer,
                         .drawn = l->layers,
                         .grid = 0.5,
                         .extent = {0, 0, 2 * SIDE, 2 * SIDE},
                         .count = GATES,
                         .box = l->box,
                         .axis = l->axis,
                         .length = l->length,
                         .width = l->width,
                         .space = l->space};
}

/* ---- images in closed form ---- */

/* Image 0.5 - deep cos(2 pi (x - 125) / pitch) + uneven cos(pi (x - 125) /
   pitch). With `uneven`, every second line is less dark. `slope` rotates the
   image, with whole periods along y in a field of SIDE. */
typedef struct waves {
  double deep, uneven;
  int slope;
  double fault; /* added to one value */
} waves;

static double intensity(const waves *w, double x, double y) {
  double phase = (x - 125) / pitch + w->slope * y / SIDE;
  return 0.5 - w->deep * cos(2 * M_PI * phase) + w->uneven * cos(M_PI * phase);
}

static int no_preparation(void *self, opc_error *error) {
  (void)self;
  (void)error;
  return OPC_OK;
}

static double some_band(const void *self) {
  (void)self;
  return 0.005;
}

static int waves_image(const void *self, int which, const eda_spectrum *mask,
                       eda_field *out, opc_error *error) {
  (void)error;
  const waves *w = self;
  (void)which;
  eda_frame f = mask->frame;
  *out = (eda_field){.frame = f, .nx = 100, .ny = 100};
  out->coefficients = eda_alloc(10000, sizeof(float));
  for (size_t y = 0; y < 100; y++)
    for (size_t x = 0; x < 100; x++)
      out->coefficients[100 * y + x] =
          (float)intensity(w, f.x0 + f.width * (double)x / 100,
                           f.y0 + f.height * (double)y / 100);
  eda_field_from_samples(NULL, out);
  out->coefficients[7] += (float)w->fault;
  return OPC_OK;
}

static const eda_litho waves_functions = {
    .prepare = no_preparation, .band = some_band, .image = waves_image};

#define PAIR(group, threshold)                             \
  group                                                    \
      ": { litho: { use: litho.hopkins }, resist: { use: " \
      "resist.threshold, threshold: " #threshold ", active_threshold: 0.3 } }"

/* Run draw.image. If `w` is not NULL, the waves are the optics of all n
   models. */
static int draw_sample(const char *mapping, const waves *w, int n, lines *l,
                       opc_error *error) {
  static const char *const names[] = {"first.litho", "second.litho"};
  void *none[1];
  opc_module model = {&waves_functions, (void *)w, "litho.waves"};
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("draw.image", mapping, error);
  if (!m) return error->code;
  for (int k = 0; w && k < n; k++) opc_test_input(m, names[k], &model);
  opc_test_input(m, "gates", &l->gates);
  return opc_test_run(m, none, error);
}

static void must_draw(const char *mapping, const waves *w, int n, lines *l) {
  opc_error error;
  if (draw_sample(mapping, w, n, l, &error)) g_error("%s", error.message);
}

static double column_value(const char *column, size_t row) {
  return opc_test_number("models", column, row);
}

static void close_to(double value, double want, double tolerance) {
  if (!(fabs(value - want) <= tolerance))
    g_error("%.9g is not within %g of %.9g", value, tolerance, want);
}

/* ---- distances ---- */

/* Return half of the width of a line printed below a threshold. */
static double half(const waves *w, double threshold) {
  return pitch / (2 * M_PI) * acos((0.5 - threshold) / w->deep);
}

#define FRAME "margin: 0 nm, window: [20 nm, 100 nm, 980 nm, 900 nm]"

static void test_same(void) {
  lines l;
  make_sample(&l);
  must_draw("{ " FRAME
            ", width: 300, " PAIR("first", 0.4) ", " PAIR("second", 0.4) " }",
            NULL, 0, &l);
  g_assert_cmpuint(opc_test_rows("models"), ==, 2);
  g_assert_cmpstr(opc_test_text("models", "model", 1), ==,
                  "hopkins, threshold");
  for (size_t k = 0; k < 2; k++) {
    g_assert_cmpfloat(column_value("rms", k), ==, 0);
    g_assert_cmpfloat(column_value("max", k), ==, 0);
    g_assert_cmpfloat(column_value("mean", k), ==, 0);
  }
  g_assert_cmpfloat(column_value("cd", 0), ==, column_value("cd", 1));
  g_assert_cmpfloat(opc_test_metric("max"), ==, 0);
}

/* Another threshold shifts the contours along the slope of the image. */
static void test_shift(void) {
  lines l;
  make_sample(&l);
  waves w = {.deep = 0.45};
  must_draw("{ " FRAME
            ", width: 300, " PAIR("first", 0.4) ", " PAIR("second", 0.41) " }",
            &w, 2, &l);
  double first = half(&w, 0.4), second = half(&w, 0.41), away = second - first;
  double slope = w.deep * 2 * M_PI / pitch * sin(2 * M_PI * first / pitch);
  close_to(away, 0.01 / slope, 0.01 * away);
  close_to(column_value("rms", 1), away, 1e-4);
  close_to(column_value("max", 1), away, 2e-4);
  close_to(column_value("mean", 1), away, 1e-4);
  close_to(column_value("cd", 0), 2 * first, 1e-3);
  close_to(column_value("cd", 1), 2 * second, 1e-3);
  close_to(column_value("ils", 0), slope / 0.4, 1e-5);
  close_to(column_value("nils", 0), drawn * slope / 0.4, 1e-3);
  close_to(column_value("intensity_low", 1), 0.41, 1e-4);
  close_to(column_value("intensity_high", 1), 0.41, 1e-4);
  close_to(opc_test_metric("rms"), away, 1e-3);
  /* With the models in the opposite order, less is printed. */
  must_draw("{ " FRAME
            ", width: 300, " PAIR("first", 0.41) ", " PAIR("second", 0.4) " }",
            &w, 2, &l);
  close_to(column_value("mean", 1), -away, 1e-4);
}

/* Distances are perpendicular to the contour in any direction. */
static void test_slanted(void) {
  lines l;
  make_sample(&l);
  for (int slope = 1; slope <= 4; slope++) {
    waves w = {.deep = 0.45, .slope = slope};
    must_draw("{ " FRAME
              ", width: 300, " PAIR("first", 0.4) ", " PAIR("second", 0.5) " }",
              &w, 2, &l);
    double turned = hypot(1 / pitch, (double)slope / SIDE) * pitch;
    double away = (half(&w, 0.5) - half(&w, 0.4)) / turned;
    g_assert_cmpfloat(away, >, 5);
    close_to(column_value("rms", 1), away, 3e-4);
    close_to(column_value("max", 1), away, 1e-3);
  }
}

/* Return the position between `from` and `to` where the image of uneven lines
   passes a level. */
static double crossing(const waves *w, double level, double from, double to) {
  double sign = intensity(w, from, 0) < level ? 1 : -1;
  for (int i = 0; i < 60; i++) {
    double middle = (from + to) / 2;
    if (sign * (intensity(w, middle, 0) - level) < 0)
      from = middle;
    else
      to = middle;
  }
  return from;
}

/* For lines that only one model prints, the distance is that to the nearest
   contour of the other model, in either order of the models. Models without
   contours have no distance. */
static void test_missing(void) {
  static const char *const both_ways[] = {
      "{ " FRAME
      ", width: 300, " PAIR("first", 0.15) ", " PAIR("second", 0.3) " }",
      "{ " FRAME
      ", width: 300, " PAIR("first", 0.3) ", " PAIR("second", 0.15) " }"};
  lines l;
  make_sample(&l);
  waves w = {.deep = 0.3, .uneven = 0.08}; /* lines of 0.28 and 0.12 */
  /* The line at 375 prints in both images, the line at 125 only at 0.3. The
     contour nearest to its left edge is that of the first line. */
  double left = crossing(&w, 0.3, 125, 20);
  double other = crossing(&w, 0.15, 375, 250);
  for (int k = 0; k < 2; k++) {
    must_draw(both_ways[k], &w, 2, &l);
    close_to(column_value("max", 1), other - left, 0.01);
    close_to(column_value("x", 1), left, 0.1);
    g_assert_cmpint((int)column_value("failed", k), ==, 2);
    g_assert_cmpint((int)column_value("failed", 1 - k), ==, 0);
  }
  must_draw("{ " FRAME
            ", width: 300, " PAIR("first", 0.3) ", " PAIR("second", 0.05) " }",
            &w, 2, &l);
  g_assert_true(isnan(column_value("max", 1)) && isnan(column_value("cd", 1)));
  g_assert_cmpint((int)column_value("failed", 1), ==, GATES);
  g_assert_true(isnan(opc_test_metric("max")));
}

/* With real optics, distances follow the slopes in the table. */
static void test_optics(void) {
  lines l;
  make_sample(&l);
  must_draw(
      "{ margin: 0 nm, width: 300, window: [200 nm, 100 nm, 300 nm, "
      "900 nm], " PAIR("first", 0.4) ", " PAIR("second", 0.404) " }",
      NULL, 0, &l);
  g_assert_true(isnan(column_value("cd", 0))); /* between gates */
  must_draw("{ " FRAME
            ", width: 300, " PAIR("first", 0.4) ", " PAIR("second", 0.404) " }",
            NULL, 0, &l);
  double away =
      0.004 / (0.402 * (column_value("ils", 0) + column_value("ils", 1)) / 2);
  g_test_message("moved by %.4f nm, slope says %.4f nm", column_value("rms", 1),
                 away);
  close_to(column_value("cd", 1) - column_value("cd", 0), 2 * away, 0.004);
  close_to(column_value("rms", 1), away, 0.002);
  g_assert_cmpfloat(opc_test_metric("kernels"), >, 3);
  g_assert_cmpfloat(opc_test_metric("error"), <, 0.01);
}

/* ---- the picture ---- */

/* Return the pixel of a position in a window of 500 nm that begins at (0,
   250). */
static int column(const picture *p, double x) {
  return p->left + (int)floor(x * (p->right - p->left + 1) / 500);
}

static int row(const picture *p, double y) {
  return p->bottom - (int)floor((y - 250) * (p->right - p->left + 1) / 500);
}

static int near_colour(uint32_t a, uint32_t b, int tolerance) {
  for (int shift = 0; shift < 24; shift += 8)
    if (ABS((int)(a >> shift & 255) - (int)(b >> shift & 255)) > tolerance)
      return 0;
  return 1;
}

/* Return the fraction of a vertical line at x that has a colour within one
   pixel. */
static double part_of(const picture *p, double x, uint32_t colour) {
  int found = 0, n = 0;
  for (int y = row(p, 700); y < row(p, 300); y++, n++) {
    int there = 0;
    for (int i = -1; i <= 1; i++)
      there |= near_colour(pixel(p, column(p, x) + i, y), colour, 50);
    found += there;
  }
  return (double)found / n;
}

#define PLACE "margin: 0 nm, window: [0 nm, 250 nm, 500 nm, 750 nm]"

static void test_picture(void) {
  static const int widths[] = {1600, 700};
  lines l;
  make_sample(&l);
  waves w = {.deep = 0.5}; /* dark to 0, bright to 1 */
  for (size_t i = 0; i < G_N_ELEMENTS(widths); i++) {
    g_autofree char *mapping = g_strdup_printf(
        "{ " PLACE
        ", width: %d, " PAIR("first", 0.3) ", " PAIR("second", 0.5) " }",
        widths[i]);
    must_draw(mapping, &w, 2, &l);
    picture p = load_picture("image.png", 0.25);
    g_assert_cmpint(p.width, ==, widths[i]);
    g_assert_cmpint(p.bottom - p.top, ==, p.right - p.left);
    /* The image: both ends and the middle of the scale, Brewer's YlGnBu. */
    g_assert_true(
        near_colour(pixel(&p, column(&p, 125), row(&p, 500)), 0x081d58, 3));
    g_assert_true(
        near_colour(pixel(&p, column(&p, 250), row(&p, 500)), 0xffffd9, 3));
    double quarter =
        125 + pitch / (2 * M_PI) * acos(-0.5); /* x of intensity 0.75 */
    g_assert_true(
        near_colour(pixel(&p, column(&p, quarter), row(&p, 500)), 0xc7e9b4, 6));
    /* Contours: the first one solid, half of the second in dashes. */
    close_to(part_of(&p, 125 + half(&w, 0.3), 0xffffff), 1, 0.02);
    close_to(part_of(&p, 125 - half(&w, 0.3), 0xffffff), 1, 0.02);
    close_to(part_of(&p, 125 + half(&w, 0.5), 0xff9a1f), 0.5, 0.12);
    close_to(part_of(&p, 125 + half(&w, 0.4), 0xff9a1f), 0, 0);
    close_to(part_of(&p, 125 + half(&w, 0.4), 0xffffff), 0, 0);
    /* The drawn edge. */
    close_to(part_of(&p, 125 + drawn / 2, 0xa9b8d6), 1, 0.02);
    cairo_surface_destroy(p.surface);
  }
}

/* The picture does not repeat the image beyond its frame. */
static void test_beyond(void) {
  lines l;
  make_sample(&l);
  waves w = {.deep = 0.5};
  must_draw(
      "{ margin: 0 nm, window: [-500 nm, 250 nm, 0 nm, 750 nm], "
      "width: 400, " PAIR("first", 0.3) " }",
      &w, 1, &l);
  picture p = load_picture("image.png", 0.25);
  for (int x = p.left; x < p.right - 2; x++)
    g_assert_cmphex(pixel(&p, x, row(&p, 500)), ==, 0xffffff);
  cairo_surface_destroy(p.surface);
}

static int rows_with(const picture *p, uint32_t colour) {
  int n = 0;
  for (int y = p->bottom + 2; y < p->height; y++) {
    int run = 0, longest = 0;
    for (int x = 0; x < p->width; x++) {
      run = near_colour(pixel(p, x, y), colour, 8) ? run + 1 : 0;
      longest = MAX(longest, run);
    }
    n += longest > p->width / 5;
  }
  return n;
}

/* Each model has a lens in its colour below the window, except a model with the
   contours of the first one. */
static void test_lens(void) {
  lines l;
  make_sample(&l);
  waves w = {.deep = 0.5};
  must_draw("{ " PLACE
            ", width: 800, " PAIR("first", 0.3) ", " PAIR("second", 0.3) " }",
            &w, 2, &l);
  picture p = load_picture("image.png", 0.25);
  int without = p.height;
  g_assert_cmpint(rows_with(&p, 0xff9a1f), ==, 0);
  cairo_surface_destroy(p.surface);
  must_draw("{ " PLACE
            ", width: 800, " PAIR("first", 0.3) ", " PAIR("second", 0.301) " }",
            &w, 2, &l);
  p = load_picture("image.png", 0.25);
  g_assert_cmpint(p.height, >, without + 100);
  g_assert_cmpint(rows_with(&p, 0xff9a1f), >=, 2); /* frame of the lens */
  cairo_surface_destroy(p.surface);
}

/* A corrected mask is simulated as it is; its outline is black. Active is
   measured along the width. */
static void test_mask(void) {
  lines l, wide;
  opc_error error;
  void *none[1];
  make_sample(&l);
  make_sample(&wide);
  for (int i = 0; i < 4 * GATES; i++)
    wide.points[i].x += i % 4 == 0 || i % 4 == 3 ? -40 : 40;
  eda_shapes shapes[] = {wide.layers[EDA_POLY], wide.layers[EDA_POLY]};
  eda_mask mask = {.gates = &l.gates, .shapes = shapes};
  must_draw("{ " PLACE ", " PAIR("first", 0.4) " }", NULL, 0, &l);
  double narrow = column_value("cd", 0);
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module(
      "draw.image", "{ " PLACE ", " PAIR("first", 0.4) " }", &error);
  g_assert_nonnull(m);
  opc_test_input(m, "mask", &mask);
  if (opc_test_run(m, none, &error)) g_error("%s", error.message);
  double broad = column_value("cd", 0);
  g_assert_cmpfloat(broad, >, narrow + 20);
  picture p = load_picture("image.png", 0.25);
  close_to(part_of(&p, 125 + drawn / 2 + 20, 0x101010), 1, 0.02);
  close_to(part_of(&p, 125 + drawn / 2, 0x101010), 0, 0);
  cairo_surface_destroy(p.surface);
  opc_test_forget();
  g_autoptr(opc_module) active = opc_test_module(
      "draw.image", "{ " PLACE ", layer: active, " PAIR("first", 0.4) " }",
      &error);
  g_assert_nonnull(active);
  for (int i = 0; i < GATES; i++) l.axis[i] = EDA_Y;
  opc_test_input(active, "mask", &mask);
  if (opc_test_run(active, none, &error)) g_error("%s", error.message);
  g_assert_cmpfloat(column_value("cd", 0), >, narrow);
  g_assert_cmpfloat(column_value("cd", 0), <, broad - 5); /* at 0.3 */
}

static void test_formats(void) {
  static const char *const files[] = {"a.png", "a.svg", "a.pdf"};
  lines l;
  make_sample(&l);
  waves w = {.deep = 0.5};
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    g_autofree char *path = g_build_filename(opc_test_folder(), files[i], NULL);
    g_autofree char *mapping = g_strdup_printf(
        "{ " PLACE ", width: 300, " PAIR("first", 0.3) ", " PAIR(
            "second", 0.5) ", file: %s }",
        files[i]);
    char *content[2];
    size_t size[2];
    for (int k = 0; k < 2; k++) { /* the same bytes each time */
      must_draw(mapping, &w, 2, &l);
      g_assert_true(g_file_get_contents(path, &content[k], &size[k], NULL));
    }
    g_assert_cmpmem(content[0], size[0], content[1], size[1]);
    g_free(content[0]);
    g_free(content[1]);
  }
}

/* ---- refusals ---- */

static void assert_refused(const char *mapping, const waves *w, lines *l,
                           int code, const char *why) {
  opc_error error;
  g_assert_cmpint(draw_sample(mapping, w, 1, l, &error), ==, code);
  if (!strstr(error.message, why))
    g_error("'%s' does not say '%s'", error.message, why);
}

static void test_refused(void) {
  lines l;
  make_sample(&l);
  waves w = {.deep = 0.5, .fault = NAN};
  assert_refused("{ " PAIR("first", 0.3) ", file: a.jpg }", &w, &l, OPC_INVALID,
                 ".png, .svg or .pdf");
  assert_refused("{ " PAIR("first", 0.3) ", window: [0 nm, 1 nm] }", &w, &l,
                 OPC_INVALID, "must be 4 lengths");
  assert_refused("{ " PAIR("first", 0.3) ", second: { litho: { use: litho.hopkins } } " 
          "}",
 &w, &l, OPC_INVALID, "'second.litho' requires 'second.resist'");
  assert_refused("{ " PAIR("first", 0.3) ", third: { resist: { use: resist.threshold " 
          "} } }",
 &w, &l, OPC_INVALID, "'third.resist' requires 'third.litho'");
  assert_refused("{ " PAIR("first", 0.3) ", fourth: { label: Mine } }", &w, &l,
                 OPC_INVALID, "'fourth.label' requires 'fourth.litho'");
  assert_refused("{ " PAIR("first", 0.3) ", margin: 250 nm }", NULL, &l,
                 OPC_INVALID, "expected at least 300 nm");
  opc_error error;
  g_assert_cmpint(
      draw_sample("{ " PLACE ", " PAIR("first", 0.3) " }", &w, 1, &l, &error),
      ==, OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "first.litho");
  g_assert_nonnull(strstr(error.message, "intensity"));
  g_assert_nonnull(strstr(error.message, "not a number"));
  assert_refused("{ " PAIR("first", 0.3) ", layer: active }", &w, &l,
                 OPC_INVALID, "the layout has no active");
  assert_refused("{ " PAIR("first", 0.3) ", window: [5 um, 0 nm, 6 um, 1 um] }",
                 &w, &l, OPC_INVALID, "is outside of the layout");
  void *none[1];
  g_autoptr(opc_module) m =
      opc_test_module("draw.image", "{ " PAIR("first", 0.3) " }", &error);
  g_assert_cmpint(opc_test_run(m, none, &error), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "either 'mask' or 'gates'"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/image/same", test_same);
  g_test_add_func("/image/shift", test_shift);
  g_test_add_func("/image/slanted", test_slanted);
  g_test_add_func("/image/missing", test_missing);
  g_test_add_func("/image/optics", test_optics);
  g_test_add_func("/image/picture", test_picture);
  g_test_add_func("/image/beyond", test_beyond);
  g_test_add_func("/image/lens", test_lens);
  g_test_add_func("/image/mask", test_mask);
  g_test_add_func("/image/formats", test_formats);
  g_test_add_func("/image/refused", test_refused);
  return g_test_run();
}
