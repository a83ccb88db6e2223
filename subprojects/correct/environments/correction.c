/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the correction of selected transistors on sheets of clips. */
#include <eda/index.h>
#include <eda/memory.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <correct/loop.h>
#include "work.h"

typedef struct correction {
  sheets on;            /* transistors to correct */
  const uint32_t *wide; /* [prints], 1 + place of the print's representative, 0:
                           the print's transistors keep the masks of the chip;
                           NULL: correction of classes, in which no transistor
                           keeps a mask */
  uint32_t *mask;       /* [count], new masks */
} correction;

/* Record of a corrected transistor, followed by its parts and boxes. */
typedef struct corrected {
  uint32_t place, unused; /* unused: explicit padding */
  eda_chip_mask mask;
  drawn_print before;
  double off; /* |Ion deviation| with `mask`, %; INFINITY: none */
} corrected;

/* Header of a sheet's records. */
typedef struct head {
  uint32_t iterations, simulations, fine_simulations, unused;
} head;

/* ---- start of the loop ---- */

/* Return the masks from which the loop on a sheet starts: the masks of the
   chip, but drawn edges for the transistors to correct. These are the
   transistors within the radius of which all transistors belong to split
   prints. *still receives 1 for all other transistors; the loop frees
   *still. */
static eda_mask *fixed_masks(const correction *m, const sheet *s,
                             uint8_t **still) {
  const work *w = m->on.work;
  const eda_gates *g = s->gates;
  eda_mask *mask = eda_mask_new(g);
  mask->moved = eda_moved_new(g->layers, g->count);
  memset(*still = eda_alloc(g->count, 1), 1, g->count);
  eda_index *index = eda_index_new(g->box, g->count, 0);
  for (size_t i = 0; i < g->count; i++) {
    if (s->place[i] == UINT32_MAX) continue;
    eda_finder f = eda_index_find(index, eda_box_grown(g->box[i], w->radius));
    for (uint32_t k; eda_index_next(&f, &k);)
      (*still)[k] &= !m->wide[w->chip->gate[s->of[k]].print];
  }
  for (size_t i = 0; i < g->count; i++)
    if ((*still)[i])
      eda_chip_move(w->chip, s->of[i], g->box[i], mask->moved, i);
  eda_index_free(index);
  return mask;
}

/* ---- results of the loop ---- */

static double gate_deviation(const loop *l, size_t i) {
  if (eda_print_failed(l->measured.flags[i])) return INFINITY;
  return fabs(eda_deviation(l->measured.performance.ion[i], l->design.ion[i]));
}

/* Lists of added shapes and cut-outs for each transistor, in the coordinates of
   the transistor. */
typedef struct owned {
  eda_chip_box *box;
  uint32_t *next;  /* [count], index of the next box of the same gate, plus 1;
                      0: end */
  uint32_t *first; /* [gates], index of the first box, plus 1; 0: none */
  size_t count, capacity, next_capacity;
} owned;

static void owned_add(owned *to, uint32_t gate, eda_chip_box box) {
  size_t count = to->count;
  EDA_PUSH(to->next, count, to->next_capacity, to->first[gate]);
  EDA_PUSH(to->box, to->count, to->capacity, box);
  to->first[gate] = (uint32_t)to->count;
}

/* Add a part of an added shape or cut-out to its owner, the nearest transistor.
   The part is clipped at the radius around the owner, because the environment
   is equal throughout the class only within the radius. If several transistors
   are at the smallest distance, each of them is an owner, because any of them
   may be the representative; equal shapes merge. */
static void own_part(const correction *m, const eda_gates *g,
                     const eda_index *index, eda_chip_box part, owned *to) {
  int32_t r = m->on.work->radius;
  eda_box near = eda_box_grown(part.box, r);
  double least = INFINITY;
  eda_finder f = eda_index_find(index, near);
  for (uint32_t i; eda_index_next(&f, &i);)
    least = fmin(least, eda_box_distance(part.box, g->box[i]));
  f = eda_index_find(index, near);
  for (uint32_t i; eda_index_next(&f, &i);) {
    if (eda_box_distance(part.box, g->box[i]) > least) continue;
    eda_box b = eda_box_grown(g->box[i], r);
    b = (eda_box){MAX(b.x0, part.box.x0), MAX(b.y0, part.box.y0),
                  MIN(b.x1, part.box.x1), MIN(b.y1, part.box.y1)};
    if (b.x0 >= b.x1 || b.y0 >= b.y1) continue;
    b = eda_chip_own(g->box[i], g->axis[i], 0, b);
    owned_add(to, i, (eda_chip_box){b, part.layer, part.cutout});
  }
}

/* Divide a long shape into parts, because parts may be near different
   transistors, and add each part to its owner. */
