/* SPDX-License-Identifier: BSD-3-Clause */
/* A JSON Schema (draft-07) of flow files, from what plugins declare. */
#ifndef OPCFLOW_DEVEL_SCHEMA_H
#define OPCFLOW_DEVEL_SCHEMA_H

#include <json-glib/json-glib.h>

#include "core/text/node.h"

/* `plugins`: const opc_plugin *, those that a flow may use. */
JsonNode *opc_flow_schema(const GPtrArray *plugins);

/* A tree as JSON; texts without quotes become what YAML 1.2 takes them for:
   true, false, null, numbers, else texts. */
JsonNode *opc_node_json(const opc_node *node);

#endif
