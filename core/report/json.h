/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables and metrics as JSON. */
#pragma once

#include <store/json.h>

#include "core/report/table.h"

/* Return a metric with its value, or a table with its columns and rows
   (json_node_unref). */
JsonNode *opc_metric_json(const opc_metric *metric, double value);
JsonNode *opc_table_json(const opc_table *table);
