/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "synthesizer". Lists the functions that a synthesizer must have, tests
   them on sample transistors, and registers the template of a new synthesizer
   (templates.h). */
#include <eda/synthesizer.h>
#include <math.h>
#include <stdlib.h>

#include "../try.h"
#include "templates.h"

enum {
  MOST_ROUNDS = 500, /* iterations after which the method must have ended */
  GATES = 2          /* gates of the sample */
};

/* The fragments that the synthesizer defines, [layers]: number, displacements
   (grid steps), edge placement errors (nm), and assist features. */
typedef struct fragments {
  size_t *count;
  int32_t **shift;
  double **epe;
  eda_boxes *assists;
} fragments;

/* ---- work ---- */

/* Compute the performance of the two transistors for mask biases l and w. With
   a bias of 0, the first prints 5 nm too long and the second 5 nm too short.
   Currents are proportional to W / L. */
static void print_gates(const eda_gates *g, const int32_t *l, const int32_t *w,
                        eda_performance *p) {
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

/* Compute edge placement errors: -6 or 6 nm plus the displacement of the
   fragment. In iteration 3, some edges do not print (NAN). */
static void print_fragments(const eda_gates *g, const fragments *f,
                            uint32_t iteration) {
  for (size_t k = 0; k < g->layers; k++)
    for (size_t i = 0; i < f->count[k]; i++)
      f->epe[k][i] = iteration == 3 && i % 5 == 2
                         ? NAN
                         : f->shift[k][i] * g->grid + (i % 3 ? 6 : -6);
}

static int try_cut(opc_inspector *in, const opc_module *m, int layer,
                   fragments *out) {
  const eda_synthesizer *o = m->functions;
  const eda_gates *g = eda_gates_sample();
  eda_cuts cuts = {0};
  opc_error error = {0};
  const char *before = eda_enter(in->context, m, &error);
  int code = o->cut(m->self, g, layer, &cuts, &error);
  opc_leave(in->context, before);
  if (!try_went_well(in, "cut", code, &error)) return 0;
  code = eda_check_cuts(g, layer, &cuts, &error);
  if (!try_is_sound(in, "cut", code, &error)) return 0;
  if (!cuts.polygons) return 1;
  size_t n = out->count[layer] = cuts.start[cuts.polygons];
  out->shift[layer] = eda_alloc(n, sizeof(int32_t));
  out->epe[layer] = eda_alloc(n, sizeof(double));
  out->assists[layer] = cuts.assists;
  in->add(in, cuts.from, n * sizeof *cuts.from);
  in->add(in, cuts.site, 2 * n * sizeof *cuts.site);
  in->add(in, cuts.assists.box, cuts.assists.count * sizeof(eda_box));
  return 1;
}

/* Clear the results of an open gate. */
static void open_gate(eda_performance *p, size_t i) {
  p->ion[i] = p->ioff[i] = p->leq_ion[i] = p->leq_ioff[i] = 0;
  p->weq[i] = p->area[i] = 0;
}

static int forward_update(void *self, const eda_feedback *f, eda_moves *moves,
                          int *done, opc_error *error) {
  const try_shim *shim = self;
  const eda_synthesizer *o = shim->plugin->functions;
  return *shim->code = o->update(shim->plugin->self, f, moves, done, error);
}

static const eda_synthesizer forwards = {.update = forward_update};

/* Run iterations until the synthesizer reports that it is done. Iteration 2 has
   a veto, iteration 3 an open gate. */
static int try_moves(opc_inspector *in, const opc_module *m, eda_feedback f,
                     eda_performance *printed, fragments *own) {
  const eda_gates *g = f.gates;
  uint32_t flags[GATES] = {0}, vetoes[GATES] = {0};
  int32_t l[GATES] = {0}, w[GATES] = {0}, jog[GATES] = {0};
  int32_t aside[GATES] = {0};
  eda_part part[GATES * EDA_PARTS] = {{0}};
  opc_error error = {0};
  int done = 0;
  f.printed = printed;
  f.flags = flags;
  f.vetoes = vetoes;
  f.epe = (const double *const *)own->epe;
  eda_moves moves = {l, w, jog, own->shift, own->assists, part, aside};
  for (; f.iteration < MOST_ROUNDS && !done; f.iteration++) {
    print_gates(g, l, w, printed);
    print_fragments(g, own, f.iteration);
    vetoes[0] = f.iteration == 2 ? EDA_VETO_LONGER : 0;
    flags[1] = f.iteration == 3 ? EDA_PRINT_OPEN : 0;
    if (flags[1]) open_gate(printed, 1);
    int its = OPC_OK;
    const try_shim shim = {m, &its};
    const opc_module shown = {&forwards, (void *)&shim, m->id};
    int code = eda_call_update(in->context, &shown, &f, own->count, &moves,
                               &done, &error);
    if (!try_call(in, "update", its, code, &error)) return 0;
    in->add(in, l, sizeof l);
    in->add(in, w, sizeof w);
    in->add(in, jog, sizeof jog);
    in->add(in, part, sizeof part);
    in->add(in, aside, sizeof aside);
    for (size_t k = 0; k < g->layers; k++) {
      const eda_boxes *srafs = &own->assists[k];
      in->add(in, own->shift[k], own->count[k] * sizeof(int32_t));
      in->add(in, srafs->box, srafs->count * sizeof(eda_box));
    }
  }
  if (!done)
    in->find(in, "update is not done after %d iterations", MOST_ROUNDS);
  return 1;
}

static void try_verdicts(opc_inspector *in, const opc_module *m) {
  for (size_t i = 0; i < GATES; i++) {
    const char *verdict;
    opc_error error = {0};
    int code = eda_call_verdict(in->context, m, i, &verdict, &error);
    if (!try_is_sound(in, "verdict", code, &error)) return;
  }
}

static void try_targets(opc_inspector *in, const opc_module *m) {
  const eda_synthesizer *o = m->functions;
  for (size_t i = 0; o->target && i < GATES; i++) {
    const char *before = opc_enter(in->context, m->id);
    double target = o->target(m->self, i);
    opc_leave(in->context, before);
    if (!isnan(target) && !(target > 0 && isfinite(target)))
      in->find(in, "target of transistor %zu is %g", i + 1, target);
  }
}

static void exercise(const opc_module *m, opc_inspector *in) {
  const eda_synthesizer *o = m->functions;
  const eda_gates *g = eda_gates_sample();
  const int32_t l[GATES] = {-5, 5}, w[GATES] = {0}, end[2 * GATES] = {0};
  const uint32_t none[GATES] = {0};
  eda_performance design, printed;
  fragments own = {eda_alloc(g->layers, sizeof(size_t)),
                   eda_alloc(g->layers, sizeof(int32_t *)),
                   eda_alloc(g->layers, sizeof(double *)),
                   eda_alloc(g->layers, sizeof(eda_boxes))};
  opc_error error = {0};
  eda_performance_init(&design, g->count);
  eda_performance_init(&printed, g->count);
  print_gates(g, l, w, &design);
  const eda_feedback f = {.gates = g,
                          .design = &design,
                          .flags = none,
                          .vetoes = none,
                          .epe = (const double *const *)own.epe,
                          .end = end,
                          .next_end = end};
  const char *before = eda_enter(in->context, m, &error);
  int code = o->begin(m->self, &f, &error);
  opc_leave(in->context, before);
  int good = try_went_well(in, "begin", code, &error);
  for (size_t k = 0; k < g->layers && good; k++)
    if (o->cut && g->corrected[k]) good = try_cut(in, m, (int)k, &own);
  if (good) try_targets(in, m);
  if (good && try_moves(in, m, f, &printed, &own)) try_verdicts(in, m);
  for (size_t k = 0; k < g->layers; k++) {
    free(own.shift[k]);
    free(own.epe[k]);
  }
  free(own.count);
  free(own.shift);
  free(own.epe);
  free(own.assists);
  eda_performance_clear(&design);
  eda_performance_clear(&printed);
}

/* ---- entry ---- */

static const opc_function required[] = {OPC_FUNCTION(eda_synthesizer, begin),
                                        OPC_FUNCTION(eda_synthesizer, update)};
OPC_KIND("synthesizer", eda_synthesizer,
         "synthesizers: edge displacements from measured transistors");
