/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of images by synthetic kernels against closed forms, and of the kernels
   of the ICCAD 2013 contest against the double sum over the exact Fourier
   coefficients of a clip. Printed areas of the clip as drawn are compared with
   another program. */
#include <complex.h>
#include <eda/layout.h>
#include <eda/litho.h>
#include <math.h>
#include <string.h>

#include "../image_test.h"
#include "tests/data.h"

static const opc_host *host;

/* ---- synthetic kernels ---- */

static void append32(GByteArray *b, uint32_t v) {
  uint8_t bytes[] = {(uint8_t)(v >> 24), (uint8_t)(v >> 16), (uint8_t)(v >> 8),
                     (uint8_t)v};
  g_byte_array_append(b, bytes, 4);
}

static char *set_path(void) {
  return g_build_filename(opc_test_folder(), "scales.txt", NULL);
}

/* Write a kernel set: `weights` as text, and size x size kernels, kernel s with
   the values value(s, k, l). */
static void write_set(const char *weights, int kernels, uint32_t size,
                      float complex (*value)(int s, int k, int l)) {
  g_autofree char *path = set_path();
  g_assert_true(g_file_set_contents(path, weights, -1, NULL));
  for (int s = 0; s < kernels; s++) {
    GByteArray *b = g_byte_array_new();
    for (int i = 0; i < 6; i++) append32(b, i < 2 ? size : 2);
    int half = (int)size / 2;
    for (int l = -half; l <= half; l++)
      for (int k = -half; k <= half; k++) {
        float complex v = value(s, k, l);
        float part[2] = {crealf(v), cimagf(v)};
        uint32_t bits[2];
        memcpy(bits, part, 8);
        append32(b, bits[0]);
        append32(b, bits[1]);
      }
    g_autofree char *name = g_strdup_printf("fh%d.bin", s);
    g_autofree char *file = g_build_filename(opc_test_folder(), name, NULL);
    g_assert_true(g_file_set_contents(file, (char *)b->data, b->len, NULL));
    g_byte_array_unref(b);
  }
}

static opc_module *model(const char *focus, const char *more) {
  opc_error error;
  g_autofree char *p = g_strdup_printf("{ focus: '%s'%s }", focus, more);
  opc_module *m = opc_test_module("litho.kernels", p, &error);
  if (!m) g_error("%s", error.message);
  return m;
}

static opc_module *ready(const char *focus, const char *more) {
  opc_error error;
  opc_module *m = model(focus, more);
  const eda_litho *litho = m->functions;
  if (litho->prepare(m->self, &error)) g_error("%s", error.message);
  return m;
}

static eda_field image_of(opc_module *m, const eda_shapes *shapes, eda_frame f,
                          double defocus) {
  const eda_litho *litho = m->functions;
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  g_assert_cmpint(eda_mask_spectrum(host->context, shapes, 1, f,
                                    litho->band(m->self), &mask, &error),
                  ==, OPC_OK);
  if (litho->image_at(m->self, 0, &mask, defocus, &field, &error))
    g_error("%s", error.message);
  eda_spectrum_clear(&mask);
  return field;
}

