/* SPDX-License-Identifier: BSD-3-Clause */
/* mask.bisect: the length of each transistor by bisection. Its on current falls
   with its length, so that each measurement halves the range in which the
   length with the drawn current lies. */
#include <math.h>
#include <opcflow/mask.h>

/* ---- state ---- */

typedef struct range {
  int32_t low, high;   /* grid steps: too short, too long */
  int32_t best;
  double deviation;    /* of the best, % */
} range;

typedef struct bisect {
  const opc_host *host;
  double max_pde;      /* % */
  double max_bias;     /* nm */
  range *ranges;       /* of each transistor */
} bisect;

/* ---- work ---- */

static int begin(void *self, const opc_feedback *f, opc_error *error) {
  bisect *b = self;
  int32_t far = (int32_t)(b->max_bias / f->gates->grid);
  b->host->free(b->host, b->ranges);
  b->ranges = b->host->alloc(b->host, f->gates->count, sizeof *b->ranges);
  if (!b->ranges)
    return b->host->fail(b->host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < f->gates->count; i++) {
    range r = {0, 0, 0, 0};
    r.low = -far;
    r.high = far;
    r.deviation = INFINITY;
    b->ranges[i] = r;
  }
  return OPC_OK;
}

/* What to try after `l` gave that deviation; the best there was at the end. */
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

static int update(void *self, const opc_feedback *f, opc_moves *moves,
                  int *done, opc_error *error) {
  bisect *b = self;
  (void)error;
  *done = 1;
  for (size_t i = 0; i < f->gates->count; i++) {
    double drawn = f->design->ion[i];
    double deviation = 100 * (f->printed->ion[i] - drawn) / drawn;
    int32_t l = next_length(&b->ranges[i], moves->l[i], deviation, b->max_pde);
    if (l != moves->l[i]) *done = 0;
    moves->l[i] = l;
  }
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  const bisect *b = self;
  return fabs(b->ranges[gate].deviation) <= b->max_pde ? "within limit"
                                                       : "grid";
}

/* ---- parameters ---- */

enum { MAX_PDE, MAX_BIAS, PARAMETERS };

static const opc_parameter parameters[PARAMETERS] = {
    {"max_pde", OPC_REAL, OPC_ABOVE, "%", "0.5 %", 0, 0, NULL,
     "deviation of the on current that is good enough"},
    {"max_bias", OPC_REAL, OPC_ABOVE | OPC_AT_MOST, "nm", "32 nm", 0, 1000,
     NULL, "how far a length may change"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  bisect *b = host->alloc(host, 1, sizeof *b);
  if (!b) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  b->host = host;
  b->max_pde = values[MAX_PDE].real;
  b->max_bias = values[MAX_BIAS].real;
  return b;
}

static void destroy(void *self) {
  bisect *b = self;
  b->host->free(b->host, b->ranges);
  b->host->free(b->host, b);
}

/* ---- entry ---- */

static const opc_synthesizer operations = {
    .size = sizeof operations,
    .begin = begin,
    .update = update,
    .verdict = verdict,
};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "mask.bisect",
    .version = "1.0.0",
    .licence = "BSD-3-Clause",
    .summary = "length of each transistor by bisection",
    .kind = OPC_KIND_MASK,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
