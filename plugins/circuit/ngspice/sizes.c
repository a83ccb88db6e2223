/* SPDX-License-Identifier: BSD-3-Clause */
/* Sizes in one number: each transistor has its drawn width, and the length at
   which that drives what is printed (thesis 2.2.4 and 2.3.3, where a netlist's
   L is replaced by Leq_Ion and nothing else). */
#include <math.h>

#include "../../extract/curves.h"
#include "bench.h"

/* The length at which the drawn width has the printed current. */
static double length_of(const curves *c, const opc_gates *g, size_t i,
                        int current, double printed, double drawn) {
  if (!(printed > 0 && drawn > 0) || isinf(printed)) return 0;
  double is = curves_at(c, g->type[i], current, g->length[i]);
  return curves_length(c, g->type[i], current, is + log(printed / drawn));
}

static int resize(bench *b, const curves *c, opc_performance *p,
                  opc_error *error) {
  const opc_gates *g = b->mask->gates;
  const opc_performance *drawn = &b->mask->design, was = *p;
  p->leq_ion = bench_alloc(b, g->count, sizeof *p->leq_ion, error);
  p->leq_ioff = bench_alloc(b, g->count, sizeof *p->leq_ioff, error);
  p->weq = g->width;
  if (!p->leq_ion || !p->leq_ioff) return error->code;
  for (size_t i = 0; i < g->count; i++) {
    p->leq_ion[i] = length_of(c, g, i, ION, was.ion[i], drawn->ion[i]);
    p->leq_ioff[i] = length_of(c, g, i, IOFF, was.ioff[i], drawn->ioff[i]);
  }
  return OPC_OK;
}

int sizes_by_length(bench *b, const char *devices, opc_error *error) {
  curves c = {0};
  if (!b->mask) return OPC_OK;
  int code = curves_load(&c, b->host, devices, error);
  b->sized = *b->mask;
  if (!code) code = resize(b, &c, &b->sized.before, error);
  if (!code) code = resize(b, &c, &b->sized.after, error);
  b->mask = &b->sized;
  curves_clear(&c, b->host);
  return code;
}
