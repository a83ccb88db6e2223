/* SPDX-License-Identifier: BSD-3-Clause */
/* mask.dpb: device performance-based OPC (thesis 3.2.2 (2), figure 3.3). Each
   transistor on its own: a first jump of its length, then steps of one grid
   unit, on while the performance deviation error falls, back when it rises;
   length first (coarse), then width (fine). */
#include <opcflow/mask.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum { COARSE, FINE, SETTLED };

/* Why a transistor stays where it is. */
enum { WITHIN, GRID, BRIDGING, BIAS, MOVING, VERDICTS };
static const char *const verdicts[VERDICTS] = {
    "within limit", "grid", "bridging", "bias limit", "not done"};

typedef struct transistor {
  double error;       /* |PDE| of the last measurement, % */
  double settled;     /* |PDE| when it settled */
  uint8_t phase;
  uint8_t verdict;
  int8_t l, w;        /* its last step */
  uint8_t reopened;   /* how often its neighbours moved it from its minimum */
} transistor;

typedef struct dpb {
  const opc_host *host;
  double max_pde;     /* % */
  double init_adjust; /* nm */
  double max_bias;    /* nm */
  transistor *state;
  size_t count;
} dpb;

/* A settled transistor that its neighbours disturb is taken up again, this
   often at most. */
enum { REOPENINGS = 8 };

/* ---- work ---- */

static int begin(void *self, const opc_feedback *f, opc_error *error) {
  dpb *d = self;
  free(d->state);
  d->count = f->gates->count;
  d->state = calloc(d->count ? d->count : 1, sizeof *d->state);
  if (d->state) return OPC_OK;
  return d->host->fail(d->host, error, OPC_FAILED, NULL, "out of memory");
}

static void settle(transistor *t, double error, int verdict) {
  t->phase = SETTLED;
  t->verdict = (uint8_t)verdict;
  t->settled = error;
  t->l = t->w = 0;
}

/* Too much current: longer or narrower; too little: shorter or wider. */
static int longer(double pde) { return pde > 0 ? 1 : -1; }

/* The first correction: init_adjust towards the smaller error. */
static void jump(const dpb *d, transistor *t, double pde, double grid,
                 int32_t *l) {
  int steps = (int)lround(d->init_adjust / grid);
  t->phase = COARSE;
  t->l = (int8_t)longer(pde);
  *l += longer(pde) * (steps > 0 ? steps : 1);
}

/* One step of L. Returns 0 if L is at its minimum, and W is to be taken. */
static int step_length(transistor *t, double error, double pde, uint32_t veto,
                       int32_t limit, int32_t *l) {
  int bad = (t->l > 0 && veto & OPC_VETO_LONGER) ||
            (t->l < 0 && veto & OPC_VETO_SHORTER);
  if (t->l && (bad || error > t->error)) {   /* back, and on with W */
    *l -= t->l;
    t->l = 0;
    t->phase = FINE;
    if (bad) t->verdict = BRIDGING;
    return 1;
  }
  int step = t->l ? t->l : longer(pde);
  uint32_t forbidden = step > 0 ? OPC_VETO_LONGER : OPC_VETO_SHORTER;
  if (veto & forbidden || abs(*l + step) > limit) {
    t->l = 0;
    t->phase = FINE;
    return 0;
  }
  t->l = (int8_t)step;
  *l += step;
  return 1;
}

static void step_width(transistor *t, double error, double pde, uint32_t veto,
                       int32_t limit, int32_t *w) {
  if (t->w && error > t->error) {   /* back: the minimum */
    *w -= t->w;
    settle(t, t->error, GRID);
    return;
  }
  int step = t->w ? t->w : -longer(pde);
  uint32_t forbidden = step > 0 ? OPC_VETO_WIDER : OPC_VETO_NARROWER;
  if (veto & forbidden || abs(*w + step) > limit) {
    settle(t, error, veto & forbidden ? BRIDGING : BIAS);
    return;
  }
  t->w = (int8_t)step;
  *w += step;
}

/* A settled transistor is at its local minimum, unless its neighbours have
   changed since: then it goes on with W. */
static void reconsider(const dpb *d, transistor *t, double error) {
  if (error > d->max_pde && t->reopened < REOPENINGS &&
      fabs(error - t->settled) > d->max_pde / 4) {
    t->phase = FINE;
    t->reopened++;
  }
}

static int update(void *self, const opc_feedback *f, opc_moves *moves,
                  int *done, opc_error *error) {
  dpb *d = self;
  (void)error;
  *done = 1;
  double grid = f->gates->grid;
  int32_t limit = (int32_t)(d->max_bias / grid);
  for (size_t i = 0; i < d->count; i++) {
    transistor *t = &d->state[i];
    double design = f->design->ion[i];
    double pde = 100 * (f->printed->ion[i] - design) / design;   /* eq. 3.1 */
    double now = fabs(pde);
    int32_t l = moves->l[i], w = moves->w[i];
    int32_t half = (int32_t)(f->gates->width[i] / grid / 2);
    if (t->phase == SETTLED) reconsider(d, t, now);
    if (now <= d->max_pde && !(f->vetoes[i] & OPC_VETO_LONGER && t->l > 0)) {
      t->verdict = WITHIN;
      t->l = t->w = 0;
    } else if (t->phase != SETTLED) {
      t->verdict = MOVING;
      if (f->iteration == 0) {
        jump(d, t, pde, grid, &moves->l[i]);
      } else if (t->phase == FINE ||
                 !step_length(t, now, pde, f->vetoes[i], limit, &moves->l[i])) {
        step_width(t, now, pde, f->vetoes[i], limit < half ? limit : half,
                   &moves->w[i]);
      }
    }
    t->error = now;
    if (l != moves->l[i] || w != moves->w[i]) *done = 0;
  }
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  const dpb *d = self;
  return gate < d->count ? verdicts[d->state[gate].verdict] : NULL;
}

/* ---- parameters ---- */

enum { MAX_PDE, INIT_ADJUST, MAX_BIAS, PARAMETERS };

static const opc_parameter parameters[PARAMETERS] = {
    [MAX_PDE] = {.name = "max_pde", .type = OPC_REAL, .flags = OPC_ABOVE,
                 .unit = "%", .preset = "0.5 %",
                 .summary = "a transistor whose |Ion deviation| is at most this "
                            "is left alone"},
    [INIT_ADJUST] = {.name = "init_adjust", .type = OPC_REAL,
                     .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                     .preset = "1 nm", .min = 0, .max = 15,
                     .summary = "size of the first correction of L, towards the "
                                "smaller error; at least one grid step"},
    [MAX_BIAS] = {.name = "max_bias", .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "nm", .preset = "40 nm",
                  .summary = "largest correction of L or of W, and no more than "
                             "half of W"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  dpb *d = calloc(1, sizeof *d);
  if (!d) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  d->host = host;
  d->max_pde = values[MAX_PDE].real;
  d->init_adjust = values[INIT_ADJUST].real;
  d->max_bias = values[MAX_BIAS].real;
  return d;
}

static void destroy(void *self) {
  dpb *d = self;
  free(d->state);
  free(d);
}

/* ---- entry ---- */

static const opc_synthesizer operations = {.size = sizeof operations,
                                           .begin = begin,
                                           .update = update,
                                           .verdict = verdict};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "mask.dpb",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "device performance-based OPC: one-step descent on Ion",
      .kind = OPC_KIND_MASK,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
