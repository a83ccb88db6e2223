/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the conversion of a mask to the start of a correction, and
   back. */
#include <correct/start.h>

#include <eda/index.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/loop.h>

/* ---- from a mask ---- */

int correct_start_check(const loop_start *s, const eda_gates *gates,
                        opc_error *error) {
  if (s->mask && s->mask->chip)
    return opc_fail(error, OPC_INVALID, "start",
                    "the mask is by classes: set 'divide: whole' in the step "
                    "that makes it");
  if (s->mask && s->mask->gates != gates)
    return opc_fail(error, OPC_INVALID, "start",
                    "the mask belongs to the gates of another step");
  if (s->mask && !s->mask->moved)
    return opc_fail(error, OPC_INVALID, "start",
                    "the mask has no displacements of transistors from their "
                    "drawn edges: expected a mask of the step 'correct'");
  return OPC_OK;
}

void correct_start_reset_ends(const loop_start *s, biases *b, size_t i) {
  for (size_t end = 2 * i; end < 2 * i + 2; end++)
    b->end[end] = s->from ? s->from->end[end] : 0;
}

void correct_start_reset(const loop_start *s, biases *b, size_t i, int ends) {
  const eda_moved *from = s->from;
  eda_part *part = b->part + EDA_PARTS * i;
  b->w[i] = from ? from->w[i] : 0;
  b->aside[i] = from ? from->aside[i] : 0;
  b->l[i] = from ? from->l[i] : 0;
  b->jog[i] = from ? from->jog[i] : 0;
  memset(part, 0, EDA_PARTS * sizeof *part);
  if (from) memcpy(part, from->part + EDA_PARTS * i, EDA_PARTS * sizeof *part);
  if (ends) correct_start_reset_ends(s, b, i);
}

void correct_start_begin(loop *l) {
  size_t n = l->gates->count, layers = l->gates->layers;
  l->begun = eda_alloc(2 * layers, sizeof *l->begun);
  if (!l->start.mask) return;
  l->base = l->start.mask->moved;
  l->now.biases.base = l->next.biases.base = l->base;
  l->whole =
      correct_biases_in(eda_alloc(TRIAL_BIASES * n, sizeof *l->whole.w), n);
  for (size_t i = 0; i < n; i++)
    correct_start_reset(&l->start, &l->next.biases, i, 1);
  for (size_t k = 0; k < layers; k++) {
    const eda_box_list *added = &l->base->added[k],
                       *cutouts = &l->base->cutouts[k];
    correct_trial_set_boxes(&l->begun[k],
                            (eda_boxes){added->box, added->count});
    correct_trial_set_boxes(&l->begun[layers + k],
                            (eda_boxes){cutouts->box, cutouts->count});
    correct_trial_set_boxes(&l->next.added[k], correct_loop_begun(l, k, 0));
    correct_trial_set_boxes(&l->next.cutouts[k], correct_loop_begun(l, k, 1));
  }
}

const biases *correct_start_whole(const loop *l) {
  biases whole = l->whole;
  if (!l->base) return &l->now.biases;
  correct_biases_add_base(&l->now.biases, l->gates->count, &whole);
  return &l->whole;
}

eda_printed correct_loop_printed(const loop *l) {
  const biases *b = correct_start_whole(l);
  return (eda_printed){.iteration = l->iterations,
                       .gates = l->gates,
                       .flags = l->measured.flags,
                       .l = b->l,
                       .w = b->w,
                       .aside = b->aside,
                       .extension = correct_corners_extension(l),
                       .shapes = l->mask,
                       .print = l->printer.print,
                       .scanner = eda_scanner_of(&l->printer.litho.module)};
}

eda_boxes correct_loop_begun(const loop *l, size_t layer, int cutouts) {
  return l->begun[(cutouts ? l->gates->layers : 0) + layer];
}

