/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the disturbance for known figures: the table, the metrics and the
   pixels of the picture. */
#include "disturb.c"

#include "tools/devel/testing.h"

enum { GATES = 6, WIDTH = 400, GREY = 0xd8d8d8 };

/* Ion in % of the drawn Ion: in the cell alone, and in the circuit. */
static const double alone[GATES] = {101, 98, 100, 103, 99, 102};
static const double placed[GATES] = {103, 98.5, 100.04, 101, 95, 90};
static const uint8_t known[GATES] = {1, 1, 1, 1, 1, 0};

static double wanted_disturbance(size_t i) {
  return known[i] ? fabs(placed[i] - 100) - fabs(alone[i] - 100) : NAN;
}

typedef struct made {
  eda_box box[GATES];
  double ion[3][GATES];
  uint32_t flags[GATES], number[GATES];
  char *name[GATES];
  eda_gates gates;
  eda_mask mask;
} made;

static void make_sample(made *d) {
  memset(d, 0, sizeof *d);
  for (int i = 0; i < GATES; i++) {
    int32_t x = 300 * i, y = 500 * (i % 3);
    d->box[i] = (eda_box){x, y, x + 100, y + 200};
    d->number[i] = (uint32_t)i;
    d->name[i] = "A";
    d->ion[0][i] = 2e-3;
    d->ion[1][i] = 2e-5 * alone[i];
    d->ion[2][i] = 2e-5 * placed[i];
  }
  d->gates = (eda_gates){.grid = 2,
                         .count = GATES,
                         .extent = {-100, -100, 1800, 1400},
                         .box = d->box,
                         .number = d->number,
                         .cell = d->name,
                         .instance = d->name};
  d->mask = (eda_mask){.gates = &d->gates,
                       .flags = d->flags,
                       .design = {.count = GATES, .ion = d->ion[0]},
                       .before = {.count = GATES, .ion = d->ion[1]},
                       .after = {.count = GATES, .ion = d->ion[2]}};
}

static double cell(const char *column, size_t at) {
  const opc_column *c = opc_table_column(opc_test_table("disturbance"), column);
  g_assert_nonnull(c);
  return ((const double *)c->data)[at];
}

static void assert_same(double got, double expected) {
  g_assert_true(isnan(expected) ? isnan(got) : fabs(got - expected) < 1e-9);
}

static void test_table(void) {
  made d;
  opc_error error = {0};
  make_sample(&d);
  g_assert_cmpint(disturb_report(opc_test_host(), &d.mask, known, &error), ==,
                  OPC_OK);
  double sum = 0, most = -INFINITY, worse = 0;
  for (size_t i = 0; i < GATES; i++) {
    assert_same(cell("ion_cell", i), known[i] ? alone[i] - 100 : NAN);
    assert_same(cell("ion_placed", i), placed[i] - 100);
    assert_same(cell("disturbance", i), wanted_disturbance(i));
    assert_same(cell("x", i), 600.0 * (double)i + 100);
    assert_same(cell("y", i), 1000.0 * (double)(i % 3) + 200);
    if (!known[i]) continue;
    sum += wanted_disturbance(i);
    most = fmax(most, wanted_disturbance(i));
    worse += wanted_disturbance(i) >= 0.05;
  }
  assert_same(opc_test_metric("disturbance_mean"), sum / 5);
  assert_same(opc_test_metric("disturbance_max"), most);
  assert_same(opc_test_metric("disturbed"), 100 * worse / 5);
}

/* ---- the picture ---- */

static uint32_t pixel(cairo_surface_t *s, int x, int y) {
  const unsigned char *line =
      cairo_image_surface_get_data(s) +
      (size_t)y * (size_t)cairo_image_surface_get_stride(s);
  uint32_t p;
  memcpy(&p, line + (size_t)x * 4, sizeof p);
  return p & 0xffffff;
}

static int is_near(uint32_t p, eda_colour c) {
  const double all[] = {c.r, c.g, c.b};
  for (int k = 0; k < 3; k++)
    if (fabs((p >> (16 - 8 * k) & 255) - 255 * all[k]) > 2) return 0;
  return 1;
}

/* The picture has gates in their colours on a grey chip. The scale of the
   picture is computed from the extent of the chip. */
static void test_picture(void) {
  made d;
  opc_error error = {0};
  make_sample(&d);
  if (disturb_draw(opc_test_host(), &d.mask, known, "chip.png", WIDTH, &error))
    g_error("%s", error.message);
  g_autofree char *path = g_build_filename(opc_test_folder(), "chip.png", NULL);
  cairo_surface_t *s = cairo_image_surface_create_from_png(path);
  int wide = cairo_image_surface_get_width(s);
  int high = cairo_image_surface_get_height(s);
  g_assert_cmpint(wide, ==, WIDTH);
  /* Search for two equal pixels in a row, because the edges of letters may
     contain single pixels of the same grey. */
  int x0 = wide, x1 = -1, y0 = high, y1 = -1;
  for (int y = 1; y < high; y++)
    for (int x = 1; x < wide; x++)
      if (pixel(s, x, y) == GREY && pixel(s, x - 1, y) == GREY &&
          pixel(s, x, y - 1) == GREY) {
        x0 = MIN(x0, x - 1), x1 = MAX(x1, x);
        y0 = MIN(y0, y - 1), y1 = MAX(y1, y);
      }
  g_assert_cmpint(x1 - x0, >, WIDTH / 2);
  const eda_box e = d.gates.extent;
  double by_x = (x1 - x0 + 1) / (double)(e.x1 - e.x0);
  double by_y = (y1 - y0 + 1) / (double)(e.y1 - e.y0);
  g_assert_cmpfloat(fabs(by_x / by_y - 1), <, 0.2); /* the scale is equal in x
                                                       and y within 20 % */
  /* Five figures, the largest 4 %: the second largest is the end of the colour
     scale. */
  const double range = 2;
  for (size_t i = 0; i < GATES; i++) {
    eda_box b = d.box[i];
    double t = 0.5 + wanted_disturbance(i) / range / 2;
    eda_colour c = known[i] ? eda_diverging(t) : eda_unknown;
    for (int k = 0; k < 8; k++) {
      /* A gate has its colour in the middle and just inside its corners. Just
         outside of the corners is the chip. */
      int corner = k & 3, out = k > 3;
      double in = out ? -40 : 30;
      double x = corner & 1 ? b.x0 + in : b.x1 - in;
      double y = corner & 2 ? b.y0 + in : b.y1 - in;
      int px = x0 + (int)((x - e.x0) * by_x),
          py = y1 - (int)((y - e.y0) * by_y);
      uint32_t p = pixel(s, px, py);
      if (out ? p != GREY : !is_near(p, c))
        g_error("gate %zu, %d: %06x", i, k, p);
    }
  }
  cairo_surface_destroy(s);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/disturb/table", test_table);
  g_test_add_func("/disturb/picture", test_picture);
  return g_test_run();
}
