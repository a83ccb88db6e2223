/* SPDX-License-Identifier: BSD-3-Clause */
/* A regulator without rules. */
#include "compat.h"

static int rule(void *self, const eda_printed *printed, eda_ruling *ruling,
                opc_error *error) {
  (void)self, (void)printed, (void)ruling, (void)error;
  return OPC_OK;
}

static int violations(void *self, const eda_printed *printed,
                      eda_violation *list, size_t most, size_t *count,
                      opc_error *error) {
  (void)self, (void)printed, (void)list, (void)most, (void)error;
  *count = 0;
  return OPC_OK;
}

static const eda_regulator functions = {.rule = rule, .violations = violations};

COMPAT_PLAIN("compat.regulator", "regulator");
