/* SPDX-License-Identifier: BSD-3-Clause */
/* Sizes of the transistors of sampled chips (data kind "samples"). */
#include <eda/memory.h>
#include <eda/samples.h>
#include <math.h>
#include <stdlib.h>

eda_samples *eda_samples_new(const eda_gates *gates, size_t count) {
  eda_samples *c = eda_alloc(1, sizeof *c);
  c->gates = gates;
  c->count = count;
  c->of = eda_alloc(count, sizeof *c->of);
  for (size_t k = 0; k < count; k++)
    eda_performance_init(&c->of[k], gates->count);
  return c;
}

void eda_samples_free(void *chips) {
  eda_samples *c = chips;
  if (!c) return;
  for (size_t k = 0; k < c->count; k++) eda_performance_clear(&c->of[k]);
  free(c->of);
  free(c);
}

static int is_size(double size) { return isfinite(size) && size > 0; }

int eda_samples_check(const void *chips, opc_error *error) {
  const eda_samples *c = chips;
  for (size_t k = 0; k < c->count; k++)
    for (size_t i = 0; i < c->gates->count; i++) {
      const eda_performance *p = &c->of[k];
      if (!is_size(p->leq_ion[i]) || !is_size(p->weq[i]) ||
          !is_size(p->area[i]))
        return opc_fail(error, OPC_FAILED, NULL,
                        "transistor %zu of chip %zu has the sizes %g nm, %g nm "
                        "and %g nm^2, expected positive sizes",
                        i + 1, k + 1, p->leq_ion[i], p->weq[i], p->area[i]);
    }
  return OPC_OK;
}
