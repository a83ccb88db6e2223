/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty resist with a constant threshold. */
#include "bad.h"

static int bad_prepare(void *self, const opc_module *litho, opc_error *error) {
  evil("prepare");
  (void)self, (void)litho, (void)error;
  return OPC_OK;
}

static int bad_print(const void *self, int layer, eda_field *field,
                     opc_error *error) {
  (void)self, (void)layer, (void)error;
  size_t n = (size_t)field->nx * (size_t)field->ny;
  evil("print");
  for (size_t i = 0; i < n; i++)
    field->coefficients[i] =
        (fault_is("sign") ? -1 : 1) * (0.3f - field->coefficients[i]);
  if (fault_is("overrun")) field->coefficients[n + 2] = 1;
  WRITE_AFAR(field->coefficients + n / 2, n - n / 2);
  if (fault_is("dangling")) field->coefficients = (float *)16;
  if (fault_is("nan")) field->coefficients[n - 1] = NAN;
  return fault_apply();
}

static const eda_resist functions = {.prepare = bad_prepare,
                                     .print = bad_print};

BAD_PLUGIN("resist", functions);
