/* SPDX-License-Identifier: BSD-3-Clause */
/* @ID@: a regulator that lengthens line ends whose printed extension beyond the
   active is too short, by one grid step per iteration. */
#include <eda/regulator.h>
#include <opcflow/plugin.h>

typedef struct state {
  const opc_host *host;
  double extension; /* nm */
} state;

static int regulator_rule(void *self, const eda_printed *p, eda_ruling *ruling,
                          opc_error *error) {
  const state *s = self;
  (void)error;
  ruling->transistors = p->gates->count;
  for (size_t i = 0; i < 2 * p->gates->count; i++)
    ruling->end[i] += p->extension[i] < s->extension && ruling->end[i] < 60;
  return OPC_OK;
}

/* Count all violations, and list at most `capacity` of them. */
static int regulator_violations(void *self, const eda_printed *p,
                                eda_violation *list, size_t capacity,
                                size_t *count, opc_error *error) {
  const state *s = self;
  (void)error;
  *count = 0;
  for (size_t i = 0; i < 2 * p->gates->count; i++) {
    double value = p->extension[i];
    if (value >= s->extension || (*count)++ >= capacity) continue;
    list[*count - 1] = (eda_violation){"extension", (int32_t)(i / 2), 0, 0,
                                       value,       s->extension};
  }
  return OPC_OK;
}

static const opc_parameter parameters[] = {OPC_PARAMETER(
    state, extension, .type = OPC_REAL, .flags = OPC_AT_LEAST, .unit = "nm",
    .preset = "20 nm",
    .summary = "required extension of printed poly beyond printed active")};
static const eda_regulator functions = {.rule = regulator_rule,
                                        .violations = regulator_violations};
OPC_PLUGIN(state, .id = "@ID@", .kind = "regulator", .version = "0.1.0",
           .licence = "BSD-3-Clause", .summary = "line-end extension",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
