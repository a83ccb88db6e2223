/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty synthesizer that is done after the first iteration. */
#include "bad.h"

static int bad_begin(void *self, const eda_feedback *feedback,
                     opc_error *error) {
  (void)self, (void)feedback, (void)error;
  evil("begin");
  return fault_is("begin") ? OPC_INVALID : OPC_OK;
}

static int bad_update(void *self, const eda_feedback *feedback,
                      eda_moves *moves, int *done, opc_error *error) {
  size_t n = feedback->gates->count;
  (void)self, (void)error;
  evil("update");
  if (fault_is("overrun")) moves->jog[n] = 1;
  if (fault_is("underrun")) moves->l[-1] = 1;
  if (fault_is("assists")) moves->assists[feedback->gates->layers].count = 0;
  if (fault_is("dangling assists"))
    moves->assists[0] = (eda_boxes){(const eda_box *)16, 3};
  if (fault_is("moves")) moves->w[1] = INT32_MIN;
  if (fault_is("heap")) heap_damage(feedback->gates->box);
  WRITE_AFAR(moves->jog, n);
  *done = !fault_is("restless") && !fault_is("kept");
  return fault_apply();
}

static const char *bad_verdict(const void *self, size_t gate) {
  static char endless[4096];
  (void)self, (void)gate;
  evil("verdict");
  if (fault_is("dangling")) return (const char *)16;
  if (fault_is("endless")) return memset(endless, 'x', sizeof endless);
  if (fault_is("bytes")) return "a\xFF";
  if (fault_is("escape")) return "\033[2J";
  if (fault_is("verdict")) write_wildly(NULL, 7);
  return NULL;
}

static const eda_synthesizer functions = {
    .begin = bad_begin, .update = bad_update, .verdict = bad_verdict};

BAD_PLUGIN("synthesizer", functions);
