/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "extractor": required functions, tests of a plugin, and the templates of
   a new plugin. */
#include <eda/extractor.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../try.h"
#include "samples.h"
#include "templates.h"

enum { SLICES_MOST = 4096 };

/* Cases of printed gates. In case c, the drawn lengths and widths of the sample
   are multiplied by length_factor[c] and width_factor[c]. In the case OPEN the
   length is 0: the gates do not print. */
enum { CASES = 5, AS_DRAWN = 0, OPEN = 3, TWICE_AS_WIDE = 4, FIGURES = 12 };
static const double length_factor[CASES] = {1, 0.8, 1.3, 0, 1};
static const double width_factor[CASES] = {1, 1, 1, 1, 2};

/* Plausible Ion in A of a transistor some hundred nanometres wide: 50 nA/um to
   50 mA/um. Real transistors have 0.1 to 3 mA/um at full supply and a
   thousandth of that near the threshold. At full supply, currents in mA, uA or
   A/m are outside the range. */
static const double least_ion = 1e-8, most_ion = 1e-2;

/* Plausible ratio of the currents of two gates, one of which is twice as wide.
   Edge effects cause the deviation from 2. */
static const double least_gain = 1.4, most_gain = 3;

/* ---- work ---- */

typedef struct cases {
  const opc_module *m;
  const eda_gates *gates;
  eda_slices slices[CASES];
  double *slice[CASES];          /* storage of `slices` */
  double figure[CASES][FIGURES]; /* results */
} cases;

/* Fill the slices of case c; `slice` has width, length and edge in sequence. */
static void fill_slices(cases *all, size_t c, size_t n, const double *place,
                        const double *share) {
  const eda_gates *g = all->gates;
  double *width = all->slice[c] = eda_alloc(3 * n * g->count, sizeof *width);
  double *length = width + n * g->count, *edge = length + n * g->count;
  for (size_t i = 0; i < g->count; i++)
    for (size_t s = 0; s < n; s++) {
      size_t k = i * n + s;
      double printed = g->width[i] * width_factor[c];
      width[k] = printed * share[s];
      length[k] = g->length[i] * length_factor[c];
      edge[k] = printed * fmin(place[s], 1 - place[s]);
    }
  all->slices[c] = (eda_slices){.count = g->count,
                                .slices = n,
                                .type = g->type,
                                .width = width,
                                .length = length,
                                .edge = edge};
}

/* Return a performance of two gates whose arrays are parts of `figure`. */
static eda_performance capacity_in(double *figure) {
  memset(figure, 0, FIGURES * sizeof *figure);
  return (eda_performance){.count = 2,
                           .ion = figure,
                           .ioff = figure + 2,
                           .leq_ion = figure + 4,
                           .leq_ioff = figure + 6,
                           .weq = figure + 8,
                           .area = figure + 10};
}

static int forward_extract(const void *self, const eda_slices *in,
                           eda_performance *out, opc_error *error) {
  const try_shim *shim = self;
  const eda_extractor *o = shim->plugin->functions;
  for (size_t i = 0; i < in->count;
       i++) /* NAN marks results that the plugin does not set */
    out->ion[i] = out->ioff[i] = out->leq_ion[i] = out->leq_ioff[i] =
        out->weq[i] = out->area[i] = NAN;
  return *shim->code = o->extract(shim->plugin->self, in, out, error);
}

static const eda_extractor forwards = {.extract = forward_extract};

/* Call the plugin for case c. */
static int case_extract(opc_inspector *in, const cases *all, size_t c,
                        double *figure, uint8_t *outside,
                        eda_performance *out) {
  int own = OPC_OK;
  const try_shim shim = {all->m, &own};
  const opc_module shown = {&forwards, (void *)&shim, all->m->id};
  opc_error error = {0};
  *out = capacity_in(figure);
  out->outside = outside;
  int code =
      eda_call_extract(in->context, &shown, &all->slices[c], out, &error);
  return try_call(in, "extract", own, code, &error);
}

static int try_case(opc_inspector *in, cases *all, size_t c) {
  static const uint32_t open[] = {EDA_PRINT_OPEN, EDA_PRINT_OPEN};
  uint8_t outside[2] = {0};
  opc_error error = {0};
  eda_performance out;
  if (!case_extract(in, all, c, all->figure[c], outside, &out)) return 0;
  int code = eda_check_performance(all->gates, 0, c == OPEN ? open : NULL, &out,
                                   &error);
  if (!try_is_sound(in, "extract", code, &error)) return 0;
  in->add(in, all->figure[c], sizeof all->figure[c]);
  return 1;
}

