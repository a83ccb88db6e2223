/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the reversion of transistors that the loop made worse than with
   the drawn mask. */
#include <correct/guard.h>

#include <eda/index.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/loop.h>

/* Tuned constants. Lengths in nm. */
static const struct {
  double worse, part, equal_part, near, reach, around;
  int rounds, trials;
} tuned = {
    /* Tolerance of |Ion deviation|, %; below the resolution of device tables.
     */
    .worse = 0.001,

    /* Tolerance of a comparison with the drawn mask, as a fraction of
       `ion_limit`; equal to the error for which the accurate model is set
       up. */
    .part = 0.1,

    /* Tolerance, %, within which a gate is as good as drawn in a trial. Edges
       farther than 4 um change Ion by less (c432: by 0.02 for a drawn deviation
       of 41 %). */
    .equal_part = 0.05,

    /* Two violations of one rule within this distance are the same; below the
       width of a gate, so that its two ends are distinguished. */
    .near = 100,

    /* Fragments within this distance of a gate's box belong to the gate; this
       includes fragments of its line ends. About the resolution at 193 nm, NA
       0.75. */
    .reach = 150,

    /* Distance within which all edges are reverted at the level
       GUARD_SURROUNDED; each higher level doubles the distance. About the
       distance of neighbouring poly. */
    .around = 250,

    /* Number of simulations after which the entire mask is reverted to drawn. A
       single gate needed three, a cluster of a hundred lines less than ten. */
    .rounds = 30,

    /* Number of trials of possible causes. The trials revert the regulator's
       shapes, then all edges within eight times `around`, then within sixteen
       times. The optical influence beyond 2 um is small. */
    .trials = 3,
};

enum { GOOD, WORSE, RULE, LOST }; /* faults, by severity */

/* ---- drawn mask ---- */

void correct_guard_init(guard *g, size_t gates) {
  g->state = eda_alloc(gates, sizeof *g->state);
  g->flags = eda_alloc(gates, sizeof *g->flags);
  for (size_t i = 0; i < gates; i++)
    g->state[i].off = g->state[i].least = INFINITY;
}

void correct_guard_clear(guard *g) {
  free(g->state);
  free(g->flags);
  free(g->drawn);
}

/* Compare violations by transistor, then by x. */
static int by_place(const void *a, const void *b) {
  const eda_violation *p = a, *q = b;
  if (p->gate != q->gate) return p->gate < q->gate ? -1 : 1;
  return p->x < q->x ? -1 : p->x > q->x;
}

int correct_guard_begin(loop *l, const eda_printed *drawn, opc_error *error) {
  guard *g = &l->guard;
  if (!l->gates->count) return OPC_OK;
  memcpy(g->flags, drawn->flags, l->gates->count * sizeof *g->flags);
  if (!l->regulator) return OPC_OK;
  free(g->drawn);
  int code = correct_violations(l->host->context, l->regulator, drawn,
                                &g->drawn, &g->rules, error);
  if (g->rules) qsort(g->drawn, g->rules, sizeof *g->drawn, by_place);
  return code;
}

/* Return the factor on a gate's drawn Ion that the synthesizer aims at; NAN: no
   target. */
static double target_of(const loop *l, size_t gate) {
  const opc_module *m = l->drivers[MAIN].module;
  const eda_synthesizer *s = m->functions;
  if (!s->target) return 1;
  const char *before = opc_enter(l->host->context, m->id);
  double target = s->target(m->self, gate);
  opc_leave(l->host->context, before);
  return target;
}

/* Return the |Ion deviation| from the target, %. */
static double guard_deviation(const loop *l, const eda_performance *p, size_t i,
                              double target) {
  return fabs(eda_deviation(p->ion[i], l->design.ion[i] * target));
}

double correct_guard_off(const loop *l, size_t i) {
  if (eda_print_failed(l->measured.flags[i])) return NAN;
  return guard_deviation(l, &l->measured.performance, i, target_of(l, i));
}

/* Record the best displacements of each gate. If the line ends of a gate
   changed, discard its record, because its Ion depends on the line ends. The
   guard's own simulations are not recorded. */
void correct_guard_watch(loop *l) {
  const biases *b = &l->now.biases;
  if (l->guard.prints) return;
  for (size_t i = 0; i < l->gates->count; i++) {
    guarded *s = &l->guard.state[i];
    if (memcmp(s->end, b->end + 2 * i, sizeof s->end)) s->off = INFINITY;
    memcpy(s->end, b->end + 2 * i, sizeof s->end);
    double now = correct_guard_off(l, i);
    if (!(now < s->off)) continue;
    s->off = now;
    s->best = (gate_moves){
        .l = b->l[i], .w = b->w[i], .aside = b->aside[i], .jog = b->jog[i]};
    memcpy(s->best.part, b->part + EDA_PARTS * i, sizeof s->best.part);
  }
}

