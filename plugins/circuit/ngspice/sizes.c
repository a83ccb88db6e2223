/* SPDX-License-Identifier: BSD-3-Clause */
/* Expresses printed sizes by the length alone. Each transistor keeps the drawn
   width and gets the length at which this width drives the printed current
   (thesis 2.2.4 and 2.3.3, where Leq_Ion replaces L in the netlist). */
#include <eda/curves.h>
#include <math.h>

#include "bench.h"

/* Return the length at which the drawn width drives the printed current. */
static double length_of(const eda_curves *all, const eda_gates *g, size_t i,
                        int current, double printed, double drawn) {
  const eda_curves *c = eda_curves_of(all, eda_gates_flavour(g, i));
  if (!c || !(printed > 0 && drawn > 0) || isinf(printed)) return 0;
  eda_curves_width w = eda_curves_among(c, g->width[i]);
  double is = eda_curves_narrow_at(c, g->type[i], current, g->length[i], &w);
  return eda_curves_narrow_length(c, g->type[i], current,
                                  is + log(printed / drawn), &w, g->length[i]);
}

static void device_resize(bench *b, const eda_curves *c, eda_performance *p) {
  const eda_gates *g = b->mask->gates;
  const eda_performance *drawn = &b->mask->design, was = *p;
  p->leq_ion = eda_pool_alloc(&b->pool, g->count, sizeof *p->leq_ion);
  p->leq_ioff = eda_pool_alloc(&b->pool, g->count, sizeof *p->leq_ioff);
  p->weq = g->width;
  for (size_t i = 0; i < g->count; i++) {
    p->leq_ion[i] = length_of(c, g, i, EDA_ION, was.ion[i], drawn->ion[i]);
    p->leq_ioff[i] = length_of(c, g, i, EDA_IOFF, was.ioff[i], drawn->ioff[i]);
  }
}

int sizes_by_length(bench *b, opc_error *error) {
  eda_curves c = {0};
  if (!b->mask) return OPC_OK;
  int code = eda_curves_read(&c, b->devices, error);
  if (code) return code;
  b->sized = *b->mask;
  device_resize(b, &c, &b->sized.before);
  device_resize(b, &c, &b->sized.after);
  b->printed = &b->sized;
  eda_curves_clear(&c);
  return OPC_OK;
}
