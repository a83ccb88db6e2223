/* SPDX-License-Identifier: BSD-3-Clause */
/* A synthesizer that is done at once, and goes wrong. */
#include "bad.h"

static int begin(void *self, const eda_feedback *feedback, opc_error *error) {
  (void)self, (void)feedback, (void)error;
  return does("begin") ? OPC_INVALID : OPC_OK;
}

static int update(void *self, const eda_feedback *feedback, eda_moves *moves,
                  int *done, opc_error *error) {
  (void)self, (void)feedback, (void)error;
  if (does("moves")) moves->w[1] = INT32_MIN;
  *done = 1;
  return misbehave();
}

static const char *verdict(const void *self, size_t gate) {
  (void)self, (void)gate;
  if (does("verdict")) write_wildly(NULL, 7);
  return NULL;
}

static const eda_synthesizer functions = {
    .begin = begin, .update = update, .verdict = verdict};

BAD_PLUGIN("synthesizer", functions);
