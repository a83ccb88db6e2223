/* SPDX-License-Identifier: BSD-3-Clause */
/* Small standard inputs for each kind of plugin, all from opc_test_gates. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/correct/check.h"
#include "core/plugin/host.h"
#include "core/plugin/lint.h"
#include "core/plugin/testing.h"

enum { ROUNDS = 6, SLICES_MOST = 4096 };

/* The period that a print is made in, nm: the transistors and some room. */
static const opc_frame frame = {-1000, -1000, 2500, 3000};

static void add(opc_inspector *in, const void *data, size_t size) {
  g_checksum_update(in->digest, data, (gssize)size);
}

/* Whether a call went well; a failure is noted with its reason. */
static gboolean went_well(opc_inspector *in, const char *what, int code,
                          opc_error *error) {
  if (!code) return TRUE;
  error->message[sizeof error->message - 1] = 0;
  if (code < OPC_INVALID || code > OPC_CANCELLED)
    opc_find(in, "%s returned the unknown code %d", what, code);
  else if (!*error->message)
    opc_find(in, "%s failed without a message", what);
  else
    opc_note(in, "%s: %s", what, error->message);
  return FALSE;
}

/* Something that a check of the core found. */
static gboolean is_sound(opc_inspector *in, const char *what,
                         const opc_error *error) {
  if (!error->code) return TRUE;
  opc_find(in, "%s: %s", what, error->message);
  return FALSE;
}

/* ---- litho and resist ---- */

static void add_field(opc_inspector *in, const opc_field *f) {
  add(in, f->coefficients,
      (size_t)f->nx * (size_t)f->ny * sizeof *f->coefficients);
}

static gboolean make_mask(opc_inspector *in, int layer, double band,
                          opc_spectrum *mask) {
  const opc_host *host = opc_test_host();
  const opc_gates *g = opc_test_gates();
  opc_error error = {0};
  int code = host->imaging->mask_spectrum(host, &g->drawn[layer], g->grid,
                                          frame, band, mask, &error);
  if (code)
    opc_find(in, "a mask of its band of %g 1/nm: %s", band, error.message);
  return !code;
}

static void exercise_image(opc_inspector *in, const opc_litho *o, void *self,
                           int layer, const opc_spectrum *mask,
                           double defocus) {
  const opc_host *host = opc_test_host();
  opc_field field = {0};
  opc_error error = {0};
  int code = defocus == 0
                 ? o->image(self, layer, mask, &field, &error)
                 : o->image_at(self, layer, mask, defocus, &field, &error);
  if (went_well(in, defocus == 0 ? "image" : "image_at", code, &error)) {
    opc_check_field(&field, &mask->frame, "intensity", &error);
    if (is_sound(in, "image", &error)) add_field(in, &field);
  }
  host->imaging->release_field(host, &field);
}

static void exercise_litho(opc_inspector *in, const opc_module *m) {
  const opc_litho *o = m->plugin->operations;
  opc_error error = {0};
  if (!went_well(in, "prepare", o->prepare(m->self, &error), &error)) return;
  double band = o->band(m->self);
  if (!(band > 0) || !isfinite(band)) {
    opc_find(in, "its band is %g 1/nm", band);
    return;
  }
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    opc_spectrum mask;
    if (!make_mask(in, layer, band, &mask)) return;
    exercise_image(in, o, m->self, layer, &mask, 0);
    if (o->image_at) exercise_image(in, o, m->self, layer, &mask, 50);
    opc_test_host()->imaging->release_spectrum(opc_test_host(), &mask);
  }
}

/* A model for the resist: one coherent system without edges. */
static const double cut = 120, limit = 4 / 120.0;

static int model_prepare(void *self, opc_error *error) {
  (void)self, (void)error;
  return OPC_OK;
}

static double model_band(const void *self) {
  (void)self;
  return limit;
}

