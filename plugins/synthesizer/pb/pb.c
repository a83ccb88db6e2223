/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements synthesizer.pb: performance-based OPC (thesis 2.2.5, figure 2.5).
   The first correction of each length equals the error of the effective length.
   Then L and W move by single grid steps to the local minimum of the
   |deviation|. */
#include <math.h>
#include <opcflow/follow.h>

#include "../descent.h"

/* ---- state ---- */

enum { MODE_ION, MODE_IOFF, MODE_IOFFION };
enum { ION, IOFF };

/* Smallest |Leq - L|, nm, from which a slope is computed. Half and twice this
   value result in the same first steps for all test cells. */
static const double least_slope = 0.1;

typedef struct pb {
  const opc_host *host;
  double current_limit; /* % */
  double max_bias;      /* nm */
  int mode;
  int driven; /* ION or IOFF: the current that is corrected at present */
  descent descent;
} pb;

/* ---- work ---- */

static const double *pb_current(const eda_performance *p, int which) {
  return which == ION ? p->ion : p->ioff;
}

/* Return the deviation (TPE) of the corrected current, thesis eq. 2.3 and 2.4,
   %. */
static double pb_error(const void *self, const eda_feedback *f, size_t i) {
  int which = ((const pb *)self)->driven;
  double design = pb_current(f->design, which)[i];
  return 100 * (pb_current(f->printed, which)[i] - design) / design;
}

/* Return the length of a rectangle with the printed current and the drawn
   width. Leq is the equivalent length at the printed width. The current per
   width is assumed to be exponential in the length between the drawn length and
   Leq. If Leq is close to the drawn length, or the slope is not negative, the
   slope is unknown and Leq is returned. */
static double length_at_drawn_width(double drawn, double leq, double width,
                                    double weq, double current) {
  double slope = log(current * width / weq) / (leq - drawn);
  double length = drawn + log(current) / slope;
  return fabs(leq - drawn) > least_slope && weq > 0 && slope < 0 ? length : leq;
}

/* Return the first correction, L_design - Leq in grid steps (thesis 3.2.2 (2),
   for the algorithm of chapter 2); 0 for a gate that does not print. */
static int32_t pb_first(const void *self, const eda_feedback *f, size_t i) {
  int which = ((const pb *)self)->driven;
  const eda_gates *g = f->gates;
  double leq = (which == ION ? f->printed->leq_ion : f->printed->leq_ioff)[i];
  double ratio =
      pb_current(f->printed, which)[i] / pb_current(f->design, which)[i];
  if (!(leq > 0 && ratio > 0)) return 0;
  double length = length_at_drawn_width(g->length[i], leq, g->width[i],
                                        f->printed->weq[i], ratio);
  return (int32_t)lround((g->length[i] - length) / g->grid);
}

static void pb_follow(pb *p, eda_scanner scanner);

static int pb_begin(void *self, const eda_feedback *f, opc_error *error) {
  pb *p = self;
  pb_follow(p, f->scanner);
  eda_follow_ion_limit(f, &p->current_limit);
  (void)error;
  p->driven = p->mode == MODE_ION ? ION : IOFF;
  p->descent.rules = correct_control_rules_for(p->current_limit, p->max_bias,
                                               f->gates->grid, 0);
  p->descent.error = pb_error;
  p->descent.first = pb_first;
  p->descent.self = p;
  descent_reset(&p->descent, f->gates->count);
  return OPC_OK;
}

/* Begin the correction of Ion by widths; the lengths no longer move. */
static void pb_begin_ion(pb *p) {
  p->driven = ION;
  p->descent.fine = 1;
  for (size_t i = 0; i < p->descent.count; i++)
    p->descent.state[i] = (control){.phase = CONTROL_FINE};
}

static int pb_update(void *self, const eda_feedback *f, eda_moves *moves,
                     int *done, opc_error *error) {
  pb *p = self;
  (void)error;
  int first_of_two = p->mode == MODE_IOFFION && p->driven == IOFF;
  descent_moves m = descent_update(&p->descent, f, moves, first_of_two);
  if (first_of_two && !m.lengths) {
    pb_begin_ion(p);
    m = descent_update(&p->descent, f, moves, 0);
  }
  *done = descent_is_done(p->host, f, &m);
  return OPC_OK;
}

static const char *pb_verdict(const void *self, size_t gate) {
  return descent_verdict(&((const pb *)self)->descent, gate);
}

/* Return the target of Ion relative to the design, 1; NAN in the mode ioff,
   which has no target of Ion. */
static double pb_target(const void *self, size_t gate) {
  (void)gate;
  return ((const pb *)self)->mode == MODE_IOFF ? NAN : 1;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(pb, mode, .type = OPC_CHOICE, .preset = "ion",
                  .choices = "ion|ioff|ioffion",
                  .summary = "corrected current (thesis table 2.1); ioffion: "
                             "Ioff by L, then Ion by W"),
    OPC_PARAMETER(
        pb, current_limit, .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "%",
        .follows = "ion_limit of the step", .former = "max_tpe|limit",
        .summary = "largest allowed |deviation| of the corrected current; a "
                   "transistor within the limit is not changed"),
    EDA_MAX_BIAS(pb),
};

/* Compute the defaults of parameters that are not set. */
static void pb_follow(pb *p, eda_scanner scanner) {
  EDA_FOLLOW(p->host, "synthesizer.pb", p, parameters, scanner);
}

static void pb_clear(void *self) { descent_clear(&((pb *)self)->descent); }

/* ---- entry ---- */

static const eda_synthesizer functions = {.begin = pb_begin,
                                          .update = pb_update,
                                          .verdict = pb_verdict,
                                          .flags = EDA_SYNTHESIZER_CONTINUES,
                                          .target = pb_target};

OPC_PLUGIN(pb, .id = "synthesizer.pb", .kind = "synthesizer",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary =
               "performance-based OPC: correction by effective length, then by "
               "single steps",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .clear = pb_clear,
           OPC_FUNCTIONS(functions));
