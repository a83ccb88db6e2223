/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the correction of selected transistors on sheets of clips. */
#include <eda/index.h>
#include <eda/memory.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <correct/loop.h>
#include "align.h"
#include "correction.h"

typedef struct correction {
  sheets on;            /* transistors to correct */
  const uint32_t *wide; /* [prints], 1 + place of the print's representative, 0:
                           the print's transistors keep the masks of the chip;
                           NULL: correction of classes, in which no transistor
                           keeps a mask */
  uint32_t *mask;       /* [count], new masks */
} correction;

/* Header of the records of a loop. */
typedef struct head {
  uint32_t iterations, simulations, fine_simulations, unused;
} head;

/* ---- start of the loop ---- */

/* Start of the loop of a refinement; fields as in loop_start. */
typedef struct beginning {
  eda_mask *mask;
  eda_moved *from;
  double *limit;
  uint32_t **owner; /* [2 * layers] */
} beginning;

/* Set still[i] to 0 for each transistor of a split print within the radius of a
   selected transistor, and to 1 for all other transistors of a sheet. */
static void find_still(const correction *m, const sheet *s, uint8_t *still) {
  const work *w = m->on.work;
  const eda_gates *g = s->gates;
  memset(still, 1, g->count);
  eda_index *index = eda_index_new(g->box, g->count, 0);
  for (size_t i = 0; i < g->count; i++) {
    if (s->place[i] == UINT32_MAX) continue;
    eda_finder f = eda_index_find(index, eda_box_grown(g->box[i], w->radius));
    for (uint32_t k; eda_index_next(&f, &k);)
      still[k] &= !m->wide[w->chip->gate[s->of[k]].print];
  }
  eda_index_free(index);
}

/* Move the displacements of gate i from one mask to another. */
static void pass_moves(eda_moved *from, eda_moved *to, size_t i) {
  eda_part *parts = from->part + EDA_PARTS * i;
  to->w[i] = from->w[i];
  to->aside[i] = from->aside[i];
  to->l[i] = from->l[i];
  to->jog[i] = from->jog[i];
  memcpy(to->part + EDA_PARTS * i, parts, EDA_PARTS * sizeof *parts);
  memcpy(to->end + 2 * i, from->end + 2 * i, 2 * sizeof *to->end);
  from->w[i] = from->aside[i] = from->l[i] = from->jog[i] = 0;
  from->end[2 * i] = from->end[2 * i + 1] = 0;
  memset(parts, 0, EDA_PARTS * sizeof *parts);
}

/* Append transistor i to the owners of the shapes that its mask added. */
static void add_owner(beginning *b, size_t *capacity, size_t *count, size_t i) {
  size_t layers = b->mask->layers;
  const eda_moved *m = b->mask->moved;
  for (size_t k = 0; k < 2 * layers; k++) {
    size_t n = k < layers ? m->added[k].count : m->cutouts[k - layers].count;
    while (count[k] < n)
      EDA_PUSH(b->owner[k], count[k], capacity[k], (uint32_t)i);
  }
}

/* Return the |Ion deviation|, %, up to which a transistor keeps its mask: its
   limit, or less if the drawn mask deviates by less. */
static double placed_limit(const work *w, uint32_t mask) {
  const alone *a = &w->alone[mask];
  const drawn_print *before = &w->before[mask];
  double limit = mask_limit(w, mask);
  if (!a->known || eda_print_failed(before->flags)) return limit;
  double drawn = fabs(eda_deviation(before->figures.ion, a->result.design.ion));
  return fmin(limit, fmax(drawn, w->with->ion_limit));
}

/* Start from the masks of all transistors. A transistor that the loop may
   correct keeps its mask until its deviation exceeds its limit. */
static void begin_placed(const correction *m, const sheet *s, uint8_t *still,
                         beginning *out) {
  const work *w = m->on.work;
  size_t n = s->gates->count, lists = 2 * s->gates->layers;
  size_t *capacity = eda_alloc(lists, sizeof *capacity),
         *count = eda_alloc(lists, sizeof *count);
  out->from = eda_moved_new(s->gates->layers, n);
  out->limit = eda_alloc(n, sizeof *out->limit);
  out->owner = eda_alloc(lists, sizeof(uint32_t *));
  for (size_t i = 0; i < n; i++) {
    const eda_chip_gate *g = &w->chip->gate[s->of[i]];
    eda_chip_move(w->chip, s->of[i], s->gates->box[i], out->mask->moved, i);
    add_owner(out, capacity, count, i);
    out->limit[i] = still[i] ? INFINITY : placed_limit(w, g->mask);
  }
  align_boxes(w->chip, s->gates, out->mask->moved);
  for (size_t i = 0; i < n; i++) {
    if (!still[i]) pass_moves(out->mask->moved, out->from, i);
    still[i] = 1;
  }
  free(capacity);
  free(count);
}