static void model_transfer(const void *self, size_t s, const double *fx,
                           double fy, size_t n, float *out) {
  (void)self, (void)s;
  for (size_t i = 0; i < n; i++) {
    double r = (fx[i] * fx[i] + fy * fy) * cut * cut;
    out[2 * i] = (float)(1 / ((1 + r) * (1 + r)));
    out[2 * i + 1] = 0;
  }
}

static int model_image(const void *self, int layer, const opc_spectrum *mask,
                       opc_field *out, opc_error *error) {
  static const double one = 1;
  (void)self, (void)layer;
  const opc_systems systems = {.size = sizeof systems,
                               .count = 1,
                               .weight = &one,
                               .band = limit,
                               .intensity_band = 2 * limit,
                               .transfer = model_transfer,
                               .scale = {1, 0}};
  return opc_test_host()->imaging->coherent_sum(opc_test_host(), mask, &systems,
                                                0, out, error);
}

static const opc_litho model = {.size = sizeof model,
                                .prepare = model_prepare,
                                .band = model_band,
                                .image = model_image};
static const opc_plugin model_plugin = {.size = sizeof model_plugin,
                                        .id = "lint.litho",
                                        .kind = OPC_KIND_LITHO,
                                        .operations = &model};

static void exercise_resist(opc_inspector *in, const opc_module *m) {
  static const opc_module litho = {&model_plugin, NULL};
  const opc_host *host = opc_test_host();
  const opc_resist *o = m->plugin->operations;
  opc_error error = {0};
  if (!went_well(in, "prepare", o->prepare(m->self, &litho, &error), &error))
    return;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    opc_spectrum mask;
    opc_field field;
    if (!make_mask(in, layer, limit, &mask)) return;
    int code = model_image(NULL, layer, &mask, &field, &error);
    host->imaging->release_spectrum(host, &mask);
    if (code) return;
    code = o->print(m->self, layer, &field, &error);
    if (went_well(in, "print", code, &error)) {
      opc_check_field(&field, &frame, "level set", &error);
      if (is_sound(in, "print", &error)) add_field(in, &field);
    }
    host->imaging->release_field(host, &field);
  }
}

/* ---- extract ---- */

/* The slices of the sample's gates, all of their length times a factor; 0: as
   if nothing had printed. */
static void fill_slices(const opc_gates *g, size_t n, const double *place,
                        const double *share, double length_factor,
                        double *width, double *length, double *edge) {
  for (size_t i = 0; i < g->count; i++)
    for (size_t s = 0; s < n; s++) {
      size_t k = i * n + s;
      width[k] = g->width[i] * share[s];
      length[k] = g->length[i] * length_factor;
      edge[k] = g->width[i] * fmin(place[s], 1 - place[s]);
    }
}

static void exercise_slices(opc_inspector *in, const opc_module *m, size_t n,
                            const double *place, const double *share) {
  const opc_extract *o = m->plugin->operations;
  const opc_gates *g = opc_test_gates();
  g_autofree double *slice = g_new0(double, 3 * n * g->count);
  double figure[12];
  static const double factors[] = {1, 0.8, 1.3, 0};
  for (size_t f = 0; f < G_N_ELEMENTS(factors); f++) {
    const opc_slices input = {sizeof input,
                              g->count,
                              n,
                              g->type,
                              slice,
                              slice + n * g->count,
                              slice + 2 * n * g->count};
    fill_slices(g, n, place, share, factors[f], slice, slice + n * g->count,
                slice + 2 * n * g->count);
    for (size_t i = 0; i < G_N_ELEMENTS(figure); i++) figure[i] = NAN;
    opc_performance out = {2,          figure,     figure + 2, figure + 4,
                           figure + 6, figure + 8, figure + 10};
    const uint32_t open[] = {OPC_PRINT_OPEN, OPC_PRINT_OPEN};
    opc_error error = {0};
    if (!went_well(in, "extract", o->extract(m->self, &input, &out, &error),
                   &error))
      return;
    opc_check_performance(g, 0, factors[f] == 0 ? open : NULL, &out, &error);
    if (!is_sound(in, "extract", &error)) return;
    add(in, figure, sizeof figure);
  }
  const opc_slices none = {.size = sizeof none, .slices = n};
  opc_performance nothing = {0};
  opc_error error = {0};
  went_well(in, "extract of no gates",
            o->extract(m->self, &none, &nothing, &error), &error);
}

