/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty regulator without rules. */
#include "bad.h"

static uint32_t *old; /* array of the last call of bad_rule */

static int bad_rule(void *self, const eda_printed *printed, eda_ruling *ruling,
                    opc_error *error) {
  size_t n = printed->gates->count;
  (void)self, (void)error;
  evil("rule");
  if (fault_is("overrun")) ruling->vetoes[n] = 0;
  if (fault_is("underrun")) ruling->end[-1] = 0;
  if (fault_is("dangling shapes"))
    ruling->added[0] = (eda_boxes){(const eda_box *)16, 3};
  WRITE_AFAR(ruling->vetoes, n);
  old = ruling->vetoes;
  if (fault_is("ends")) ruling->end[0] = 1 << 24;
  if (fault_is("vetoes")) ruling->vetoes[2] = 0x40;
  return fault_apply();
}

static int bad_smooth(void *self, const eda_printed *printed,
                      eda_ruling *ruling, opc_error *error) {
  (void)self, (void)error;
  if (fault_is("smooth")) ruling->vetoes[printed->gates->count] = 0;
  return OPC_OK;
}

/* Return a text without a terminating zero. */
static const char *endless(void) {
  static char text[4096];
  return memset(text, 'x', sizeof text);
}

static int bad_violations(void *self, const eda_printed *printed,
                          eda_violation *list, size_t most, size_t *count,
                          opc_error *error) {
  (void)self, (void)printed, (void)error;
  evil("violations");
  if (fault_is("kept") && old) *old = 1;
  *count = fault_is("count") || fault_is("gate") || fault_is("place") ||
           fault_is("dangling") || fault_is("endless");
  if (fault_is("overrun violations")) list[most].gate = 0;
  if (!most) return OPC_OK;
  list[0] = (eda_violation){.gate = 99};
  if (fault_is("gate")) list[0].rule = "space";
  if (fault_is("dangling")) list[0] = (eda_violation){.rule = (const char *)16};
  if (fault_is("endless")) list[0] = (eda_violation){.rule = endless()};
  if (fault_is("place"))
    list[0] = (eda_violation){.rule = "space", .x = -5000, .y = 40};
  return OPC_OK;
}

static const eda_regulator functions = {
    .rule = bad_rule, .smooth = bad_smooth, .violations = bad_violations};

BAD_PLUGIN("regulator", functions);
