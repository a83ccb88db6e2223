/* SPDX-License-Identifier: BSD-3-Clause */
/* Minimal models, and a host that records messages, for tests of the loop. */
#pragma once

#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/loop.h>

/* ---- a host ---- */

static GString *published; /* metrics, tables and their columns */

static int warnings;

static void hear_warnings(const opc_host *h, int level, const char *format,
                          ...) {
  (void)h, (void)format;
  warnings += level == OPC_LOG_WARNING || level == OPC_LOG_FINDING;
}

static void see_nothing(const opc_host *h, const opc_progress *progress) {
  (void)h;
  g_assert_true(isfinite(progress->worst));
}

static int keep_metric(const opc_host *h, const char *name, double value,
                       opc_error *error) {
  (void)h, (void)error;
  g_assert_true(isfinite(value));
  g_string_append_printf(published, "%s ", name);
  return OPC_OK;
}

static int keep_table(const opc_host *h, const char *name, uint32_t flags,
                      size_t rows, const opc_column *columns, size_t n,
                      size_t size, opc_error *error) {
  (void)h, (void)flags, (void)size, (void)error;
  g_string_append_printf(published, "%s[%zu]", name, rows);
  if (!strcmp(name, "history"))
    for (size_t i = 0; i < n; i++)
      g_string_append_printf(published, ",%s", columns[i].name);
  g_string_append_c(published, ' ');
  return OPC_OK;
}

static const opc_host host = {.log = hear_warnings,
                              .progress = see_nothing,
                              .table = keep_table,
                              .metric = keep_metric};

/* ---- models ---- */

/* A single coherent kernel of a Gaussian. */
static const double cut_off = 60, limit = 4 / 60.0;

static int prepare_nothing(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static double model_band(const void *self) {
  (void)self;
  return limit;
}

static void model_transfer(const void *self, size_t s, const double *fx,
                           double fy, size_t n, float *out) {
  (void)self, (void)s;
  for (size_t i = 0; i < n; i++) {
    double r = (fx[i] * fx[i] + fy * fy) * cut_off * cut_off;
    out[2 * i] = (float)exp(-r);
    out[2 * i + 1] = 0;
  }
}

static int model_image(const void *self, int layer, const eda_spectrum *mask,
                       eda_field *out, opc_error *error) {
  static const double one = 1;
  (void)self, (void)layer;
  const eda_kernels kernels = {.count = 1,
                               .weight = &one,
                               .band = limit,
                               .intensity_band = 2 * limit,
                               .transfer = model_transfer,
                               .scale = {1, 0}};
  return eda_coherent_sum(NULL, mask, &kernels, 0, out, error);
}

/* The accurate model adds a wave across the frame, The wave has the height
   fine_adds[n] in accurate simulation n of poly, and fine_adds[0] in each
   accurate simulation of active. Half of the height is added everywhere. */
enum { FINE_PRINTS = 8 };
static double fine_adds[FINE_PRINTS];
static int fine_prints[2];                   /* poly and active */
static double fine_errors[2] = {1e-4, 1e-4}; /* requested errors */

static double wave(double height, double x, double width) {
  return height * (0.5 + sin(2 * G_PI * x / width));
}

G_GNUC_UNUSED static int image_fine(const void *self, int layer,
                                    const eda_spectrum *mask, double defocus,
                                    double wanted, eda_field *out,
                                    opc_error *error) {
  int n = fine_prints[layer]++;
  double height = fine_adds[layer == EDA_POLY ? n : 0];
  g_assert_cmpfloat(defocus, ==, 0);
  g_assert_cmpfloat(wanted, ==, fine_errors[layer]);
  g_assert_cmpint(n, <, FINE_PRINTS);
  if (model_image(self, layer, mask, out, error)) return error->code;
  for (int j = 0; j < out->ny; j++)
    for (int i = 0; i < out->nx; i++)
      out->coefficients[j * out->nx + i] += (float)wave(height, i, out->nx);
  return OPC_OK;
}

static int model_calibrate(void *self, const opc_module *litho,
                           opc_error *error) {
  (void)self, (void)litho, (void)error;
  return OPC_OK;
}

static int model_print(const void *self, int layer, eda_field *f,
                       opc_error *error) {
  (void)self, (void)layer, (void)error;
  for (int i = 0; i < f->nx * f->ny; i++)
    f->coefficients[i] = 0.6F - f->coefficients[i];
  return OPC_OK;
}

static size_t model_slicing(const void *self, const double **p,
                            const double **s) {
  static const double middle = 0.5, all = 1;
  (void)self;
  *p = &middle;
  *s = &all;
  return 1;
}

/* Return a current proportional to W / L. */
static int model_extract(const void *self, const eda_slices *in,
                         eda_performance *out, opc_error *error) {
  (void)self, (void)error;
  for (size_t i = 0; i < in->count; i++) {
    double l = in->length[i], w = in->width[i];
    out->leq_ion[i] = out->leq_ioff[i] = l;
    out->weq[i] = w;
    out->area[i] = w * l;
    out->ion[i] = out->ioff[i] = l > 0 ? 1e-6 * w / l : 0;
  }
  return OPC_OK;
}

static const eda_litho litho = {
    .prepare = prepare_nothing, .band = model_band, .image = model_image};
static const eda_resist resist = {.prepare = model_calibrate,
                                  .print = model_print};
static const eda_extractor extractor = {.prepare = prepare_nothing,
                                        .slicing = model_slicing,
                                        .extract = model_extract};
#define MODULE(functions_, self_) \
  (&(const opc_module){(functions_), (self_), "test.module"})
