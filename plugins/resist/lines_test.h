/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of resist models: simulated lines. */
#pragma once

#include <eda/gates.h>
#include <eda/memory.h>
#include <eda/resist.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

/* Return the level set of a vertical line of `width` at x = 0 in a grating. */
static inline eda_field lines_print(opc_module *litho, opc_module *resist,
                                    int layer, double width, double pitch) {
  const opc_host *host = opc_test_host();
  const eda_litho *model = litho->functions;
  const eda_resist *develop = resist->functions;
  eda_frame f = {-pitch / 2, 0, pitch, pitch};
  int32_t x = (int32_t)lround(width * 500), top = (int32_t)lround(pitch * 1000);
  eda_point points[] = {{-x, 0}, {x, 0}, {x, top}, {-x, top}};
  uint32_t start[] = {0, 4};
  eda_shapes line = {1, start, points, NULL};
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  g_assert_cmpint(eda_mask_spectrum(host->context, &line, 1e-3, f,
                                    model->band(litho->self), &mask, &error),
                  ==, OPC_OK);
  /* Error of the images for calibration. */
  int code = model->image_fine
                 ? model->image_fine(litho->self, layer, &mask, 0, 1e-4, &field,
                                     &error)
                 : model->image(litho->self, layer, &mask, &field, &error);
  g_assert_cmpint(code, ==, OPC_OK);
  eda_spectrum_clear(&mask);
  g_assert_cmpint(develop->print(resist->self, layer, &field, &error), ==,
                  OPC_OK);
  return field;
}

static inline double lines_value(const eda_field *f, double x) {
  double y = 10, v;
  eda_field_sample(f, &x, &y, 1, &v);
  return v;
}

/* Return the printed width of the line at x = 0. */
static inline double lines_width(const eda_field *f) {
  double low = 0, high = f->frame.width / 2;
  for (double x = 0; x < high && lines_value(f, x) > 0; x += 2) low = x;
  high = low + 2;
  for (int i = 0; i < 50; i++) {
    double middle = (low + high) / 2;
    if (lines_value(f, middle) > 0)
      low = middle;
    else
      high = middle;
  }
  return 2 * low;
}

static inline opc_module *lines_resist(const char *id, const char *parameters,
                                       opc_module *litho) {
  opc_error error;
  opc_module *m = opc_test_module(id, parameters, &error);
  if (!m) g_error("%s", error.message);
  const eda_resist *resist = m->functions;
  int code = resist->prepare(m->self, litho, &error);
  if (code) g_error("%s", error.message);
  return m;
}

static inline opc_module *lines_litho(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("litho.hopkins", parameters, &error);
  if (!m) g_error("%s", error.message);
  const eda_litho *litho = m->functions;
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
  return m;
}

static inline opc_module *lines_hopkins(void) {
  return lines_litho("{ kernels: 94 }");
}

/* Return the number of findings about the diffusion, in two preparations of a
   resist. */
static inline int lines_diffusion_findings(const char *id,
                                           const char *parameters,
                                           opc_module *litho) {
  opc_error error;
  opc_test_forget();
  g_autoptr(opc_module) m = lines_resist(id, parameters, litho);
  const eda_resist *resist = m->functions;
  g_assert_cmpint(resist->prepare(m->self, litho, &error), ==, OPC_OK);
  int count = 0;
  for (const char *at = opc_test_log(); (at = strstr(at, "'diffusion' is not"));
       at++)
    count++;
  return count;
}

/* Test that only a diffusion that is not given is reported, once, and is 0. */
static inline void lines_check_diffusion(const char *id) {
  g_autoptr(opc_module) litho = lines_hopkins();
  g_assert_cmpint(lines_diffusion_findings(id, "{}", litho), ==, 1);
  static const char *const given[] = {"{ diffusion: 0 nm }",
                                      "{ diffusion: 20 nm }"};
  eda_field f[3];
  for (int i = 0; i < 3; i++) {
    g_autoptr(opc_module) m = lines_resist(id, i ? given[i - 1] : "{}", litho);
    f[i] = lines_print(litho, m, EDA_POLY, 65, 320);
    if (i)
      g_assert_cmpint(lines_diffusion_findings(id, given[i - 1], litho), ==, 0);
  }
  g_assert_cmpfloat(lines_width(&f[0]), ==, lines_width(&f[1]));
  g_assert_cmpfloat(fabs(lines_width(&f[2]) - lines_width(&f[1])), >, 0.1);
  for (int i = 0; i < 3; i++) eda_field_clear(&f[i]);
}

/* Assert that a module or its calibration fails with a message. */
static inline void lines_refused(const char *id, const char *parameters,
                                 opc_module *litho, const char *why) {
  opc_error error;
  g_autoptr(opc_module) m = opc_test_module(id, parameters, &error);
  if (m) {
    const eda_resist *resist = m->functions;
    g_assert_cmpint(resist->prepare(m->self, litho, &error), ==, OPC_INVALID);
  }
  if (!strstr(error.message, why))
    g_error("'%s' does not say '%s'", error.message, why);
}
