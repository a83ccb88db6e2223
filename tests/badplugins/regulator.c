/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty regulator without rules. */
#include "bad.h"

static int rule(void *self, const eda_printed *printed, eda_ruling *ruling,
                opc_error *error) {
  size_t n = printed->gates->count;
  (void)self, (void)error;
  evil("rule");
  if (does("overrun")) ruling->vetoes[n] = 0;
  if (does("underrun")) ruling->end[-1] = 0;
  if (does("dangling patches"))
    ruling->patches[0] = (eda_boxes){(const eda_box *)16, 3};
  if (does("ends")) ruling->end[0] = 1 << 24;
  if (does("vetoes")) ruling->vetoes[2] = 0x40;
  return misbehave();
}

/* Return a text without a terminating zero. */
static const char *endless(void) {
  static char text[4096];
  return memset(text, 'x', sizeof text);
}

static int violations(void *self, const eda_printed *printed,
                      eda_violation *list, size_t most, size_t *count,
                      opc_error *error) {
  (void)self, (void)printed, (void)error;
  evil("violations");
  *count = does("count") || does("gate") || does("place") || does("dangling") ||
           does("endless");
  if (does("overrun violations")) list[most].gate = 0;
  if (!most) return OPC_OK;
  list[0] = (eda_violation){.gate = 99};
  if (does("gate")) list[0].rule = "space";
  if (does("dangling")) list[0] = (eda_violation){.rule = (const char *)16};
  if (does("endless")) list[0] = (eda_violation){.rule = endless()};
  if (does("place"))
    list[0] = (eda_violation){.rule = "space", .x = -5000, .y = 40};
  return OPC_OK;
}

static const eda_regulator functions = {.rule = rule, .violations = violations};

BAD_PLUGIN("regulator", functions);