/* Return the masks from which the loop on a sheet starts. Without a limit for
   each transistor, the transistors to correct have drawn edges. *still receives
   1 for all transistors that keep their masks; the loop frees *still. */
static beginning begin_with(const correction *m, const sheet *s,
                            uint8_t **still) {
  const work *w = m->on.work;
  const eda_gates *g = s->gates;
  beginning b = {.mask = eda_mask_new(g)};
  b.mask->moved = eda_moved_new(g->layers, g->count);
  *still = eda_alloc(g->count, 1);
  find_still(m, s, *still);
  if (work_continues(w)) {
    begin_placed(m, s, *still, &b);
  } else {
    for (size_t i = 0; i < g->count; i++)
      if ((*still)[i])
        eda_chip_move(w->chip, s->of[i], g->box[i], b.mask->moved, i);
    align_boxes(w->chip, g, b.mask->moved);
  }
  for (size_t i = 0; i < g->count && w->cells.used; i++)
    b.mask->moved->seen[i] = w->alone[w->chip->gate[s->of[i]].mask].seen;
  return b;
}

static void beginning_clear(beginning *b) {
  for (size_t k = 0; b->owner && k < 2 * b->mask->layers; k++)
    free(b->owner[k]);
  free(b->owner);
  free(b->limit);
  eda_moved_free(b->from);
  eda_mask_free(b->mask);
}

/* ---- results of the loop ---- */

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

/* Transistors that can own added shapes: those without a fixed mask. */
typedef struct owners {
  eda_index *index;
  const uint32_t *gate; /* numbers of the transistors of the index */
} owners;

/* Return 1 if clipping left nothing of a part of a shape, or along an axis less
   than the mask rules of widths and edges permit. */
static int is_remnant(const work *w, eda_box part, eda_box clipped) {
  const double *rules = w->with->rules;
  double least = fmax(rules[EDA_RULE_WIDTH], rules[EDA_RULE_EDGE]);
  const int32_t full[] = {part.x1 - part.x0, part.y1 - part.y0};
  const int32_t left[] = {clipped.x1 - clipped.x0, clipped.y1 - clipped.y0};
  for (int k = 0; k < 2; k++)
    if (left[k] <= 0 || (left[k] < full[k] && left[k] * w->chip->grid < least))
      return 1;
  return 0;
}

/* Add a part of an added shape or cut-out to its owner, the nearest transistor.
   The part is clipped at the radius around the owner, because the environment
   is equal throughout the class only within the radius. A remnant is omitted,
   because its edges would violate mask rules. If several transistors are at the
   smallest distance, each of them is an owner, because any of them may be the
   representative; equal shapes merge. */
static void own_part(const work *w, const eda_gates *g, const owners *among,
                     eda_chip_box part, owned *to) {
  int32_t r = w->radius;
  eda_box near = eda_box_grown(part.box, r);
  double least = INFINITY;
  eda_finder f = eda_index_find(among->index, near);
  for (uint32_t k; eda_index_next(&f, &k);)
    least = fmin(least, eda_box_distance(part.box, g->box[among->gate[k]]));
  f = eda_index_find(among->index, near);
  for (uint32_t k; eda_index_next(&f, &k);) {
    uint32_t i = among->gate[k];
    if (eda_box_distance(part.box, g->box[i]) > least) continue;
    eda_box b = eda_box_grown(g->box[i], r);
    b = (eda_box){MAX(b.x0, part.box.x0), MAX(b.y0, part.box.y0),
                  MIN(b.x1, part.box.x1), MIN(b.y1, part.box.y1)};
    if (is_remnant(w, part.box, b)) continue;
    b = eda_chip_own(g->box[i], g->axis[i], 0, b);
    owned_add(to, i, (eda_chip_box){b, part.layer, part.cutout});
  }
}

/* Divide a long shape into parts, because parts may be near different
   transistors, and add each part to its owner. */
static void own_box(const work *w, const eda_gates *g, const owners *among,
                    eda_chip_box all, owned *to) {
  eda_chip_box low = all, high = all;
  int32_t most = MAX(w->radius / 2, 1), wide = all.box.x1 - all.box.x0,
          tall = all.box.y1 - all.box.y0;
  if (wide <= most && tall <= most) {
    own_part(w, g, among, all, to);
    return;
  }
  if (wide >= tall)
    low.box.x1 = high.box.x0 = all.box.x0 + wide / 2;
  else
    low.box.y1 = high.box.y0 = all.box.y0 + tall / 2;
  own_box(w, g, among, low, to);
  own_box(w, g, among, high, to);
}

