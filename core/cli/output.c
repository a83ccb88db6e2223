/* SPDX-License-Identifier: BSD-3-Clause */
/* Prints messages to standard error and results to standard output. */
#include <base/sheet.h>
#include <store/json.h>

#include "core/cli/cli.h"

int cli_exit_code(int code) {
  switch (code) {
    case OPC_OK:
      return CLI_GOOD;
    case OPC_INVALID:
      return CLI_USAGE;
    case OPC_NO_PLUGIN:
      return CLI_PLUGIN;
    case OPC_IO:
      return CLI_IO;
    case OPC_LIMIT:
      return CLI_LIMIT;
    default:
      return CLI_STEP;
  }
}

int cli_fail(const opc_error *error) {
  return cli_error(cli_exit_code(error->code), "%s", error->message);
}

int cli_problems(opc_problems *problems) {
  int code = opc_problems_code(problems);
  opc_problems_sort(problems);
  for (guint i = 0; i < problems->list->len; i++) {
    const opc_problem *problem = problems->list->pdata[i];
    g_autofree char *text = opc_problem_text(problem);
    cli_message(problem->at.file ? NULL : "error", "%s", text);
  }
  return cli_exit_code(code);
}

/* ---- standard output ---- */

gboolean cli_wide;

void cli_print_table(const opc_table *table) {
  g_autofree char *text = opc_table_text(table, cli_wide ? 0 : cli_width());
  cli_print("%s", text);
}

void cli_print_rows(const char *const *names, size_t n,
                    const GPtrArray *cells) {
  g_autoptr(opc_sheet) sheet = opc_sheet_new(n);
  for (size_t i = 0; i < n; i++) {
    sheet->left[i] = TRUE;
    g_ptr_array_add(sheet->cells, g_strdup(names[i]));
  }
  for (guint i = 0; i < cells->len; i++)
    g_ptr_array_add(sheet->cells, g_strdup(cells->pdata[i]));
  g_autofree char *text = opc_sheet_text(sheet, cli_wide ? 0 : cli_width());
  if (cells->len) cli_print("%s", text);
}

static void print_json(JsonNode *node) {
  g_autofree char *text = opc_json_text(node);
  cli_write(text);
}

void cli_print_object(JsonObject *object) {
  JsonNode *node = json_node_new(JSON_NODE_OBJECT);
  json_node_take_object(node, object);
  print_json(node);
}

void cli_print_array(JsonArray *array) {
  JsonNode *node = json_node_new(JSON_NODE_ARRAY);
  json_node_take_array(node, array);
  print_json(node);
}

void cli_add_problems(JsonObject *object, opc_problems *problems) {
  JsonArray *list = json_array_new();
  opc_problems_sort(problems);
  for (guint i = 0; i < problems->list->len; i++) {
    const opc_problem *problem = problems->list->pdata[i];
    JsonObject *o = json_object_new();
    const opc_place *at = &problem->at;
    if (at->file) json_object_set_string_member(o, "file", at->file);
    if (at->file && at->line) {
      json_object_set_int_member(o, "line", at->line);
      json_object_set_int_member(o, "column", at->column);
    }
    json_object_set_string_member(o, "message", problem->message);
    json_object_set_int_member(o, "exit", cli_exit_code(problem->code));
    json_array_add_object_element(list, o);
  }
  json_object_set_array_member(object, "problems", list);
}

void cli_add_texts(JsonObject *object, const char *name,
                   const GPtrArray *texts) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i < texts->len; i++)
    json_array_add_string_element(list, texts->pdata[i]);
  json_object_set_array_member(object, name, list);
}

int cli_finish(int code) { return cli_is_written() || code ? code : CLI_IO; }