/* Check the currents; `figure` begins with Ion, then Ioff, of each gate. */
static void try_currents(opc_inspector *in, const cases *all) {
  const double *drawn = all->figure[AS_DRAWN];
  for (size_t i = 0; i < 2; i++) {
    const eda_gates *g = all->gates;
    double ion = drawn[i], ioff = drawn[2 + i];
    double gain = all->figure[TWICE_AS_WIDE][i] / ion;
    if (!(ion >= least_ion && ion <= most_ion))
      in->find(
          in,
          "extract: Ion of a gate of L %g, W %g nm is %g A, expected %g to %g",
          g->length[i], g->width[i], ion, least_ion, most_ion);
    if (!(ioff < ion))
      in->find(in, "extract: Ioff of %g A is not below Ion of %g A", ioff, ion);
    if (!(gain >= least_gain && gain <= most_gain))
      in->find(in,
               "extract: a gate of twice the width has %g times the Ion, "
               "expected about 2",
               gain);
  }
}

static int same_figures(void *data, size_t c) {
  const cases *all = data;
  double figure[FIGURES];
  eda_performance out = capacity_in(figure); /* `outside` stays NULL: not
                                                requested */
  const eda_extractor *o = all->m->functions;
  opc_error error = {0};
  if (o->extract(all->m->self, &all->slices[c], &out, &error)) return 0;
  uint64_t now[FIGURES], before[FIGURES]; /* compared bit by bit */
  memcpy(now, figure, sizeof now);
  memcpy(before, all->figure[c], sizeof before);
  return !memcmp(now, before, sizeof now);
}

static void try_slices(opc_inspector *in, const opc_module *m, size_t n,
                       const double *place, const double *share) {
  const eda_extractor *o = m->functions;
  cases all = {.m = m, .gates = eda_gates_sample()};
  int good = 1;
  for (size_t c = 0; c < CASES; c++) fill_slices(&all, c, n, place, share);
  for (size_t c = 0; c < CASES && good; c++) good = try_case(in, &all, c);
  if (good) try_currents(in, &all);
  if (good && !try_at_once(CASES, same_figures, &all))
    in->find(in,
             "extract fails or returns different bits while other threads call "
             "the function, although declared [any]");
  for (size_t c = 0; c < CASES; c++) free(all.slice[c]);
  if (!good) return;
  const eda_slices none = {.slices = n};
  eda_performance nothing = {0};
  opc_error error = {0};
  try_went_well(in, "extract of no gates",
                o->extract(m->self, &none, &nothing, &error), &error);
}

/* Return the printed length at the relative position `place` across the width.
   The gate is shorter towards place 0, and does not print above 0.95. */
static double printed_length(const eda_printed_gate *gate, double place) {
  return place > 0.95 ? 0 : gate->design_length * (0.8 + 0.3 * place);
}

static void printed_lengths(const eda_printed_gate *gate, size_t n,
                            const double *place, double *length) {
  for (size_t i = 0; i < n; i++) length[i] = printed_length(gate, place[i]);
}

static void try_slice(opc_inspector *in, const opc_module *m, size_t n) {
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
    int code = eda_call_slice(in->context, m, &gate, n, slicing, &error);
    if (!try_is_sound(in, "slice", code, &error)) break;
    in->add(in, slicing, 2 * n * sizeof *slicing);
  }
  free(slicing);
}

static void try_range(opc_inspector *in, const opc_module *m) {
  const eda_extractor *o = m->functions;
  for (int type = EDA_NMOS; type <= EDA_PMOS; type++) {
    double low = NAN, high = NAN;
    const char *before = opc_enter(in->context, m->id);
    int known = o->range(m->self, type, &low, &high);
    opc_leave(in->context, before);
    if (known && !(low > 0 && low < high && isfinite(high)))
      in->find(in, "range: %g to %g nm, expected 0 < low < high, finite", low,
               high);
  }
}

static void exercise(const opc_module *m, opc_inspector *in) {
  const eda_extractor *o = m->functions;
  opc_error error = {0};
  const char *before = eda_enter(in->context, m, &error);
  int code = o->prepare(m->self, &error);
  opc_leave(in->context, before);
  if (!try_went_well(in, "prepare", code, &error)) return;
  if (o->range) try_range(in, m);
  const double *place = NULL, *share = NULL;
  before = eda_enter(in->context, m, &error);
  size_t n = o->slicing(m->self, &place, &share);
  code = eda_check_slicing(n, place, share, &error);
  opc_leave(in->context, before);
  if (!try_is_sound(in, "slicing", code, &error) || n > SLICES_MOST) return;
  if (o->slice) try_slice(in, m, n);
  try_slices(in, m, n, place, share);
}

/* ---- entry ---- */

static const opc_function required[] = {OPC_FUNCTION(eda_extractor, prepare),
                                        OPC_FUNCTION(eda_extractor, slicing),
                                        OPC_FUNCTION(eda_extractor, extract)};
OPC_KIND("extractor", eda_extractor,
         "extractors: performance of a gate from the printed contour",
         OPC_SAMPLES(samples));