/* A print that is shorter towards the LOW side, and ends before HIGH. */
static double printed_length(const opc_printed_gate *gate, double place) {
  return place > 0.95 ? 0 : gate->design_length * (0.8 + 0.3 * place);
}

static void exercise_slice(opc_inspector *in, const opc_module *m, size_t n) {
  const opc_extract *o = m->plugin->operations;
  const opc_gates *g = opc_test_gates();
  g_autofree double *room = g_new0(double, 2 * n);
  for (size_t i = 0; i < g->count; i++) {
    const opc_printed_gate gate = {.size = sizeof gate,
                                   .type = g->type[i],
                                   .design_length = g->length[i],
                                   .design_width = g->width[i],
                                   .width = 0.9 * g->width[i],
                                   .extension = {30, INFINITY},
                                   .length = printed_length};
    opc_error error = {0};
    o->slice(m->self, &gate, room, room + n);
    opc_check_slicing(n, room, room + n, &error);
    if (!is_sound(in, "slice", &error)) return;
    add(in, room, 2 * n * sizeof *room);
  }
}

static void exercise_extract(opc_inspector *in, const opc_module *m) {
  const opc_extract *o = m->plugin->operations;
  opc_error error = {0};
  if (!went_well(in, "prepare", o->prepare(m->self, &error), &error)) return;
  const double *place = NULL, *share = NULL;
  size_t n = o->slicing(m->self, &place, &share);
  opc_check_slicing(n, place, share, &error);
  if (!is_sound(in, "slicing", &error) || n > SLICES_MOST) return;
  if (OPC_HAS(o, slice)) exercise_slice(in, m, n);
  exercise_slices(in, m, n, place, share);
}

/* ---- mask ---- */

/* Two transistors of current W / L that print 5 nm too long and too short. */
static void print_sample(const opc_gates *g, const int32_t *l, const int32_t *w,
                         opc_performance *p) {
  for (size_t i = 0; i < g->count; i++) {
    double length = fmax(1, g->length[i] + l[i] + (i ? -5 : 5));
    double width = fmax(1, g->width[i] + w[i]);
    p->ion[i] = 1e-4 * width / length;
    p->ioff[i] = 1e-9 * width / length;
    p->leq_ion[i] = p->leq_ioff[i] = length;
    p->weq[i] = width;
    p->area[i] = width * length;
  }
}

/* The fragments that a synthesizer cuts itself. */
typedef struct fragments {
  size_t count[OPC_MASKS];
  int32_t *shift[OPC_MASKS];
  double *epe[OPC_MASKS];
  const opc_box *assists[OPC_MASKS];
  size_t assist_count[OPC_MASKS];
} fragments;

static gboolean cut_layers(opc_inspector *in, const opc_module *m,
                           fragments *out) {
  const opc_synthesizer *o = m->plugin->operations;
  const opc_gates *g = opc_test_gates();
  for (int layer = 0; layer < OPC_MASKS && OPC_HAS(o, cut); layer++) {
    opc_cuts cuts = {.size = sizeof cuts};
    opc_error error = {0};
    int code = o->cut(m->self, g, layer, &cuts, &error);
    if (!went_well(in, "cut", code, &error)) return FALSE;
    opc_check_cuts(g, layer, &cuts, &error);
    if (!is_sound(in, "cut", &error)) return FALSE;
    if (!cuts.polygons) continue;
    size_t n = out->count[layer] = cuts.start[cuts.polygons];
    out->shift[layer] = g_new0(int32_t, n);
    out->epe[layer] = g_new0(double, n);
    add(in, cuts.from, n * sizeof *cuts.from);
    add(in, cuts.site, 2 * n * sizeof *cuts.site);
    add(in, cuts.assists, cuts.assist_count * sizeof *cuts.assists);
    out->assists[layer] = cuts.assists;
    out->assist_count[layer] = cuts.assist_count;
  }
  return TRUE;
}

