/* SPDX-License-Identifier: BSD-3-Clause */
/* Steps, plugins, parameters and metrics of a flow by their paths. */
#pragma once

#include "core/binding/flow.h"

/* What "step.parameter" or a deeper path means; NULL if it is no parameter that
   is there. */
const opc_parameter *opc_flow_parameter(const opc_flow *flow, const char *path);

/* Return the parameter of that path among bindings, and whose it is in *owner;
   NULL if there is none. */
const opc_parameter *opc_parameter_at(const GPtrArray *bindings,
                                      const char *path, opc_binding **owner);

/* The step that a path ("step", "step.slot.parameter") begins with, or NULL. */
opc_flow_step *opc_flow_find(const opc_flow *flow, const char *path);

/* The bindings of all steps of a good flow (opc_binding *), as they run, each
   after those in its slots. */
GPtrArray *opc_flow_bindings(const opc_flow *flow);

/* The plugin that a path ("step", "step.slot") means, and a metric of one
   ("step.metric"), with whose it is in *binding; NULL and *error if there is
   none. */
const opc_binding *opc_flow_binding(const opc_flow *flow, const char *path,
                                    opc_error *error);
const opc_metric *opc_flow_metric(const opc_flow *flow, const char *path,
                                  const opc_binding **binding,
                                  opc_error *error);
