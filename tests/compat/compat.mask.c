/* SPDX-License-Identifier: BSD-3-Clause */
/* compat.mask: length by one grid step at a time, towards the drawn current. */
#include "compat.h"

enum { LIMIT, MOST, PARAMETERS };

static int begin(void *self, const opc_feedback *feedback, opc_error *error) {
  const compat *c = self;
  if (feedback->gates->count && !feedback->printed &&
      feedback->design->count == feedback->gates->count)
    return OPC_OK;
  return c->host->fail(c->host, error, OPC_INVALID, NULL, "no transistors");
}

static int update(void *self, const opc_feedback *f, opc_moves *moves,
                  int *done, opc_error *error) {
  const compat *c = self;
  (void)error;
  *done = 1;
  if (f->iteration >= (uint32_t)c->values[MOST].integer) return OPC_OK;
  for (size_t i = 0; i < f->gates->count; i++) {
    double ratio = f->printed->ion[i] / f->design->ion[i];
    double limit = c->values[LIMIT].real / 100;
    int step = ratio > 1 + limit ? 1 : ratio < 1 - limit ? -1 : 0;
    if (f->vetoes[i] & OPC_VETO_LONGER && step > 0) step = 0;
    if (f->flags[i] & (OPC_PRINT_OPEN | OPC_PRINT_NO_ACTIVE)) step = 1;
    moves->l[i] += step;
    if (step) *done = 0;
  }
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  (void)self, (void)gate;
  return "kept";
}

static const opc_parameter parameters[PARAMETERS] = {
    {"limit", OPC_REAL, OPC_ABOVE, "%", "1.2 %", 0, 0, NULL,
     "deviation that is good enough"},
    {"most", OPC_INT, OPC_AT_LEAST, NULL, "60", 0, 0, NULL,
     "iterations at most"},
};

static const opc_synthesizer operations = {sizeof operations, begin, update,
                                           verdict};

COMPAT_PLUGIN("compat.mask", OPC_KIND_MASK, OPC_PARAMETERS(parameters));