static void own_box(const correction *m, const eda_gates *g,
                    const eda_index *index, eda_chip_box all, owned *to) {
  eda_chip_box low = all, high = all;
  int32_t most = MAX(m->on.work->radius / 2, 1), wide = all.box.x1 - all.box.x0,
          tall = all.box.y1 - all.box.y0;
  if (wide <= most && tall <= most) {
    own_part(m, g, index, all, to);
    return;
  }
  if (wide >= tall)
    low.box.x1 = high.box.x0 = all.box.x0 + wide / 2;
  else
    low.box.y1 = high.box.y0 = all.box.y0 + tall / 2;
  own_box(m, g, index, low, to);
  own_box(m, g, index, high, to);
}

static void own_all(const correction *m, const loop *l, owned *out) {
  const eda_gates *g = l->gates;
  *out = (owned){.first = eda_alloc(g->count, sizeof *out->first)};
  eda_index *index = eda_index_new(g->box, g->count, 0);
  for (size_t k = g->layers; k-- > 0;)
    for (int cutout = 1; cutout >= 0; cutout--) {
      eda_boxes b = cutout ? l->now.cutouts[k] : l->now.added[k];
      for (size_t i = b.count; i-- > 0;)
        own_box(m, g, index,
                (eda_chip_box){b.box[i], (uint16_t)k, (uint16_t)cutout}, out);
    }
  eda_index_free(index);
}

static void owned_clear(owned *o) {
  free(o->box);
  free(o->next);
  free(o->first);
}

static void put_one(const loop *l, const owned *o, uint32_t place, size_t i,
                    opc_bytes *out) {
  const biases *b = &l->now.biases;
  const eda_part *part = b->part + EDA_PARTS * i;
  corrected one = {
      .place = place,
      .mask = {.w = b->w[i],
               .aside = b->aside[i],
               .l = b->l[i],
               .jog = b->jog[i],
               .end = {b->end[2 * i], b->end[2 * i + 1]}},
      .before = {eda_figures_of(&l->before, i), l->guard.flags[i], 0},
      .off = gate_deviation(l, i)};
  while (one.mask.parts < EDA_PARTS &&
         part[one.mask.parts].from < part[one.mask.parts].to)
    one.mask.parts++;
  for (uint32_t k = o->first[i]; k; k = o->next[k - 1]) one.mask.boxes++;
  out->add(out, &one, sizeof one);
  out->add(out, part, one.mask.parts * sizeof *part);
  for (uint32_t k = o->first[i]; k; k = o->next[k - 1])
    out->add(out, &o->box[k - 1], sizeof *o->box);
}

static int put_all(const correction *m, const loop *l, const sheet *s,
                   opc_bytes *out, opc_error *error) {
  for (size_t k = 0; k < l->gates->layers; k++)
    if (l->now.shift[k] || l->now.assists[k].count)
      return opc_fail(error, OPC_INVALID, "synthesizer",
                      "'%s' displaces fragments of edges or adds scatter "
                      "bars, expected a synthesizer that only changes lengths "
                      "and widths of transistors",
                      m->on.work->with->synthesizer->id);
  owned o;
  own_all(m, l, &o);
  const head h = {l->iterations, l->printer.simulations,
                  l->printer.fine_simulations, 0};
  out->add(out, &h, sizeof h);
  for (size_t i = 0; i < l->gates->count; i++)
    if (s->place[i] != UINT32_MAX) put_one(l, &o, s->place[i], i, out);
  owned_clear(&o);
  return OPC_OK;
}

/* ---- a sheet ---- */

/* Host of a loop on a sheet. Progress is scaled to the phase. Messages become
   debug messages, because users do not know sheets. */
typedef struct inner {
  opc_host host;
  const correction *correction;
} inner;

OPC_PRINTF(3, 4)
static void log_inner(const opc_host *host, int level, const char *format,
                      ...) {
  const opc_host *outer = ((const inner *)host)->correction->on.work->host;
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *line = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  outer->log(outer, level == OPC_LOG_INFO ? OPC_LOG_DEBUG : level, "%s", line);
}

static void inner_progress(const opc_host *host, const opc_progress *at) {
  const inner *in = (const inner *)host;
  const correction *m = in->correction;
  double part = at->total > 0 ? at->done / at->total : 0;
  if (isfinite(at->worst)) m->on.work->worst = at->worst;
  work_progress(m->on.work,
                ((double)m->on.done + part) / (double)m->on.pages.count);
}

static int correct_gates(const correction *m, const sheet *s, opc_bytes *out,
                         opc_error *error) {
  const work *w = m->on.work;
  inner in = {*w->host, m};
  in.host.log = log_inner;
  in.host.progress = inner_progress;
  correct_settings with = *w->with;
  with.margin = w->gap * w->chip->grid;
  loop l;
  correct_loop_init(&l, &in.host, s->gates, &with);
  l.prepared = 1;
  l.printer.drawn = NULL; /* all sheets share one resist calibration */
  eda_mask *begun = m->wide ? fixed_masks(m, s, &l.still) : NULL;
  l.start.mask = begun;
  int code = correct_loop_run(&l, error);
  if (!code) code = put_all(m, &l, s, out, error);
  correct_loop_clear(&l);
  eda_mask_free(begun);
  return code;
}

