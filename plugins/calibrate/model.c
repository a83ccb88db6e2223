/* SPDX-License-Identifier: BSD-3-Clause */
/* Printed widths of gauges by images at nodes of NA, sigma and focus, which are
   simulated once: interpolation between the nodes, diffusion, threshold and
   bias. */
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calibrate.h"

const char *const term_name[TERMS] = {
    "threshold", "active_threshold", "diffusion", "defocus", "na", "sigma",
    "bias",      "bias_density"};
const char *const term_unit[TERMS] = {NULL, NULL, "nm", "nm",
                                      NULL, NULL, "nm", "nm"};

/* ---- nodes ---- */

static const int axis_term[AXES] = {NA, SIGMA, DEFOCUS};
static const size_t axis_nodes[AXES] = {5, 5, NODES};

/* Set the nodes of each parameter of the optics: Chebyshev's extrema, whose
   interpolation error is small. */
static void model_place_nodes(model *m, const double from[TERMS],
                              const double to[TERMS]) {
  m->nodes = 1;
  for (size_t a = 0; a < AXES; a++) {
    double low = from[axis_term[a]], high = to[axis_term[a]];
    size_t n = m->n[a] = high > low ? axis_nodes[a] : 1;
    for (size_t k = 0; k < n; k++) {
      double c = n > 1 ? -cos(G_PI * (double)k / (double)(n - 1)) : 0;
      m->node[a][k] = n > 1 ? (low + high) / 2 + c * (high - low) / 2 : low;
    }
    m->nodes *= n;
  }
}

/* Return the number of a node of the parameter `axis` that belongs to node k of
   all parameters; the focus varies fastest. */
static size_t node_along(const model *m, size_t axis, size_t k) {
  for (size_t a = AXES - 1; a > axis; a--) k /= m->n[a];
  return k % m->n[axis];
}

static double node_value(const model *m, size_t axis, size_t k) {
  return m->node[axis][node_along(m, axis, k)];
}

/* ---- images ---- */

/* Compute the image of a spectrum at a node. */
static int model_image(model *m, int layer, const eda_spectrum *mask, size_t k,
                       eda_field *out, opc_error *error) {
  const eda_litho *l = &m->litho.functions;
  double na = node_value(m, ALONG_NA, k), sigma = node_value(m, ALONG_SIGMA, k),
         focus = node_value(m, ALONG_FOCUS, k);
  if (!isnan(na) || !isnan(sigma)) {
    if (l->image_optics)
      return l->image_optics(&m->litho, layer, mask, na, sigma, focus,
                             m->image_error, out, error);
    return opc_fail(
        error, OPC_INVALID, isnan(na) ? "sigma" : "na",
        "%s cannot change NA or sigma; use litho.hopkins, or remove "
        "'na' and 'sigma'",
        m->optics->id);
  }
  if (l->image_fine)
    return l->image_fine(&m->litho, layer, mask, focus, m->image_error, out,
                         error);
  if (l->image_at)
    return l->image_at(&m->litho, layer, mask, focus, out, error);
  if (focus == 0) return l->image(&m->litho, layer, mask, out, error);
  return opc_fail(error, OPC_INVALID, "defocus",
                  "the model of the optics has one focus, found a defocus of "
                  "%g nm",
                  focus);
}

static eda_frame mask_frame(const model *m, size_t mask) {
  const eda_gates *g = m->masks[mask]->gates;
  eda_box b = g->extent;
  return (eda_frame){b.x0 * g->grid - m->margin, b.y0 * g->grid - m->margin,
                     ((double)b.x1 - b.x0) * g->grid + 2 * m->margin,
                     ((double)b.y1 - b.y0) * g->grid + 2 * m->margin};
}

/* Return 1 if a gauge is on a layer of a mask. */
static int layer_is_used(const model *m, size_t mask, size_t layer) {
  for (size_t i = 0; i < m->count; i++)
    if ((size_t)m->gauges[i].mask == mask &&
        (size_t)m->gauges[i].layer == layer)
      return 1;
  return 0;
}

