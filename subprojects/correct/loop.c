/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the loop of thesis figures 2.1, 3.1 and 5.1. The loop simulates a
   mask, extracts the performance of each transistor, and lets synthesizers
   displace mask edges within the limits of a regulator, until all synthesizers
   are done. All algorithms are plugins; the loop passes arrays between them. */
#include <correct/loop.h>

#include <eda/check.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/fine.h>

static const char *const slots[DRIVERS] = {"synthesizer", "edges"};

/* ---- changes ---- */

static int layer_changed(const loop *l, size_t layer) {
  return correct_trial_differs(&l->now, &l->next, layer);
}

/* Return 1 if a layer of this driver changed. */
static int any_changed(const loop *l, int which) {
  for (size_t k = 0; k < l->gates->layers; k++)
    if (l->driver_of[k] == which && layer_changed(l, k)) return 1;
  return 0;
}

/* Clear the biases of layers that are dissected into fragments. */
static void drop_biases(loop *l) {
  size_t n = l->gates->count * sizeof(int32_t), layers = l->gates->layers;
  biases *b = &l->next.biases;
  if (layers > EDA_ACTIVE && l->next.shift[EDA_ACTIVE])
    memset(b->w, 0, TRIAL_ACTIVE_BIASES * n);
  if (layers && l->next.shift[EDA_POLY]) memset(b->l, 0, TRIAL_POLY_BIASES * n);
}

/* ---- one print ---- */

/* Build the mask of a layer of `now`. */
static int make_mask(loop *l, size_t layer, opc_error *error) {
  pieces *p = &l->pieces[layer];
  if (l->now.shift[layer])
    memcpy(p->by, l->now.shift[layer], l->sites[layer].count * sizeof *p->by);
  else
    correct_pieces_follow(l->gates, layer, &l->now.biases, p);
  correct_pieces_build(p, &l->polygons[layer]);
  eda_shapes_clear(&l->mask[layer]);
  const eda_boxes all[] = {l->now.added[layer], l->now.assists[layer]};
  return correct_mask_merge(&l->polygons[layer], (boxes_lists){all, 2},
                            (boxes_lists){&l->now.cutouts[layer], 1},
                            &l->mask[layer], error);
}

/* Measure the transistors if poly or active was simulated. */
static int loop_measure(loop *l, const uint8_t *printed, opc_error *error) {
  int again = 0;
  for (size_t k = 0; k <= EDA_ACTIVE && k < l->gates->layers; k++)
    again |= printed[k];
  if (!again) return OPC_OK;
  int code = eda_measure(l->host->context, l->gates, l->printer.print,
                         l->extractor, &l->measured, error);
  if (code) return code;
  /* After an accurate simulation, images include the difference of models. */
  if (l->base && !l->printer.fine_simulations)
    correct_start_correct(l->base, &l->measured.performance);
  return correct_corners_measure(l, error);
}

/* Copy the measurement for synthesizers; transistors that keep their masks get
   their drawn figures. */
static void loop_show(loop *l) {
  const eda_performance *drawn = &l->design;
  eda_measurement *to = &l->shown;
  if (!l->still) return;
  eda_performance_copy(&to->performance, &l->measured.performance);
  memcpy(to->flags, l->measured.flags, l->gates->count * sizeof *to->flags);
  for (size_t i = 0; i < l->gates->count; i++)
    if (l->still[i]) {
      to->flags[i] = 0;
      eda_performance_one(&to->performance, drawn, i);
    }
}

/* Measure and record a simulation of the layers k with printed[k] = 1. */
static int take_in(loop *l, const uint8_t *printed, int fine,
                   opc_error *error) {
  int code = loop_measure(l, printed, error);
  for (size_t k = 0; k < l->gates->layers && !code; k++)
    if (printed[k])
      correct_sites_measure(l->host->context, &l->sites[k],
                            &l->printer.print[k],
                            eda_scanner_of(&l->printer.litho.module));
  if (code) return code;
  if (!l->guard.prints) correct_start_open(l, 0);
  loop_show(l);
  l->summary = correct_summarize(l->gates, &l->design, &l->measured.performance,
                                 l->measured.flags, l->sites);
  if (!l->guard.prints)
    correct_history_add(&l->history, &l->summary, l->iterations, &l->printer,
                        fine);
  correct_guard_watch(l);
  if (l->traced) correct_trace_add(&l->trace, l);
  return fine ? correct_verification_of_drawn(l, error) : OPC_OK;
}

