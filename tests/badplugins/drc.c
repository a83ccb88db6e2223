/* SPDX-License-Identifier: BSD-3-Clause */
/* A regulator that has no rule, and goes wrong. */
#include "bad.h"

static int rule(void *self, const opc_printed *printed, opc_ruling *ruling,
                opc_error *error) {
  (void)self, (void)printed, (void)error;
  if (does("ends")) ruling->end[0] = 1 << 24;
  if (does("vetoes")) ruling->vetoes[2] = 0x40;
  return misbehave();
}

static int violations(void *self, const opc_printed *printed,
                      opc_violation *list, size_t room, size_t *count,
                      opc_error *error) {
  (void)self, (void)printed, (void)room, (void)error;
  *count = does("count") || does("gate");
  list[0] = (opc_violation){.gate = 99};
  if (does("gate")) list[0].rule = "space";
  return OPC_OK;
}

static const opc_regulator operations = {
    .size = sizeof operations, .rule = rule, .violations = violations};

BAD_PLUGIN(OPC_KIND_DRC, operations);
