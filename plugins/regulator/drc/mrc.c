/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements mask rule checks as violations. */
#include <eda/memory.h>
#include <stdlib.h>

#include "drc.h"

size_t mrc_faults(const drc *r, const eda_shapes *shapes,
                  eda_rule_fault **fault) {
  const double limit[EDA_RULES] = {
      [EDA_RULE_SPACE] = r->min_space, [EDA_RULE_WIDTH] = r->min_mask_width};
  return eda_rules_check(shapes, r->grid, limit, fault);
}

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

/* Faults of each layer. */
typedef struct found {
  const drc *r;
  const eda_shapes *shapes;
  eda_rule_fault **fault;
  size_t *n;
} found;

static void check_layer(void *data, size_t layer) {
  const found *f = data;
  f->n[layer] = mrc_faults(f->r, &f->shapes[layer], &f->fault[layer]);
}

void mrc_check(const drc *r, const eda_shapes *shapes, violations *out) {
  found f = {r, shapes, eda_alloc(r->layers, sizeof *f.fault),
             eda_alloc(r->layers, sizeof *f.n)};
  opc_parallel(r->host->context, r->layers, check_layer, &f);
  for (size_t k = 0; k < r->layers; k++) {
    faults_report(r, f.fault[k], f.n[k], out);
    free(f.fault[k]);
  }
  free(f.fault);
  free(f.n);
}
