/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the synthesizer synthesizer.bisect: finds the mask length of each
   transistor by bisection. The on current decreases with the length, so each
   iteration halves the range that contains the length with the drawn
   current. */
#include <eda/memory.h>
#include <eda/synthesizer.h>
#include <math.h>
#include <opcflow/plugin.h>
#include <stdlib.h>

/* ---- state ---- */

typedef struct range {
  int32_t low, high; /* grid steps: largest length known to be too short, least
                        known to be too long */
  int32_t best;
  double deviation; /* deviation at the best length so far, % */
} range;

typedef struct bisect {
  const opc_host *host;
  double ion_limit; /* % */
  double max_bias;  /* nm */
  range *ranges;    /* for each transistor */
} bisect;

/* ---- work ---- */

static int bisect_begin(void *self, const eda_feedback *f, opc_error *error) {
  bisect *b = self;
  int32_t far = (int32_t)(b->max_bias / f->gates->grid);
  (void)error;
  free(b->ranges);
  b->ranges = eda_alloc(f->gates->count, sizeof *b->ranges);
  for (size_t i = 0; i < f->gates->count; i++)
    b->ranges[i] = (range){-far, far, 0, INFINITY};
  return OPC_OK;
}

/* Return the next length to try, after the length `l` resulted in `deviation`
   (%); at the end, the best length. */
static int32_t next_length(range *r, int32_t l, double deviation,
                           double limit) {
  if (fabs(deviation) < fabs(r->deviation)) {
    r->best = l;
    r->deviation = deviation;
  }
  if (deviation > 0 && l > r->low) r->low = l;
  if (deviation < 0 && l < r->high) r->high = l;
  if (fabs(r->deviation) <= limit || r->high - r->low <= 1) return r->best;
  return r->low + (r->high - r->low) / 2;
}

static int bisect_update(void *self, const eda_feedback *f, eda_moves *moves,
                         int *done, opc_error *error) {
  bisect *b = self;
  (void)error;
  *done = 1;
  for (size_t i = 0; i < f->gates->count; i++) {
    double drawn = f->design->ion[i];
    double deviation = 100 * (f->printed->ion[i] - drawn) / drawn;
    /* An open line carries no current: the mask is too short. */
    if (f->flags[i] & EDA_PRINT_OPEN) deviation = 100;
    int32_t l =
        next_length(&b->ranges[i], moves->l[i], deviation, b->ion_limit);
    if (l != moves->l[i]) *done = 0;
    moves->l[i] = l;
  }
  return OPC_OK;
}

static const char *bisect_verdict(const void *self, size_t gate) {
  const bisect *b = self;
  return fabs(b->ranges[gate].deviation) <= b->ion_limit ? "within limit"
                                                         : "grid";
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(bisect, ion_limit, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "%", .preset = "0.5 %",
                  .summary = "deviation of the on current at which the "
                             "correction of a transistor ends"),
    OPC_PARAMETER(bisect, max_bias, .type = OPC_REAL,
                  .flags = OPC_ABOVE | OPC_AT_MOST, .unit = "nm",
                  .preset = "32 nm", .max = 1000,
                  .summary = "largest change of a length"),
};

static void bisect_clear(void *self) { free(((bisect *)self)->ranges); }

/* ---- entry ---- */

static const eda_synthesizer functions = {
    .begin = bisect_begin, .update = bisect_update, .verdict = bisect_verdict};

OPC_PLUGIN(bisect, .id = "synthesizer.bisect", .kind = "synthesizer",
           .version = "1.0.0", .licence = "BSD-3-Clause",
           .summary = "length of each transistor by bisection",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .clear = bisect_clear,
           OPC_FUNCTIONS(functions));
