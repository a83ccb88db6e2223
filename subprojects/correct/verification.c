/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the verification of fast simulations by accurate ones. */
#include <correct/verification.h>

#include <eda/memory.h>
#include <math.h>
#include <opcflow/plugin.h>
#include <stdlib.h>
#include <string.h>

#include <correct/loop.h>

/* Tuned constants. */
static const struct {
  double part, edge;
} tuned = {
    /* Largest mean |difference of Ion| between the accurate and the fast
       simulation, as a fraction of `ion_limit`; equal to the error of the
       accurate model. A larger change means that the loop corrected figures
       that differ from the result. */
    .part = 0.1,

    /* Largest difference of a printed edge position, in grid steps, that would
       not change the displacement of a fragment. */
    .edge = 0.5,
};

/* ---- the drawn mask ---- */

int correct_verification_begin(loop *l, opc_error *error) {
  size_t layers = l->gates->layers;
  int code = OPC_OK;
  if (!(l->printer.fine > 0) || !l->gates->count) return OPC_OK;
  l->verification.mask = eda_alloc(layers, sizeof *l->verification.mask);
  l->verification.image = eda_alloc(layers, sizeof *l->verification.image);
  for (size_t k = 0; k < layers && !code; k++) {
    if (!l->gates->corrected[k]) continue;
    l->verification.image[k] = eda_field_scaled(&l->printer.image[k], 1);
    code =
        eda_boolean(EDA_OR, &l->mask[k], NULL, &l->verification.mask[k], error);
  }
  return code;
}

void correct_verification_clear(loop *l) {
  for (size_t k = 0; l->verification.mask && k < l->gates->layers; k++) {
    eda_shapes_clear(&l->verification.mask[k]);
    eda_field_clear(&l->verification.image[k]);
  }
  free(l->verification.mask);
  free(l->verification.image);
  l->verification = (verification){0};
}

static int measure_drawn(loop *l, eda_measurement *m, opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < l->gates->layers && !code; k++)
    if (l->gates->corrected[k])
      code = eda_printer_correct(&l->printer, (int)k, &l->verification.image[k],
                                 error);
  if (!code)
    code = eda_measure(l->host->context, l->gates, l->verification.image,
                       l->extractor, m, error);
  return code;
}

/* Keep the image of the drawn mask as the loop's drawn_print. */
static void keep_print(loop *l) {
  for (size_t k = 0; k < l->gates->layers; k++) {
    if (!l->verification.image[k].coefficients) continue;
    eda_field_clear(&l->drawn_print[k]);
    l->drawn_print[k] = l->verification.image[k];
    l->verification.image[k] = (eda_field){0};
  }
}

int correct_verification_of_drawn(loop *l, opc_error *error) {
  eda_measurement m;
  if (!l->verification.mask) return OPC_OK;
  int32_t *none = eda_alloc(l->gates->count, sizeof *none);
  eda_measurement_init(&m, l->gates->count);
  int code = measure_drawn(l, &m, error);
  if (!code) {
    const eda_printed drawn = {
        .iteration = l->iterations,
        .gates = l->gates,
        .flags = m.flags,
        .l = none,
        .w = none,
        .extension = m.extension,
        .shapes = l->verification.mask,
        .print = l->verification.image,
        .scanner = eda_scanner_of(&l->printer.litho.module)};
    eda_performance_copy(&l->before, &m.performance);
    code = correct_guard_begin(l, &drawn, error);
    keep_print(l);
  }
  eda_measurement_clear(&m);
  free(none);
  correct_verification_clear(l);
  return code;
}

/* ---- conditions ---- */

int correct_verification_is_early(const loop *l) {
  return l->printer.fine > 0 && l->iterations > 0 &&
         l->printer.fine_simulations == 0;
}

int correct_verification_is_due(const loop *l) {
  if (l->checked && l->printer.fine_simulations) return 0;
  for (size_t k = 0; k < l->gates->layers; k++)
    if (l->gates->corrected[k] && !l->printer.is_fine[k])
      return l->printer.fine > 0;
  return 0;
}

/* ---- the end ---- */

/* The figures of one simulation. `off`: |Ion deviation| from the target; `ion`:
   Ion deviation from the drawn Ion. */
typedef struct seen {
  double *off, *ion; /* [gates], % */
  double **epe;      /* [layers][sites], nm */
} seen;

static void seen_init(const loop *l, seen *s) {
  size_t n = l->gates->count, layers = l->gates->layers;
  *s = (seen){eda_alloc(n, sizeof *s->off), eda_alloc(n, sizeof *s->ion),
              eda_alloc(layers, sizeof *s->epe)};
  for (size_t i = 0; i < n; i++) {
    s->off[i] = correct_guard_off(l, i);
    s->ion[i] = eda_deviation(l->measured.performance.ion[i], l->design.ion[i]);
  }
  for (size_t k = 0; k < layers; k++) {
    const sites *places = &l->sites[k];
    s->epe[k] = eda_alloc(places->count, sizeof *s->epe[k]);
    if (places->count)
      memcpy(s->epe[k], places->epe, places->count * sizeof *s->epe[k]);
  }
}

static void seen_clear(const loop *l, seen *s) {
  for (size_t k = 0; k < l->gates->layers; k++) free(s->epe[k]);
  free(s->epe);
  free(s->ion);
  free(s->off);
}

/* Return 0 if the mean change of Ion from the fast simulation (`before`) to the
   accurate simulation (`now`) is too large. Also return 0 if a transistor
   within the limit in the fast simulation exceeds the limit or does not print
   in the accurate one. */
static int transistors_hold(const loop *l, const seen *before,
                            const seen *now) {
  double sum = 0, most = 0, count = 0;
  size_t crossed = 0;
  for (size_t i = 0; i < l->gates->count; i++) {
    if (isnan(before->off[i])) continue;
    double good = before->off[i] <= l->ion_limit ? l->ion_limit : INFINITY;
    crossed += !(now->off[i] <= good);
    if (isnan(now->off[i])) continue;
    double d = fabs(now->ion[i] - before->ion[i]);
    sum += d;
    most = fmax(most, d);
    count++;
  }
  double mean = count > 0 ? sum / count : 0;
  int holds = !crossed && mean <= tuned.part * l->ion_limit;
  l->host->log(
      l->host, holds ? OPC_LOG_DEBUG : OPC_LOG_INFO,
      "accurate simulation: Ion differs from the fast one by %.3f %% in "
      "the mean and %.3f %% at most; %zu more transistor%s above 'ion_limit'",
      mean, most, crossed, crossed == 1 ? "" : "s");
  return holds;
}

static int edges_hold(const loop *l, const seen *before) {
  double most = tuned.edge * l->gates->grid;
  for (size_t k = 0; k < l->gates->layers; k++)
    for (size_t i = 0; i < l->sites[k].count; i++)
      if (!isnan(before->epe[k][i]) &&
          !(fabs(l->sites[k].epe[i] - before->epe[k][i]) <= most))
        return 0;
  return 1;
}

int correct_verification_of_end(loop *l, int *holds, opc_error *error) {
  seen before, now;
  *holds = 1;
  if (!correct_verification_is_due(l)) return OPC_OK;
  seen_init(l, &before);
  int code = correct_loop_refine(l, error);
  seen_init(l, &now);
  if (!code)
    *holds = edges_hold(l, &before) &&
             (!l->gates->count || transistors_hold(l, &before, &now));
  seen_clear(l, &before);
  seen_clear(l, &now);
  return code;
}
