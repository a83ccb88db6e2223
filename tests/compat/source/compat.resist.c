/* SPDX-License-Identifier: BSD-3-Clause */
/* A resist of a fixed threshold. */
#include "compat.h"

static int prepare(void *self, const opc_module *litho, opc_error *error) {
  (void)self, (void)litho, (void)error;
  return OPC_OK;
}

static int print(const void *self, int layer, eda_field *field,
                 opc_error *error) {
  size_t i, n = (size_t)field->nx * (size_t)field->ny;
  (void)self, (void)layer, (void)error;
  for (i = 0; i < n; i++)
    field->coefficients[i] = 0.3f - field->coefficients[i];
  return OPC_OK;
}

static const eda_resist functions = {.prepare = prepare, .print = print};

COMPAT_PLAIN("compat.resist", "resist");