int correct_loop_refine(loop *l, opc_error *error) {
  const uint8_t *all = l->gates->corrected;
  int code = eda_printer_refine(&l->printer, all, l->mask, error);
  if (!code) code = correct_corners_refine(l, all, error);
  return code ? code : take_in(l, all, 1, error);
}

static int loop_judge(loop *l, int smooth, opc_error *error);

/* Build the masks of changed layers of `next`, or of all, and copy `next` to
   `now`. `smooth`: the regulator repairs the mask rules of changed masks. Set
   printed[k] of the built layers. */
static int make_masks(loop *l, int all, int smooth, uint8_t *printed,
                      opc_error *error) {
  enum { PASSES = 8 }; /* a repair may require the next; most masks need 2 */
  const eda_regulator *r = l->regulator ? l->regulator->functions : NULL;
  size_t layers = l->gates->layers;
  uint8_t *fresh = eda_alloc(layers, 1);
  int smooths = smooth && r && r->smooth, again = 1, code = OPC_OK;
  for (int pass = 0; again && !code && pass <= PASSES; pass++) {
    if (pass) code = loop_judge(l, 1, error);
    again = 0;
    for (size_t k = 0; k < layers; k++) {
      fresh[k] = l->gates->corrected[k] && (all || layer_changed(l, k));
      printed[k] |= fresh[k];
      again |= fresh[k] && smooths;
    }
    correct_trial_copy(&l->now, &l->next);
    for (size_t k = 0; k < layers && !code; k++)
      if (fresh[k]) code = make_mask(l, k, error);
  }
  free(fresh);
  return code;
}

static int loop_print(loop *l, int all, int smooth, opc_error *error) {
  uint8_t *printed = eda_alloc(l->gates->layers, 1);
  int code = make_masks(l, all, smooth, printed, error);
  if (!code) code = eda_printer_print(&l->printer, printed, l->mask, error);
  if (!code) code = correct_corners_print(l, printed, error);
  if (!code)
    code = correct_verification_is_early(l) ? correct_loop_refine(l, error)
                                            : take_in(l, printed, 0, error);
  free(printed);
  return code;
}

int correct_loop_print(loop *l, int all, opc_error *error) {
  return loop_print(l, all, 0, error);
}

/* ---- calls of plugins ---- */

static int loop_rule(loop *l, int smooth, eda_ruling *ruling,
                     opc_error *error) {
  eda_printed p = correct_loop_printed(l);
  int code =
      eda_call_rule(l->host->context, l->regulator, &p, smooth, ruling, error);
  if (code) return eda_blame(error, code, "regulator");
  for (size_t k = 0; k < l->gates->layers; k++) {
    /* Added shapes repair drawn edges of transistors. In poly and active layers
       that a synthesizer dissects, violations are only counted. */
    if (l->gates->count && k <= EDA_ACTIVE && l->next.shift[k]) continue;
    correct_start_open_touched(l, k, ruling);
    correct_trial_set_both(&l->next.added[k], correct_loop_begun(l, k, 0),
                           ruling->added[k]);
    correct_trial_set_both(&l->next.cutouts[k], correct_loop_begun(l, k, 1),
                           ruling->cutouts[k]);
  }
  return OPC_OK;
}

/* Let the regulator set the vetoes, and the line ends, added shapes and
   cut-outs of `next`. */
static int loop_judge(loop *l, int smooth, opc_error *error) {
  size_t layers = l->gates->layers;
  if (!smooth) memset(l->vetoes, 0, l->gates->count * sizeof *l->vetoes);
  if (!l->regulator) return OPC_OK;
  eda_ruling ruling = {.vetoes = l->vetoes,
                       .end = l->next.biases.end,
                       .added = eda_alloc(layers, sizeof *ruling.added),
                       .cutouts = eda_alloc(layers, sizeof *ruling.cutouts)};
  eda_boxes *added = ruling.added, *cutouts = ruling.cutouts;
  int code = loop_rule(l, smooth, &ruling, error);
  free(added);
  free(cutouts);
  drop_biases(l);
  correct_start_keep(l);
  return code;
}