/* Compute the spectrum of a layer, up to the largest band of all nodes. */
static int model_spectrum(model *m, size_t mask, size_t layer,
                          eda_spectrum *out, opc_error *error) {
  const eda_mask *k = m->masks[mask];
  eda_scanner s = eda_scanner_of(m->optics);
  double na = m->node[ALONG_NA][m->n[ALONG_NA] - 1],
         sigma = m->node[ALONG_SIGMA][m->n[ALONG_SIGMA] - 1];
  if (isnan(na) && isnan(sigma))
    return eda_litho_spectrum(m->host->context, &m->litho.module,
                              &k->shapes[layer], k->gates->grid,
                              mask_frame(m, mask), out, error);
  double band =
      (1 + (isnan(sigma) ? 1 : sigma)) * (isnan(na) ? s.na : na) / s.wavelength;
  return eda_mask_spectrum(m->host->context, &k->shapes[layer], k->gates->grid,
                           mask_frame(m, mask), band, out, error);
}

/* Resample the images of a layer on the finest of their grids, which differ if
   NA varies. */
static int images_resample(const model *m, eda_field *image, opc_error *error) {
  double step = INFINITY;
  for (size_t k = 0; k < m->nodes; k++)
    step = fmin(step, fmin(image[k].frame.width / image[k].nx,
                           image[k].frame.height / image[k].ny));
  int code = OPC_OK;
  for (size_t k = 0; k < m->nodes && !code && m->n[ALONG_NA] > 1; k++)
    code = eda_field_resample(m->host->context, &image[k], step, error);
  return code;
}

/* Simulate the layers with gauges at all nodes. All layers are simulated at a
   node before the next node, because the layers share the kernels. */
static int model_simulate(model *m, eda_spectrum *const *spectra,
                          opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < m->nodes && !code; k++)
    for (size_t i = 0; i < m->n_masks && !code; i++)
      for (size_t layer = 0; layer < m->masks[i]->layers && !code; layer++) {
        if (opc_cancelled(m->host->context))
          return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
        if (spectra[i][layer].data)
          code = model_image(m, (int)layer, &spectra[i][layer], k,
                             &m->image[i][layer * m->nodes + k], error);
      }
  for (size_t i = 0; i < m->n_masks && !code; i++)
    for (size_t layer = 0; layer < m->masks[i]->layers && !code; layer++)
      if (spectra[i][layer].data)
        code = images_resample(m, m->image[i] + layer * m->nodes, error);
  return code;
}

static int gauges_check(const model *m, opc_error *error) {
  for (size_t i = 0; i < m->count; i++) {
    const gauge *g = &m->gauges[i];
    eda_frame f = mask_frame(m, (size_t)g->mask);
    if (g->x < f.x0 || g->x > f.x0 + f.width || g->y < f.y0 ||
        g->y > f.y0 + f.height)
      return opc_fail(error, OPC_INVALID, "gauges",
                      "gauge %zu at (%g, %g) nm is outside of the simulated "
                      "field",
                      i + 1, g->x, g->y);
  }
  return OPC_OK;
}

int model_prepare(model *m, const double from[TERMS], const double to[TERMS],
                  opc_error *error) {
  eda_spectrum *spectra[MASKS] = {0};
  model_place_nodes(m, from, to);
  eda_model_init(&m->litho, m->host->context, m->optics);
  int code = gauges_check(m, error);
  if (!code) code = m->litho.functions.prepare(&m->litho, error);
  for (size_t i = 0; i < m->n_masks && !code; i++) {
    size_t layers = m->masks[i]->layers;
    m->image[i] = eda_alloc(layers * m->nodes, sizeof *m->image[i]);
    spectra[i] = eda_alloc(layers, sizeof *spectra[i]);
    for (size_t layer = 0; layer < layers && !code; layer++)
      if (layer_is_used(m, i, layer))
        code = model_spectrum(m, i, layer, &spectra[i][layer], error);
  }
  if (!code) code = model_simulate(m, spectra, error);
  for (size_t i = 0; i < m->n_masks; i++) {
    for (size_t l = 0; spectra[i] && l < m->masks[i]->layers; l++)
      eda_spectrum_clear(&spectra[i][l]);
    free(spectra[i]);
  }
  return code;
}

void model_clear(model *m) {
  for (size_t i = 0; i < m->n_masks; i++) {
    size_t n = m->image[i] ? m->masks[i]->layers * m->nodes : 0;
    for (size_t k = 0; k < n; k++) eda_field_clear(&m->image[i][k]);
    free(m->image[i]);
    m->image[i] = NULL;
  }
}

/* ---- density ---- */

