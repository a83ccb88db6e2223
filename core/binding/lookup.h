/* SPDX-License-Identifier: BSD-3-Clause */
/* Search for steps, plugins, parameters and metrics by their paths. */
#pragma once

#include "core/binding/flow.h"

/* Return the parameter at "step.parameter" or "step.slot.parameter"; NULL if
   missing. */
const opc_parameter *opc_flow_parameter(const opc_flow *flow, const char *path);

/* Return the parameter at a path in one of `bindings`, and this binding in
 *owner; NULL if missing. */
const opc_parameter *opc_parameter_at(const GPtrArray *bindings,
                                      const char *path, opc_binding **owner);

/* Return the step at the beginning of a path ("step", "step.slot"), or NULL. */
opc_flow_step *opc_flow_find(const opc_flow *flow, const char *path);

/* Return the bindings of all steps of a valid flow (opc_binding *) in order of
   execution, each after the bindings in its slots. */
GPtrArray *opc_flow_bindings(const opc_flow *flow);

/* Return the binding at a path ("step", "step.slot"), or the metric at
   "step.metric" with its binding in *binding; NULL and *error if there is
   none. */
const opc_binding *opc_flow_binding(const opc_flow *flow, const char *path,
                                    opc_error *error);
const opc_metric *opc_flow_metric(const opc_flow *flow, const char *path,
                                  const opc_binding **binding,
                                  opc_error *error);
