/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements rows of evaluation transistors: masks, printed images, and
   currents. Images are measured as in the correction loop. */
#include "row.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the mask ---- */

static int32_t bias_steps(const row *r, double nm) {
  return (int32_t)lround(nm / r->rules->grid);
}

/* Return the distance from one transistor to the next, grid steps. It is the
   drawn length with the enclosure and the margin on both sides. */
static int32_t row_pitch(const row *r) {
  return bias_steps(r, r->length) + 2 * bias_steps(r, r->rules->enclosure) +
         2 * bias_steps(r, r->rules->margin);
}

static eda_frame frame_of(const row *r) {
  const row_rules *k = r->rules;
  double past = fmax(k->extension, 0) + k->margin;
  return (eda_frame){-k->enclosure - k->margin, -past,
                     (double)r->count * row_pitch(r) * k->grid,
                     r->width + 2 * past};
}

/* Return the box of transistor i in a layer. The lower left corner of the drawn
   gate is at (i * pitch, 0). If the number of steps of a bias is odd, the high
   side moves one step more, as in eda_moves. */
static eda_box box_of(const row *r, int layer, size_t i) {
  int32_t x = (int32_t)i * row_pitch(r), l = r->l[i], w = r->w[i];
  int32_t length = bias_steps(r, r->length), width = bias_steps(r, r->width);
  int32_t past = bias_steps(r, r->rules->extension);
  int32_t beside = bias_steps(r, r->rules->enclosure);
  if (layer == EDA_POLY)
    return (eda_box){x - (l >> 1), -past, x + length + l - (l >> 1),
                     width + past};
  return (eda_box){x - beside, -(w >> 1), x + length + beside,
                   width + w - (w >> 1)};
}

static void fill_mask(const row *r, int layer, eda_shapes *mask) {
  for (size_t i = 0; i < r->count; i++)
    eda_shapes_set_box(mask, i, box_of(r, layer, i));
}

static int print_layer(row *r, int layer, opc_error *error) {
  const row_rules *k = r->rules;
  const eda_litho *litho = k->litho->functions;
  const eda_resist *resist = k->resist->functions;
  eda_field *print = &r->print[layer];
  eda_spectrum spectrum = {0};
  eda_shapes mask = {.count = r->count,
                     .start = eda_alloc(r->count + 1, sizeof *mask.start),
                     .points = eda_alloc(4 * r->count, sizeof *mask.points)};
  fill_mask(r, layer, &mask);
  eda_field_clear(print);
  int code = eda_mask_spectrum(k->context, &mask, k->grid, frame_of(r),
                               litho->band(k->litho->self), &spectrum, error);
  if (!code)
    code = litho->image(k->litho->self, layer, &spectrum, print, error);
  if (!code) code = resist->print(k->resist->self, layer, print, error);
  eda_spectrum_clear(&spectrum);
  eda_shapes_clear(&mask);
  return code;
}

/* ---- measurement ---- */

/* One printed transistor. */
typedef struct printed {
  const row *row;
  double middle;    /* x of the middle of the gate */
  double low, high; /* y of the printed edges of the active */
} printed;

static double image_value(const row *r, int layer, double x, double y) {
  double v;
  eda_field_sample(&r->print[layer], &x, &y, 1, &v);
  return v;
}

/* Return the coordinate along `axis` of the printed edge of a layer nearest to
   (x, y); NAN if there is none within the drawn size. */
static double printed_edge(const row *r, int layer, int axis, double x,
                           double y) {
  double reach = axis == EDA_X ? r->length : r->width;
  return (axis == EDA_X ? x : y) +
         eda_field_edge(&r->print[layer], axis, x, y, reach);
}

static double length_at(const printed *p, double y) {
  const row *r = p->row;
  if (!(image_value(r, EDA_POLY, p->middle, y) > 0)) return 0;
  double low = printed_edge(r, EDA_POLY, EDA_X, p->middle - r->length / 2, y);
  double high = printed_edge(r, EDA_POLY, EDA_X, p->middle + r->length / 2, y);
  return high > low ? high - low : 0; /* also 0 if an edge is NAN */
}

static double length_of_gate(const eda_printed_gate *gate, double place) {
  const printed *p = gate->data;
  return length_at(p, p->low + place * (p->high - p->low));
}

static void lengths_of_gate(const eda_printed_gate *gate, size_t n,
                            const double *place, double *length) {
  for (size_t k = 0; k < n; k++) length[k] = length_of_gate(gate, place[k]);
}

/* Compute the printed edges of the active. They are means over the channel, as
   in the correction loop. */
