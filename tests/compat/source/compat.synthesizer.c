/* SPDX-License-Identifier: BSD-3-Clause */
/* A synthesizer that shortens all gates by four steps, once. */
#include "compat.h"

static int begin(void *self, const eda_feedback *feedback, opc_error *error) {
  (void)self, (void)feedback, (void)error;
  return OPC_OK;
}

static int update(void *self, const eda_feedback *feedback, eda_moves *moves,
                  int *done, opc_error *error) {
  size_t i;
  (void)self, (void)error;
  *done = feedback->iteration > 0;
  for (i = 0; i < feedback->gates->count && !*done; i++) moves->l[i] = -4;
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  (void)self, (void)gate;
  return "moved once";
}

static const eda_synthesizer functions = {
    .begin = begin, .update = update, .verdict = verdict};

COMPAT_PLAIN("compat.synthesizer", "synthesizer");
