/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the verification of a mask by classes. One transistor of each
   class of equal masked environments is simulated, and all transistors of the
   class receive the figures of that transistor. Two environments are equal if
   they contain equal masks at equal relative positions within the range of
   optical interaction. Transistors with equal masks have equal drawn
   environments. */
#include <eda/index.h>
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/start.h>
#include "work.h"

enum { SUMS_AT_ONCE = 1024 };

/* Tuned constants. */
static const struct {
  double split, distinct;
} tuned = {
    /* Fraction of `ion_limit` beyond which a group is split. In an SRAM macro,
       33 of 2,807 verified transistors exceed half of 0.5 %; splitting their
       groups reduces the largest deviation from 0.49 to 0.26 %. */
    .split = 0.5,

    /* Number of classes per transistor beyond which groups are split at
       `ion_limit`: most groups then have one transistor, which has already
       been corrected in place. A second correction disturbs its neighbours: in
       logic of 15,716 transistors, after 61 second corrections, 166 other
       transistors exceeded half of an `ion_limit` of 0.5 %. */
    .distinct = 0.5,
};

/* ---- classes of masked environments ---- */

/* A band: transistors `begin` to `end` - 1 of the chip, in the order of their
   lower edges. */
typedef struct band {
  const work *work;
  size_t begin, end;
  size_t from; /* first transistor that can be within `margin` of the band */
  eda_index *index;         /* boxes of the transistors from `from` */
  uint8_t (*sum)[SUM_SIZE]; /* [end - begin] */
} band;

/* Return the orientation of a gate relative to another one; Bit 0 is 1 if the
   axes of the gates differ, so that L and W are exchanged. */
static uint32_t orientation_of(const eda_chip_gate *g,
                               const eda_chip_gate *to) {
  uint32_t flip = to->flip;
  if (g->axis != to->axis) flip = (flip & 1) << 1 | flip >> 1;
  return (g->flip ^ flip) << 1 | (g->axis ^ to->axis);
}

/* Add the mask and the position of a neighbour `o`, in the coordinates of
   transistor g, to the sums. The hash of each word includes the preceding
   words. */
static void sum_neighbour(const eda_chip_gate *g, const eda_chip_gate *o,
                          uint64_t sum[2]) {
  eda_box b = eda_chip_own(g->box, g->axis, g->flip, o->box);
  const uint32_t word[] = {(uint32_t)b.x0, (uint32_t)b.y0,
                           (uint32_t)b.x1, (uint32_t)b.y1,
                           o->mask,        orientation_of(o, g)};
  uint64_t one[2] = {0};
  for (size_t k = 0; k < G_N_ELEMENTS(word); k += 2)
    environment_add(one, one[0] ^ ((uint64_t)word[k] << 32 | word[k + 1]));
  sum[0] += one[0];
  sum[1] += one[1];
}

/* Return 1 for the only transistor of a class, while representatives are
   chosen. */
static int is_single(const work *w, size_t i) {
  return w->members && w->members[w->chip->gate[i].mask] == 1;
}

/* The sums include transistor i itself. */
static void sum_up(const band *s, size_t i) {
  const eda_chip *c = s->work->chip;
  const eda_chip_gate *g = &c->gate[i];
  eda_finder f =
      eda_index_find(s->index, eda_box_grown(g->box, s->work->margin));
  uint64_t sum[2] = {0};
  for (uint32_t k; eda_index_next(&f, &k);)
    sum_neighbour(g, &c->gate[s->from + k], sum);
  memcpy(s->sum[i - s->begin], sum, SUM_SIZE);
}

static void sum_some(void *data, size_t part) {
  const band *s = data;
  size_t first = s->begin + part * SUMS_AT_ONCE,
         end = MIN(first + SUMS_AT_ONCE, s->end);
  for (size_t i = first; i < end; i++)
    if (!is_single(s->work, i)) sum_up(s, i);
}

/* Return the number of transistors whose lower edge is below y. */
static size_t count_below(const eda_chip *c, int64_t y) {
  size_t from = 0, to = c->count;
  while (from < to) {
    size_t middle = from + (to - from) / 2;
    if (c->gate[middle].box.y0 < y)
      from = middle + 1;
    else
      to = middle;
  }
  return from;
}

/* Compute the checksums of the band of transistors that begins with `begin` and
   has the height of a window. The caller frees band.sum. */
