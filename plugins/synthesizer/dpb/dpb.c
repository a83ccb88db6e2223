/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements synthesizer.dpb: device performance-based OPC (thesis 3.2.2 (2),
   figure 3.3). Each transistor is corrected separately: first one change of the
   length by `init_adjust` or by a table, then single grid steps of the length,
   then steps of the width. Steps continue as long as the performance deviation
   error decreases; a step that increases the error is reverted.
   correct/control.h implements the steps of one transistor, descent.c the
   iteration over all transistors, table.c the table of first corrections. */
#include <math.h>
#include <opcflow/follow.h>

#include "../descent.h"
#include "table.h"

/* ---- state ---- */

typedef struct dpb {
  const opc_host *host;
  double ion_limit;       /* % */
  double init_adjust;     /* nm; 0 means one step that reduces the error */
  const char *table_path; /* NULL: init_adjust applies to all transistors */
  first_table table;
  double max_bias;  /* nm */
  int proportional; /* 1: steps of W proportional to the error */
  descent descent;
} dpb;

/* ---- work ---- */

/* Return the performance deviation error of Ion, thesis eq. 3.1, %. */
static double dpb_error(const void *self, const eda_feedback *f, size_t i) {
  double design = f->design->ion[i];
  (void)self;
  return 100 * (f->printed->ion[i] - design) / design;
}

static int32_t dpb_first(const void *self, const eda_feedback *f, size_t i) {
  const dpb *d = self;
  const eda_gates *g = f->gates;
  double nm = d->table_path
                  ? first_table_find(&d->table, g->length[i], g->width[i])
                  : d->init_adjust;
  return (int32_t)lround(nm / g->grid);
}

static void dpb_follow(dpb *d, eda_scanner scanner);

static int dpb_begin(void *self, const eda_feedback *f, opc_error *error) {
  dpb *d = self;
  dpb_follow(d, f->scanner);
  eda_follow_ion_limit(f, &d->ion_limit);
  d->descent.rules = correct_control_rules_for(d->ion_limit, d->max_bias,
                                               f->gates->grid, d->proportional);
  d->descent.error = dpb_error;
  d->descent.first = dpb_first;
  d->descent.self = d;
  descent_reset(&d->descent, f->gates->count);
  first_table_clear(&d->table);
  return d->table_path ? first_table_read(d->table_path, &d->table, error)
                       : OPC_OK;
}

static int dpb_update(void *self, const eda_feedback *f, eda_moves *moves,
                      int *done, opc_error *error) {
  dpb *d = self;
  (void)error;
  descent_moves m = descent_update(&d->descent, f, moves, 0);
  *done = descent_is_done(d->host, f, &m);
  return OPC_OK;
}

static const char *dpb_verdict(const void *self, size_t gate) {
  return descent_verdict(&((const dpb *)self)->descent, gate);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(dpb, ion_limit, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "%", .follows = "ion_limit of the step",
                  .former = "max_pde|limit",
                  .summary = "largest allowed |Ion deviation|; a transistor "
                             "within the limit is not changed"),
    OPC_PARAMETER(dpb, init_adjust, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                  .preset = "0 nm", .min = -100, .max = 100,
                  .summary = "first correction of L, longer if positive; 0 nm: "
                             "one grid step that reduces the error"),
    OPC_PARAMETER_NAMED(
        "init_adjust_table", dpb, table_path, .type = OPC_FILE,
        .summary = "CSV table of first corrections by L and W; the row of the "
                   "nearest L, then of the nearest W applies"),
    EDA_MAX_BIAS(dpb),
    OPC_PARAMETER_NAMED(
        "w_step", dpb, proportional, .type = OPC_CHOICE,
        .preset = "proportional", .choices = "unit|proportional",
        .summary = "steps of W: one grid step, or proportional to the error, "
                   "because Ion is proportional to W"),
};

/* Compute the defaults of parameters that are not set. */
static void dpb_follow(dpb *d, eda_scanner scanner) {
  EDA_FOLLOW(d->host, "synthesizer.dpb", d, parameters, scanner);
}

static void dpb_clear(void *self) {
  dpb *d = self;
  descent_clear(&d->descent);
  first_table_clear(&d->table);
}

/* ---- entry ---- */

static const eda_synthesizer functions = {.begin = dpb_begin,
                                          .update = dpb_update,
                                          .verdict = dpb_verdict,
                                          .flags = EDA_SYNTHESIZER_CONTINUES};

OPC_PLUGIN(dpb, .id = "synthesizer.dpb", .kind = "synthesizer",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "device performance-based OPC: one-step descent on Ion",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .clear = dpb_clear,
           OPC_FUNCTIONS(functions));
