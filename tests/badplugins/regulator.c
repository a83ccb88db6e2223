/* SPDX-License-Identifier: BSD-3-Clause */
/* A regulator that has no rule, and goes wrong. */
#include "bad.h"

static int rule(void *self, const eda_printed *printed, eda_ruling *ruling,
                opc_error *error) {
  (void)self, (void)printed, (void)error;
  if (does("ends")) ruling->end[0] = 1 << 24;
  if (does("vetoes")) ruling->vetoes[2] = 0x40;
  return misbehave();
}

static int violations(void *self, const eda_printed *printed,
                      eda_violation *list, size_t most, size_t *count,
                      opc_error *error) {
  (void)self, (void)printed, (void)error;
  *count = does("count") || does("gate");
  if (!most) return OPC_OK;
  list[0] = (eda_violation){.gate = 99};
  if (does("gate")) list[0].rule = "space";
  return OPC_OK;
}

static const eda_regulator functions = {.rule = rule, .violations = violations};

BAD_PLUGIN("regulator", functions);