static eda_feedback feedback_of(const loop *l, const driver *d) {
  const eda_measurement *m = l->still ? &l->shown : &l->measured;
  return (eda_feedback){.iteration = l->iterations,
                        .gates = l->gates,
                        .design = &l->design,
                        .printed = &m->performance,
                        .flags = m->flags,
                        .vetoes = l->vetoes,
                        .epe = d->epe,
                        .end = l->now.biases.end,
                        .next_end = l->next.biases.end,
                        .print = l->printer.print,
                        .ion_limit = &l->ion_limit,
                        .rules = l->rules,
                        .refines = l->start.limit != NULL,
                        .scanner = eda_scanner_of(&l->printer.litho.module)};
}

/* Return 1 if a layer has edges that belong to gates. */
static int has_gates(const eda_gates *gates, size_t layer) {
  const eda_edges *e = &gates->edges[layer];
  size_t n = e->polygons ? e->start[e->polygons] : 0;
  for (size_t i = 0; i < n; i++)
    if (e->fragments[i].role != EDA_FIXED) return 1;
  return 0;
}

/* Store the fragments into which a synthesizer dissected a layer. */
static void take_cuts(loop *l, size_t layer, int which, const eda_cuts *cuts) {
  driver *d = &l->drivers[which];
  correct_pieces_of_cuts(cuts, &l->pieces[layer]);
  correct_sites_init(&l->sites[layer], cuts);
  size_t n = d->fragments[layer] = l->sites[layer].count;
  correct_trial_cut(&l->now, layer, n);
  correct_trial_cut(&l->next, layer, n);
  l->driver_of[layer] = (uint8_t)which;
  d->shift[layer] = l->next.shift[layer];
  d->epe[layer] = l->sites[layer].epe;
}

/* Ask a synthesizer for its dissection of a layer, which may be empty. */
static int ask_for_cuts(loop *l, size_t layer, int which, opc_error *error) {
  const opc_module *module = l->drivers[which].module;
  const eda_synthesizer *s = module ? module->functions : NULL;
  eda_cuts cuts = {0};
  if (!s || !s->cut) return OPC_OK;
  const char *before = eda_enter(l->host->context, module, error);
  int code = s->cut(module->self, l->gates, (int)layer, &cuts, error);
  if (!code) code = eda_check_cuts(l->gates, (int)layer, &cuts, error);
  opc_leave(l->host->context, before);
  if (code) return eda_blame(error, code, slots[which]);
  correct_trial_set_boxes(&l->next.assists[layer], cuts.assists);
  if (cuts.polygons) take_cuts(l, layer, which, &cuts);
  return OPC_OK;
}

/* Dissect a layer: by a synthesizer, or else at the edges of its gates. */
static int cut_layer(loop *l, size_t layer, opc_error *error) {
  const eda_gates *g = l->gates;
  if (!g->corrected[layer]) return OPC_OK;
  int code = ask_for_cuts(l, layer, MAIN, error);
  if (!code && !l->now.shift[layer] && !has_gates(g, layer))
    code = ask_for_cuts(l, layer, EDGES, error);
  if (code) return code;
  if (!l->now.shift[layer])
    correct_pieces_of_edges(&g->edges[layer], l->base != NULL,
                            &l->pieces[layer]);
  eda_shapes *polygons = &l->polygons[layer];
  correct_pieces_alloc(&l->pieces[layer], polygons);
  if (!g->drawn[layer].hole) return OPC_OK;
  polygons->hole = eda_alloc(polygons->count, 1);
  if (polygons->count)
    memcpy(polygons->hole, g->drawn[layer].hole, polygons->count);
  return OPC_OK;
}

