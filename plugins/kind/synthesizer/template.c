/* SPDX-License-Identifier: BSD-3-Clause */
/* @ID@: a mask synthesizer that changes the mask length of each transistor in
   proportion to the deviation of the drive current, until all changes round to
   zero grid steps. */
#include <eda/synthesizer.h>
#include <math.h>
#include <opcflow/plugin.h>

typedef struct state {
  const opc_host *host;
  double gain; /* relative length change per relative current deviation */
} state;

static int state_begin(void *self, const eda_feedback *f, opc_error *error) {
  (void)self, (void)f, (void)error; /* called once: allocate the state of the
                                       loop here */
  return OPC_OK;
}

/* Lengthen gates with too much current and shorten gates with too little
   current. The gain decreases with the number of the iteration. */
static int state_update(void *self, const eda_feedback *f, eda_moves *moves,
                        int *done, opc_error *error) {
  double gain = ((const state *)self)->gain / (1 + 0.25 * f->iteration);
  (void)error;
  *done = 1;
  for (size_t i = 0; i < f->gates->count; i++) {
    double off = f->printed->ion[i] / f->design->ion[i] - 1;
    int32_t step =
        (int32_t)lround(gain * off * f->gates->length[i] / f->gates->grid);
    uint32_t veto = step > 0 ? EDA_VETO_LONGER : EDA_VETO_SHORTER;
    if (!step || f->flags[i] & EDA_PRINT_OPEN || f->vetoes[i] & veto) continue;
    moves->l[i] += step;
    *done = 0;
  }
  return OPC_OK;
}

static const opc_parameter parameters[] = {OPC_PARAMETER(
    state, gain, .type = OPC_REAL, .flags = OPC_ABOVE, .preset = "0.25",
    .summary = "relative change of the length per relative deviation of Ion")};
static const eda_synthesizer functions = {.begin = state_begin,
                                          .update = state_update};
OPC_PLUGIN(
    state, .id = "@ID@", .kind = "synthesizer", .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "change of the length in proportion to the deviation of Ion",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_FUNCTIONS(functions));
