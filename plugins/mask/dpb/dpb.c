/* SPDX-License-Identifier: BSD-3-Clause */
/* mask.dpb: device performance-based OPC (thesis 3.2.2 (2), figure 3.3). Each
   transistor on its own: a first jump of its length, then steps of one grid
   unit, on while the performance deviation error falls, back when it rises;
   length first (coarse), then width (fine). control.c has the steps of one
   transistor, descent.c those of all. */
#include <math.h>
#include <stdlib.h>

#include "descent.h"
#include "table.h"

/* ---- state ---- */

typedef struct dpb {
  const opc_host *host;
  double max_pde;           /* % */
  double init_adjust;       /* nm; 0: one step towards the smaller error */
  const char *table_path;   /* NULL: that for all */
  first_table table;
  double max_bias;          /* nm */
  int proportional;
  descent descent;
} dpb;

/* ---- work ---- */

/* PDE, eq. 3.1, with Ion as the performance. */
static double pde(const void *self, const opc_feedback *f, size_t i) {
  double design = f->design->ion[i];
  (void)self;
  return 100 * (f->printed->ion[i] - design) / design;
}

static int32_t first(const void *self, const opc_feedback *f, size_t i) {
  const dpb *d = self;
  const opc_gates *g = f->gates;
  double nm = d->table_path
                  ? first_table_look(&d->table, g->length[i], g->width[i])
                  : d->init_adjust;
  return (int32_t)lround(nm / g->grid);
}

static int begin(void *self, const opc_feedback *f, opc_error *error) {
  dpb *d = self;
  d->descent.rules = control_rules_make(d->max_pde, d->max_bias, f->gates->grid,
                                        d->proportional);
  d->descent.error = pde;
  d->descent.first = first;
  d->descent.self = d;
  if (!descent_begin(&d->descent, f->gates->count))
    return d->host->fail(d->host, error, OPC_FAILED, NULL, "out of memory");
  first_table_clear(&d->table);
  return d->table_path
             ? first_table_read(d->host, d->table_path, &d->table, error)
             : OPC_OK;
}

static int update(void *self, const opc_feedback *f, opc_moves *moves,
                  int *done, opc_error *error) {
  dpb *d = self;
  (void)error;
  descent_moves m = descent_update(&d->descent, f, moves, 0);
  d->host->log(d->host, OPC_LOG_DEBUG,
               "iteration %u: %zu lengths and %zu widths move", f->iteration,
               m.lengths, m.widths);
  *done = !m.lengths && !m.widths && !m.changed;
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  const descent *d = &((const dpb *)self)->descent;
  return gate < d->count ? control_verdict(&d->state[gate]) : NULL;
}

/* ---- parameters ---- */

enum { MAX_PDE, INIT_ADJUST, INIT_ADJUST_TABLE, MAX_BIAS, W_STEP, PARAMETERS };

static const opc_parameter parameters[PARAMETERS] = {
    [MAX_PDE] = {.name = "max_pde", .type = OPC_REAL, .flags = OPC_ABOVE,
                 .unit = "%", .preset = "0.5 %",
                 .summary = "a transistor whose |Ion deviation| is at most this "
                            "is left alone"},
    [INIT_ADJUST] = {.name = "init_adjust", .type = OPC_REAL,
                     .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                     .preset = "0 nm", .min = -100, .max = 100,
                     .summary = "first correction of L, longer if positive; "
                                "0 nm: one grid step towards the smaller error"},
    [INIT_ADJUST_TABLE] = {.name = "init_adjust_table", .type = OPC_FILE,
                           .summary = "first corrections by L and W, CSV: that "
                                      "of the nearest L, then of the nearest W"},
    [MAX_BIAS] = {.name = "max_bias", .type = OPC_REAL,
                  .flags = OPC_ABOVE | OPC_AT_MOST, .unit = "nm",
                  .preset = "80 nm", .max = 10000,
                  .summary = "largest correction of L or of W, and no more than "
                             "half of W"},
    [W_STEP] = {.name = "w_step", .type = OPC_CHOICE, .preset = "unit",
                .choices = "unit|proportional",
                .summary = "steps of W: one grid unit, or as much as the error "
                           "asks for, as Ion is proportional to W"},
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
  d->proportional = (int)values[W_STEP].integer;
  d->init_adjust = values[INIT_ADJUST].real;
  if (values[INIT_ADJUST_TABLE].type != OPC_ABSENT)
    d->table_path = values[INIT_ADJUST_TABLE].text;
  d->max_bias = values[MAX_BIAS].real;
  return d;
}

static void destroy(void *self) {
  dpb *d = self;
  descent_clear(&d->descent);
  first_table_clear(&d->table);
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
