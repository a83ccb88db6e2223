/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables and metrics as JSON, and JSON as text. */
#ifndef OPCFLOW_CORE_JSON_H
#define OPCFLOW_CORE_JSON_H

#include <json-glib/json-glib.h>

#include "core/report/table.h"

JsonNode *opc_metric_json(const opc_metric *metric, double value);
JsonNode *opc_table_json(const opc_table *table);

/* Return the text, readable, with a last newline (g_free). Takes the node. */
char *opc_json_text(JsonNode *node);

#endif