static eda_shapes box_shapes(eda_box b, eda_point points[4],
                             uint32_t start[2]) {
  const eda_point corners[] = {
      {b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
  memcpy(points, corners, sizeof corners);
  start[0] = 0;
  start[1] = 4;
  return (eda_shapes){1, start, points, NULL};
}

/* Return a value of one of two kernels. The first has the orders -1, 0, 1 of x
   with different phases, the second has order (0, 0). */
static float complex two_kernels(int s, int k, int l) {
  if (s == 1) return k == 0 && l == 0 ? 0.5f : 0;
  if (l != 0 || k < -1 || k > 1) return l == 1 && k == 0 ? 0.3f * I : 0;
  return k == 0 ? 1 : k == 1 ? 0.8f * I : 0.6f;
}

/* Test a clear box of 300 x 1000 nm at the origin of a square period of 1000
   nm, which has only order 0 in y, against the sum in closed form. A frame
   larger than the period tests that order 1 belongs to the frequency 1 /
   period. */
static void test_orders(void) {
  write_set("2\n2.5\n4\n", 2, 5, two_kernels);
  g_autofree char *path = set_path();
  eda_point points[4];
  uint32_t start[2];
  eda_shapes line = box_shapes((eda_box){-150, -500, 150, 500}, points, start);
  for (int dark = 0; dark < 2; dark++) {
    g_autoptr(opc_module) m =
        ready(path, dark ? ", period: 1000 nm, dose: 1.2"
                         : ", period: 1000 nm, dose: 1.2, tone: clear");
    eda_field f = image_of(m, &line, (eda_frame){-500, -500, 1000, 1000}, 0);
    for (double x = -500; x < 500; x += 37) {
      double a0 = 0.3, a1 = sin(0.3 * M_PI) / M_PI;
      if (!dark) {
        a0 = 1 - a0;
        a1 = -a1;
      }
      double complex wave = cexp(2 * M_PI * I * x / 1000);
      double complex e = a0 + a1 * (0.8 * I * wave + 0.6 / wave);
      double want = 1.2 * (2.5 * creal(e * conj(e)) + 4 * 0.25 * a0 * a0);
      g_assert_cmpfloat(fabs(value_at(&f, x, 77) - want), <, 3e-5);
    }
    eda_field_clear(&f);
  }
}

/* Return a random value of any order. */
static float complex by_lot(int s, int k, int l) {
  uint32_t h = (uint32_t)(s * 25 + (l + 2) * 5 + k + 3) * 2654435761u;
  return (float)(h >> 20) / 4096 - 0.5f +
         ((float)(h >> 8 & 4095) / 4096 - 0.5f) * I;
}

/* Return the amplitude of order k of a slit from a to b. */
static double complex slit(int k, double a, double b) {
  double complex w = 2 * M_PI * I * k / 1000;
  return k ? (cexp(-w * a) - cexp(-w * b)) / (w * 1000) : (b - a) / 1000;
}

/* Test a clear box at a general position against the sum over all 25 orders. */
static void test_all_orders(void) {
  write_set("2 1.5 0.7", 2, 5, by_lot);
  g_autofree char *path = set_path();
  eda_point points[4];
  uint32_t start[2];
  eda_shapes box = box_shapes((eda_box){-350, -120, 60, 270}, points, start);
  g_autoptr(opc_module) m = ready(path, ", period: 1000 nm");
  eda_field f = image_of(m, &box, (eda_frame){-500, -500, 1000, 1000}, 0);
  for (double x = -500; x < 500; x += 77) {
    double y = 0.7 * x - 31, want = 0;
    for (int s = 0; s < 2; s++) {
      double complex e = 0;
      for (int l = -2; l <= 2; l++)
        for (int k = -2; k <= 2; k++)
          e += by_lot(s, k, l) * slit(k, -350, 60) * slit(l, -120, 270) *
               cexp(2 * M_PI * I * (k * x + l * y) / 1000);
      want += (s ? 0.7 : 1.5) * creal(e * conj(e));
    }
    g_assert_cmpfloat(fabs(value_at(&f, x, y) - want), <, 3e-5);
  }
  eda_field_clear(&f);
}

static float complex wide(int s, int k, int l) {
  double r2 = k * k + l * l, edge = r2 < 25 ? 1 - r2 / 25 : 0;
  (void)s;
  return (float)(edge * edge) * cexpf(0.02f * I * (float)r2);
}

/* Test a small opening, whose image is defined within half a period, in frames
   that are multiples of the period and in other frames. */
static void test_frames(void) {
  write_set("1 1", 1, 11, wide);
  g_autofree char *path = set_path();
  g_autoptr(opc_module) m = ready(path, ", period: 2000 nm");
  eda_point points[4];
  uint32_t start[2];
  eda_shapes box = box_shapes((eda_box){-60, -100, 140, 110}, points, start);
  eda_field own = image_of(m, &box, (eda_frame){-1000, -1000, 2000, 2000}, 0);
  eda_field other = image_of(m, &box, (eda_frame){-1700, -2000, 3371, 4219}, 0);
  double top = value_at(&own, 40, 5), worst = 0;
  for (double x = -700; x <= 700; x += 50)
    for (double y = -700; y <= 700; y += 50)
      worst = fmax(worst, fabs(value_at(&own, x, y) - value_at(&other, x, y)));
  g_test_message("%.2g of %.3g", worst, top);
  g_assert_cmpfloat(worst, <, 1e-3 * top);
  /* A frame of two periods with the box in each has the same image. */
  eda_point pair[8];
  for (int i = 0; i < 8; i++)
    pair[i] =
        (eda_point){points[i % 4].x + (i < 4 ? 0 : 2000), points[i % 4].y};
  uint32_t starts[] = {0, 4, 8};
  eda_shapes both = {2, starts, pair, NULL};
  eda_field twice =
      image_of(m, &both, (eda_frame){-1000, -1000, 4000, 2000}, 0);
  for (double x = -1000; x <= 3000; x += 130)
    g_assert_cmpfloat(fabs(value_at(&own, x > 1000 ? x - 2000 : x, 0.3 * x) -
                           value_at(&twice, x, 0.3 * x)),
                      <, 1e-5);
  eda_field_clear(&own);
  eda_field_clear(&other);
  eda_field_clear(&twice);
}

static void test_first_kernels(void) {
  write_set("2 2.5 4", 2, 5, two_kernels);
  g_autofree char *path = set_path();
  g_autoptr(opc_module) one = ready(path, ", kernels: 1, tone: clear");
  eda_shapes none = {0};
  eda_field f = image_of(one, &none, (eda_frame){0, 0, 900, 800}, 0);
  g_assert_cmpfloat(fabs(value_at(&f, 3, 4) - 2.5), <, 1e-5);
  eda_field_clear(&f);
  g_autoptr(opc_module) three = model(path, ", kernels: 3");
  opc_error error;
  const eda_litho *litho = three->functions;
  g_assert_cmpint(litho->prepare(three->self, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "kernels");
  g_assert_cmpint(litho->image_at(one->self, 0, NULL, 50, &f, &error), ==,
                  OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "defocus");
}

/* ---- files with something wrong ---- */

static void assert_refused(const char *words) {
  g_autofree char *path = set_path();
  g_autoptr(opc_module) m = model(path, "");
  const eda_litho *litho = m->functions;
  opc_error error = {0};
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_IO);
  g_test_message("%s", error.message);
  g_assert_nonnull(strstr(error.message, words));
}

static void file_change(const char *name, size_t at, const void *bytes,
                        gssize n) {
  g_autofree char *file = g_build_filename(opc_test_folder(), name, NULL);
  char *text;
  gsize size;
  g_assert_true(g_file_get_contents(file, &text, &size, NULL));
  if (n < 0)
    size = at;
  else
    memcpy(text + at, bytes, (size_t)n);
  g_assert_true(g_file_set_contents(file, text, (gssize)size, NULL));
  g_free(text);
}

static float complex nothing(int s, int k, int l) {
  return s == 0 && k == 0 && l == 0;
}

static void test_refused(void) {
  write_set("", 0, 5, two_kernels);
  assert_refused("scales.txt:1: expected a number of kernels");
  write_set("0", 0, 5, two_kernels);
  assert_refused("expected a number of kernels");
  write_set("5000", 0, 5, two_kernels);
  assert_refused("expected a number of kernels");
  write_set("2\n1.5\n", 2, 5, two_kernels);
  assert_refused("scales.txt:3: expected the weight of kernel 1");
  write_set("2\n1.5\n-2", 2, 5, two_kernels);
  assert_refused("scales.txt:3: expected the weight");
  write_set("3\n1 1 1", 2, 5, two_kernels);
  assert_refused("fh2.bin': No such file");
  write_set("2\n1 1", 2, 4, two_kernels);
  assert_refused("fh0.bin': 4 x 4 frequencies at byte 0");
  write_set("2\n1 1", 2, 5, two_kernels);
  file_change("fh1.bin", 24 + 8 * 25 - 1, NULL, -1);
  assert_refused("fh1.bin': ends at byte 223");
  file_change("fh1.bin", 11, NULL, -1);
  assert_refused("fh1.bin': ends at byte 11");
  write_set("2\n1 1", 2, 5, two_kernels);
  file_change("fh1.bin", 3, "\x03\0\0\0\x03", 5);
  assert_refused("expected 5 as in the preceding kernels");
  file_change("fh0.bin", 24 + 8, "\x7f\xc0\0\0", 4);
  assert_refused("fh0.bin': value at byte 32 is not a finite number");
  write_set("2\n1 1", 2, 5, two_kernels);
  file_change("fh0.bin", 0, "\xff\xff\xff\xff", 4);
  assert_refused("expected an odd square");
  write_set("1\n1", 1, 5, two_kernels);
  file_change("fh0.bin", 3, "\x03", 1);
  file_change("fh0.bin", 7, "\x03", 1);
  assert_refused("more than 3 x 3 frequencies, at byte 96");
  write_set("1\n1", 1, 5, nothing);
  assert_refused("pass only the zero order");
}

/* ---- the contest's ---- */

static char *contest(const char *folder, const char *name) {
  g_autofree char *within = g_build_filename("clips", folder, name, NULL);
  return find_data(within);
}

static eda_shapes read_clip(const char *path) {
  g_autofree char *parameters = g_strdup_printf("{ file: '%s' }", path);
  opc_error error;
  g_autoptr(opc_module) m = opc_test_module("read.glp", parameters, &error);
  void *out[1];
  if (!m || opc_test_run(m, out, &error)) g_error("%s", error.message);
  eda_flat flat;
  eda_shapes merged;
  int32_t top = eda_layout_top(out[0], &error);
  g_assert_cmpint(
      eda_layout_flatten(out[0], top, eda_layout_find_layer(out[0], "M1"), 1,
                         &flat, &error),
      ==, OPC_OK);
  g_assert_cmpint(eda_boolean(EDA_OR, &flat.shapes, NULL, &merged, &error), ==,
                  OPC_OK);
  eda_flat_clear(&flat);
  opc_test_release(m, out);
  return merged;
}

enum { ACROSS = 35, HALF = 17, KERNELS = 24, PERIOD = 2048 };

/* Return the integral of exp(-2 pi i (k x + l y) / PERIOD) over the shapes,
   divided by PERIOD^2, by Green's theorem along the vertical edges. */
static double complex coefficient(const eda_shapes *s, int k, int l) {
  const double complex turn = -2 * M_PI * I / PERIOD;
  double complex sum = 0;
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      eda_point a = s->points[i];
      eda_point b = s->points[i + 1 < s->start[p + 1] ? i + 1 : s->start[p]];
      if (a.x != b.x) continue;
      double complex x = k ? cexp(turn * k * a.x) / (turn * k) : a.x;
      double complex y =
          l ? (cexp(turn * l * b.y) - cexp(turn * l * a.y)) / (turn * l)
            : b.y - a.y;
      sum += x * y;
    }
  return sum / ((double)PERIOD * PERIOD);
}

static float float_at(const uint8_t *p) {
  uint32_t bits =
      (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
  float value;
  memcpy(&value, &bits, 4);
  return value;
}

/* Compute the intensities at n positions from the definition. */
static void image_direct(const char *scales, const eda_shapes *clip,
                         const double *x, const double *y, int n, double *out) {
  g_autofree char *text = NULL;
  g_autofree char *folder = g_path_get_dirname(scales);
  g_assert_true(g_file_get_contents(scales, &text, NULL, NULL));
  g_auto(GStrv) words = g_strsplit(g_strstrip(text), "\n", -1);
  g_assert_cmpstr(g_strstrip(words[0]), ==, "24");
  double complex mask[ACROSS][ACROSS];
  for (int l = -HALF; l <= HALF; l++)
    for (int k = -HALF; k <= HALF; k++)
      mask[l + HALF][k + HALF] = coefficient(clip, k, l);
  for (int i = 0; i < n; i++) out[i] = 0;
  for (int s = 0; s < KERNELS; s++) {
    g_autofree char *path = g_strdup_printf("%s/fh%d.bin", folder, s);
    char *data;
    gsize size;
    g_assert_true(g_file_get_contents(path, &data, &size, NULL));
    const uint8_t *at = (const uint8_t *)data + 24;
    for (int i = 0; i < n; i++) {
      double complex e = 0;
      for (int l = 0; l < ACROSS; l++)
        for (int k = 0; k < ACROSS; k++) {
          const uint8_t *h = at + 8 * (ACROSS * l + k);
          e += (float_at(h) + (double)float_at(h + 4) * I) * mask[l][k] *
               cexp(2 * M_PI * I / PERIOD *
                    ((k - HALF) * x[i] + (l - HALF) * y[i]));
        }
      out[i] += g_ascii_strtod(words[s + 1], NULL) * creal(e * conj(e));
    }
    g_free(data);
  }
}

static const eda_frame tile = {-512, -512, PERIOD, PERIOD};

static void test_contest(void) {
  enum { PLACES = 40 };
  g_autofree char *focus = contest("kernels/focus", "scales.txt");
  g_autofree char *defocus = contest("kernels/defocus", "scales.txt");
  g_autofree char *clip = contest("iccad2013", "M1_test1.glp");
  if (!focus || !defocus || !clip) return;
  eda_shapes shapes = read_clip(clip);
  g_autofree char *more = g_strdup_printf(", defocus: '%s'", defocus);
  g_autoptr(opc_module) m = ready(focus, more);
  double x[PLACES], y[PLACES], want[PLACES];
  for (int i = 0; i < PLACES; i++) {
    x[i] = 30 + fmod(251.7 * i, 800);
    y[i] = 50 + 21.1 * i;
  }
  for (int out = 0; out < 2; out++) {
    eda_field f = image_of(m, &shapes, tile, out ? 25 : 0);
    image_direct(out ? defocus : focus, &shapes, x, y, PLACES, want);
    double worst = 0, top = 0;
    for (int i = 0; i < PLACES; i++) {
      worst = fmax(worst, fabs(value_at(&f, x[i], y[i]) - want[i]));
      top = fmax(top, want[i]);
    }
    g_test_message("%s: %.2g off the sum, up to %.3f",
                   out ? "defocus" : "focus", worst, top);
    g_assert_cmpfloat(worst, <, 3e-5);
    g_assert_cmpfloat(top, >, 0.3);
    eda_field_clear(&f);
  }
  eda_shapes_clear(&shapes);
}

/* Test the corners of the contest: nominal; in focus with 2 % more amplitude
   (intensity 1.02^2), and out of focus with 2 % less (0.98^2). The areas (nm^2)
   that differ from the clip or between the corners are those of a program that
   rasters the clip and sums over frequencies. */
static void test_merit(void) {
  enum { SIDE = 1300 };
  const double threshold = 0.225;
  g_autofree char *focus = contest("kernels/focus", "scales.txt");
  g_autofree char *defocus = contest("kernels/defocus", "scales.txt");
  g_autofree char *clip = contest("iccad2013", "M1_test1.glp");
  if (!focus || !defocus || !clip) return;
  eda_shapes shapes = read_clip(clip);
  g_autofree char *more = g_strdup_printf(", defocus: '%s'", defocus);
  g_autoptr(opc_module) m = ready(focus, more);
  gint64 begin = g_get_monotonic_time();
  eda_field in = image_of(m, &shapes, tile, 0);
  gint64 middle = g_get_monotonic_time();
  eda_field out = image_of(m, &shapes, tile, 25);
  g_test_message("%.2f ms for two images, %.2f ms for the second",
                 (double)(g_get_monotonic_time() - begin) / 1e3,
                 (double)(g_get_monotonic_time() - middle) / 1e3);
  double *x = g_new(double, SIDE), *y = g_new(double, SIDE);
  double *a = g_new(double, SIDE), *b = g_new(double, SIDE);
  long printed = 0, band = 0;
  for (int j = 0; j < SIDE; j++) {
    for (int i = 0; i < SIDE; i++) {
      x[i] = i - 112 + 0.5;
      y[i] = j - 112 + 0.5;
    }
    eda_field_sample(&in, x, y, SIDE, a);
    eda_field_sample(&out, x, y, SIDE, b);
    for (int i = 0; i < SIDE; i++) {
      printed += a[i] > threshold;
      band +=
          (a[i] * 1.02 * 1.02 > threshold) != (b[i] * 0.98 * 0.98 > threshold);
    }
  }
  g_test_message("%ld nm^2 print, process variation band %ld nm^2", printed,
                 band);
  g_assert_cmpint(ABS(printed - 141995), <, 100);
  g_assert_cmpint(ABS(band - 43707), <, 100);
  g_free(x);
  g_free(y);
  g_free(a);
  g_free(b);
  eda_field_clear(&in);
  eda_field_clear(&out);
  eda_shapes_clear(&shapes);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_test_host();
  g_test_add_func("/kernels/orders", test_orders);
  g_test_add_func("/kernels/all-orders", test_all_orders);
  g_test_add_func("/kernels/frames", test_frames);
  g_test_add_func("/kernels/first-kernels", test_first_kernels);
  g_test_add_func("/kernels/refused", test_refused);
  g_test_add_func("/kernels/contest", test_contest);
  g_test_add_func("/kernels/merit", test_merit);
  return g_test_run();
}
