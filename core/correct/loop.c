/* SPDX-License-Identifier: BSD-3-Clause */
/* The loop of thesis figures 2.1, 3.1 and 5.1. A mask is printed, each
   transistor's performance taken from the print, and the mask's edges moved by
   a synthesizer, within what a regulator allows, until the synthesizer is
   done. All boxes of the figures are plugins; the loop only hands arrays from
   one to the next. */
#include "core/correct/loop.h"
#include "core/correct/check.h"
#include "core/plugin/guard.h"
#include "core/plugin/host.h"

#include <math.h>
#include <string.h>

/* ---- trials ---- */

static int make_trial(const opc_loop *l, opc_trial *t) {
  size_t n = l->gates->count;
  opc_biases *b = &t->biases;
  b->l = l->host->alloc(l->host, n, sizeof *b->l);
  b->w = l->host->alloc(l->host, n, sizeof *b->w);
  b->end = l->host->alloc(l->host, 2 * n, sizeof *b->end);
  b->jog = l->host->alloc(l->host, n, sizeof *b->jog);
  return b->l && b->w && b->end && b->jog;
}

static void clear_trial(const opc_loop *l, opc_trial *t) {
  l->host->free(l->host, t->biases.l);
  l->host->free(l->host, t->biases.w);
  l->host->free(l->host, t->biases.end);
  l->host->free(l->host, t->biases.jog);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    l->host->free(l->host, t->shift[layer]);
    l->host->free(l->host, t->patches[layer].box);
    l->host->free(l->host, t->bites[layer].box);
    l->host->free(l->host, t->assists[layer].box);
  }
}

static int set_patches(const opc_loop *l, opc_patches *p, const opc_box *box,
                       size_t count) {
  if (count != p->count) {
    opc_box *room = l->host->alloc(l->host, count, sizeof *room);
    if (!room) return 0;
    if (count) memcpy(room, box, count * sizeof *box);
    l->host->free(l->host, p->box);
    *p = (opc_patches){room, count};
  } else if (count && box != p->box) {
    memcpy(p->box, box, count * sizeof *box);
  }
  return 1;
}

static int copy_trial(const opc_loop *l, opc_trial *to, const opc_trial *from) {
  size_t n = l->gates->count * sizeof(int32_t);
  memcpy(to->biases.l, from->biases.l, n);
  memcpy(to->biases.w, from->biases.w, n);
  memcpy(to->biases.jog, from->biases.jog, n);
  memcpy(to->biases.end, from->biases.end, 2 * n);
  int ok = 1;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    const opc_patches *p = &from->patches[layer], *a = &from->assists[layer];
    const opc_patches *b = &from->bites[layer];
    ok &= set_patches(l, &to->patches[layer], p->box, p->count) &
          set_patches(l, &to->bites[layer], b->box, b->count) &
          set_patches(l, &to->assists[layer], a->box, a->count);
    if (to->shift[layer])
      memcpy(to->shift[layer], from->shift[layer],
             l->sites[layer].count * sizeof(int32_t));
  }
  return ok;
}

static int differ(const int32_t *a, const int32_t *b, size_t n) {
  return n && memcmp(a, b, n * sizeof *a) != 0;
}

static int other_boxes(const opc_patches *p, const opc_patches *q) {
  return p->count != q->count ||
         (p->count && memcmp(p->box, q->box, p->count * sizeof *p->box));
}

/* Would `next` print another mask of that layer? */
static int changed(const opc_loop *l, int layer) {
  const opc_biases *a = &l->now.biases, *b = &l->next.biases;
  size_t n = l->gates->count;
  if (other_boxes(&l->now.patches[layer], &l->next.patches[layer]) ||
      other_boxes(&l->now.bites[layer], &l->next.bites[layer]) ||
      other_boxes(&l->now.assists[layer], &l->next.assists[layer]))
    return 1;
  if (l->now.shift[layer])
    return differ(l->now.shift[layer], l->next.shift[layer],
                  l->sites[layer].count);
  if (layer == OPC_ACTIVE) return differ(a->w, b->w, n);
  return differ(a->l, b->l, n) || differ(a->jog, b->jog, n) ||
         differ(a->end, b->end, 2 * n);
}

static int any_changed(const opc_loop *l) {
  return changed(l, OPC_POLY) || changed(l, OPC_ACTIVE);
}