/* Warn of layers that no synthesizer moves, and of `edges` without a layer. */
static void loop_log_idle(const loop *l) {
  const opc_host *host = l->host;
  int edges = 0;
  for (size_t k = 0; k < l->gates->layers; k++) {
    if (!l->gates->corrected[k]) continue;
    if (l->now.shift[k])
      edges |= l->driver_of[k] == EDGES;
    else if (!has_gates(l->gates, k))
      host->log(host, OPC_LOG_WARNING,
                "layer '%s' keeps the drawn mask: neither 'synthesizer' nor "
                "'edges' moves the edges of this layer",
                l->gates->layer[k]);
  }
  if (l->drivers[EDGES].module && !edges)
    host->log(host, OPC_LOG_WARNING, "'edges' (%s) moves no layer",
              l->drivers[EDGES].module->id);
}

static int loop_begin(loop *l, opc_error *error) {
  int code = OPC_OK;
  for (int which = 0; which < DRIVERS; which++) {
    driver *d = &l->drivers[which];
    d->done = !d->module;
    if (!d->module) continue;
    const eda_synthesizer *s = d->module->functions;
    eda_feedback f = feedback_of(l, d);
    f.printed = NULL;
    f.print = NULL;
    const char *before = eda_enter(l->host->context, d->module, error);
    code = s->begin(d->module->self, &f, error);
    opc_leave(l->host->context, before);
    if (code) return eda_blame(error, code, slots[which]);
  }
  for (size_t k = 0; k < l->gates->layers && !code; k++)
    code = cut_layer(l, k, error);
  if (!code) code = correct_assists_begin(l, error);
  if (!code) code = correct_search_begin(l, error);
  if (!code) code = correct_assists_check(l, error);
  if (!code) loop_log_idle(l);
  return code;
}

/* Let a synthesizer set displacements in `next`. Store scatter bars of its own
   layers only. */
static int driver_move(loop *l, int which, eda_moves *moves, opc_error *error) {
  driver *d = &l->drivers[which];
  eda_feedback f = feedback_of(l, d);
  int code = eda_call_update(l->host->context, d->module, &f, d->fragments,
                             moves, &d->done, error);
  if (code) return eda_blame(error, code, slots[which]);
  for (size_t k = 0; k < l->gates->layers; k++)
    if (l->driver_of[k] == which)
      correct_trial_set_boxes(&l->next.assists[k], moves->assists[k]);
  return OPC_OK;
}

/* Let a synthesizer compute displacements; discard biases that EDGES sets. */
static int driver_update(loop *l, int which, opc_error *error) {
  size_t n = l->gates->count, layers = l->gates->layers;
  const biases *b = &l->next.biases;
  eda_boxes *assists = eda_alloc(layers, sizeof *assists);
  memcpy(assists, l->next.assists, layers * sizeof *assists);
  eda_moves moves = {.l = b->l,
                     .w = b->w,
                     .jog = b->jog,
                     .part = b->part,
                     .aside = b->aside,
                     .shift = l->drivers[which].shift,
                     .assists = assists};
  if (which == EDGES) {
    const trial *t = &l->now;
    size_t all = TRIAL_BIASES * n * sizeof(int32_t);
    biases idle = correct_biases_in(memcpy(l->unused, t->biases.w, all), n);
    moves.l = idle.l;
    moves.w = idle.w;
    moves.jog = idle.jog;
    moves.part = idle.part;
    moves.aside = idle.aside;
  }
  int code = driver_move(l, which, &moves, error);
  free(assists);
  drop_biases(l);
  correct_start_keep(l);
  return code;
}

/* ---- the loop ---- */

/* Return the largest |Ion deviation|, %; without transistors, |EPE|, nm. */
static double loop_worst(const loop *l) {
  return l->summary.gates ? l->summary.ion_max : l->summary.epe_max;
}

static const char *worst_unit(const loop *l) {
  return l->summary.gates ? "%" : "nm";
}

/* Log that the loop ends before its synthesizers have finished. If all
   transistors are within the limit, log no finding. */
static void loop_log_unconverged(const loop *l) {
  char worst[64] = "nothing prints";
  if (!isnan(loop_worst(l)))
    (void)snprintf(worst, sizeof worst, "worst deviation %.3g %s",
                   loop_worst(l), worst_unit(l));
  int within = l->summary.gates && loop_worst(l) <= l->ion_limit;
  l->host->log(l->host, within ? OPC_LOG_INFO : OPC_LOG_FINDING,
               "not converged after %d iteration%s ('max_iterations'): %s",
               (int)l->max_iterations, l->max_iterations == 1 ? "" : "s",
               worst);
}

