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
  double pde;         /* of the last measurement, % */
  double by_l;        /* what the last step of L changed it by; 0: none yet */
  uint8_t phase;
  uint8_t verdict;
  int8_t l, w;        /* its last step */
  uint8_t barred;     /* steps of L that the regulator took back, as vetoes */
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

static void settle(transistor *t, int verdict) {
  t->phase = SETTLED;
  t->verdict = (uint8_t)verdict;
  t->l = t->w = 0;
}

/* Too much current: longer or narrower; too little: shorter or wider. */
static int longer(double pde) { return pde > 0 ? 1 : -1; }

/* The first correction: init_adjust towards the smaller error. */
static void jump(const dpb *d, transistor *t, double pde, double grid,
                 int32_t *l) {
  int steps = (int)lround(d->init_adjust / grid);
  t->verdict = MOVING;
  t->l = (int8_t)longer(pde);
  *l += longer(pde) * (steps > 0 ? steps : 1);
}

/* Did the last step go past the minimum? Every step goes the way that lowers
   |PDE|; an error that rises with the same sign is the neighbours' doing. */
static int passed(const transistor *t, double pde) {
  return (pde > 0) != (t->pde > 0);
}

/* One step of L. Returns 0 if L stays as it is, and W is to be taken. */
static int step_length(transistor *t, double pde, uint32_t veto, int32_t limit,
                       int32_t *l) {
  uint32_t last = t->l > 0 ? OPC_VETO_LONGER : OPC_VETO_SHORTER;
  int bad = t->l && veto & last;
  if (bad) t->barred |= (uint8_t)last;
  if (t->l) t->by_l = fabs(pde - t->pde);
  if (t->l && (bad || passed(t, pde))) {
    int back = bad || fabs(pde) > fabs(t->pde);
    if (back) *l -= t->l;
    t->l = 0;
    t->phase = FINE;
    return back;
  }
  int step = longer(pde);
  uint32_t forbidden = step > 0 ? OPC_VETO_LONGER : OPC_VETO_SHORTER;
  if ((veto | t->barred) & forbidden || abs(*l + step) > limit) {
    t->l = 0;
    t->phase = FINE;
    return 0;
  }
  t->l = (int8_t)step;
  *l += step;
  return 1;
}

static void step_width(transistor *t, double pde, uint32_t veto, int32_t limit,
                       int32_t *w) {
  if (t->w && passed(t, pde)) {   /* the minimum: here or one step back */
    if (fabs(pde) > fabs(t->pde)) *w -= t->w;
    settle(t, GRID);
    return;
  }
  int step = -longer(pde);
  uint32_t forbidden = step > 0 ? OPC_VETO_WIDER : OPC_VETO_NARROWER;
  if (veto & forbidden || abs(*w + step) > limit) {
    settle(t, veto & forbidden ? BRIDGING : BIAS);
    return;
  }
  t->w = (int8_t)step;
  *w += step;
}

/* Past its minimum of L or of both, a transistor is there no more when its
   neighbours have changed: it goes back to where a step would still help. A
   step of W changes Ion by its part of W (Ion is proportional to it), one of L
   by what it did last. */
static void reconsider(transistor *t, double pde, double by_w, uint32_t veto) {
  if (t->reopened >= REOPENINGS) return;
  uint32_t forbidden = pde > 0 ? OPC_VETO_LONGER : OPC_VETO_SHORTER;
  int phase = t->phase;
  if (t->by_l > 0 && fabs(pde) > 0.55 * t->by_l && !((veto | t->barred) & forbidden))
    phase = COARSE;
  else if (t->phase == SETTLED && fabs(pde) > 0.75 * by_w)
    phase = FINE;
  if (phase == t->phase) return;
  t->phase = (uint8_t)phase;
  t->l = t->w = 0;
  t->reopened++;
}

/* Figure 3.3 for one transistor: the next l and w. */
static void correct(const dpb *d, transistor *t, double pde, double width,
                    double grid, uint32_t veto, int32_t *l, int32_t *w) {
  int32_t limit = (int32_t)(d->max_bias / grid);
  int32_t half = (int32_t)(width / grid / 2);
  if (fabs(pde) <= d->max_pde && !(veto & OPC_VETO_LONGER && t->l > 0)) {
    t->verdict = WITHIN;
    t->l = t->w = 0;
    return;
  }
  if (t->phase != COARSE) reconsider(t, pde, 100 * grid / width, veto);
  if (t->phase == SETTLED) return;
  t->verdict = MOVING;
  if (t->phase == COARSE && step_length(t, pde, veto, limit, l)) return;
  step_width(t, pde, veto, limit < half ? limit : half, w);
}

static int update(void *self, const opc_feedback *f, opc_moves *moves,
                  int *done, opc_error *error) {
  dpb *d = self;
  (void)error;
  *done = 1;
  double grid = f->gates->grid;
  for (size_t i = 0; i < d->count; i++) {
    transistor *t = &d->state[i];
    double design = f->design->ion[i];
    double pde = 100 * (f->printed->ion[i] - design) / design;   /* eq. 3.1 */
    int32_t l = moves->l[i], w = moves->w[i];
    if (f->iteration == 0 && fabs(pde) > d->max_pde)
      jump(d, t, pde, grid, &moves->l[i]);
    else
      correct(d, t, pde, f->gates->width[i], grid, f->vetoes[i], &moves->l[i],
              &moves->w[i]);
    t->pde = pde;
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
                  .unit = "nm", .preset = "80 nm",
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