/* Edges that print 6 nm too far out or in, and sometimes not at all. */
static void print_fragments(const opc_gates *g, const fragments *f,
                            uint32_t iteration) {
  for (int layer = 0; layer < OPC_MASKS; layer++)
    for (size_t i = 0; i < f->count[layer]; i++)
      f->epe[layer][i] = iteration == 3 && i % 5 == 2
                             ? NAN
                             : f->shift[layer][i] * g->grid + (i % 3 ? 6 : -6);
}

static void exercise_moves(opc_inspector *in, const opc_module *m,
                           opc_feedback f, opc_performance *printed,
                           fragments *own) {
  const opc_synthesizer *o = m->plugin->operations;
  const opc_gates *g = opc_test_gates();
  uint32_t flags[2] = {0}, vetoes[2] = {0};
  int32_t l[2] = {0}, w[2] = {0}, jog[2] = {0}, end[4] = {0};
  opc_error error = {0};
  int done = 0;
  f.printed = printed;
  f.flags = flags;
  f.vetoes = vetoes;
  f.end = f.next_end = end;
  for (; f.iteration < ROUNDS && !done; f.iteration++) {
    print_sample(g, l, w, printed);
    print_fragments(g, own, f.iteration);
    vetoes[0] = f.iteration == 2 ? OPC_VETO_LONGER : 0;
    flags[1] = f.iteration == 3 ? OPC_PRINT_OPEN : 0;
    opc_moves moves = {.size = sizeof moves, .l = l, .w = w, .jog = jog};
    for (int layer = 0; layer < OPC_MASKS; layer++) {
      moves.shift[layer] = own->shift[layer];
      moves.assists[layer] = own->assists[layer];
      moves.assist_count[layer] = own->assist_count[layer];
      f.epe[layer] = own->epe[layer];
    }
    int code = o->update(m->self, &f, &moves, &done, &error);
    if (!went_well(in, "update", code, &error)) return;
    opc_check_moves(&moves, g->count, own->count, &error);
    if (!is_sound(in, "update", &error)) return;
    add(in, l, sizeof l);
    add(in, w, sizeof w);
    add(in, jog, sizeof jog);
    for (int layer = 0; layer < OPC_MASKS; layer++) {
      own->assists[layer] = moves.assists[layer];
      own->assist_count[layer] = moves.assist_count[layer];
      add(in, own->shift[layer], own->count[layer] * sizeof(int32_t));
      add(in, moves.assists[layer],
          moves.assist_count[layer] * sizeof(opc_box));
    }
  }
  for (size_t i = 0; i < g->count; i++) {
    const char *why = o->verdict(m->self, i);
    if (why && !g_utf8_validate(why, -1, NULL))
      opc_find(in, "verdict gave a text that is not UTF-8");
  }
}

static void exercise_mask(opc_inspector *in, const opc_module *m) {
  const opc_synthesizer *o = m->plugin->operations;
  const opc_gates *g = opc_test_gates();
  double a[12], b[12];
  opc_performance design = {2, a, a + 2, a + 4, a + 6, a + 8, a + 10};
  opc_performance printed = {2, b, b + 2, b + 4, b + 6, b + 8, b + 10};
  const uint32_t none[2] = {0};
  const int32_t l[2] = {-5, 5}, w[2] = {0};
  print_sample(g, l, w, &design);
  opc_feedback f = {.size = sizeof f, .gates = g, .design = &design,
                    .flags = none, .vetoes = none};
  fragments own = {0};
  opc_error error = {0};
  if (went_well(in, "begin", o->begin(m->self, &f, &error), &error) &&
      cut_layers(in, m, &own))
    exercise_moves(in, m, f, &printed, &own);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    g_free(own.shift[layer]);
    g_free(own.epe[layer]);
  }
}

