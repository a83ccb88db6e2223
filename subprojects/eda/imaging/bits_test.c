/* SPDX-License-Identifier: BSD-3-Clause */
/* Bit-identical results for different vector widths. The program runs itself in
   qemu-x86_64 with only AVX2 and FMA, and compares hashes of the results of
   each imaging step. On a processor with AVX-512 the test compares both
   versions of EDA_WIDE functions. Skipped without qemu-user. */
#include <eda/imaging.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "imaging/cuts.h"

enum { LINES = 24, POINTS = 400, CUTS = 40 };

static const double band = 0.0065; /* 1/nm */

/* Artificial transfer functions: even or odd along x, and complex. */
static void kernel_transfer(const void *self, size_t s, const double *fx,
                            double fy, size_t n, float *out) {
  (void)self;
  for (size_t i = 0; i < n; i++) {
    double square = (fx[i] * fx[i] + fy * fy) / (band * band);
    double shape = s % 2 ? fx[i] / band : 1;
    out[2 * i] = square > 1 ? 0 : (float)((1 - square) * shape);
    out[2 * i + 1] = square > 1 ? 0 : (float)(0.1 * square * (double)(s + 1));
  }
}

static void hash_append(GString *out, const char *what, const void *data,
                        size_t n) {
  g_autofree char *hash =
      g_compute_checksum_for_data(G_CHECKSUM_SHA256, data, n);
  g_string_append_printf(out, "%s %s\n", what, hash);
}

static void field_append(GString *out, const char *what, const eda_field *f) {
  hash_append(out, what, f->coefficients,
              sizeof(float) * (size_t)f->nx * (size_t)f->ny);
}

/* Return the spectrum of rows of lines with positions that differ by 1 nm. */
static eda_spectrum mask_of_lines(eda_frame frame) {
  eda_point points[4 * LINES];
  uint32_t start[LINES + 1];
  for (int i = 0; i <= LINES; i++) start[i] = 4 * (uint32_t)i;
  for (int i = 0; i < LINES; i++) {
    int x = 100 + 250 * (i % 12), y = 50 + 1500 * (i / 12), w = 60 + i % 7;
    memcpy(points + 4 * i,
           (eda_point[]){{x, y}, {x + w, y}, {x + w, y + 1300}, {x, y + 1300}},
           4 * sizeof *points);
  }
  const eda_shapes shapes = {LINES, start, points, NULL};
  eda_spectrum out;
  opc_error error;
  if (eda_mask_spectrum(NULL, &shapes, 1, frame, 2 * band, &out, &error))
    g_error("%s", error.message);
  return out;
}

static void look_at(GString *out, const eda_field *f) {
  static double x[POINTS], y[POINTS], value[POINTS], dx[POINTS], dy[POINTS];
  double at[CUTS], distance[CUTS][2];
  for (int i = 0; i < POINTS; i++) {
    x[i] = fmod(i * 377.7, f->frame.width * 1.2);
    y[i] = fmod(i * 811.3, f->frame.height);
  }
  eda_field_sample(f, x, y, POINTS, value);
  hash_append(out, "sample", value, sizeof value);
  eda_field_gradient(f, x, y, POINTS, value, dx, dy);
  hash_append(out, "gradient", dx, sizeof dx);
  for (int i = 0; i < POINTS; i++)
    value[i] = eda_field_edge(f, i % 2, x[i], y[i], 200);
  hash_append(out, "edge", value, sizeof value);
  for (int i = 0; i < CUTS; i++) at[i] = 200 + 20 * i;
  eda_cut_many(f, 0, 130, 40, CUTS, at, distance);
  hash_append(out, "cuts", distance, sizeof distance);
}

/* Return the results of all steps as hashes. */
static char *all_hashes(void) {
  static const double weight[] = {0.5, 0.2, 0.1, 0.05};
  const eda_kernels kernels = {.count = G_N_ELEMENTS(weight),
                               .weight = weight,
                               .band = band,
                               .intensity_band = 1.5 * band,
                               .transfer = kernel_transfer,
                               .scale = {1, 0}};
  GString *out = g_string_new(NULL);
  eda_spectrum mask = mask_of_lines((eda_frame){0, 0, 3100, 2900});
  hash_append(out, "spectrum", mask.data,
              2 * sizeof(float) * (size_t)mask.columns * (size_t)mask.rows);
  eda_field field;
  opc_error error;
  if (eda_coherent_sum(NULL, &mask, &kernels, 0, &field, &error))
    g_error("%s", error.message);
  field_append(out, "image", &field);
  if (eda_field_diffuse(NULL, &field, 20, &error)) g_error("%s", error.message);
  field_append(out, "diffuse", &field);
  if (eda_field_resample(NULL, &field, 15, &error))
    g_error("%s", error.message);
  field_append(out, "resample", &field);
  size_t n = (size_t)field.nx * (size_t)field.ny;
  for (size_t i = 0; i < n; i++)
    field.coefficients[i] = 0.3f - field.coefficients[i];
  look_at(out, &field);
  eda_spectrum_clear(&mask);
  eda_field_clear(&field);
  return g_string_free(out, FALSE);
}

static char *program;

static void test_haswell(void) {
  char *command[] = {(char *)"qemu-x86_64", (char *)"-cpu",
                     (char *)"Haswell",     program,
                     (char *)"--hashes",    NULL};
  g_autofree char *emulator = g_find_program_in_path(command[0]);
  g_autofree char *there = NULL, *here = all_hashes();
  int status = 0;
#if defined(__AVX512F__) || defined(__SANITIZE_ADDRESS__) || \
    defined(__SANITIZE_THREAD__) || !defined(__x86_64__)
  g_clear_pointer(&emulator, g_free); /* this build does not run in the
                                         emulator */
#endif
  if (!emulator) {
    g_test_skip("no qemu-x86_64");
    return;
  }
  g_assert_true(g_spawn_sync(NULL, command, NULL,
                             G_SPAWN_SEARCH_PATH | G_SPAWN_STDERR_TO_DEV_NULL,
                             NULL, NULL, &there, NULL, &status, NULL));
  g_assert_cmpint(status, ==, 0);
  g_assert_cmpstr(there, ==, here);
}

int main(int argc, char **argv) {
  if (argc > 1 && !strcmp(argv[1], "--hashes")) {
    g_autofree char *hashes = all_hashes();
    g_print("%s", hashes);
    return 0;
  }
  g_test_init(&argc, &argv, NULL);
  program = argv[0];
  g_test_add_func("/bits/haswell", test_haswell);
  return g_test_run();
}