static int loop_is_cancelled(const loop *l) {
  opc_progress progress = {.done = l->iterations,
                           .total = (double)l->max_iterations,
                           .worst = loop_worst(l),
                           .worst_unit = worst_unit(l)};
  l->host->progress(l->host, &progress);
  return opc_cancelled(l->host->context);
}

static int ends_anytime(const driver *d) {
  const eda_synthesizer *s = d->module->functions;
  return s->flags & EDA_SYNTHESIZER_ENDS_ANYTIME;
}

/* Call the synthesizers that have not finished, and synthesizers whose layers
   the regulator changed (ruled[which] = 1). */
static int move_all(loop *l, const int *ruled, opc_error *error) {
  int code = OPC_OK;
  for (int which = 0; which < DRIVERS && !code; which++) {
    driver *d = &l->drivers[which];
    if (!d->module || (d->done && !ruled[which])) continue;
    d->done = 0;
    code = driver_update(l, which, error);
    /* Continue, because the regulator's change has not been simulated yet. */
    if (ruled[which] && ends_anytime(d)) d->done = 0;
  }
  return code;
}

static int all_done(const loop *l) {
  return l->drivers[MAIN].done && l->drivers[EDGES].done;
}

static int loop_iterate(loop *l, opc_error *error) {
  int code = OPC_OK;
  int64_t prints = 0;
  for (; !code; code = loop_print(l, 0, 1, error)) {
    if (loop_is_cancelled(l))
      return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    if ((code = loop_judge(l, 0, error))) return code;
    correct_assists_watch(l);
    if ((code = correct_search_watch(l, all_done(l), error))) return code;
    int ruled[DRIVERS], wait = 0;
    for (int which = 0; which < DRIVERS; which++) {
      ruled[which] = any_changed(l, which);
      wait |= ruled[which] && !ends_anytime(&l->drivers[which]);
    }
    if (all_done(l) && !ruled[MAIN] && !ruled[EDGES]) return OPC_OK;
    /* Simulate new line ends before the first displacements, so that the
       synthesizer does not attribute their effect to its displacements. */
    if (l->iterations == 0 && !l->base && wait && prints++ < l->max_iterations)
      continue;
    if (l->iterations == l->max_iterations) {
      loop_log_unconverged(l);
      return OPC_OK;
    }
    if ((code = move_all(l, ruled, error))) return code;
    l->iterations++;
    if ((all_done(l) || correct_start_is_done(l)) && !any_changed(l, MAIN) &&
        !any_changed(l, EDGES))
      return OPC_OK;
  }
  return code;
}

/* Count violations without a stated cause, which may still be repaired. */
static int count_open(loop *l, size_t *count, opc_error *error) {
  eda_violation *v = NULL;
  size_t n = 0;
  *count = 0;
  if (!l->regulator) return OPC_OK;
  eda_printed p = correct_loop_printed(l);
  int code =
      correct_violations(l->host->context, l->regulator, &p, &v, &n, error);
  for (size_t i = 0; i < n && !code; i++) *count += !strchr(v[i].rule, ';');
  free(v);
  return code;
}

/* Iterate until an accurate simulation verifies the result (VERIFICATIONS). */
static int loop_iterate_verified(loop *l, opc_error *error) {
  int code = OPC_OK, holds = 0;
  for (int k = 0; k < VERIFICATIONS && !holds && !code; k++) {
    size_t open = 0, now = 0;
    int due = 0;
    for (int which = 0; which < DRIVERS; which++)
      l->drivers[which].done = !l->drivers[which].module;
    code = loop_iterate(l, error);
    if (!code) due = correct_verification_is_due(l);
    if (due) code = count_open(l, &open, error);
    if (!code) code = correct_verification_of_end(l, &holds, error);
    if (!code && due) code = count_open(l, &now, error);
    holds &= now <= open;
    if (l->iterations == l->max_iterations) break;
  }
  return code;
}

