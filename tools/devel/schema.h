/* SPDX-License-Identifier: BSD-3-Clause */
/* A JSON Schema (draft-07) of flow files, from the declarations of plugins. */
#pragma once

#include <base/node.h>
#include <json-glib/json-glib.h>

/* Return the schema. `plugins` has the const opc_plugin * that a flow may
   use. */
JsonNode *opc_flow_schema(const GPtrArray *plugins);

/* Return a tree as JSON. Texts without quotes have the type that YAML 1.2
   assigns: true, false, null, numbers, else texts. */
JsonNode *opc_node_json(const opc_node *node);