/* Remove the shapes of a transistor from the shapes of the start. */
static void drop_owned(loop *l, uint32_t gate) {
  for (size_t k = 0; k < 2 * l->gates->layers; k++) {
    eda_box *box = (eda_box *)l->begun[k].box;
    uint32_t *owner = l->start.owner[k];
    size_t kept = 0;
    for (size_t i = 0; i < l->begun[k].count; i++) {
      if (owner[i] == gate) continue;
      box[kept] = box[i];
      owner[kept++] = owner[i];
    }
    l->begun[k].count = kept;
  }
}

static void open_one(loop *l, size_t i) {
  const loop_start *s = &l->start;
  int begun = l->still[i] == STILL_BEGUN;
  if (!l->still[i] || !(s->limit[i] < INFINITY)) return;
  l->still[i] = 0;
  if (begun) drop_owned(l, (uint32_t)i);
}

/* Copy the displacements of gate i, except those of line ends. */
static void keep_now(loop *l, size_t i) {
  const biases *from = &l->now.biases, *to = &l->next.biases;
  size_t part = EDA_PARTS * i;
  to->w[i] = from->w[i];
  to->aside[i] = from->aside[i];
  to->l[i] = from->l[i];
  to->jog[i] = from->jog[i];
  memcpy(to->part + part, from->part + part, EDA_PARTS * sizeof *to->part);
}

/* With `limit`, start the correction of a transistor whose line ends the
   regulator displaced. */
static void open_moved(loop *l, size_t i) {
  const int32_t *end = l->next.biases.end + 2 * i;
  if (l->start.limit && l->still[i] == STILL_BEGUN &&
      memcmp(end, l->start.from->end + 2 * i, 2 * sizeof *end))
    open_one(l, i);
}

void correct_start_keep(loop *l) {
  for (size_t i = 0; l->still && i < l->gates->count; i++) {
    open_moved(l, i);
    if (l->still[i] == STILL_BEGUN)
      correct_start_reset(&l->start, &l->next.biases, i, 1);
    else if (l->still[i] && !l->vetoes[i])
      keep_now(l, i);
  }
}

void correct_start_open(loop *l, int violations) {
  const loop_start *s = &l->start;
  if (!s->limit) return;
  for (size_t k = 0; violations && k < l->guard.rules; k++)
    if (l->guard.drawn[k].gate >= 0)
      open_one(l, (size_t)l->guard.drawn[k].gate);
  for (size_t i = 0; !violations && i < l->gates->count; i++) {
    double off =
        eda_deviation(l->measured.performance.ion[i], l->design.ion[i]);
    if (eda_print_failed(l->measured.flags[i]) || fabs(off) > s->limit[i])
      open_one(l, i);
    else if (!l->still[i])
      l->still[i] = STILL_WITHIN;
  }
}

int correct_start_is_done(const loop *l) {
  return l->start.limit && !memchr(l->still, 0, l->gates->count);
}

/* Mark the owners of begun shapes that touch a box. */
static void find_touched(const loop *l, size_t list, eda_boxes by,
                         uint8_t *touched) {
  const eda_boxes begun = l->begun[list];
  if (!by.count) return;
  eda_index *index = eda_index_new(by.box, by.count, 0);
  for (size_t i = 0; i < begun.count; i++) {
    uint32_t any;
    eda_finder f = eda_index_find(index, begun.box[i]);
    if (eda_index_next(&f, &any)) touched[l->start.owner[list][i]] = 1;
  }
  eda_index_free(index);
}

void correct_start_open_touched(loop *l, size_t layer, const eda_ruling *by) {
  size_t n = l->gates->count;
  if (!l->start.limit) return;
  uint8_t *touched = eda_alloc(n, 1);
  find_touched(l, layer, by->added[layer], touched);
  find_touched(l, l->gates->layers + layer, by->cutouts[layer], touched);
  for (size_t i = 0; i < n; i++)
    if (touched[i]) open_one(l, i);
  free(touched);
}

