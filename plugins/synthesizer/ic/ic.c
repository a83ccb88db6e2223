/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements synthesizer.ic: hybrid Ion and capacitance based OPC (thesis
   chapter 5, figure 5.2). L or W of each transistor moves by one grid step. The
   signs of its current and area deviations select the step (figure 5.3). Steps
   continue as long as the weighted sum of both |deviations| decreases. */
#include <eda/memory.h>
#include <eda/synthesizer.h>
#include <math.h>
#include <opcflow/follow.h>
#include <stdlib.h>

/* ---- state ---- */

enum { FREEZE, CONTINUE };

/* Verdicts of transistors. */
enum { WITHIN, STALLED, BRIDGING, BIAS, MOVING, VERDICTS };
static const char *const verdicts[VERDICTS] = {
    "within limit", "stalled", "bridging", "bias limit", "not done"};

/* The four corrections of the decision matrix. */
enum { LONGER, SHORTER, WIDER, NARROWER, CORRECTIONS };
static const struct {
  int32_t l, w;
  uint32_t veto;
} corrections[CORRECTIONS] = {[LONGER] = {1, 0, EDA_VETO_LONGER},
                              [SHORTER] = {-1, 0, EDA_VETO_SHORTER},
                              [WIDER] = {0, 1, EDA_VETO_WIDER},
                              [NARROWER] = {0, -1, EDA_VETO_NARROWER}};

typedef struct transistor {
  double eff; /* effective deviation at the last measurement, % */
  /* In the variant CONTINUE: figures of the best state. */
  double best_eff, best_di, best_da;
  int32_t best_l, best_w;
  int8_t moved;  /* last correction, or -1 */
  uint8_t tried; /* in the variant CONTINUE: bit set of the corrections of the
                    best state that failed */
  uint8_t ended; /* 1: no further correction */
  uint8_t why;   /* verdict if the transistor ended outside the limits */
  uint8_t verdict;
  int64_t retries;
} transistor;

typedef struct ic {
  const opc_host *host;
  double alpha_i, alpha_a;
  double ion_limit, area_limit; /* % */
  double max_bias;              /* nm */
  int stall;
  int64_t retries;
  transistor *state;
  size_t count;
} ic;

/* Measured figures of a transistor. */
typedef struct measured {
  double di, da;        /* Ion and area deviation, %; lines 7 and 8 */
  double eff;           /* effective deviation, %; line 9 */
  double length, width; /* drawn sizes, grid steps */
  int32_t most;         /* largest |bias| of L, grid steps */
  int32_t most_w;       /* largest |bias| of W, grid steps */
  uint32_t veto;
} measured;

/* ---- work ---- */

static void ic_follow(ic *c, eda_scanner scanner);

static int ic_begin(void *self, const eda_feedback *f, opc_error *error) {
  ic *c = self;
  ic_follow(c, f->scanner);
  eda_follow_ion_limit(f, &c->ion_limit);
  (void)error;
  free(c->state);
  c->count = f->gates->count;
  c->state = eda_alloc(c->count, sizeof *c->state);
  for (size_t i = 0; i < c->count; i++) {
    c->state[i].moved = -1;
    c->state[i].eff = c->state[i].best_eff = INFINITY;
  }
  return OPC_OK;
}

static measured transistor_measure(const ic *c, const eda_feedback *f,
                                   size_t i) {
  const eda_gates *g = f->gates;
  double ion = f->design->ion[i], area = f->design->area[i];
  measured m = {.di = 100 * (f->printed->ion[i] - ion) / ion,
                .da = 100 * (f->printed->area[i] - area) / area,
                .length = g->length[i] / g->grid,
                .width = g->width[i] / g->grid,
                .most = (int32_t)(c->max_bias / g->grid),
                .veto = f->vetoes[i]};
  m.eff = c->alpha_i * fabs(m.di) + c->alpha_a * fabs(m.da);
  if (f->flags[i] & EDA_PRINT_OPEN)
    m.eff = INFINITY; /* an open transistor has no valid measurement */
  m.most_w = (int32_t)fmin(m.most, m.width / 2);
  return m;
}

