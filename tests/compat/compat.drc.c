/* SPDX-License-Identifier: BSD-3-Clause */
/* compat.drc: line ends that reach far enough past the active. */
#include "compat.h"

enum { EXTENSION, PARAMETERS };

static int rule(void *self, const opc_printed *printed, opc_ruling *ruling,
                opc_error *error) {
  const compat *c = self;
  (void)error;
  for (size_t k = 0; k < 2 * printed->gates->count; k++) {
    double lacks = c->values[EXTENSION].real - printed->extension[k];
    if (lacks > 0) ruling->end[k] += (int32_t)(lacks / printed->gates->grid) + 1;
  }
  for (size_t i = 0; i < printed->gates->count; i++)
    ruling->transistors += printed->flags[i] == 0;
  return OPC_OK;
}

static int violations(void *self, const opc_printed *printed,
                      opc_violation *list, size_t room, size_t *count,
                      opc_error *error) {
  const compat *c = self;
  (void)error;
  *count = 0;
  for (size_t k = 0; k < 2 * printed->gates->count; k++) {
    double value = printed->extension[k], limit = c->values[EXTENSION].real;
    if (value >= limit) continue;
    if (*count < room) {
      opc_box box = printed->gates->box[k / 2];
      opc_violation v = {"extension", (int32_t)(k / 2),
                         box.x0 * printed->gates->grid,
                         box.y0 * printed->gates->grid, value, limit};
      list[*count] = v;
    }
    ++*count;
  }
  return OPC_OK;
}

static const opc_parameter parameters[PARAMETERS] = {
    {"extension", OPC_REAL, OPC_AT_LEAST, "nm", "180 nm", 0, 0, NULL,
     "of the print past the active"},
};

static const opc_regulator operations = {sizeof operations, rule, violations};

COMPAT_PLUGIN("compat.drc", OPC_KIND_DRC, OPC_PARAMETERS(parameters));
