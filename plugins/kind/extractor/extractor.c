/* SPDX-License-Identifier: BSD-3-Clause */
/* kind.extractor: what an extractor must have, how it is tried out, and what a
   new one looks like. */
#include <eda/extractor.h>
#include <math.h>
#include <stdlib.h>

#include "../try.h"
#include "templates.h"

enum { SLICES_MOST = 4096 };

/* ---- work ---- */

/* The slices of the sample's gates, all of their length times a factor; 0: as
   if nothing had printed. `slice` has width, length and edge one after the
   other. */
static eda_slices fill_slices(const eda_gates *g, size_t n, const double *place,
                              const double *share, double length_factor,
                              double *slice) {
  double *width = slice, *length = width + n * g->count;
  double *edge = length + n * g->count;
  for (size_t i = 0; i < g->count; i++)
    for (size_t s = 0; s < n; s++) {
      size_t k = i * n + s;
      width[k] = g->width[i] * share[s];
      length[k] = g->length[i] * length_factor;
      edge[k] = g->width[i] * fmin(place[s], 1 - place[s]);
    }
  return (eda_slices){g->count, n, g->type, width, length, edge};
}

/* NAN in all results shows what is not filled. */
static int try_extract(opc_inspector *in, const opc_module *m,
                       const eda_slices *slices, const uint32_t *flags) {
  const eda_extractor *o = m->functions;
  double figure[12];
  for (size_t i = 0; i < 12; i++) figure[i] = NAN;
  eda_performance out = {2,          figure,     figure + 2, figure + 4,
                         figure + 6, figure + 8, figure + 10};
  opc_error error = {0};
  int code = o->extract(m->self, slices, &out, &error);
  if (!try_went_well(in, "extract", code, &error)) return 0;
  code = eda_check_performance(eda_gates_sample(), 0, flags, &out, &error);
  if (!try_is_sound(in, "extract", code, &error)) return 0;
  in->add(in, figure, sizeof figure);
  return 1;
}

static void try_slices(opc_inspector *in, const opc_module *m, size_t n,
                       const double *place, const double *share) {
  const eda_extractor *o = m->functions;
  const eda_gates *g = eda_gates_sample();
  static const double factors[] = {1, 0.8, 1.3, 0};
  static const uint32_t open[] = {EDA_PRINT_OPEN, EDA_PRINT_OPEN};
  double *slice = eda_alloc(3 * n * g->count, sizeof *slice);
  int good = 1;
  for (size_t f = 0; f < 4 && good; f++) {
    eda_slices slices = fill_slices(g, n, place, share, factors[f], slice);
    good = try_extract(in, m, &slices, factors[f] == 0 ? open : NULL);
  }
  free(slice);
  if (!good) return;
  const eda_slices none = {.slices = n};
  eda_performance nothing = {0};
  opc_error error = {0};
  try_went_well(in, "extract of no gates",
                o->extract(m->self, &none, &nothing, &error), &error);
}

/* A print that is shorter towards the LOW side, and ends before HIGH. */
static double printed_length(const eda_printed_gate *gate, double place) {
  return place > 0.95 ? 0 : gate->design_length * (0.8 + 0.3 * place);
}

static void printed_lengths(const eda_printed_gate *gate, size_t n,
                            const double *place, double *length) {
  for (size_t i = 0; i < n; i++) length[i] = printed_length(gate, place[i]);
}

static void try_slice(opc_inspector *in, const opc_module *m, size_t n) {
  const eda_extractor *o = m->functions;
  const eda_gates *g = eda_gates_sample();
  double *slicing = eda_alloc(2 * n, sizeof *slicing);
  for (size_t i = 0; i < g->count; i++) {
    const eda_printed_gate gate = {.type = g->type[i],
                                   .design_length = g->length[i],
                                   .design_width = g->width[i],
                                   .width = 0.9 * g->width[i],
                                   .extension = {30, INFINITY},
                                   .length = printed_length,
                                   .lengths = printed_lengths};
    opc_error error = {0};
    o->slice(m->self, &gate, slicing, slicing + n);
    int code = eda_check_slicing(n, slicing, slicing + n, &error);
    if (!try_is_sound(in, "slice", code, &error)) break;
    in->add(in, slicing, 2 * n * sizeof *slicing);
  }
  free(slicing);
}

static void exercise(const opc_module *m, opc_inspector *in) {
  const eda_extractor *o = m->functions;
  opc_error error = {0};
  if (!try_went_well(in, "prepare", o->prepare(m->self, &error), &error))
    return;
  const double *place = NULL, *share = NULL;
  size_t n = o->slicing(m->self, &place, &share);
  int code = eda_check_slicing(n, place, share, &error);
  if (!try_is_sound(in, "slicing", code, &error) || n > SLICES_MOST) return;
  if (o->slice) try_slice(in, m, n);
  try_slices(in, m, n, place, share);
}

/* ---- entry ---- */

static const opc_function required[] = {OPC_FUNCTION(eda_extractor, prepare),
                                        OPC_FUNCTION(eda_extractor, slicing),
                                        OPC_FUNCTION(eda_extractor, extract)};
OPC_KIND("extractor", eda_extractor,
         "extractors: from the print of a gate to its performance");