static int correct_sheet(void *data, size_t i, opc_bytes *out,
                         opc_error *error) {
  correction *m = data;
  work *w = m->on.work;
  sheet s;
  int code = sheet_make(w->host->context, w->chip, &m->on.cover, m->on.number,
                        &m->on.pages, i, m->wide ? 0 : w->margin, &s, error);
  if (!code) code = correct_gates(m, &s, out, error);
  sheet_clear(&s);
  return code;
}

/* ---- results ---- */

/* Allocate a mask. Return its number. */
static uint32_t add_mask(work *w) {
  eda_chip *c = w->chip;
  size_t capacity = w->mask_capacity;
  eda_grow(&c->mask, &capacity, c->masks + 1, sizeof *c->mask);
  capacity = w->mask_capacity;
  eda_grow(&w->before, &capacity, c->masks + 1, sizeof *w->before);
  w->mask_capacity = capacity;
  return (uint32_t)c->masks++;
}

/* Store the mask of a record. In a refinement, the new mask keeps the drawn
   figures of the replaced mask, because the refinement does not simulate drawn
   neighbours. */
static void take_mask(correction *m, const corrected *one, const char *bytes) {
  work *w = m->on.work;
  eda_chip *c = w->chip;
  eda_chip_mask mask = one->mask;
  size_t parts = mask.parts * sizeof *c->part;
  mask.part = (uint32_t)c->parts;
  mask.box = (uint32_t)c->boxes;
  eda_grow(&c->part, &w->part_capacity, c->parts + mask.parts, sizeof *c->part);
  eda_grow(&c->box, &w->box_capacity, c->boxes + mask.boxes, sizeof *c->box);
  if (mask.parts) memcpy(c->part + c->parts, bytes, parts);
  if (mask.boxes)
    memcpy(c->box + c->boxes, bytes + parts, mask.boxes * sizeof *c->box);
  c->parts += mask.parts;
  c->boxes += mask.boxes;
  uint32_t k = m->mask[one->place] = add_mask(w);
  uint32_t was = c->gate[m->on.number[one->place]].mask;
  c->mask[k] = mask;
  w->before[k] = m->wide ? w->before[was] : one->before;
}

static int take_sheet(void *data, size_t i, const void *bytes, size_t size,
                      opc_error *error) {
  correction *m = data;
  const eda_chip *c = m->on.work->chip;
  const char *at = bytes, *end = at + size;
  head h;
  corrected one;
  (void)i, (void)error;
  memcpy(&h, at, sizeof h);
  m->on.work->iterations = MAX(m->on.work->iterations, h.iterations);
  m->on.work->simulations += h.simulations;
  m->on.work->fine_simulations += h.fine_simulations;
  for (at += sizeof h; at < end;) {
    memcpy(&one, at, sizeof one);
    at += sizeof one;
    const eda_chip_gate *g = &c->gate[m->on.number[one.place]];
    if (!m->wide ||
        one.off < print_beyond(m->on.work, &m->on.work->print[g->print]))
      take_mask(m, &one, at);
    at += one.mask.parts * sizeof(eda_part) +
          one.mask.boxes * sizeof(eda_chip_box);
  }
  return OPC_OK;
}

/* ---- run ---- */

/* Correct the transistors. m->mask receives the numbers of the new masks. */
static int correct_selected(correction *m, opc_error *error) {
  const work *w = m->on.work;
  m->mask = eda_alloc(m->on.count, sizeof *m->mask);
  for (size_t i = 0; i < m->on.count; i++) m->mask[i] = UINT32_MAX;
  return work_sheets(&m->on, w->margin + (m->wide ? 0 : w->radius),
                     (opc_pieces){.name = m->wide ? "refine" : "correct",
                                  .work = correct_sheet,
                                  .take = take_sheet},
                     error);
}

int correct_classes(work *w, opc_error *error) {
  correction m = {.on = {.work = w, .number = w->first, .count = w->classes}};
  int code = correct_selected(&m, error);
  for (size_t i = 0; i < w->chip->count && !code; i++)
    w->chip->gate[i].mask = m.mask[w->chip->gate[i].mask];
  free(m.mask);
  return code;
}

int correct_prints(work *w, const uint32_t *prints, size_t n,
                   opc_error *error) {
  eda_chip *c = w->chip;
  uint32_t *number = eda_alloc(n, sizeof *number),
           *place = eda_alloc(c->prints, sizeof *place);
  uint8_t *flip = eda_alloc(n, 1);
  for (size_t k = 0; k < n; k++) {
    number[k] = w->print_first[prints[k]];
    flip[k] = c->gate[number[k]].flip;
    place[prints[k]] = (uint32_t)(k + 1);
  }
  correction m = {.on = {.work = w, .number = number, .count = n},
                  .wide = place};
  int code = correct_selected(&m, error);
  for (size_t i = 0; i < c->count && !code; i++) {
    eda_chip_gate *g = &c->gate[i];
    uint32_t k = place[g->print];
    if (!k || m.mask[k - 1] == UINT32_MAX) continue;
    g->mask = m.mask[k - 1];
    g->flip ^= flip[k - 1];
    w->refined++;
  }
  free(m.mask);
  free(number);
  free(place);
  free(flip);
  return code;
}
