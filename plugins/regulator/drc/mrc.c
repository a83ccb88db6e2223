/* SPDX-License-Identifier: BSD-3-Clause */
/* The rules of the mask itself, as violations. */
#include <stdlib.h>

#include "drc.h"

size_t mrc_faults(const drc *r, const eda_shapes *shapes,
                  eda_rule_fault **fault) {
  const double limit[EDA_RULES] = {
      [EDA_RULE_SPACE] = r->min_space, [EDA_RULE_WIDTH] = r->min_mask_width};
  return eda_rules_check(shapes, r->grid, limit, fault);
}

void mrc_check(const drc *r, const eda_shapes *shapes, violations *out) {
  static const char *const names[] = {
      [EDA_RULE_SPACE] = "mask space", [EDA_RULE_WIDTH] = "mask width"};
  eda_rule_fault *fault;
  size_t n = mrc_faults(r, shapes, &fault);
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
  free(fault);
}
