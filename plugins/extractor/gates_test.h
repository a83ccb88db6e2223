/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of extractors: synthetic gates of any shape. */
#pragma once

#include <eda/extractor.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

typedef struct figures {
  double ion, ioff, leq_ion, leq_ioff, weq, area;
  uint8_t outside;
} figures;

typedef double shape(double place);

static inline double made_up_length(const eda_printed_gate *gate,
                                    double place) {
  shape *const *s = gate->data;
  return (*s)(place);
}

static inline void made_up_lengths(const eda_printed_gate *gate, size_t n,
                                   const double *place, double *length) {
  for (size_t i = 0; i < n; i++) length[i] = made_up_length(gate, place[i]);
}

/* Return the extracted figures of a gate of width w whose length at fraction t
   of the width is s(t). `extension`: extension of the poly past the active on
   both sides, nm. */
static inline figures of_gate(const opc_module *m, uint8_t type, double w,
                              shape *s, double extension) {
  const eda_extractor *e = m->functions;
  const double *place, *share;
  size_t n = e->slicing(m->self, &place, &share);
  g_autofree double *own = g_new0(double, 2 * n);
  g_autofree double *slices = g_new0(double, 3 * n);
  const eda_printed_gate gate = {.type = type,
                                 .design_length = 65,
                                 .design_width = w,
                                 .width = w,
                                 .extension = {extension, extension},
                                 .length = made_up_length,
                                 .lengths = made_up_lengths,
                                 .data = &s};
  double sum = 0;
  e->slice(m->self, &gate, own, own + n);
  for (size_t i = 0; i < n; i++) {
    double t = own[i];
    g_assert_true(t >= (i ? own[i - 1] : 0) && t <= 1 && own[n + i] >= 0);
    sum += own[n + i];
    slices[i] = own[n + i] * w;
    slices[n + i] = s(t);
    slices[2 * n + i] = w * MIN(t, 1 - t);
  }
  g_assert_cmpfloat(fabs(sum - 1), <, 1e-12);
  figures f;
  eda_performance out = {1,           &f.ion, &f.ioff, &f.leq_ion,
                         &f.leq_ioff, &f.weq, &f.area, &f.outside};
  eda_slices in = {.count = 1,
                   .slices = n,
                   .type = &type,
                   .width = slices,
                   .length = slices + n,
                   .edge = slices + 2 * n};
  opc_error error;
  g_assert_cmpint(e->extract(m->self, &in, &out, &error), ==, OPC_OK);
  return f;
}

static inline void assert_near(double a, double b, double relative) {
  if (!(fabs(a - b) <= relative * fabs(b)))
    g_error("%.12g is not %.12g within %g", a, b, relative);
}