static int is_outside(const ic *c, const measured *m) {
  return fabs(m->di) > c->ion_limit || fabs(m->da) > c->area_limit;
}

/* Return the correction of the decision matrix, lines 12 to 19; -1 if a
   deviation is exactly 0. */
static int matrix_decide(const measured *m) {
  if (m->di > 0 && m->da < 0) return LONGER;
  if (m->di < 0 && m->da > 0) return SHORTER;
  if (m->di < 0 && m->da < 0) return WIDER;
  if (m->di > 0 && m->da > 0) return NARROWER;
  return -1;
}

static void transistor_end(transistor *t, int why) {
  t->ended = 1;
  t->moved = -1;
  t->why = (uint8_t)why;
}

/* Apply a correction to (l, w). If a veto or the bias limit forbids the
   correction, end the transistor. */
static void transistor_correct(transistor *t, const measured *m, int correction,
                               int32_t *l, int32_t *w) {
  t->moved = -1;
  if (correction < 0) return;
  if (m->veto & corrections[correction].veto) {
    transistor_end(t, BRIDGING);
  } else if (abs(*l + corrections[correction].l) > m->most ||
             abs(*w + corrections[correction].w) > m->most_w) {
    transistor_end(t, BIAS);
  } else {
    *l += corrections[correction].l;
    *w += corrections[correction].w;
    t->moved = (int8_t)correction;
  }
}

/* Perform lines 10 to 20 for one transistor. A transistor whose step was
   reverted ends: its mask equals an earlier one, so the algorithm would repeat
   the same step forever. */
static void transistor_freeze(const ic *c, transistor *t, const measured *m,
                              int32_t *l, int32_t *w) {
  int vetoed = t->moved >= 0 && m->veto & corrections[t->moved].veto;
  if (m->eff < t->eff && !vetoed) {
    transistor_correct(t, m, is_outside(c, m) ? matrix_decide(m) : -1, l, w);
  } else if (t->moved >= 0) {
    *l -= corrections[t->moved].l;
    *w -= corrections[t->moved].w;
    transistor_end(t, vetoed ? BRIDGING : STALLED);
  }
}

/* Return the effective deviation expected after a correction, with Ion
   proportional to W / L and area to W L. */
static double deviation_after(const ic *c, const measured *m, int correction) {
  double by_l = 100 * corrections[correction].l / m->length,
         by_w = 100 * corrections[correction].w / m->width;
  return c->alpha_i * fabs(m->di - by_l + by_w) +
         c->alpha_a * fabs(m->da + by_l + by_w);
}

/* Return the next correction to try from the best state: first the correction
   of the matrix, then the others by expected deviation. Return -1 if all
   corrections failed or are forbidden. */
static int next_correction(const ic *c, const transistor *t, measured m) {
  m.di = t->best_di;
  m.da = t->best_da;
  int best = -1, first = matrix_decide(&m);
  for (int correction = 0; correction < CORRECTIONS; correction++) {
    if (t->tried & 1 << correction || m.veto & corrections[correction].veto ||
        abs(t->best_l + corrections[correction].l) > m.most ||
        abs(t->best_w + corrections[correction].w) > m.most_w)
      continue;
    if (correction == first) return correction;
    if (best < 0 ||
        deviation_after(c, &m, correction) < deviation_after(c, &m, best))
      best = correction;
  }
  return best;
}

/* Perform one iteration of the variant CONTINUE: if Eff did not fall, return to
   the best state and try another correction. */
static void transistor_retry(const ic *c, transistor *t, const measured *m,
                             int32_t *l, int32_t *w) {
  int vetoed = t->moved >= 0 && m->veto & corrections[t->moved].veto;
  if ((m->eff < t->best_eff && !vetoed) || t->moved < 0) {
    t->best_eff = m->eff;
    t->best_di = m->di;
    t->best_da = m->da;
    t->best_l = *l;
    t->best_w = *w;
    t->tried = 0;
  } else {
    t->tried |= (uint8_t)(1 << t->moved);
    t->retries++;
  }
  int best = t->best_l == *l && t->best_w == *w;
  int correction = best && !is_outside(c, m) ? -1 : next_correction(c, t, *m);
  if (t->retries > c->retries || correction < 0) {
    if (!best || is_outside(c, m))
      transistor_end(t, vetoed ? BRIDGING : STALLED);
    correction = -1;
  }
  *l = t->best_l + (correction < 0 ? 0 : corrections[correction].l);
  *w = t->best_w + (correction < 0 ? 0 : corrections[correction].w);
  t->moved = (int8_t)correction;
}

