/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty synthesizer that is done after the first iteration. */
#include "bad.h"

static int begin(void *self, const eda_feedback *feedback, opc_error *error) {
  (void)self, (void)feedback, (void)error;
  evil("begin");
  return does("begin") ? OPC_INVALID : OPC_OK;
}

static int update(void *self, const eda_feedback *feedback, eda_moves *moves,
                  int *done, opc_error *error) {
  size_t n = feedback->gates->count;
  (void)self, (void)error;
  evil("update");
  if (does("overrun")) moves->jog[n] = 1;
  if (does("underrun")) moves->l[-1] = 1;
  if (does("assists")) moves->assists[feedback->gates->layers].count = 0;
  if (does("dangling assists"))
    moves->assists[0] = (eda_boxes){(const eda_box *)16, 3};
  if (does("moves")) moves->w[1] = INT32_MIN;
  *done = !does("restless");
  return misbehave();
}

static const char *verdict(const void *self, size_t gate) {
  static char endless[4096];
  (void)self, (void)gate;
  evil("verdict");
  if (does("dangling")) return (const char *)16;
  if (does("endless")) return memset(endless, 'x', sizeof endless);
  if (does("bytes")) return "a\xFF";
  if (does("escape")) return "\033[2J";
  if (does("verdict")) write_wildly(NULL, 7);
  return NULL;
}

static const eda_synthesizer functions = {
    .begin = begin, .update = update, .verdict = verdict};

BAD_PLUGIN("synthesizer", functions);
