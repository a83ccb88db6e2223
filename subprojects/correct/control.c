/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements thesis figure 3.3 for one transistor, extended by a restart of
   transistors whose error changes after they reached their minimum. */
#include <correct/control.h>

#include <math.h>
#include <stdlib.h>

/* Tuned constants. Each comment states the number of iterations and the largest
   |Ion deviation| (%) of flows/dpb.yaml with half and with twice the value.
   With the present values: SRAM 12, 1.43; NAND2_X1 8, 0.47; c432 19, 0.50. */
static const struct {
  double widest_step, min_part, rest;
  uint8_t reopenings;
} tuned = {
    /* Largest proportional step that widens a gate, nm; twice the line-end step
       of regulator.drc. Half: NAND2_X1 9, 0.23; c432 23, 0.50. Twice: c432 18,
       0.50. */
    .widest_step = 20,

    /* Smallest |error| that justifies a step of L or W, as a fraction of the
       step's effect; above one half to avoid oscillation. Half: equal results
       with 36 iterations for SRAM and 45 for c432. Twice: c432 differs in the
       last digits. */
    .min_part = 0.55,

    /* Divisor of the limit: a transistor past its coarse phase restarts if its
       error changes by more than `limit` / `rest`. Half: no difference. Twice:
       SRAM 12, 0.61. */
    .rest = 10,

    /* Largest number of restarts of a transistor, to guarantee termination.
       Half and twice: no difference. */
    .reopenings = 8,
};

control_rules correct_control_rules_for(double limit, double max_bias,
                                        double grid, int proportional) {
  return (control_rules){.limit = limit,
                         .most = (int32_t)(max_bias / grid),
                         .widest = (int32_t)fmax(1, tuned.widest_step / grid),
                         .proportional = proportional};
}

/* Return the sign of the step of L that reduces |error|: 1 if Ion is too
   large. */
static int length_step_sign(double error) { return error > 0 ? 1 : -1; }

static uint32_t veto_of_l(int step) {
  return step > 0 ? EDA_VETO_LONGER : EDA_VETO_SHORTER;
}

static uint32_t veto_of_w(int step) {
  return step > 0 ? EDA_VETO_WIDER : EDA_VETO_NARROWER;
}

/* Return the bound of |w|. */
static int32_t most_w(const control_rules *r, const control_input *in) {
  int32_t half = (int32_t)(in->width / 2);
  return r->most < half ? r->most : half;
}

static void control_settle(control *c, int verdict) {
  c->phase = CONTROL_SETTLED;
  c->verdict = (uint8_t)verdict;
  c->l = c->w = c->rested = 0;
}

/* Return 1 if the last step overshot the minimum: the error changed its sign.
   An increase of equal sign is caused by the neighbours. */
static int control_passed(const control *c, double error) {
  return (error > 0) != (c->error > 0);
}

int correct_control_first(const control_rules *r, control *c,
                          const control_input *in, int32_t steps, int32_t *l) {
  if (fabs(in->error) <= r->limit) {
    c->verdict = CONTROL_WITHIN;
    return 0;
  }
  if (!steps) steps = length_step_sign(in->error);
  if (steps > r->most) steps = r->most;
  if (steps < -r->most) steps = -r->most;
  c->verdict = CONTROL_MOVING;
  c->l = steps;
  *l += steps;
  return steps != 0;
}

/* Evaluate the last step of L. Returns 1 if the step is reverted. */
static int judge_length(control *c, const control_input *in, int32_t *l) {
  int32_t last = c->l;
  c->by_l = fabs(in->error - c->error) / abs(last);
  c->l = 0;
  if (in->veto & veto_of_l(last)) {
    c->barred |= (uint8_t)veto_of_l(last);
  } else {
    /* A first correction of several steps that overshoots is followed by single
       steps. */
    if (abs(last) > 1 || !control_passed(c, in->error)) return 0;
    c->phase = CONTROL_FINE;
    if (fabs(in->error) <= fabs(c->error)) return 0;
  }
  c->phase = CONTROL_FINE;
  *l -= last;
  return 1;
}

/* If W has reached its bound, move L by one step, once per transistor, so that
   W can leave the bound. Applies to proportional steps of W only. */
