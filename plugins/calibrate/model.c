/* SPDX-License-Identifier: BSD-3-Clause */
/* Printed widths of gauges by images at several foci, which are simulated once:
   interpolation over the focus, diffusion, threshold and bias. */
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calibrate.h"

const char *const term_name[TERMS] = {"threshold", "active_threshold",
                                      "diffusion", "defocus", "bias"};
const char *const term_unit[TERMS] = {NULL, NULL, "nm", "nm", "nm"};

/* Set the foci: Chebyshev's extrema, whose interpolation error is small. */
static void model_place_nodes(model *m, const double focus[2]) {
  m->nodes = focus[1] > focus[0] ? NODES : 1;
  for (size_t k = 0; k < m->nodes; k++) {
    double c = m->nodes > 1 ? -cos(G_PI * (double)k / (double)(NODES - 1)) : 0;
    m->node[k] = (focus[0] + focus[1]) / 2 + c * (focus[1] - focus[0]) / 2;
  }
}

/* Compute the image of a spectrum at a focus. */
static int model_image(model *m, int layer, const eda_spectrum *mask,
                       double focus, double accuracy, eda_field *out,
                       opc_error *error) {
  const eda_litho *l = &m->litho.functions;
  if (l->image_fine)
    return l->image_fine(&m->litho, layer, mask, focus, accuracy, out, error);
  if (l->image_at)
    return l->image_at(&m->litho, layer, mask, focus, out, error);
  if (focus == 0) return l->image(&m->litho, layer, mask, out, error);
  return opc_fail(error, OPC_INVALID, "defocus",
                  "the model of the optics has one focus, found a defocus of "
                  "%g nm",
                  focus);
}

static int model_simulate(model *m, size_t layer, const eda_mask *mask,
                          eda_frame frame, double accuracy, opc_error *error) {
  eda_spectrum spectrum;
  int code = eda_litho_spectrum(m->host->context, &m->litho.module,
                                &mask->shapes[layer], mask->gates->grid, frame,
                                &spectrum, error);
  if (code) return code;
  for (size_t k = 0; k < m->nodes && !code; k++)
    code = model_image(m, (int)layer, &spectrum, m->node[k], accuracy,
                       &m->image[layer * m->nodes + k], error);
  eda_spectrum_clear(&spectrum);
  return code;
}

int model_prepare(model *m, const eda_mask *mask, const opc_module *litho,
                  double margin, double error_of_image, const double focus[2],
                  opc_error *error) {
  eda_box b = mask->gates->extent;
  double grid = mask->gates->grid;
  eda_frame frame = {b.x0 * grid - margin, b.y0 * grid - margin,
                     ((double)b.x1 - b.x0) * grid + 2 * margin,
                     ((double)b.y1 - b.y0) * grid + 2 * margin};
  model_place_nodes(m, focus);
  m->layers = mask->layers;
  m->image = eda_alloc(m->layers * m->nodes, sizeof *m->image);
  eda_model_init(&m->litho, m->host->context, litho);
  int code = m->litho.functions.prepare(&m->litho, error);
  for (size_t i = 0; i < m->count && !code; i++) {
    const gauge *g = &m->gauges[i];
    if (g->x < frame.x0 || g->x > frame.x0 + frame.width || g->y < frame.y0 ||
        g->y > frame.y0 + frame.height)
      return opc_fail(error, OPC_INVALID, "gauges",
                      "gauge %zu at (%g, %g) nm is outside of the simulated "
                      "field",
                      i + 1, g->x, g->y);
    if (!m->image[(size_t)g->layer * m->nodes].coefficients)
      code = model_simulate(m, (size_t)g->layer, mask, frame, error_of_image,
                            error);
  }
  return eda_blame(error, code, "litho");
}

void model_clear(model *m) {
  for (size_t i = 0; m->image && i < m->layers * m->nodes; i++)
    eda_field_clear(&m->image[i]);
  free(m->image);
  m->image = NULL;
}

/* Interpolate the image of a layer at a focus (Lagrange's polynomials). */
static eda_field model_focus(const model *m, size_t layer, double focus) {
  const eda_field *image = &m->image[layer * m->nodes];
  eda_field out = eda_field_scaled(image, 0);
  size_t n = (size_t)out.nx * (size_t)out.ny;
  for (size_t k = 0; k < m->nodes; k++) {
    double share = 1;
    for (size_t j = 0; j < m->nodes; j++)
      if (j != k) share *= (focus - m->node[j]) / (m->node[k] - m->node[j]);
    float factor = (float)share;
    for (size_t i = 0; i < n; i++)
      out.coefficients[i] += factor * image[k].coefficients[i];
  }
  return out;
}

/* Return the printed width at a gauge. `level`: positive in the feature. */
static double gauge_width(const gauge *g, const eda_field *level) {
  double reach = fmax(2 * g->width, 200), value;
  eda_field_sample(level, &g->x, &g->y, 1, &value);
  if (!(value > 0)) return 0;
  double up = eda_field_epe(level, g->axis, 1, g->x, g->y, reach);
  double down = eda_field_epe(level, g->axis, -1, g->x, g->y, reach);
  return (isnan(up) ? reach : up) + (isnan(down) ? reach : down);
}

/* Convert an image to the level set of lines, or of spaces. */
static void field_level(eda_field *f, double threshold, int space) {
  size_t n = (size_t)f->nx * (size_t)f->ny;
  float t = (float)threshold, sign = space ? -1 : 1;
  for (size_t i = 0; i < n; i++)
    f->coefficients[i] = sign * (t - f->coefficients[i]);
}

int model_widths(const model *m, const double p[TERMS], double *width,
                 opc_error *error) {
  for (size_t layer = 0; layer < m->layers; layer++) {
    if (!m->image[layer * m->nodes].coefficients) continue;
    double t = p[layer == EDA_ACTIVE ? ACTIVE_THRESHOLD : THRESHOLD];
    eda_field line = model_focus(m, layer, p[DEFOCUS]);
    int code = eda_field_diffuse(m->host->context, &line, p[DIFFUSION], error);
    eda_field space = code ? (eda_field){0} : eda_field_scaled(&line, 1);
    if (!code) {
      field_level(&line, t, 0);
      field_level(&space, t, 1);
    }
    for (size_t i = 0; i < m->count && !code; i++) {
      const gauge *g = &m->gauges[i];
      if ((size_t)g->layer != layer) continue;
      width[i] = gauge_width(g, g->space ? &space : &line);
      if (width[i] > 0) width[i] += g->space ? -p[BIAS] : p[BIAS];
    }
    eda_field_clear(&line);
    eda_field_clear(&space);
    if (code) return code;
  }
  return OPC_OK;
}