/* Correct all transistors. The correction is finished if neither a mask (line
   21) nor a measured figure changes; line ends that the regulator moves may
   change measured figures. */
static int ic_update(void *self, const eda_feedback *f, eda_moves *moves,
                     int *done, opc_error *error) {
  ic *c = self;
  (void)error;
  *done = 1;
  for (size_t i = 0; i < c->count; i++) {
    transistor *t = &c->state[i];
    measured m = transistor_measure(c, f, i);
    int32_t l = moves->l[i], w = moves->w[i];
    if (t->eff != m.eff && isfinite(t->eff)) *done = 0;
    /* An open line is too thin: increase L. */
    if (!t->ended && isinf(m.eff) && isinf(t->eff))
      transistor_correct(t, &m, LONGER, &moves->l[i], &moves->w[i]);
    else if (!t->ended)
      (c->stall == FREEZE ? transistor_freeze : transistor_retry)(
          c, t, &m, &moves->l[i], &moves->w[i]);
    if (l != moves->l[i] || w != moves->w[i]) *done = 0;
    t->eff = m.eff;
    t->verdict = !is_outside(c, &m) ? WITHIN : t->ended ? t->why : MOVING;
  }
  return OPC_OK;
}

static const char *ic_verdict(const void *self, size_t gate) {
  const ic *c = self;
  return gate < c->count ? verdicts[c->state[gate].verdict] : NULL;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(
        ic, alpha_i, .type = OPC_REAL, .preset = "1",
        .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 0, .max = 1e6,
        .summary = "weight of |Ion deviation| in the effective deviation"),
    OPC_PARAMETER(
        ic, alpha_a, .type = OPC_REAL, .preset = "1",
        .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 0, .max = 1e6,
        .summary =
            "weight of |gate area deviation| in the effective deviation"),
    OPC_PARAMETER(
        ic, ion_limit, .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "%",
        .follows = "ion_limit of the step", .former = "max_di|limit",
        .summary =
            "largest allowed |Ion deviation|; the thesis states no value"),
    OPC_PARAMETER(ic, area_limit, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "%", .preset = "0.5 %", .former = "max_da",
                  .summary = "largest allowed |gate area deviation|; a "
                             "transistor within both limits is not changed"),
    OPC_PARAMETER(
        ic, stall, .type = OPC_CHOICE, .preset = "freeze",
        .choices = "freeze|continue",
        .summary = "action if the effective deviation does not fall: revert "
                   "the step and end the correction of the transistor (as in "
                   "the thesis), or try other corrections from the best state"),
    OPC_PARAMETER(
        ic, retries, .type = OPC_INT, .preset = "8",
        .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 0, .max = 100000,
        .summary = "number of failed corrections after which a transistor ends "
                   "at the best state (stall: continue)"),
    EDA_MAX_BIAS(ic),
};

/* Compute the defaults of parameters that are not set. */
static void ic_follow(ic *c, eda_scanner scanner) {
  EDA_FOLLOW(c->host, "synthesizer.ic", c, parameters, scanner);
}

static int ic_check(void *self, opc_error *error) {
  const ic *c = self;
  if (c->alpha_i + c->alpha_a > 0) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "alpha_i",
                  "'alpha_i' and 'alpha_a' are both 0");
}

static void ic_clear(void *self) { free(((ic *)self)->state); }

/* ---- entry ---- */

static const eda_synthesizer functions = {
    .begin = ic_begin, .update = ic_update, .verdict = ic_verdict};

OPC_PLUGIN(
    ic, .id = "synthesizer.ic", .kind = "synthesizer", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary =
        "Ion and capacitance based OPC: steps chosen by a decision matrix",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    .check = ic_check, .clear = ic_clear, OPC_FUNCTIONS(functions));