static owners owners_find(const loop *l) {
  const eda_gates *g = l->gates;
  uint32_t *gate = eda_alloc(g->count, sizeof *gate);
  eda_box *box = eda_alloc(g->count, sizeof *box);
  size_t n = 0;
  for (uint32_t i = 0; i < g->count; i++) {
    if (l->still && l->still[i] == STILL_BEGUN) continue;
    box[n] = g->box[i];
    gate[n++] = i;
  }
  const owners all = {eda_index_new(box, n, 0), gate};
  free(box);
  return all;
}

static int box_is_in(eda_boxes all, eda_box b) {
  for (size_t i = 0; i < all.count; i++)
    if (!memcmp(&all.box[i], &b, sizeof b)) return 1;
  return 0;
}
/* Assign the regulator's shapes of a loop to transistors. Shapes from which the
   loop started belong to fixed masks. */
static void own_all(const work *w, const loop *l, owned *out) {
  const eda_gates *g = l->gates;
  *out = (owned){.first = eda_alloc(g->count, sizeof *out->first)};
  owners among = owners_find(l);
  for (size_t k = g->layers; k-- > 0;)
    for (int cutout = 1; cutout >= 0; cutout--) {
      eda_boxes b = cutout ? l->now.cutouts[k] : l->now.added[k],
                begun = correct_loop_begun(l, k, cutout);
      for (size_t i = b.count; i-- > 0;)
        if (!box_is_in(begun, b.box[i]))
          own_box(w, g, &among,
                  (eda_chip_box){b.box[i], (uint16_t)k, (uint16_t)cutout}, out);
    }
  eda_index_free(among.index);
  free((uint32_t *)among.gate);
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
      .off = ion_deviation(l->measured.flags[i], l->measured.performance.ion[i],
                           l->design.ion[i])};
  while (one.mask.parts < EDA_PARTS &&
         part[one.mask.parts].from < part[one.mask.parts].to)
    one.mask.parts++;
  for (uint32_t k = o->first[i]; k; k = o->next[k - 1]) one.mask.boxes++;
  out->add(out, &one, sizeof one);
  out->add(out, part, one.mask.parts * sizeof *part);
  for (uint32_t k = o->first[i]; k; k = o->next[k - 1])
    out->add(out, &o->box[k - 1], sizeof *o->box);
}

int correction_put(const work *w, const loop *l, const uint32_t *place,
                   opc_bytes *out, opc_error *error) {
  for (size_t k = 0; k < l->gates->layers; k++)
    if (l->now.shift[k] || l->now.assists[k].count)
      return opc_fail(error, OPC_INVALID, "synthesizer",
                      "'%s' displaces fragments of edges or adds scatter "
                      "bars, expected a synthesizer that only changes lengths "
                      "and widths of transistors",
                      w->with->synthesizer->id);
  owned o;
  own_all(w, l, &o);
  const head h = {l->iterations, l->printer.simulations,
                  l->printer.fine_simulations, 0};
  out->add(out, &h, sizeof h);
  for (size_t i = 0; i < l->gates->count; i++)
    /* A transistor within its limit keeps its mask. */
    if (place[i] != UINT32_MAX &&
        !(l->start.limit && l->still[i] == STILL_BEGUN))
      put_one(l, &o, place[i], i, out);
  owned_clear(&o);
  return OPC_OK;
}

/* ---- a sheet ---- */

OPC_PRINTF(3, 4)
static void log_inner(const opc_host *host, int level, const char *format,
                      ...) {
  const opc_host *outer = ((const inner *)host)->work->host;
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *line = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  outer->log(outer, level == OPC_LOG_INFO ? OPC_LOG_DEBUG : level, "%s", line);
}

static void inner_progress(const opc_host *host, const opc_progress *at) {
  const inner *in = (const inner *)host;
  double part = at->total > 0 ? at->done / at->total : 0;
  if (isfinite(at->worst)) in->work->worst = at->worst;
  work_progress(in->work, ((double)in->done + part) / (double)in->count);
}

void correction_host(work *w, size_t done, size_t count, inner *out) {
  *out = (inner){*w->host, w, done, count};
  out->host.log = log_inner;
  out->host.progress = inner_progress;
}

