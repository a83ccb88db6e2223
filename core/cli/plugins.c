/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/cli/cli.h"
#include "core/flow/table.h"
#include "core/plugin/declaration.h"

static gboolean is_usable(const opc_candidate *c) {
  return !c->reason && !c->hidden_by;
}

GPtrArray *cli_usable_plugins(opc_registry *registry) {
  GPtrArray *plugins = g_ptr_array_new();
  g_autoptr(GPtrArray) list = opc_registry_scan(registry, CLI_PATIENCE);
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    opc_error error;
    const opc_plugin *plugin =
        is_usable(c) ? opc_registry_find(registry, c->id, &error) : NULL;
    if (plugin) g_ptr_array_add(plugins, (void *)plugin);
  }
  return plugins;
}

static char *why_not(const opc_candidate *c) {
  if (!c->hidden_by) return g_strdup(c->reason);
  return g_strdup_printf("hidden by %s%s%s", c->hidden_by,
                         c->reason ? "; " : "", c->reason ? c->reason : "");
}

static void set_text(JsonBuilder *b, const char *key, const char *text) {
  json_builder_set_member_name(b, key);
  if (text)
    json_builder_add_string_value(b, text);
  else
    json_builder_add_null_value(b);
}

static void print_json(const GPtrArray *list, gboolean failed) {
  JsonBuilder *b = json_builder_new();
  json_builder_begin_array(b);
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    if (failed == is_usable(c)) continue;
    json_builder_begin_object(b);
    set_text(b, "id", c->id);
    set_text(b, "path", c->path);
    if (failed) {
      g_autofree char *reason = why_not(c);
      set_text(b, "reason", reason);
    } else {
      set_text(b, "kind", opc_kind_name(c->kind));
      set_text(b, "version", c->version);
      set_text(b, "licence", c->licence);
      set_text(b, "summary", c->summary);
    }
    json_builder_end_object(b);
  }
  json_builder_end_array(b);
  cli_print_json(json_builder_get_root(b));
  g_object_unref(b);
}

/* A table of columns that are all texts, n rows each. */
static void print_columns(const char *const *names, GPtrArray *const *columns,
                          size_t n_columns) {
  g_autofree opc_column *c = g_new0(opc_column, n_columns);
  for (size_t i = 0; i < n_columns; i++)
    c[i] = (opc_column){names[i], NULL, OPC_TEXT, 0, columns[i]->pdata};
  opc_error error;
  opc_table *table =
      opc_table_new("plugins", 0, columns[0]->len, c, n_columns, &error);
  g_autofree char *text = opc_table_text(table);
  opc_table_free(table);
  cli_print("%s", text);
}

static void print_usable(const GPtrArray *list) {
  static const char *const names[] = {"plugin", "kind", "version", "summary"};
  GPtrArray *columns[4];
  for (size_t i = 0; i < 4; i++) columns[i] = g_ptr_array_new();
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    if (!is_usable(c)) continue;
    g_ptr_array_add(columns[0], c->id);
    g_ptr_array_add(columns[1], (char *)opc_kind_name(c->kind));
    g_ptr_array_add(columns[2], c->version);
    g_ptr_array_add(columns[3], c->summary);
  }
  if (columns[0]->len) print_columns(names, columns, 4);
  for (size_t i = 0; i < 4; i++) g_ptr_array_free(columns[i], TRUE);
}

static guint count_failed(const GPtrArray *list) {
  guint n = 0;
  for (guint i = 0; i < list->len; i++) n += !is_usable(list->pdata[i]);
  return n;
}

static void print_failed(const GPtrArray *list) {
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    if (is_usable(c)) continue;
    g_autofree char *reason = why_not(c);
    cli_print("%s: %s\n", c->path ? c->path : c->id, reason);
  }
}

static int run(const cli_verb *verb, int argc, char **argv) {
  gboolean failed = FALSE, json = FALSE;
  const cli_option options[] = {
      {"failed", NULL, "those that cannot be used, and why", &failed, NULL,
       NULL},
      {"json", NULL, "as JSON", &json, NULL, NULL},
      {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 0, 0, rest);
  if (code >= 0) return code;
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  g_autoptr(GPtrArray) list = opc_registry_scan(registry, CLI_PATIENCE);
  guint bad = count_failed(list);
  if (json)
    print_json(list, failed);
  else if (failed)
    print_failed(list);
  else
    print_usable(list);
  if (bad && !failed)
    cli_message("warning",
                "%u more cannot be used, see 'opcflow plugins "
                "--failed'",
                bad);
  return CLI_GOOD;
}

const cli_verb cli_plugins = {.name = "plugins",
                              .arguments = "",
                              .summary = "List the plugins",
                              .run = run};