static void loop_allocate(loop *l) {
  size_t n = l->gates->count, layers = l->gates->layers;
  for (int which = 0; which < DRIVERS; which++) {
    driver *d = &l->drivers[which];
    d->epe = eda_alloc(layers, sizeof *d->epe);
    d->shift = eda_alloc(layers, sizeof *d->shift);
    d->fragments = eda_alloc(layers, sizeof *d->fragments);
  }
  l->driver_of = eda_alloc(layers, 1);
  l->pieces = eda_alloc(layers, sizeof *l->pieces);
  l->polygons = eda_alloc(layers, sizeof *l->polygons);
  l->mask = eda_alloc(layers, sizeof *l->mask);
  l->sites = eda_alloc(layers, sizeof *l->sites);
  l->unused = eda_alloc(TRIAL_BIASES * n, sizeof *l->unused);
  l->vetoes = eda_alloc(n, sizeof *l->vetoes);
  correct_trial_init(&l->now, layers, n);
  correct_trial_init(&l->next, layers, n);
  correct_start_begin(l);
  eda_measurement_init(&l->measured, n);
  eda_measurement_init(&l->shown, n);
  eda_performance_init(&l->design, n);
  eda_performance_init(&l->before, n);
  correct_guard_init(&l->guard, n);
  l->drawn_print = eda_alloc(layers, sizeof *l->drawn_print);
}

static void keep_drawn_print(loop *l) {
  for (size_t k = 0; k < l->gates->layers; k++)
    if (l->gates->corrected[k])
      l->drawn_print[k] = eda_field_scaled(&l->printer.print[k], 1);
}

int correct_loop_run(loop *l, opc_error *error) {
  const opc_context *context = l->host->context;
  loop_allocate(l);
  int code = eda_printer_prepare(&l->printer, error);
  if (!code) code = correct_corners_begin(l, error);
  if (!code && !l->prepared)
    code = eda_extractor_prepare(context, l->extractor, error);
  if (!code)
    code =
        eda_measure_drawn(context, l->gates, l->extractor, &l->design, error);
  if (!code) code = loop_begin(l, error);
  if (!code) code = correct_loop_print(l, 1, error);
  if (code) return code;
  loop_show(l);
  eda_performance_copy(&l->before, l->corners.count ? &l->corners.nominal
                                                    : &l->measured.performance);
  keep_drawn_print(l);
  eda_printed drawn = correct_loop_printed(l);
  code = correct_guard_begin(l, &drawn, error);
  correct_start_prune(l);
  correct_start_open(l, 1);
  if (!code)
    code = correct_fine_by_layer(&l->printer, l->host, l->gates, l->extractor,
                                 l->fine_change, error);
  if (!code) code = correct_verification_begin(l, error);
  if (!code) code = loop_iterate_verified(l, error);
  if (code || !l->gates->count) return code;
  if (l->hold) return correct_guard_hold(l, error);
  correct_guard_count(l);
  return OPC_OK;
}

void correct_loop_clear(loop *l) {
  size_t layers = l->gates->layers;
  correct_trial_clear(&l->now);
  correct_trial_clear(&l->next);
  eda_measurement_clear(&l->measured);
  eda_measurement_clear(&l->shown);
  eda_performance_clear(&l->design);
  eda_performance_clear(&l->before);
  for (size_t k = 0; k < layers; k++) {
    correct_pieces_clear(&l->pieces[k]);
    correct_sites_clear(&l->sites[k]);
    eda_shapes_clear(&l->polygons[k]);
    eda_shapes_clear(&l->mask[k]);
    eda_field_clear(&l->drawn_print[k]);
  }
  free(l->drawn_print);
  for (int which = 0; which < DRIVERS; which++) {
    free(l->drivers[which].epe);
    free(l->drivers[which].shift);
    free(l->drivers[which].fragments);
  }
  free(l->driver_of);
  free(l->pieces);
  free(l->polygons);
  free(l->mask);
  free(l->sites);
  free(l->unused);
  for (size_t k = 0; k < 2 * layers; k++) free((eda_box *)l->begun[k].box);
  free(l->begun);
  free(l->whole.w);
  free(l->vetoes);
  free(l->still);
  correct_history_clear(&l->history);
  correct_guard_clear(&l->guard);
  correct_verification_clear(l);
  correct_trace_clear(&l->trace);
  correct_corners_clear(l);
  correct_assists_clear(l);
  correct_search_clear(l);
  eda_printer_clear(&l->printer);
}
