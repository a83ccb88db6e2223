/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the model-based placement of assist features (search.h). The map
   contains, for each position, the derivative of the area of the process
   variability band by the mask transmission. */
#include <correct/search.h>

#include <math.h>
#include <stdlib.h>

#include <correct/loop.h>

/* Grid of the map and of scatter bar positions, nm. */
static const double map_step = 8;

/* Steepness of the smooth step (logistic function) that replaces the threshold
   when the printed area is computed, 1 / intensity. Contours have a slope of
   0.002 / nm, so the transition spans several steps of the map. */
static const double steepness = 150;

/* Reduction of the width of a printing scatter bar per iteration, nm at each
   side. */
static const double thinner = 2;

/* Number of iterations of hold_contour. Over ten clips, the band is 1.4 % wider
   with 2 iterations and 4 % wider without iterations. */
static const int settles = 4;

static void search_show(loop *l) {
  correct_trial_set_boxes(
      &l->next.assists[EDA_POLY],
      (eda_boxes){l->search.srafs.box, l->search.srafs.count});
}

int correct_search_begin(loop *l, opc_error *error) {
  sraf_search_state *s = &l->search;
  const eda_litho *litho = &l->printer.litho.functions;
  s->next = (uint32_t)s->every;
  if (!s->most) return OPC_OK;
  if (!litho->gradient || (s->defocus != 0 && !litho->image_at))
    return opc_fail(error, OPC_INVALID, "search.most",
                    "'%s' provides no gradient of the image by the mask, or no "
                    "image at a defocus",
                    l->printer.litho.litho->id);
  if (l->next.assists[EDA_POLY].count || l->assists.rows)
    return opc_fail(error, OPC_INVALID, "search.most",
                    "'search' and the synthesizer or 'assist' place scatter "
                    "bars: keep one");
  return OPC_OK;
}

void correct_search_clear(loop *l) { free(l->search.srafs.box); }

/* ---- the map ---- */

static size_t field_nodes(const eda_field *f) {
  return (size_t)f->nx * (size_t)f->ny;
}

/* Set the weights near scatter bars to 0, because eda_srafs_narrow checks
   separately whether scatter bars print. */
static void leave_out_srafs(const loop *l, eda_field *f) {
  const eda_frame *r = &f->frame;
  double dx = r->width / f->nx, dy = r->height / f->ny, g = l->gates->grid;
  double off = l->search.distance / 2;
  for (size_t i = 0; i < l->now.assists[EDA_POLY].count; i++) {
    eda_box b = l->now.assists[EDA_POLY].box[i];
    int x0 = (int)ceil((b.x0 * g - off - r->x0) / dx);
    int y0 = (int)ceil((b.y0 * g - off - r->y0) / dy);
    for (int y = y0; r->y0 + y * dy < b.y1 * g + off; y++)
      for (int x = x0; r->x0 + x * dx < b.x1 * g + off; x++)
        f->coefficients[(size_t)eda_wrap(y, f->ny) * (size_t)f->nx +
                        (size_t)eda_wrap(x, f->nx)] = 0;
  }
}

/* Convert a level set to the derivative of the printed area by the level, at
   the nodes of the map. The derivative is a ridge along the contour; the
   integral of the ridge is the integral of 1 / slope along the contour. */
static int find_edge(const loop *l, eda_field *f, opc_error *error) {
  int code = eda_field_resample(l->host->context, f, map_step, error);
  if (code) return code;
  eda_field_samples(l->host->context, f);
  for (size_t i = 0; i < field_nodes(f); i++) {
    double z = 1 / (1 + exp(-steepness * (double)f->coefficients[i]));
    f->coefficients[i] = (float)(steepness * z * (1 - z));
  }
  leave_out_srafs(l, f);
  return OPC_OK;
}

static int mask_gradient(const loop *l, const eda_spectrum *mask,
                         double defocus, const eda_field *weight,
                         eda_field *out, opc_error *error) {
  const eda_model *m = &l->printer.litho;
  return m->functions.gradient(m, EDA_POLY, mask, defocus, weight, out, error);
}

/* Compute the derivative of the area within one contour of the band by the mask
   transmission. The contour is that at a defocus (nm) and a dose factor. */
static int find_border(const loop *l, const eda_spectrum *mask, double defocus,
                       double dose, eda_field *out, opc_error *error) {
  const eda_model *m = &l->printer.litho;
  eda_field f = {0};
  int code = defocus == 0
                 ? m->functions.image(m, EDA_POLY, mask, &f, error)
                 : m->functions.image_at(m, EDA_POLY, mask, defocus, &f, error);
  if (code) return code;
  for (size_t i = 0; i < field_nodes(&f); i++) f.coefficients[i] *= (float)dose;
  code = eda_printer_develop(&l->printer, EDA_POLY, &f, error);
  if (!code) code = find_edge(l, &f, error);
  for (size_t i = 0; i < field_nodes(&f) && !code; i++)
    f.coefficients[i] *= (float)dose;
  if (!code) code = mask_gradient(l, mask, defocus, &f, out, error);
  eda_field_clear(&f);
  return code;
}