static void measure_width(printed *p) {
  static const double place[3] = {-0.7745966692414834, 0, 0.7745966692414834};
  static const double share[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
  const row *r = p->row;
  p->low = p->high = 0;
  for (int k = 0; k < 3; k++) {
    double x = p->middle + place[k] * r->length / 2;
    p->low += share[k] * printed_edge(r, EDA_ACTIVE, EDA_Y, x, 0);
    p->high += share[k] * printed_edge(r, EDA_ACTIVE, EDA_Y, x, r->width);
  }
  int prints = image_value(r, EDA_ACTIVE, p->middle, r->width / 2) > 0;
  if (!prints || !(p->high > p->low)) p->low = p->high = r->width / 2;
}

/* Return the printed extension of the poly past the active. */
static double printed_extension(const printed *p, int side) {
  const row *r = p->row;
  double past = r->rules->extension;
  double drawn = side ? r->width + past : -past;
  double end = printed_edge(r, EDA_POLY, EDA_Y, p->middle, drawn);
  if (isnan(end)) return INFINITY;
  return side ? end - p->high : p->low - end;
}

/* Check that the image has finite values at two points. Return OPC_OK or an
   error. */
static int check_print(const row *r, double middle, opc_error *error) {
  if (isfinite(image_value(r, EDA_POLY, middle, r->width / 2)) &&
      isfinite(image_value(r, EDA_ACTIVE, middle, r->width / 2)))
    return OPC_OK;
  return opc_fail(error, OPC_FAILED, "litho",
                  "the printed image of L %g, W %g nm is not finite", r->length,
                  r->width);
}

/* Measure the slices of transistor i. Return OPC_OK or an error. */
static int transistor_slice(row *r, size_t i, const double *place,
                            const double *share, opc_error *error) {
  const opc_module *extractor = r->rules->extractor;
  const eda_extractor *model = extractor->functions;
  size_t n = r->slices, first = i * n, all = r->count * n;
  printed p = {
      .row = r,
      .middle = (double)i * row_pitch(r) * r->rules->grid + r->length / 2};
  int code = check_print(r, p.middle, error);
  if (code) return code;
  measure_width(&p);
  double width = p.high - p.low;
  if (model->slice && width > 0) {
    eda_printed_gate gate = {
        .type = r->rules->type,
        .design_length = r->length,
        .design_width = r->width,
        .width = width,
        .extension = {printed_extension(&p, 0), printed_extension(&p, 1)},
        .length = length_of_gate,
        .lengths = lengths_of_gate,
        .data = &p};
    model->slice(extractor->self, &gate, r->own, r->own + n);
    place = r->own;
    share = r->own + n;
  }
  for (size_t k = 0; k < n; k++) {
    r->slice[first + k] = share[k] * width;
    r->slice[all + first + k] =
        width > 0 ? length_at(&p, p.low + place[k] * width) : 0;
    r->slice[2 * all + first + k] =
        width * (place[k] < 0.5 ? place[k] : 1 - place[k]);
  }
  return OPC_OK;
}

static int row_extract(row *r, opc_error *error) {
  const opc_module *extractor = r->rules->extractor;
  const eda_extractor *model = extractor->functions;
  size_t n = r->count, all = n * r->slices;
  eda_slices in = {.count = n,
                   .slices = r->slices,
                   .type = r->type,
                   .width = r->slice,
                   .length = r->slice + all,
                   .edge = r->slice + 2 * all};
  eda_performance out = {.count = n,
                         .ion = r->ion,
                         .ioff = r->other,
                         .leq_ion = r->other + n,
                         .leq_ioff = r->other + 2 * n,
                         .weq = r->other + 3 * n,
                         .area = r->other + 4 * n};
  int code = model->extract(extractor->self, &in, &out, error);
  /* A gate with an open slice has no current, regardless of the other
     slices. */
  for (size_t i = 0; i < n && !code; i++) {
    for (size_t k = 0; k < r->slices; k++)
      if (!(in.length[i * r->slices + k] > 0)) r->ion[i] = 0;
    if (!(r->ion[i] >= 0) || !isfinite(r->ion[i]))
      return opc_fail(error, OPC_FAILED, "extractor",
                      "Ion is %g A, expected a finite value of at least 0",
                      r->ion[i]);
  }
  return code;
}

int row_print(row *r, const int layers[ROW_LAYERS], opc_error *error) {
  const opc_module *extractor = r->rules->extractor;
  const eda_extractor *model = extractor->functions;
  const double *place, *share;
  int code = OPC_OK;
  for (int layer = 0; layer < ROW_LAYERS && !code; layer++)
    if (layers[layer]) code = print_layer(r, layer, error);
  model->slicing(extractor->self, &place, &share);
  for (size_t i = 0; i < r->count && !code; i++)
    code = transistor_slice(r, i, place, share, error);
  return code ? code : row_extract(r, error);
}

/* ---- construction ---- */

/* Compute the drawn Ion, which is equal for all transistors. Return OPC_OK or
   an error. */
static int measure_drawn(row *r, const double *place, const double *share,
                         opc_error *error) {
  size_t n = r->slices, all = r->count * n;
  for (size_t i = 0; i < r->count; i++)
    for (size_t k = 0; k < n; k++) {
      r->slice[i * n + k] = share[k] * r->width;
      r->slice[all + i * n + k] = r->length;
      r->slice[2 * all + i * n + k] =
          r->width * (place[k] < 0.5 ? place[k] : 1 - place[k]);
    }
  int code = row_extract(r, error);
  r->design = r->ion[0];
  if (!code && !(r->design > 0))
    return opc_fail(error, OPC_FAILED, "extractor",
                    "a transistor of L %g, W %g nm has no current", r->length,
                    r->width);
  return code;
}

int row_init(row *r, const row_rules *rules, double length, double width,
             size_t count, opc_error *error) {
  const eda_extractor *model = rules->extractor->functions;
  const double *place, *share;
  *r = (row){.rules = rules, .length = length, .width = width, .count = count};
  r->slices = model->slicing(rules->extractor->self, &place, &share);
  r->l = eda_alloc(count, sizeof *r->l);
  r->w = eda_alloc(count, sizeof *r->w);
  r->ion = eda_alloc(count, sizeof *r->ion);
  r->type = eda_alloc(count, sizeof *r->type);
  r->other = eda_alloc(5 * count, sizeof *r->other);
  r->slice = eda_alloc(3 * count * r->slices, sizeof *r->slice);
  r->own = eda_alloc(2 * r->slices, sizeof *r->own);
  memset(r->type, rules->type, count);
  return measure_drawn(r, place, share, error);
}

void row_clear(row *r) {
  for (int layer = 0; layer < ROW_LAYERS; layer++)
    eda_field_clear(&r->print[layer]);
  free(r->l);
  free(r->w);
  free(r->ion);
  free(r->type);
  free(r->other);
  free(r->slice);
  free(r->own);
}