/* Half size of the window around a violation, nm; larger than the distance of
   regulator.drc's repairs from the violation. */
static const double beside = 150;

void correct_start_prune(loop *l) {
  double grid = l->gates->grid;
  for (size_t i = 0; l->base && !l->start.owner && i < l->guard.rules; i++) {
    const eda_violation *v = &l->guard.drawn[i];
    eda_box near = {
        (int32_t)((v->x - beside) / grid), (int32_t)((v->y - beside) / grid),
        (int32_t)((v->x + beside) / grid), (int32_t)((v->y + beside) / grid)};
    for (size_t k = 0; k < 2 * l->gates->layers; k++)
      correct_trial_drop_boxes(&l->begun[k], near);
  }
}

void correct_start_correct(const eda_moved *m, eda_performance *printed) {
  for (size_t i = 0; i < m->gates; i++) printed->ion[i] *= exp(-m->seen[i]);
}

void correct_start_polygons(const eda_gates *g, const eda_moved *moved,
                            size_t layer, eda_shapes *out) {
  trial none;
  pieces p;
  correct_trial_init(&none, g->layers, g->count);
  none.biases.base = moved;
  correct_pieces_of_edges(&g->edges[layer], 1, &p);
  correct_pieces_alloc(&p, out);
  if (g->drawn[layer].hole && out->count) {
    out->hole = eda_alloc(out->count, 1);
    memcpy(out->hole, g->drawn[layer].hole, out->count);
  }
  correct_pieces_follow(g, layer, &none.biases, &p);
  correct_pieces_build(&p, out);
  correct_pieces_clear(&p);
  correct_trial_clear(&none);
}

int correct_start_mask(const eda_gates *g, const eda_moved *moved, size_t layer,
                       eda_shapes *out, opc_error *error) {
  eda_shapes polygons;
  const eda_box_list *added = &moved->added[layer],
                     *cutouts = &moved->cutouts[layer];
  const eda_boxes more = {added->box, added->count},
                  cut = {cutouts->box, cutouts->count};
  correct_start_polygons(g, moved, layer, &polygons);
  int code = correct_mask_merge(&polygons, (boxes_lists){&more, 1},
                                (boxes_lists){&cut, 1}, out, error);
  eda_shapes_clear(&polygons);
  return code;
}

int correct_start_shapes(eda_mask *m, opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < m->layers && !code; k++)
    if (m->gates->corrected[k])
      code = correct_start_mask(m->gates, m->moved, k, &m->shapes[k], error);
  return code;
}

/* ---- to a mask ---- */

static eda_box_list copy_of(eda_boxes from) {
  eda_box_list to = {0};
  for (size_t i = 0; i < from.count; i++) eda_box_list_add(&to, from.box[i]);
  return to;
}

/* Return NULL for displacements relative to a start, displacements of
   fragments, and scatter bars, because eda_moved cannot represent them. */
eda_moved *correct_moved_of(const loop *l) {
  size_t n = l->gates->count, layers = l->gates->layers;
  const trial *t = &l->now;
  if (l->base || !n) return NULL;
  for (size_t k = 0; k < layers; k++)
    if (t->shift[k] || t->assists[k].count) return NULL;
  eda_moved *m = eda_moved_new(layers, n);
  memcpy(m->w, t->biases.w, n * sizeof *m->w);
  memcpy(m->aside, t->biases.aside, n * sizeof *m->aside);
  memcpy(m->l, t->biases.l, n * sizeof *m->l);
  memcpy(m->jog, t->biases.jog, n * sizeof *m->jog);
  memcpy(m->end, t->biases.end, 2 * n * sizeof *m->end);
  memcpy(m->part, t->biases.part, EDA_PARTS * n * sizeof *m->part);
  for (size_t k = 0; k < layers; k++) {
    m->added[k] = copy_of(t->added[k]);
    m->cutouts[k] = copy_of(t->cutouts[k]);
  }
  return m;
}