/* ---- faults ---- */

/* Compare the names of two rules, which end at ':' or ';'. */
static int same_rule(const char *a, const char *b) {
  size_t n = strcspn(a, ":;");
  return n == strcspn(b, ":;") && !strncmp(a, b, n);
}

/* Return 1 if the drawn mask also violates this rule at this position. */
static int was_broken(const guard *g, const eda_violation *v) {
  size_t low = 0, high = g->rules;
  const eda_violation first = {.gate = v->gate, .x = v->x - tuned.near};
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (by_place(&g->drawn[middle], &first) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  for (; low < g->rules; low++) {
    const eda_violation *d = &g->drawn[low];
    if (d->gate != v->gate || d->x > v->x + tuned.near) return 0;
    if (fabs(d->y - v->y) <= tuned.near && same_rule(d->rule, v->rule))
      return 1;
  }
  return 0;
}

static eda_box box_grown(eda_box b, double by) {
  int32_t d = (int32_t)fmin(by, INT32_MAX / 4);
  return eda_box_grown(b, d);
}

/* Return a position in nm as a box of one point, in grid units. */
static eda_box place_of(const loop *l, double x, double y) {
  int32_t a = (int32_t)lround(x / l->gates->grid),
          b = (int32_t)lround(y / l->gates->grid);
  return (eda_box){a, b, a, b};
}

/* Return the uncertainty of a comparison with the drawn mask, %. The comparison
   is uncertain because the difference of the accurate and the fast model is
   computed for the first displaced mask and applied to the drawn mask. For
   c432, this causes an error of 0.02 in the mean and 0.1 at most. */
static double model_margin(const loop *l) {
  return l->printer.fine > 0 ? tuned.part * l->ion_limit : 0;
}

static int fault_of(const loop *l, size_t i, double margin) {
  const guard *g = &l->guard;
  /* A transistor that keeps its mask is no fault: it may be worse because of
     its neighbours. At the edge of a part of a layout, where neighbours are
     missing, the transistor may not print. */
  if (l->still && l->still[i]) return GOOD;
  if (eda_print_failed(l->measured.flags[i]))
    return eda_print_failed(g->flags[i]) ? GOOD : LOST;
  double target = target_of(l, i);
  if (isnan(target) || eda_print_failed(g->flags[i])) return GOOD;
  double drawn = guard_deviation(l, &l->before, i, target) + model_margin(l);
  double most = fmax(drawn, l->ion_limit) + margin;
  return guard_deviation(l, &l->measured.performance, i, target) <= most
             ? GOOD
             : WORSE;
}

/* Mark new violations as faults of their transistors, unless all edges of the
   transistor have already been reverted: reverting its environment as well
   would cause more violations. Ignore violations of transistors that keep their
   masks, and violations without a transistor, for example of mask edges. */
static int find_broken(loop *l, opc_error *error) {
  guarded *state = l->guard.state;
  eda_violation *v = NULL;
  size_t n = 0;
  if (!l->regulator) return OPC_OK;
  eda_printed p = correct_loop_printed(l);
  int code =
      correct_violations(l->host->context, l->regulator, &p, &v, &n, error);
  for (size_t k = 0; k < n && !code; k++) {
    int fixed = v[k].gate < 0 || (l->still && l->still[v[k].gate]);
    guarded *s = fixed ? NULL : &state[v[k].gate];
    if (!s || s->tries > GUARD_DRAWN || was_broken(&l->guard, &v[k])) continue;
    s->fault = MAX(s->fault, RULE);
    s->rule = g_intern_string(v[k].rule);
    s->at[0] = v[k].x;
    s->at[1] = v[k].y;
  }
  free(v);
  return code;
}

/* Record the level with the smallest |Ion deviation| of a transistor. */
static void keep_least(loop *l, size_t i) {
  guarded *s = &l->guard.state[i];
  double now = guard_deviation(l, &l->measured.performance, i, target_of(l, i));
  if (!(now < s->least)) return;
  s->least = now;
  s->pick = s->level;
}

/* Find the faults of all transistors in the last simulation. *count receives
   the number of transistors with a fault whose cause is not known. */
static int find_faults(loop *l, size_t *count, opc_error *error) {
  *count = 0;
  for (size_t i = 0; i < l->gates->count; i++)
    l->guard.state[i].fault = (uint8_t)fault_of(l, i, tuned.worse);
  int code = find_broken(l, error);
  for (size_t i = 0; i < l->gates->count; i++) {
    guarded *s = &l->guard.state[i];
    if (s->fault != WORSE) s->cause = NULL;
    if (s->fault <= WORSE && s->level <= GUARD_DRAWN) keep_least(l, i);
    if (s->cause) s->fault = GOOD;
    *count += s->fault != GOOD;
  }
  return code;
}

/* ---- reversion ---- */

typedef struct hold {
  loop *l;
  eda_index *gates;      /* boxes of the gates */
  eda_index **fragments; /* [layers], sites of dissected layers */
  trial ended;           /* displacements with which the loop ended */
} hold;

static void hold_init(hold *h, loop *l) {
  const eda_gates *g = l->gates;
  *h = (hold){.l = l, .gates = eda_index_new(g->box, g->count, 0)};
  h->fragments = eda_alloc(g->layers, sizeof(eda_index *));
  correct_trial_init(&h->ended, g->layers, g->count);
  correct_trial_copy(&h->ended, &l->now);
  correct_trial_copy(&l->next, &l->now);
  for (size_t k = 0; k < g->layers; k++) {
    const sites *s = &l->sites[k];
    if (!l->now.shift[k] || l->driver_of[k] != MAIN) continue;
    eda_box *box = eda_alloc(s->count, sizeof *box);
    for (size_t i = 0; i < s->count; i++)
      box[i] = place_of(l, s->place[2 * i], s->place[2 * i + 1]);
    h->fragments[k] = eda_index_new(box, s->count, 0);
    free(box);
  }
}

static void hold_clear(hold *h) {
  for (size_t k = 0; k < h->l->gates->layers; k++)
    eda_index_free(h->fragments[k]);
  free(h->fragments);
  eda_index_free(h->gates);
  correct_trial_clear(&h->ended);
}

/* Set the displacements of the fragments in a window to the fraction `part` of
   the synthesizer's result. */
static void set_fragments(hold *h, eda_box window, double part) {
  for (size_t k = 0; k < h->l->gates->layers; k++) {
    if (!h->fragments[k]) continue;
    int32_t *to = h->l->next.shift[k], *from = h->ended.shift[k];
    eda_finder f = eda_index_find(h->fragments[k], window);
    for (uint32_t i; eda_index_next(&f, &i);)
      if (fabs(part * from[i]) < abs(to[i])) to[i] = (int32_t)(part * from[i]);
  }
}

static eda_box window_of(const hold *h, size_t gate, double nm) {
  return box_grown(h->l->gates->box[gate], nm / h->l->gates->grid);
}

static void set_gate(hold *h, size_t i, const gate_moves *to) {
  biases *b = &h->l->next.biases;
  b->l[i] = to->l;
  b->w[i] = to->w;
  b->aside[i] = to->aside;
  b->jog[i] = to->jog;
  memcpy(b->part + EDA_PARTS * i, to->part, sizeof to->part);
}

/* Revert the line ends of a gate, and the regulator's shapes within a distance,
   to the start of the loop. */
static void drop_rules(hold *h, size_t gate, double nm) {
  loop *l = h->l;
  eda_box window = window_of(h, gate, nm);
  correct_start_reset_ends(&l->start, &l->next.biases, gate);
  for (size_t k = 0; k < l->gates->layers; k++) {
    if (l->driver_of[k] != MAIN) continue;
    correct_trial_reset_boxes(&l->next.added[k], window,
                              correct_loop_begun(l, k, 0));
    correct_trial_reset_boxes(&l->next.cutouts[k], window,
                              correct_loop_begun(l, k, 1));
  }
}

/* Revert all edges and added shapes within a distance of a gate to drawn. */
static void set_around(hold *h, size_t gate, double nm) {
  loop *l = h->l;
  eda_box window = window_of(h, gate, nm);
  eda_finder f = eda_index_find(h->gates, window);
  for (uint32_t i; eda_index_next(&f, &i);)
    correct_start_reset(&l->start, &l->next.biases, i, 1);
  set_fragments(h, window, 0);
  drop_rules(h, gate, nm);
  for (size_t k = 0; k < l->gates->layers; k++)
    if (l->driver_of[k] == MAIN)
      correct_trial_drop_boxes(&l->next.assists[k], window);
}

/* Return the distance, nm, within which all edges are reverted at a level. */
static double level_radius(int level) {
  return tuned.around * pow(2, level - GUARD_SURROUNDED);
}

static void set_level(hold *h, size_t i) {
  const guarded *s = &h->l->guard.state[i];
  const eda_moved *from = h->l->start.from;
  const gate_moves half = {
      .l = (s->best.l + (from ? from->l[i] : 0)) / 2,
      .w = (s->best.w + (from ? from->w[i] : 0)) / 2,
      .aside = (s->best.aside + (from ? from->aside[i] : 0)) / 2};
  eda_box own = window_of(h, i, tuned.reach);
  switch (s->level) {
    case GUARD_BEST:
      set_gate(h, i, &s->best);
      break;
    case GUARD_HALF:
      set_gate(h, i, &half);
      set_fragments(h, own, 0.5);
      break;
    case GUARD_DRAWN:
      correct_start_reset(&h->l->start, &h->l->next.biases, i, 0);
      set_fragments(h, own, 0);
      break;
    default:
      set_around(h, i, level_radius(s->level));
  }
}

/* Build the next mask from the synthesizer's result and the levels of all
   transistors. Apply levels that also revert the environment of a transistor
   last, so that no other level overrides them. */
static void hold_apply(hold *h) {
  const guarded *state = h->l->guard.state;
  correct_trial_copy(&h->l->next, &h->ended);
  for (int surrounded = 0; surrounded < 2; surrounded++)
    for (size_t i = 0; i < h->l->gates->count; i++)
      if (state[i].level && (state[i].level >= GUARD_SURROUNDED) == surrounded)
        set_level(h, i);
}

/* Advance each transistor with a fault to the next level. A transistor that
   prints and has reached GUARD_DRAWN receives the best level tried. Return the
   number of advanced transistors. */
static size_t hold_advance(hold *h) {
  size_t count = 0;
  for (size_t i = 0; i < h->l->gates->count; i++) {
    guarded *s = &h->l->guard.state[i];
    if (s->fault == GOOD || (s->fault == WORSE && s->tries > GUARD_DRAWN))
      continue;
    int last = s->fault < LOST && s->tries == GUARD_DRAWN;
    s->tries++;
    s->level = last ? s->pick : s->tries;
    count++;
  }
  if (count) hold_apply(h);
  return count;
}

static void hold_revert_all(hold *h) {
  trial *next = &h->l->next;
  for (size_t i = 0; i < next->gates; i++) {
    correct_start_reset(&h->l->start, &next->biases, i, 1);
    h->l->guard.state[i].level = GUARD_SURROUNDED;
  }
  for (size_t k = 0; k < next->layers; k++) {
    if (h->l->driver_of[k] != MAIN) continue;
    next->assists[k].count = 0;
    correct_trial_set_boxes(&next->added[k], correct_loop_begun(h->l, k, 0));
    correct_trial_set_boxes(&next->cutouts[k], correct_loop_begun(h->l, k, 1));
    if (next->shift[k])
      memset(next->shift[k], 0, next->fragments[k] * sizeof(int32_t));
  }
}

static int guard_print(loop *l, opc_error *error) {
  if (opc_cancelled(l->host->context))
    return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
  l->guard.prints++;
  return correct_loop_print(l, 0, error);
}

/* ---- causes ---- */

static void centre_of(const eda_gates *g, size_t i, double *x, double *y) {
  *x = ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid;
  *y = ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid;
}

/* Set the cause to the regulator: to the line end with the larger displacement,
   or to a shape beside the gate if no line end is displaced. */
static void name_rule(hold *h, size_t gate) {
  const eda_gates *g = h->l->gates;
  const int32_t *end = h->ended.biases.end + 2 * gate;
  guarded *s = &h->l->guard.state[gate];
  eda_box b = g->box[gate];
  int high = abs(end[1]) > abs(end[0]);
  centre_of(g, gate, &s->x, &s->y);
  s->cause = end[high] ? "rule: line end" : "rule: added shape beside";
  if (!end[high]) return;
  if (g->axis[gate] == EDA_X)
    s->y = (high ? b.y1 : b.y0) * g->grid;
  else
    s->x = (high ? b.x1 : b.x0) * g->grid;
}

/* Set the cause to the nearest transistor with a displaced mask; if there is
   none, to the regulator. */
static void name_neighbour(hold *h, size_t gate, double nm) {
  const eda_gates *g = h->l->gates;
  const biases *b = &h->ended.biases;
  guarded *s = &h->l->guard.state[gate];
  double x, y, cx, cy, least = INFINITY;
  name_rule(h, gate);
  centre_of(g, gate, &x, &y);
  eda_finder f = eda_index_find(h->gates, window_of(h, gate, nm));
  for (uint32_t i; eda_index_next(&f, &i);) {
    int moved = b->l[i] || b->w[i] || b->jog[i] || h->fragments[EDA_POLY];
    centre_of(g, i, &cx, &cy);
    if (i == gate || !moved || hypot(cx - x, cy - y) >= least) continue;
    least = hypot(cx - x, cy - y);
    s->cause = "neighbour";
    s->x = cx;
    s->y = cy;
  }
}

/* Run trial t. Trial 0 reverts the regulator's shapes near each transistor in
   `open`; later trials revert all edges within a distance. Record the cause for
   transistors that are as good as drawn in the trial. */
static int try_cause(hold *h, int t, uint8_t *open, opc_error *error) {
  loop *l = h->l;
  double nm = t ? level_radius(GUARD_SURROUNDED + 2 + t) : tuned.around;
  for (size_t i = 0; i < l->gates->count; i++) {
    if (!open[i]) continue;
    if (t) {
      set_around(h, i, nm);
      continue;
    }
    correct_start_reset(&h->l->start, &h->l->next.biases, i, 0);
    set_fragments(h, window_of(h, i, tuned.reach), 0);
    drop_rules(h, i, nm);
  }
  int code = guard_print(l, error);
  for (size_t i = 0; i < l->gates->count && !code; i++) {
    if (!open[i] || fault_of(l, i, tuned.equal_part) != GOOD) continue;
    open[i] = 0;
    if (t)
      name_neighbour(h, i, nm);
    else
      name_rule(h, i);
  }
  return code;
}

/* Find the causes of worse transistors by trials, and undo the trials. For a
   transistor without a cause in any trial, revert the environment. */
static int find_causes(hold *h, opc_error *error) {
  loop *l = h->l;
  guarded *state = l->guard.state;
  size_t n = l->gates->count;
  uint8_t *open = eda_alloc(n, 1);
  int code = OPC_OK;
  for (size_t i = 0; i < n; i++) open[i] = state[i].fault == WORSE;
  for (int t = 0; t < tuned.trials && !code && memchr(open, 1, n); t++)
    code = try_cause(h, t, open, error);
  for (size_t i = 0; i < n; i++)
    if (open[i])
      state[i].level = (uint8_t)(GUARD_SURROUNDED + tuned.trials + 1);
  free(open);
  hold_apply(h);
  return code ? code : guard_print(l, error);
}

/* ---- run ---- */

static int guard_revert(hold *h, opc_error *error) {
  size_t faults = 0;
  int code = find_faults(h->l, &faults, error);
  for (int round = 0; faults && round <= tuned.rounds && !code; round++) {
    int gone = 1;
    if (round == tuned.rounds)
      hold_revert_all(h);
    else
      gone = hold_advance(h) > 0;
    code = gone ? guard_print(h->l, error) : find_causes(h, error);
    if (!code) code = find_faults(h->l, &faults, error);
  }
  return code;
}

/* Count the faults of the last simulation. */
void correct_guard_count(loop *l) {
  guard *g = &l->guard;
  for (size_t i = 0; i < l->gates->count; i++) {
    int fault = fault_of(l, i, tuned.worse);
    const guarded *s = &g->state[i];
    g->back += s->level > 0;
    if (s->level && s->rule && correct_guard_off(l, i) > l->ion_limit) {
      if (!g->ruled) g->first = i;
      g->ruled++;
    }
    g->worse += fault == WORSE;
    g->lost += fault == LOST;
  }
}

int correct_guard_hold(loop *l, opc_error *error) {
  hold h;
  hold_init(&h, l);
  int code = guard_revert(&h, error);
  for (int k = 0; !code && correct_verification_is_due(l); k++) {
    code = correct_loop_refine(l, error);
    if (!code && k < VERIFICATIONS) code = guard_revert(&h, error);
  }
  hold_clear(&h);
  if (!code) correct_guard_count(l);
  return code;
}

char *correct_guard_verdict(const guard *g, size_t gate) {
  static const char *const words[] = {
      NULL, "reverted: its best mask", "reverted: half of its best mask",
      "reverted: as drawn", "reverted: as drawn, with all neighbours"};
  const guarded *s = &g->state[gate];
  if (s->cause)
    return g_strdup_printf("%s at (%.0f, %.0f) nm", s->cause, s->x, s->y);
  if (s->level && s->rule)
    return g_strdup_printf("%s, for the rule %s at (%.0f, %.0f) nm",
                           words[MIN(s->level, GUARD_SURROUNDED)], s->rule,
                           s->at[0], s->at[1]);
  return g_strdup(words[MIN(s->level, GUARD_SURROUNDED)]);
}
