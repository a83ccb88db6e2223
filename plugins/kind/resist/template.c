/* SPDX-License-Identifier: BSD-3-Clause */
/* @ID@: a resist that prints a feature where the intensity is below a constant
   threshold. */
#include <eda/resist.h>
#include <opcflow/plugin.h>

typedef struct state {
  const opc_host *host;
  double threshold; /* relative to the clear-field intensity */
} state;

static int resist_prepare(void *self, const opc_module *litho,
                          opc_error *error) {
  (void)self, (void)litho, (void)error; /* called once: calibrate the model by
                                           `litho` here */
  return OPC_OK;
}

/* Convert the intensity to a level set, positive where the feature prints.
   Adding a constant to all coefficients adds the constant to the field. */
static int resist_print(const void *self, int layer, eda_field *field,
                        opc_error *error) {
  const state *s = self;
  (void)layer, (void)error;
  for (size_t i = 0; i < (size_t)field->nx * (size_t)field->ny; i++)
    field->coefficients[i] = (float)s->threshold - field->coefficients[i];
  return OPC_OK;
}

static const opc_parameter parameters[] = {
    OPC_PARAMETER(state, threshold, .type = OPC_REAL,
                  .flags = OPC_ABOVE | OPC_BELOW, .preset = "0.25", .max = 1,
                  .summary = "intensity below which a feature prints")};
static const eda_resist functions = {.prepare = resist_prepare,
                                     .print = resist_print};
OPC_PLUGIN(state, .id = "@ID@", .kind = "resist", .version = "0.1.0",
           .licence = "BSD-3-Clause", .summary = "constant threshold",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