/* Biases do not move what is cut into fragments, and are not to look so. */
static void drop_biases(opc_loop *l) {
  size_t n = l->gates->count * sizeof(int32_t);
  opc_biases *b = &l->next.biases;
  if (l->next.shift[OPC_ACTIVE]) memset(b->w, 0, n);
  if (!l->next.shift[OPC_POLY]) return;
  memset(b->l, 0, n);
  memset(b->jog, 0, n);
  memset(b->end, 0, 2 * n);
}

/* ---- one print ---- */

static int no_memory(opc_error *error) {
  return opc_fail(error, OPC_FAILED, NULL, "out of memory");
}

static int take_bites(opc_loop *l, int layer, opc_error *error) {
  const opc_geometry_service *g = l->host->geometry;
  const opc_patches *b = &l->now.bites[layer];
  opc_shapes bites = {0}, whole = l->mask[layer];
  if (!b->count) return OPC_OK;
  if (!opc_pieces_boxes(l->host, b->box, b->count, NULL, 0, &bites))
    return no_memory(error);
  l->mask[layer] = (opc_shapes){0};
  int code = g->boolean(l->host, OPC_NOT, &whole, &bites, &l->mask[layer],
                        error);
  g->release(&whole);
  l->host->free(l->host, bites.start);
  l->host->free(l->host, bites.points);
  return code;
}

/* The mask of a layer as `now` has it. It is merged, as what overlaps is not
   twice as dark. */
static int make_mask(opc_loop *l, int layer, opc_error *error) {
  const opc_geometry_service *g = l->host->geometry;
  opc_pieces *pieces = &l->pieces[layer];
  if (l->now.shift[layer])
    memcpy(pieces->by, l->now.shift[layer],
           l->sites[layer].count * sizeof *pieces->by);
  else
    opc_pieces_follow(l->gates, layer, &l->now.biases, pieces);
  opc_pieces_build(pieces, &l->polygons[layer]);
  g->release(&l->mask[layer]);
  const opc_patches *p = &l->now.patches[layer], *a = &l->now.assists[layer];
  opc_shapes added = {0};
  int ok = !(p->count + a->count) ||
           opc_pieces_boxes(l->host, p->box, p->count, a->box, a->count, &added);
  int code = ok ? g->boolean(l->host, OPC_OR, &l->polygons[layer],
                             added.count ? &added : NULL, &l->mask[layer],
                             error)
                : no_memory(error);
  l->host->free(l->host, added.start);
  l->host->free(l->host, added.points);
  return code ? code : take_bites(l, layer, error);
}

/* Print and measure the mask of `next`, which becomes `now`. Only layers that
   changed are printed again. */
static int print_next(opc_loop *l, int all, opc_error *error) {
  int layers[OPC_MASKS], code = OPC_OK;
  for (int layer = 0; layer < OPC_MASKS; layer++)
    layers[layer] = all || changed(l, layer);
  if (!copy_trial(l, &l->now, &l->next)) return no_memory(error);
  for (int layer = 0; layer < OPC_MASKS && !code; layer++)
    if (layers[layer]) code = make_mask(l, layer, error);
  if (!code) code = opc_printer_print(&l->printer, layers, l->mask, error);
  if (!code)
    code = opc_measure_all(l->host, l->gates, l->printer.print, l->extract,
                           &l->measured, error);
  if (code) return code;
  for (int layer = 0; layer < OPC_MASKS; layer++)
    if (layers[layer])
      opc_sites_measure(l->host, &l->sites[layer], &l->printer.print[layer]);
  l->summary = opc_summarize(l->gates, &l->design, &l->measured.performance,
                             l->measured.flags, l->sites);
  opc_history_add(l->history, &l->summary, l->iterations,
                  l->printer.simulations);
  return OPC_OK;
}

/* ---- what plugins see and say ---- */

opc_printed opc_loop_printed(const opc_loop *l) {
  return (opc_printed){.size = sizeof(opc_printed),
                       .iteration = l->iterations,
                       .gates = l->gates,
                       .flags = l->measured.flags,
                       .l = l->now.biases.l,
                       .w = l->now.biases.w,
                       .extension = l->measured.extension,
                       .mask = l->mask,
                       .print = l->printer.print};
}