/* Return the part of the area that shapes cover around (x, y), from the
   spectrum of the mask's transmission, which is 0 in the shapes. The factor of
   a frequency f is the spectrum of the Gaussian, exp(-2 (pi range f)^2). */
static double spectrum_density(const eda_spectrum *s, double range, double x,
                               double y) {
  double sum = 0;
  for (int l = 0; l < s->rows; l++) {
    int signed_l = l <= s->rows / 2 ? l : l - s->rows;
    double fy = signed_l / s->frame.height;
    for (int k = 0; k < s->columns; k++) {
      double fx = k / s->frame.width, by = G_PI * range * hypot(fx, fy);
      const float *a =
          s->data + 2 * ((size_t)l * (size_t)s->columns + (size_t)k);
      double phase =
          2 * G_PI * (fx * (x - s->frame.x0) + fy * (y - s->frame.y0));
      sum += (k ? 2 : 1) * exp(-2 * by * by) *
             (a[0] * cos(phase) - a[1] * sin(phase));
    }
  }
  return 1 - sum;
}

int model_densities(model *m, double range, opc_error *error) {
  /* The Gaussian's spectrum is below 1e-5 beyond the band. */
  const double band = 0.8 / range;
  for (size_t i = 0; i < m->n_masks; i++)
    for (size_t layer = 0; layer < m->masks[i]->layers; layer++) {
      if (!layer_is_used(m, i, layer)) continue;
      const eda_mask *k = m->masks[i];
      eda_spectrum s;
      int code =
          eda_mask_spectrum(m->host->context, &k->shapes[layer], k->gates->grid,
                            mask_frame(m, i), band, &s, error);
      if (code) return code;
      for (size_t g = 0; g < m->count; g++) {
        gauge *one = &m->gauges[g];
        if ((size_t)one->mask == i && (size_t)one->layer == layer)
          one->density = spectrum_density(&s, range, one->x, one->y);
      }
      eda_spectrum_clear(&s);
    }
  return OPC_OK;
}

/* ---- widths ---- */

/* Return the share of node k in the value at a position along an axis
   (Lagrange's polynomials). */
static double node_share(const model *m, size_t axis, size_t k, double at) {
  const double *node = m->node[axis];
  double share = 1;
  for (size_t j = 0; j < m->n[axis]; j++)
    if (j != k) share *= (at - node[j]) / (node[k] - node[j]);
  return share;
}

/* Interpolate the image of a layer at the optics p. */
static eda_field model_interpolate(const model *m, const eda_field *image,
                                   const double p[TERMS]) {
  eda_field out = eda_field_scaled(image, 0);
  size_t n = (size_t)out.nx * (size_t)out.ny;
  for (size_t k = 0; k < m->nodes; k++) {
    double share = 1;
    for (size_t a = 0; a < AXES; a++)
      share *= node_share(m, a, node_along(m, a, k), p[axis_term[a]]);
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

/* Compute the widths of the gauges on a layer of a mask. */
static int layer_widths(const model *m, size_t mask, size_t layer,
                        const double p[TERMS], double *width,
                        opc_error *error) {
  double t = p[layer == EDA_ACTIVE ? ACTIVE_THRESHOLD : THRESHOLD];
  eda_field line = model_interpolate(m, m->image[mask] + layer * m->nodes, p);
  int code = eda_field_diffuse(m->host->context, &line, p[DIFFUSION], error);
  eda_field space = code ? (eda_field){0} : eda_field_scaled(&line, 1);
  if (!code) {
    field_level(&line, t, 0);
    field_level(&space, t, 1);
  }
  for (size_t i = 0; i < m->count && !code; i++) {
    const gauge *g = &m->gauges[i];
    if ((size_t)g->mask != mask || (size_t)g->layer != layer) continue;
    double bias = p[BIAS] + p[BIAS_DENSITY] * (g->density - 0.5);
    width[i] = gauge_width(g, g->space ? &space : &line);
    if (width[i] > 0) width[i] += g->space ? -bias : bias;
  }
  eda_field_clear(&line);
  eda_field_clear(&space);
  return code;
}

int model_widths(const model *m, const double p[TERMS], double *width,
                 opc_error *error) {
  int code = OPC_OK;
  for (size_t i = 0; i < m->n_masks; i++)
    for (size_t layer = 0; layer < m->masks[i]->layers && !code; layer++)
      if (m->image[i][layer * m->nodes].coefficients)
        code = layer_widths(m, i, layer, p, width, error);
  return code;
}
