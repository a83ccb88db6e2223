/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the check of the mask rules; faults are added as violations. */
#include <eda/memory.h>
#include <stdlib.h>

#include "drc.h"

static void faults_report(const drc *r, const eda_rule_fault *fault, size_t n,
                          violations *out) {
  static const char *const names[] = {
      [EDA_RULE_SPACE] = "mask space", [EDA_RULE_WIDTH] = "mask width"};
  for (size_t i = 0; i < n; i++) {
    const eda_rule_fault *f = &fault[i];
    int is_space = f->rule == EDA_RULE_SPACE;
    violations_add(out, (eda_violation){.rule = names[f->rule],
                                        .gate = -1,
                                        .x = f->x,
                                        .y = f->y,
                                        .value = f->value,
                                        .limit = is_space ? r->min_space
                                                          : r->min_mask_width});
  }
}

typedef struct check {
  const drc *r;
  const eda_shapes *shapes;
  double min_edge;
  mrc_faults *faults;
} check;

static void check_layer(void *data, size_t layer) {
  const check *c = data;
  const drc *r = c->r;
  mrc_faults *f = &c->faults[layer];
  const double limit[EDA_RULES] = {[EDA_RULE_SPACE] = r->min_space,
                                   [EDA_RULE_WIDTH] = r->min_mask_width,
                                   [EDA_RULE_EDGE] = c->min_edge};
  if (f->wanted)
    f->n = eda_rules_check(&c->shapes[layer], r->grid, limit, &f->fault);
}

void mrc_find(const drc *r, const eda_shapes *shapes, double min_edge,
              mrc_faults *faults) {
  check c = {r, shapes, min_edge, faults};
  opc_parallel(r->host->context, r->layers, check_layer, &c);
}

void mrc_check(const drc *r, const eda_shapes *shapes, violations *out) {
  mrc_faults *faults = eda_alloc(r->layers, sizeof *faults);
  for (size_t k = 0; k < r->layers; k++) faults[k].wanted = 1;
  mrc_find(r, shapes, 0, faults);
  for (size_t k = 0; k < r->layers; k++) {
    faults_report(r, faults[k].fault, faults[k].n, out);
    free(faults[k].fault);
  }
  free(faults);
}