/* ---- drc ---- */

/* The drawn shapes as a mask, and what it prints through the model above. */
static gboolean print_drawn(opc_inspector *in, opc_field print[OPC_MASKS]) {
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    opc_spectrum mask;
    opc_error error = {0};
    opc_field *f = &print[layer];
    if (!make_mask(in, layer, limit, &mask)) return FALSE;
    int code = model_image(NULL, layer, &mask, f, &error);
    opc_test_host()->imaging->release_spectrum(opc_test_host(), &mask);
    if (code) return FALSE;
    for (int i = 0; i < f->nx * f->ny; i++)
      f->coefficients[i] = 0.3F - f->coefficients[i];
  }
  return TRUE;
}

static void exercise_rules(opc_inspector *in, const opc_module *m,
                           const opc_printed *printed) {
  const opc_regulator *o = m->plugin->operations;
  uint32_t vetoes[2] = {0};
  int32_t end[4] = {0};
  opc_ruling ruling = {.size = sizeof ruling, .vetoes = vetoes, .end = end};
  opc_error error = {0};
  size_t gates = printed->gates->count;
  if (!went_well(in, "rule", o->rule(m->self, printed, &ruling, &error),
                 &error))
    return;
  opc_check_ruling(&ruling, gates, &error);
  if (!is_sound(in, "rule", &error)) return;
  add(in, vetoes, sizeof vetoes);
  add(in, end, sizeof end);
  for (int layer = 0; layer < OPC_MASKS; layer++)
    add(in, ruling.patches[layer],
        ruling.patch_count[layer] * sizeof(opc_box));
  for (int layer = 0; layer < OPC_MASKS; layer++)
    add(in, ruling.bites[layer], ruling.bite_count[layer] * sizeof(opc_box));
  opc_violation list[64] = {{0}};
  size_t many = 0, none = 0;
  if (!went_well(in, "violations",
                 o->violations(m->self, printed, list, 64, &many, &error),
                 &error) ||
      !went_well(in, "violations without room",
                 o->violations(m->self, printed, NULL, 0, &none, &error),
                 &error))
    return;
  opc_check_violations(list, MIN(many, 64), gates, &error);
  is_sound(in, "violations", &error);
  if (many != none)
    opc_find(in, "violations counts %zu with room and %zu without", many, none);
}

static void exercise_drc(opc_inspector *in, const opc_module *m) {
  const opc_gates *g = opc_test_gates();
  const uint32_t flags[2] = {0, OPC_PRINT_MERGED};
  const int32_t l[2] = {3, -2}, w[2] = {0, 1};
  const double extension[4] = {60, INFINITY, INFINITY, -5};
  opc_field print[OPC_MASKS] = {{{0}, 0, 0, NULL}};
  const opc_printed printed = {.size = sizeof printed, .iteration = 1, .gates = g,
                               .flags = flags, .l = l, .w = w,
                               .extension = extension, .mask = g->drawn,
                               .print = print};
  if (print_drawn(in, print)) exercise_rules(in, m, &printed);
  for (int layer = 0; layer < OPC_MASKS; layer++)
    opc_test_host()->imaging->release_field(opc_test_host(), &print[layer]);
}

/* ---- entry ---- */

void opc_exercise(opc_inspector *in, const opc_module *m) {
  switch (m->plugin->kind) {
    case OPC_KIND_LITHO:
      exercise_litho(in, m);
      break;
    case OPC_KIND_RESIST:
      exercise_resist(in, m);
      break;
    case OPC_KIND_EXTRACT:
      exercise_extract(in, m);
      break;
    case OPC_KIND_MASK:
      exercise_mask(in, m);
      break;
    case OPC_KIND_DRC:
      exercise_drc(in, m);
      break;
    default: /* a step's inputs are its own */
      break;
  }
}
