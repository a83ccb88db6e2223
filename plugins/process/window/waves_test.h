/* SPDX-License-Identifier: BSD-3-Clause */
/* Gates whose image has a closed form, for the tests of process.window. */
#pragma once

#include <eda/gates.h>
#include <eda/litho.h>
#include <eda/memory.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

enum { GATES = 4 };
static const double pitch = 250, drawn = 65, drawn_width = 688;

/* ---- gates: four vertical lines ---- */

typedef struct lines {
  eda_point points[4 * GATES];
  uint32_t start[GATES + 1];
  eda_box box[GATES];
  uint8_t axis[GATES], type[GATES], corrected[2];
  double length[GATES], width[GATES], space[2 * GATES], extension[2 * GATES];
  eda_shapes drawn[2]; /* identical layers, because active is not simulated */
  eda_gates gates;
} lines;

static char *const layer[] = {"poly", "active"};

static inline void lines_make(lines *l) {
  memset(l, 0, sizeof *l);
  for (int i = 0; i < GATES; i++) {
    int32_t x0 = (int32_t)(2 * (125 - drawn / 2 + pitch * i));
    int32_t x1 = x0 + (int32_t)(2 * drawn);
    eda_point p[] = {{x0, 0}, {x1, 0}, {x1, 4000}, {x0, 4000}};
    memcpy(l->points + 4 * i, p, sizeof p);
    l->start[i + 1] = 4 * (uint32_t)(i + 1);
    l->box[i] = (eda_box){x0, 1312, x1, 2688};
    l->length[i] = drawn;
    l->width[i] = drawn_width;
    l->type[i] = i % 2 ? EDA_PMOS : EDA_NMOS;
    l->extension[2 * i] = l->extension[2 * i + 1] = INFINITY;
    l->space[2 * i] = l->space[2 * i + 1] = pitch - drawn;
  }
  for (int k = 0; k < 2; k++)
    l->drawn[k] = (eda_shapes){GATES, l->start, l->points, NULL};
  l->gates = (eda_gates){.name = "LINES",
                         .layers = 2,
                         .layer = (char **)layer,
                         .corrected = l->corrected,
                         .drawn = l->drawn,
                         .grid = 0.5,
                         .extent = {0, 0, 2000, 4000},
                         .count = GATES,
                         .box = l->box,
                         .axis = l->axis,
                         .type = l->type,
                         .length = l->length,
                         .width = l->width,
                         .extension = l->extension,
                         .space = l->space};
}

/* ---- an image with closed forms ---- */

/* Image of poly: 0.5 - m cos(2 pi (x - 125) / pitch) - s (dark - drawn). The
   contrast m decreases with the square of the defocus, s is `shadow`, and
   `dark` is the covered share of the mask. Image of active: 0.5 - 0.35 cos(2 pi
   (y - 1000) / 4000), where 4000 nm is the height of the frame. */
static const double shadow = 2, active_pitch = 4000;

static inline double contrast(double defocus) {
  return 0.35 * (1 - defocus * defocus / (400 * 400));
}

/* Return the covered share of the frame of 3000 x 4000 nm with all edges moved
   outward by `by`. */
static inline double dark(double by) {
  return GATES * (drawn + 2 * by) * (4000 * 0.5 + 2 * by) / (3000. * 4000);
}

static inline int no_preparation(void *self, opc_error *error) {
  (void)self;
  (void)error;
  return OPC_OK;
}

static inline double some_band(const void *self) {
  (void)self;
  return 0.005;
}

static inline int waves_at(const void *self, int which,
                           const eda_spectrum *mask, double defocus,
                           eda_field *out, opc_error *error) {
  (void)error;
  (void)self;
  eda_frame f = mask->frame;
  *out = (eda_field){.frame = f, .nx = (int)(f.width / 10), .ny = 32};
  size_t n = (size_t)out->nx * (size_t)out->ny;
  double brighter = shadow * (dark(0) - (1 - mask->data[0]));
  out->coefficients = eda_alloc(n, sizeof(float));
  for (size_t i = 0; i < n; i++) {
    double x = f.x0 + f.width * (double)(i % (size_t)out->nx) / out->nx;
    double y = f.y0 + f.height * floor((double)i / out->nx) / out->ny;
    out->coefficients[i] =
        (float)(which == EDA_POLY
                    ? 0.5 + brighter -
                          contrast(defocus) * cos(2 * M_PI * (x - 125) / pitch)
                    : 0.5 - contrast(0) *
                                cos(2 * M_PI * (y - 1000) / active_pitch));
  }
  eda_field_from_samples(NULL, out);
  return OPC_OK;
}

static inline int waves_image(const void *self, int which,
                              const eda_spectrum *mask, eda_field *out,
                              opc_error *error) {
  return waves_at(self, which, mask, 0, out, error);
}

static const eda_litho with_focus = {.prepare = no_preparation,
                                     .band = some_band,
                                     .image = waves_image,
                                     .image_at = waves_at};
static const eda_litho one_focus = {
    .prepare = no_preparation, .band = some_band, .image = waves_image};

#define RESIST \
  "resist: { use: resist.threshold, threshold: 0.4, active_threshold: 0.2 }"
#define LITHO "litho: { use: litho.hopkins }"

/* Return the printed length of a mask with all edges moved outward by `by`, and
   the log slope at the edges. */
static inline double length_of(double defocus, double dose, double by,
                               double *ils) {
  double level = 0.4 / (1 + dose / 100), m = contrast(defocus);
  double angle = acos((0.5 - shadow * (dark(by) - dark(0)) - level) / m);
  *ils = m * 2 * M_PI / pitch * sin(angle) / level;
  return pitch / M_PI * angle;
}

static inline double length_at(double defocus, double dose, double *ils) {
  return length_of(defocus, dose, 0, ils);
}

static inline int run_with(const char *mapping, const eda_litho *litho,
                           opc_module *extractor, lines *l, opc_error *error) {
  void *none[1];
  opc_module model = {litho, NULL,
                      litho == &one_focus ? "litho.one" : "litho.waves"};
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("process.window", mapping, error);
  if (!m) return error->code;
  if (litho) opc_test_input(m, "litho", &model);
  if (extractor) opc_test_input(m, "extractor", extractor);
  if (l) opc_test_input(m, "gates", &l->gates);
  return opc_test_run(m, none, error);
}

static inline int run_step(const char *mapping, const eda_litho *litho,
                           lines *l, opc_error *error) {
  return run_with(mapping, litho, NULL, l, error);
}

static inline const double *column(const char *table, const char *name) {
  const opc_table *t = opc_test_table(table);
  g_assert_nonnull(t);
  const opc_column *c = opc_table_column(t, name);
  g_assert_nonnull(c);
  return c->data;
}