static int correct_gates(const correction *m, const sheet *s, opc_bytes *out,
                         opc_error *error) {
  work *w = m->on.work;
  inner in;
  correction_host(w, m->on.done, m->on.pages.count, &in);
  correct_settings with = *w->with;
  with.margin = w->gap * w->chip->grid;
  if (m->wide && work_is_fast(w)) with.fine = 0;
  loop l;
  correct_loop_init(&l, &in.host, s->gates, &with);
  l.prepared = 1;
  l.checked = 1;
  l.printer.drawn = NULL; /* all sheets share one resist calibration */
  beginning begun = {0};
  if (m->wide) begun = begin_with(m, s, &l.still);
  l.start.mask = begun.mask;
  l.start.from = begun.from;
  l.start.limit = begun.limit;
  l.start.owner = begun.owner;
  /* The guard would revert transistors to masks that neighbours disturb. */
  l.hold &= !begun.limit;
  int code = correct_loop_run(&l, error);
  if (!code) code = correction_put(w, &l, s->place, out, error);
  correct_loop_clear(&l);
  if (m->wide) beginning_clear(&begun);
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
  capacity = w->mask_capacity;
  if (w->cells.used)
    eda_grow(&w->alone, &capacity, c->masks + 1, sizeof *w->alone);
  w->mask_capacity = capacity;
  if (w->cells.used) w->alone[c->masks] = (alone){.known = 0};
  return (uint32_t)c->masks++;
}

uint32_t correction_take(work *w, const char *at) {
  eda_chip *c = w->chip;
  corrected one;
  memcpy(&one, at, sizeof one);
  eda_chip_mask mask = one.mask;
  size_t parts = mask.parts * sizeof *c->part;
  const char *bytes = at + sizeof one;
  mask.part = (uint32_t)c->parts;
  mask.box = (uint32_t)c->boxes;
  eda_grow(&c->part, &w->part_capacity, c->parts + mask.parts, sizeof *c->part);
  eda_grow(&c->box, &w->box_capacity, c->boxes + mask.boxes, sizeof *c->box);
  if (mask.parts) memcpy(c->part + c->parts, bytes, parts);
  if (mask.boxes)
    memcpy(c->box + c->boxes, bytes + parts, mask.boxes * sizeof *c->box);
  c->parts += mask.parts;
  c->boxes += mask.boxes;
  uint32_t k = add_mask(w);
  c->mask[k] = mask;
  w->before[k] = one.before;
  return k;
}

const char *correction_begin(work *w, const char *at) {
  head h;
  memcpy(&h, at, sizeof h);
  if (!w) return at + sizeof h;
  w->iterations = MAX(w->iterations, h.iterations);
  w->simulations += h.simulations;
  w->fine_simulations += h.fine_simulations;
  return at + sizeof h;
}

const char *correction_next(const char *at, corrected *out) {
  memcpy(out, at, sizeof *out);
  return at + sizeof *out + out->mask.parts * sizeof(eda_part) +
         out->mask.boxes * sizeof(eda_chip_box);
}

/* Take the better masks of a refinement. A new mask keeps the drawn figures of
   the replaced mask, because the refinement does not simulate drawn
   neighbours. */
static void take_one(correction *m, const corrected *one, const char *at) {
  work *w = m->on.work;
  const eda_chip_gate *g = &w->chip->gate[m->on.number[one->place]];
  uint32_t was = g->mask, *mask = &m->mask[one->place];
  int placed = m->wide && !w->round;
  if (m->wide && !placed && !(one->off < print_beyond(w, g))) return;
  *mask = correction_take(w, at);
  if (!m->wide) return;
  w->before[*mask] = w->before[was];
  if (w->cells.used) w->alone[*mask] = w->alone[was];
}

static int take_sheet(void *data, size_t i, const void *bytes, size_t size,
                      opc_error *error) {
  correction *m = data;
  const char *at = correction_begin(m->on.work, bytes),
             *end = (const char *)bytes + size;
  (void)i, (void)error;
  while (at < end) {
    corrected one;
    const char *next = correction_next(at, &one);
    take_one(m, &one, at);
    at = next;
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

int correct_in_place(work *w, uint32_t *mask, opc_error *error) {
  uint32_t *number = eda_alloc(w->classes, sizeof *number),
           *class = eda_alloc(w->classes, sizeof *class);
  correction m = {.on = {.work = w, .number = number}};
  for (size_t k = 0; k < w->classes; k++) {
    if (mask[k] != UINT32_MAX) continue;
    class[m.on.count] = (uint32_t)k;
    number[m.on.count++] = w->first[k];
  }
  int code = m.on.count ? correct_selected(&m, error) : OPC_OK;
  for (size_t k = 0; k < m.on.count && !code; k++) mask[class[k]] = m.mask[k];
  free(m.mask);
  free(number);
  free(class);
  return code;
}

int correct_classes(work *w, opc_error *error) {
  uint32_t *mask = eda_alloc(w->classes, sizeof *mask);
  for (size_t k = 0; k < w->classes; k++) mask[k] = UINT32_MAX;
  int code = w->cells.used ? cells_correct(w, mask, error) : OPC_OK;
  if (!code) code = correct_in_place(w, mask, error);
  for (size_t i = 0; i < w->chip->count && !code; i++)
    w->chip->gate[i].mask = mask[w->chip->gate[i].mask];
  free(mask);
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