static int control_exchange(const control_rules *r, control *c,
                            const control_input *in, int32_t *l, int32_t w) {
  int step = length_step_sign(in->error);
  if (!r->proportional || c->verdict != CONTROL_BIAS || c->exchanged ||
      abs(w) < most_w(r, in) || (in->veto | c->barred) & veto_of_l(step) ||
      abs(*l + step) > r->most)
    return 0;
  *l += step;
  c->exchanged = 1;
  c->ceiling = 0;
  c->reopened = tuned.reopenings;
  c->phase = CONTROL_FINE;
  c->verdict = CONTROL_MOVING;
  return 1;
}

/* Restart a transistor whose error was changed by its neighbours. Return to the
   phase whose next step reduces |error|. A grid step of W changes Ion by the
   fraction 1 / width; a step of L is assumed to have the effect of the last
   step of L. */
static void control_reconsider(const control_rules *r, control *c,
                               const control_input *in) {
  double error = fabs(in->error), by_w = 100 / in->width;
  int phase = c->phase;
  if (c->reopened >= tuned.reopenings || c->w) return;
  if (!c->rested) c->rest = in->error;
  c->rested = 1;
  if (fabs(in->error - c->rest) <= r->limit / tuned.rest) return;
  if (c->by_l > 0 && error > tuned.min_part * c->by_l &&
      !((in->veto | c->barred) & veto_of_l(length_step_sign(in->error))))
    phase = CONTROL_COARSE;
  else if (phase == CONTROL_SETTLED && error > tuned.min_part * by_w)
    phase = CONTROL_FINE;
  if (phase == c->phase) return;
  c->phase = (uint8_t)phase;
  c->l = c->ceiling = c->rested = 0;
  c->reopened++;
}

int correct_control_length(const control_rules *r, control *c,
                           const control_input *in, int32_t *l, int32_t w) {
  if (fabs(in->error) <= r->limit &&
      !(in->veto & EDA_VETO_LONGER && c->l > 0)) {
    c->verdict = CONTROL_WITHIN;
    c->l = c->w = 0;
    return 0;
  }
  if (control_exchange(r, c, in, l, w)) return 1;
  if (c->phase != CONTROL_COARSE) control_reconsider(r, c, in);
  if (c->phase == CONTROL_SETTLED) return 0;
  c->verdict = CONTROL_MOVING;
  if (c->phase == CONTROL_FINE) return 0;
  if (c->l && judge_length(c, in, l)) return 1;
  if (c->phase == CONTROL_FINE) return 0;
  int step = length_step_sign(in->error);
  if ((in->veto | c->barred) & veto_of_l(step) || abs(*l + step) > r->most) {
    c->phase = CONTROL_FINE;
    return 0;
  }
  c->l = step;
  *l += step;
  return 1;
}

/* Return the step of W that reduces |error|. Ion is proportional to W. Widening
   is limited, because the regulator extends line ends by a limited step, and a
   wider gate would reach their rounded corners. Each change of sign halves the
   bound, so that the steps terminate. */
static int32_t width_step(const control_rules *r, control *c,
                          const control_input *in, int32_t w) {
  int sign = -length_step_sign(in->error);
  if (!r->proportional) return sign;
  if (c->w && control_passed(c, in->error)) c->ceiling = abs(c->w) / 2;
  double size = floor(fabs(in->error) / 100 * (in->width + w));
  if (c->ceiling) size = fmin(size, c->ceiling);
  if (sign > 0) size = fmin(size, r->widest);
  return sign * (int32_t)fmax(size, 1);
}

int correct_control_width(const control_rules *r, control *c,
                          const control_input *in, int32_t *w) {
  if (c->phase != CONTROL_FINE || c->verdict != CONTROL_MOVING) return 0;
  if (abs(c->w) == 1 &&
      control_passed(c, in->error)) { /* the last step of W is kept or reverted
                                         below */
    int back = fabs(in->error) > fabs(c->error);
    if (back) *w -= c->w;
    control_settle(c, CONTROL_GRID);
    return back;
  }
  int32_t step = width_step(r, c, in, *w), most = most_w(r, in);
  if (step > most - *w) step = most - *w;
  if (step < -most - *w) step = -most - *w;
  if (!step) {
    control_settle(c, CONTROL_BIAS);
    return 0;
  }
  if (in->veto & veto_of_w(step)) {
    /* The regulator may withdraw the veto after a repair. */
    c->verdict = CONTROL_BRIDGING;
    c->w = 0;
    return 0;
  }
  c->w = step;
  *w += step;
  return 1;
}

const char *correct_control_verdict(const control *c) {
  static const char *const words[CONTROL_VERDICTS] = {
      "within limit", "grid", "bridging", "bias limit", "not done"};
  return words[c->verdict];
}