/* Compute the derivative of the band's area, the difference of the areas within
   two contours. The area grows with intensity for bright features and shrinks
   for dark features. For dark features, the contour at the lower dose is the
   larger one, so the same difference applies. */
static int find_band(const loop *l, const eda_spectrum *mask, eda_field *out,
                     opc_error *error) {
  double dose = l->search.dose / 100;
  eda_field inner = {0};
  int code = find_border(l, mask, 0, 1 + dose, out, error);
  if (!code)
    code = find_border(l, mask, l->search.defocus, 1 - dose, &inner, error);
  for (size_t i = 0; i < field_nodes(out) && !code; i++)
    out->coefficients[i] -= inner.coefficients[i];
  eda_field_clear(&inner);
  return code;
}

/* Constrain the map to a fixed nominal contour. Feature edges are displaced to
   compensate for the effect of a scatter bar on the nominal contour; subtract
   the effect of these displacements from the map. Richardson's iteration
   computes `push`, the weight of the displacements. */
static int hold_contour(const loop *l, const eda_spectrum *mask, eda_field *map,
                        opc_error *error) {
  eda_field edge = eda_field_scaled(&l->printer.print[EDA_POLY], 1);
  eda_field answer = {0};
  int code = find_edge(l, &edge, error);
  if (!code) code = mask_gradient(l, mask, 0, &edge, &answer, error);
  double along = 0, all = 0;
  for (size_t i = 0; i < field_nodes(&edge) && !code; i++) {
    along += (double)edge.coefficients[i] * (double)answer.coefficients[i];
    all += (double)edge.coefficients[i];
  }
  double part = along != 0 ? all / along : 0;
  for (int k = 0; k < settles && !code; k++) {
    eda_field push = eda_field_scaled(&edge, part);
    for (size_t i = 0; i < field_nodes(&edge); i++)
      push.coefficients[i] *= map->coefficients[i];
    eda_field_clear(&answer);
    code = mask_gradient(l, mask, 0, &push, &answer, error);
    for (size_t i = 0; i < field_nodes(map) && !code; i++)
      map->coefficients[i] -= answer.coefficients[i];
    eda_field_clear(&push);
  }
  eda_field_clear(&answer);
  eda_field_clear(&edge);
  return code;
}

static int make_map(const loop *l, eda_field *map, opc_error *error) {
  eda_spectrum mask;
  *map = (eda_field){0};
  int code =
      eda_printer_spectrum(&l->printer, &l->mask[EDA_POLY], &mask, error);
  if (code) return code;
  code = find_band(l, &mask, map, error);
  if (!code) code = hold_contour(l, &mask, map, error);
  eda_spectrum_clear(&mask);
  if (code) eda_field_clear(map);
  return code;
}

/* ---- scatter bars ---- */

/* Remove scatter bars that do not reduce the band. */
static void drop_idle(loop *l, const eda_field *map) {
  sraf_search_state *s = &l->search;
  size_t kept = 0;
  for (size_t i = 0; i < s->srafs.count; i++)
    if (eda_srafs_gain(map, s->srafs.box[i], l->gates->grid) > 0)
      s->srafs.box[kept++] = s->srafs.box[i];
  s->srafs.count = kept;
}

static int search_round(loop *l, opc_error *error) {
  sraf_search_state *s = &l->search;
  const eda_sraf_limits rule = {
      .most = (size_t)(s->most * (s->round + 1) / s->rounds),
      .min_gain = s->min_gain,
      .least_width = correct_steps(l->gates, s->least_width),
      .most_width = correct_steps(l->gates, s->width),
      .least_length = correct_steps(l->gates, s->min_length),
      .most_length = correct_steps(l->gates, s->length),
      .distance = correct_steps(l->gates, s->distance),
      .space = correct_steps(l->gates, s->space)};
  eda_field map;
  int code = make_map(l, &map, error);
  if (code) return code;
  drop_idle(l, &map);
  code = eda_srafs_search(&map, &rule, &l->gates->drawn[EDA_POLY],
                          l->gates->grid, &s->srafs, error);
  double total = 0;
  for (size_t i = 0; i < s->srafs.count; i++)
    total += eda_srafs_gain(&map, s->srafs.box[i], l->gates->grid);
  l->host->log(l->host, OPC_LOG_INFO,
               "scatter bars, round %d: %zu, which reduce the band by %.0f "
               "nm^2; %zu removed",
               (int)s->round + 1, s->srafs.count, total, s->dropped);
  eda_field_clear(&map);
  s->round++;
  s->next = l->iterations + (uint32_t)s->every;
  return code;
}

int correct_search_watch(loop *l, int done, opc_error *error) {
  sraf_search_state *s = &l->search;
  if (!s->most) return OPC_OK;
  size_t changed = eda_srafs_narrow(
      l->host->context, &s->srafs, &l->printer.print[EDA_POLY], l->gates->grid,
      s->margin, correct_steps(l->gates, thinner),
      correct_steps(l->gates, s->least_width), &s->dropped);
  int code = OPC_OK;
  if (s->round < s->rounds && (done || l->iterations >= s->next)) {
    code = search_round(l, error);
    changed = 1;
  }
  if (changed) search_show(l);
  return code;
}