/* Let the regulator set vetoes, and line ends, patches and bites of `next`. */
static int judge(opc_loop *l, opc_error *error) {
  memset(l->vetoes, 0, l->gates->count * sizeof *l->vetoes);
  if (!l->regulator) return OPC_OK;
  const opc_regulator *r = l->regulator->plugin->operations;
  opc_printed p = opc_loop_printed(l);
  opc_ruling ruling = {.size = sizeof ruling, .vetoes = l->vetoes,
                       .end = l->next.biases.end};
  const char *before = opc_call(l->regulator, error);
  int code = r->rule(l->regulator->self, &p, &ruling, error);
  opc_leave(before);
  if (!code) code = opc_check_ruling(&ruling, l->gates->count, error);
  if (code) return opc_blame(error, code, "regulator");
  drop_biases(l);
  for (int layer = 0; layer < OPC_MASKS; layer++)
    if (!set_patches(l, &l->next.patches[layer], ruling.patches[layer],
                     ruling.patch_count[layer]) ||
        !set_patches(l, &l->next.bites[layer], ruling.bites[layer],
                     ruling.bite_count[layer]))
      return no_memory(error);
  return OPC_OK;
}

static opc_feedback feedback(const opc_loop *l) {
  opc_feedback f = {.size = sizeof(opc_feedback),
                    .iteration = l->iterations,
                    .gates = l->gates,
                    .design = &l->design,
                    .printed = &l->measured.performance,
                    .flags = l->measured.flags,
                    .vetoes = l->vetoes,
                    .end = l->now.biases.end,
                    .print = l->printer.print,
                    .next_end = l->next.biases.end};
  for (int layer = 0; layer < OPC_MASKS; layer++)
    f.epe[layer] = l->sites[layer].epe;
  return f;
}

/* The fragments of a layer: the synthesizer's own, or those of the gates. */
static int cut_layer(opc_loop *l, int layer, opc_error *error) {
  const opc_synthesizer *s = l->synthesizer->plugin->operations;
  opc_cuts cuts = {.size = sizeof cuts};
  if (OPC_HAS(s, cut)) {
    const char *before = opc_call(l->synthesizer, error);
    int code = s->cut(l->synthesizer->self, l->gates, layer, &cuts, error);
    opc_leave(before);
    if (!code) code = opc_check_cuts(l->gates, layer, &cuts, error);
    if (code) return opc_blame(error, code, "synthesizer");
  }
  int ok = set_patches(l, &l->next.assists[layer], cuts.assists,
                       cuts.assist_count);
  if (cuts.polygons) {
    ok &= opc_pieces_of_cuts(l->host, &cuts, &l->pieces[layer]) &
          opc_sites_make(l->host, &cuts, &l->sites[layer]);
    size_t n = l->sites[layer].count;
    l->now.shift[layer] = l->host->alloc(l->host, n, sizeof(int32_t));
    l->next.shift[layer] = l->host->alloc(l->host, n, sizeof(int32_t));
    ok = ok && l->now.shift[layer] && l->next.shift[layer];
  } else {
    ok &= opc_pieces_of_edges(l->host, &l->gates->edges[layer],
                              &l->pieces[layer]);
  }
  ok = ok && opc_pieces_shapes(l->host, &l->pieces[layer], &l->polygons[layer]);
  l->polygons[layer].hole = l->gates->drawn[layer].hole;
  return ok ? OPC_OK : no_memory(error);
}

static int begin(opc_loop *l, opc_error *error) {
  const opc_synthesizer *s = l->synthesizer->plugin->operations;
  opc_feedback f = feedback(l);
  f.printed = NULL;
  f.print = NULL;
  const char *before = opc_call(l->synthesizer, error);
  int code = s->begin(l->synthesizer->self, &f, error);
  opc_leave(before);
  if (code) return opc_blame(error, code, "synthesizer");
  for (int layer = 0; layer < OPC_MASKS && !code; layer++)
    code = cut_layer(l, layer, error);
  return code;
}

