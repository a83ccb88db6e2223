/* SPDX-License-Identifier: BSD-3-Clause */
/* Delays of a circuit with their derivatives (data kind "delays"). */
#include <eda/delays.h>

#include <math.h>
#include <stdlib.h>

eda_delays *eda_delays_new(const eda_gates *gates) {
  eda_delays *d = eda_alloc(1, sizeof *d);
  d->gates = gates;
  for (int k = 0; k < EDA_SIZES && gates; k++)
    d->size[k] = eda_pool_alloc(&d->memory, gates->count, sizeof *d->size[k]);
  return d;
}

void eda_delays_free(void *delays) {
  eda_delays *d = delays;
  if (!d) return;
  eda_pool_clear(&d->memory);
  free(d);
}

static int delay_is_good(const eda_delays *d, const eda_delay *one) {
  int good = isfinite(one->time);
  for (size_t i = 0; i < one->terms; i++) {
    good &= one->term[i].gate < d->gates->count;
    for (int k = 0; k < EDA_SIZES; k++) good &= isfinite(one->term[i].by[k]);
  }
  return good;
}

int eda_delays_check(const void *delays, opc_error *error) {
  const eda_delays *d = delays;
  if (!d->gates) return OPC_OK;
  if (!d->name || !d->paths)
    return opc_fail(error, OPC_FAILED, NULL,
                    "delays have %zu paths, expected a named circuit with at "
                    "least one path",
                    d->paths);
  for (size_t i = 0; i < d->paths + d->arcs; i++)
    if (!delay_is_good(
            d, i < d->paths ? &d->path[i].delay : &d->arc[i - d->paths].delay))
      return opc_fail(error, OPC_FAILED, NULL,
                      "a derivative of %s %zu is not a number, or its "
                      "transistor does not exist",
                      i < d->paths ? "path" : "arc",
                      i < d->paths ? i : i - d->paths);
  return OPC_OK;
}
