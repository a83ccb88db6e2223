/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask rules: smallest allowed spaces, widths, edges and jogs of a mask. */
#pragma once

#include <eda/gates.h>
#include <eda/rules.h>
#include <opcflow/follow.h>

/* A rule in a layer: numbers of violations in the drawn layer and in the mask;
   worst (smallest) value in the mask and its position, nm; NAN: no
   violation. */
typedef struct rules_row {
  const char *layer, *rule;
  double limit;
  int64_t drawn, count;
  double least, x, y;
} rules_row;

/* Publish the table "mask_rules" and the metrics mask_violations,
   mask_violations_added and mask_RULE. Log violations with their places, as a
   finding if the mask violates any rule more often than the drawn layout.
   `rows` has EDA_RULES rows for each layer, in the order of the rules. */
OPC_EXPORT int correct_rules_table(const opc_host *host, const rules_row *rows,
                                   size_t n, opc_error *error);

/* Report the rule violations in the masks of corrected layers; `mask` is
   [gates->layers]. */
OPC_EXPORT int correct_rules_report(const opc_host *host,
                                    const eda_gates *gates,
                                    const eda_shapes *mask,
                                    const double limit[EDA_RULES],
                                    opc_error *error);

/* Parameters of the rules, stored in with.rules of `state`. Violations are
   counted, not repaired. clang-format off */
#define RULES_PARAMETER(state, name, rule, from, text)                        \
  OPC_PARAMETER_NAMED(name, state, with.rules[rule], .type = OPC_REAL,        \
                      .flags = OPC_AT_LEAST, .unit = "nm", .follows = (from), \
                      .min = 0, .summary = (text))
#define RULES_PARAMETERS(state)                                            \
  RULES_PARAMETER(state, "min_space", EDA_RULE_SPACE, "0.155 lambda/NA",   \
                  "Smallest allowed space of the mask"),                   \
      RULES_PARAMETER(state, "min_mask_width", EDA_RULE_WIDTH,             \
                      "0.155 lambda/NA",                                   \
                      "Smallest allowed width of the mask"),               \
      RULES_PARAMETER(state, "min_edge", EDA_RULE_EDGE, "0.078 lambda/NA", \
                      "Smallest allowed length of a mask edge, unless "    \
                      "both adjacent edges are longer"),                   \
      OPC_PARAMETER_NAMED(                                                 \
          "min_jog", state, with.rules[EDA_RULE_JOG], .type = OPC_REAL,    \
          .flags = OPC_AT_LEAST, .unit = "nm", .preset = "1 nm", .min = 0, \
          .summary = "Smallest allowed height of a jog of the mask")
#define RULES_METRICS                                                        \
  {"mask_violations", NULL, OPC_LOWER, 0,                                    \
   "violations of mask rules: sum of mask_space, mask_width, mask_edge and " \
   "mask_jog"},                                                              \
      {"mask_violations_added", NULL, OPC_LOWER, 0,                          \
       "violations of mask rules that the drawn layout does not have, "      \
       "counted "                                                            \
       "for each layer and rule, then added"},                               \
      {"mask_space", NULL, OPC_LOWER, 0, "spaces below min_space"},          \
      {"mask_width", NULL, OPC_LOWER, 0, "widths below min_mask_width"},     \
      {"mask_edge", NULL, OPC_LOWER, 0, "edges below min_edge"}, {           \
    "mask_jog", NULL, OPC_LOWER, 0, "jogs below min_jog"                     \
  }
/* clang-format on */