/* Let the synthesizer write what to try next. */
static int update(opc_loop *l, int *done, opc_error *error) {
  const opc_synthesizer *s = l->synthesizer->plugin->operations;
  opc_feedback f = feedback(l);
  opc_biases *b = &l->next.biases;
  opc_moves moves = {.size = sizeof moves, .l = b->l, .w = b->w, .jog = b->jog};
  size_t fragments[OPC_MASKS];
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    moves.shift[layer] = l->next.shift[layer];
    moves.assists[layer] = l->next.assists[layer].box;
    moves.assist_count[layer] = l->next.assists[layer].count;
    fragments[layer] = l->sites[layer].count;
  }
  const char *before = opc_call(l->synthesizer, error);
  int code = s->update(l->synthesizer->self, &f, &moves, done, error);
  opc_leave(before);
  if (!code) code = opc_check_moves(&moves, l->gates->count, fragments, error);
  if (code) return opc_blame(error, code, "synthesizer");
  drop_biases(l);
  for (int layer = 0; layer < OPC_MASKS; layer++)
    if (!set_patches(l, &l->next.assists[layer], moves.assists[layer],
                     moves.assist_count[layer]))
      return no_memory(error);
  return OPC_OK;
}

/* ---- the loop ---- */

/* The figure that is driven down. */
static double worst(const opc_loop *l) {
  return l->summary.gates ? l->summary.ion_max : l->summary.epe_max;
}

static const char *worst_unit(const opc_loop *l) {
  return l->summary.gates ? "%" : "nm";
}

static int told_to_stop(const opc_loop *l) {
  opc_progress progress = {.size = sizeof progress, .done = l->iterations,
                           .total = l->max_iterations, .worst = worst(l),
                           .worst_unit = worst_unit(l)};
  l->host->progress(l->host, &progress);
  return l->host->cancelled(l->host);
}

static int ends_anytime(const opc_loop *l) {
  const opc_synthesizer *s = l->synthesizer->plugin->operations;
  return OPC_HAS(s, flags) && s->flags & OPC_SYNTHESIZER_ENDS_ANYTIME;
}

static int iterate(opc_loop *l, opc_error *error) {
  int code = OPC_OK, done = 0, prints = 0;
  for (; !code; code = print_next(l, 0, error)) {
    if (told_to_stop(l)) return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    if ((code = judge(l, error))) return code;
    int ruled = any_changed(l);
    if (done && !ruled) return OPC_OK;
    /* Line ends first, so that their effect is not taken for that of the
       first moves. */
    if (l->iterations == 0 && ruled && !ends_anytime(l) &&
        prints++ < l->max_iterations)
      continue;
    if ((int)l->iterations == l->max_iterations) {
      l->host->log(l->host, OPC_LOG_WARNING,
                   "not done after %d iterations: worst deviation %.3g %s",
                   l->max_iterations, worst(l), worst_unit(l));
      return OPC_OK;
    }
    done = 0;
    if ((code = update(l, &done, error))) return code;
    /* What the regulator changes now, it has not seen yet. */
    if (ruled && ends_anytime(l)) done = 0;
    l->iterations++;
    if (done && !any_changed(l)) return OPC_OK;
  }
  return code;
}

static int make_loop(opc_loop *l) {
  size_t n = l->gates->count;
  l->history = opc_history_new();
  l->vetoes = l->host->alloc(l->host, n, sizeof *l->vetoes);
  return make_trial(l, &l->now) & make_trial(l, &l->next) &
         opc_measurement_make(l->host, n, &l->measured) &
         opc_performance_make(l->host, n, &l->design) &
         opc_performance_make(l->host, n, &l->before) & (l->vetoes != NULL);
}

int opc_loop_run(opc_loop *l, opc_error *error) {
  if (!make_loop(l)) return no_memory(error);
  int code = opc_printer_prepare(&l->printer, error);
  if (!code) code = opc_extract_prepare(l->extract, error);
  if (!code)
    code = opc_measure_drawn(l->gates, l->extract, &l->design, error);
  if (!code) code = begin(l, error);
  if (!code) code = print_next(l, 1, error);
  if (code) return code;
  opc_performance_copy(&l->before, &l->measured.performance);
  return iterate(l, error);
}

void opc_loop_clear(opc_loop *l) {
  const opc_host *host = l->host;
  clear_trial(l, &l->now);
  clear_trial(l, &l->next);
  opc_measurement_clear(host, &l->measured);
  opc_performance_clear(host, &l->design);
  opc_performance_clear(host, &l->before);
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    opc_pieces_clear(host, &l->pieces[layer]);
    opc_sites_clear(host, &l->sites[layer]);
    host->free(host, l->polygons[layer].start);
    host->free(host, l->polygons[layer].points);
    host->geometry->release(&l->mask[layer]);
  }
  opc_printer_clear(&l->printer);
  opc_history_free(l->history);
  host->free(host, l->vetoes);
}