static band band_sum(const work *w, size_t begin) {
  const eda_chip *c = w->chip;
  int64_t low = c->gate[begin].box.y0, high = low + w->window;
  int64_t reach = (int64_t)w->margin + w->tallest;
  band s = {.work = w,
            .begin = begin,
            .end = count_below(c, high),
            .from = count_below(c, low - reach)};
  size_t n = count_below(c, high + reach) - s.from, own = s.end - begin;
  eda_box *box = eda_alloc(n, sizeof *box);
  for (size_t i = 0; i < n; i++) box[i] = c->gate[s.from + i].box;
  s.index = eda_index_new(box, n, 0);
  free(box);
  s.sum = eda_alloc(own, sizeof *s.sum);
  opc_parallel(w->host->context, (own + SUMS_AT_ONCE - 1) / SUMS_AT_ONCE,
               sum_some, &s);
  eda_index_free(s.index);
  return s;
}

static void add_print(work *w, const uint8_t *sum, uint32_t first) {
  eda_chip *c = w->chip;
  size_t capacity = w->print_capacity;
  eda_grow(&w->print, &capacity, c->prints + 1, sizeof *w->print);
  capacity = w->print_capacity;
  eda_grow(&w->print_first, &capacity, c->prints + 1, sizeof *w->print_first);
  capacity = w->print_capacity;
  eda_grow(&w->tried, &capacity, c->prints + 1, 1);
  w->print_capacity = capacity;
  w->print[c->prints] = (class_result){0};
  w->print_first[c->prints] = first;
  w->tried[c->prints] = 0;
  gpointer copy = g_memdup2(sum, SUM_SIZE);
  g_ptr_array_add(w->sums, copy);
  g_hash_table_insert(w->prints, copy, GUINT_TO_POINTER(++c->prints));
}

void prints_find(work *w) {
  eda_chip *c = w->chip;
  for (size_t i = 0; i < c->count;) {
    band s = band_sum(w, i);
    for (; i < s.end; i++) {
      if (is_single(w, i)) continue;
      const uint8_t *sum = s.sum[i - s.begin];
      guint k = GPOINTER_TO_UINT(g_hash_table_lookup(w->prints, sum));
      if (!k) add_print(w, sum, (uint32_t)i);
      c->gate[i].print = (k ? k : (guint)c->prints) - 1;
    }
    free(s.sum);
  }
}

void prints_clear(work *w) {
  g_hash_table_remove_all(w->prints);
  g_ptr_array_set_size(w->sums, 0);
  w->chip->prints = 0;
}

/* ---- printing ---- */

typedef struct verify_run {
  sheets on;    /* transistors to simulate */
  size_t first; /* number of the first simulated print */
} verify_run;

typedef struct verified {
  uint32_t place, flags;
  eda_figures design, after;
  double length, width, extension[2]; /* nm */
} verified;

/* Build the masks of a sheet without simulating them. */
static int make_mask(const work *w, const sheet *s, eda_mask **out,
                     opc_error *error) {
  int code = sheet_mask(w->chip, s, out, error);
  if (code) return code;
  for (size_t i = 0; i < s->gates->count && w->cells.used; i++)
    (*out)->moved->seen[i] = w->alone[w->chip->gate[s->of[i]].mask].seen;
  eda_performance_init(&(*out)->design, s->gates->count);
  return eda_measure_drawn(w->host->context, s->gates, w->with->extractor,
                           &(*out)->design, error);
}

static int print_mask(const work *w, eda_mask *m, double **extension,
                      opc_error *error) {
  correct_settings with = *w->with;
  with.margin = w->gap * w->chip->grid;
  if (work_is_fast(w)) with.fine = 0;
  int code = correct_print(&with, w->host, 0, m, NULL, extension, error);
  if (!code && work_is_fast(w)) correct_start_correct(m->moved, &m->after);
  return code;
}

static void put_all(const eda_mask *m, const sheet *s, const double *extension,
                    opc_bytes *out) {
  uint64_t n = 0; /* number of records, which precede the violations */
  for (size_t k = 0; k < s->gates->count; k++) n += s->place[k] != UINT32_MAX;
  out->add(out, &n, sizeof n);
  for (size_t k = 0; k < s->gates->count; k++) {
    const verified one = {
        .place = s->place[k],
        .flags = m->flags[k],
        .design = eda_figures_of(&m->design, k),
        .after = eda_figures_of(&m->after, k),
        .length = s->gates->length[k],
        .width = s->gates->width[k],
        .extension = {extension[2 * k], extension[2 * k + 1]}};
    if (one.place != UINT32_MAX) out->add(out, &one, sizeof one);
  }
}

