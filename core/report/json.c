/* SPDX-License-Identifier: BSD-3-Clause */
/* Converts metrics and tables to JSON. */
#include "core/report/json.h"

#include <math.h>

JsonNode *opc_metric_json(const opc_metric *metric, double value) {
  static const char *const better[] = {"neutral", "lower", "higher"};
  JsonObject *o = json_object_new();
  json_object_set_double_member(o, "value", value);
  json_object_set_string_member(o, "unit", metric->unit);
  json_object_set_string_member(o, "better", better[metric->better]);
  json_object_set_double_member(o, "tolerance", metric->tolerance);
  JsonNode *node = json_node_new(JSON_NODE_OBJECT);
  json_node_take_object(node, o);
  return node;
}

/* Add a cell; NAN and infinity become null, as JSON has neither. */
static void add_cell(JsonArray *cells, const opc_column *c, size_t row) {
  double real = c->type == OPC_REAL ? ((const double *)c->data)[row] : 0;
  if (c->type == OPC_TEXT)
    json_array_add_string_element(cells, ((const char *const *)c->data)[row]);
  else if (c->type == OPC_INT)
    json_array_add_int_element(cells, ((const int64_t *)c->data)[row]);
  else if (isfinite(real))
    json_array_add_double_element(cells, real);
  else
    json_array_add_null_element(cells);
}

JsonNode *opc_table_json(const opc_table *table) {
  JsonObject *o = json_object_new();
  JsonArray *columns = json_array_new(), *rows = json_array_new();
  for (size_t i = 0; i < table->n_columns; i++) {
    JsonObject *column = json_object_new();
    json_object_set_string_member(column, "name", table->columns[i].name);
    json_object_set_string_member(column, "unit", table->columns[i].unit);
    json_array_add_object_element(columns, column);
  }
  for (size_t row = 0; row < table->rows; row++) {
    JsonArray *cells = json_array_new();
    for (size_t i = 0; i < table->n_columns; i++)
      add_cell(cells, &table->columns[i], row);
    json_array_add_array_element(rows, cells);
  }
  json_object_set_string_member(o, "name", table->name);
  json_object_set_array_member(o, "columns", columns);
  json_object_set_array_member(o, "rows", rows);
  JsonNode *node = json_node_new(JSON_NODE_OBJECT);
  json_node_take_object(node, o);
  return node;
}