static int verify_sheet(void *data, size_t i, opc_bytes *out,
                        opc_error *error) {
  verify_run *p = data;
  work *w = p->on.work;
  sheet s;
  eda_mask *m = NULL;
  double *extension = NULL;
  int code = sheet_make(w->host->context, w->chip, &p->on.cover, p->on.number,
                        &p->on.pages, i, 0, &s, error);
  if (!code) code = make_mask(w, &s, &m, error);
  if (!code) code = print_mask(w, m, &extension, error);
  if (!code) {
    const eda_printed printed = {.gates = s.gates,
                                 .flags = m->flags,
                                 .l = m->moved->l,
                                 .w = m->moved->w,
                                 .aside = m->moved->aside,
                                 .extension = extension,
                                 .shapes = m->shapes,
                                 .print = m->print,
                                 .scanner = eda_scanner_of(w->with->litho)};
    put_all(m, &s, extension, out);
    code = faults_find(w, &s, &printed, out, error);
  }
  free(extension);
  eda_mask_free(m);
  sheet_clear(&s);
  return code;
}

double print_deviation(const class_result *p) {
  return ion_deviation(p->flags, p->after.ion, p->design.ion);
}

int work_is_fast(const work *w) {
  return w->cells.used && !isnan(w->cells.max_diff) && w->with->fine > 0;
}

int work_continues(const work *w) {
  const eda_synthesizer *s = w->with->synthesizer->functions;
  return w->cells.used && !isnan(w->cells.max_diff) &&
         s->flags & EDA_SYNTHESIZER_CONTINUES;
}

double mask_limit(const work *w, uint32_t mask) {
  double n = (double)w->chip->count, most = w->with->ion_limit;
  if (!w->cells.used || isnan(w->cells.max_diff))
    return !w->cells.used && (double)w->classes > tuned.distinct * n
               ? most
               : tuned.split * most;
  const alone *a = &w->alone[mask];
  double off = a->known ? print_deviation(&a->result) : 0;
  double limit = w->cells.max_diff + (isfinite(off) ? off : 0);
  /* The synthesizer does not move transistors within `ion_limit`. */
  return work_continues(w) ? fmax(limit, most) : limit;
}

double print_beyond(const work *w, const eda_chip_gate *g) {
  const class_result *p = &w->print[g->print];
  double limit = mask_limit(w, g->mask), off = print_deviation(p);
  return off > limit ? off : p->violations ? limit : NAN;
}

static int take_sheet(void *data, size_t i, const void *bytes, size_t size,
                      opc_error *error) {
  verify_run *p = data;
  work *w = p->on.work;
  eda_chip *c = w->chip;
  const char *at = bytes;
  uint64_t n;
  (void)i, (void)error;
  memcpy(&n, at, sizeof n);
  at += sizeof n;
  for (; n; n--, at += sizeof(verified)) {
    verified one;
    memcpy(&one, at, sizeof one);
    class_result *to = &w->print[p->first + one.place];
    uint32_t mask = c->gate[p->on.number[one.place]].mask;
    *to = (class_result){.design = one.design,
                         .before = w->before[mask].figures,
                         .after = one.after,
                         .length = one.length,
                         .width = one.width,
                         .extension = {one.extension[0], one.extension[1]},
                         .flags_before = w->before[mask].flags,
                         .flags = one.flags};
    if (isfinite(print_deviation(to)))
      w->worst = fmax(w->worst, print_deviation(to));
  }
  faults_take(w, p->first, at, (const char *)bytes + size);
  return OPC_OK;
}

/* Set the figures of the new prints to those in their cells. Return 0 if a mask
   was not made in a cell. */
static int take_alone(work *w, size_t first) {
  const eda_chip *c = w->chip;
  for (size_t k = first; k < c->prints; k++) {
    const alone *a = &w->alone[c->gate[w->print_first[k]].mask];
    if (!a->known) return 0;
    w->print[k] = a->result;
  }
  return 1;
}

int verify_all(work *w, opc_error *error) {
  eda_chip *c = w->chip;
  verify_run p = {.on.work = w, .first = c->prints};
  prints_find(w);
  if (w->cells.used && !w->cells.verify && take_alone(w, p.first))
    return OPC_OK;
  p.on.count = c->prints - p.first;
  p.on.number = w->print_first + p.first;
  w->worst = 0;
  return work_sheets(
      &p.on, w->margin,
      (opc_pieces){.name = "prove", .work = verify_sheet, .take = take_sheet},
      error);
}
