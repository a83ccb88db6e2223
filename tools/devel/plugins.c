/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow plugins: prints the usable plugins, or the unusable plugins with the
   reasons. */
#include "tools/devel/verbs.h"

static gboolean is_usable(const opc_candidate *c) {
  return !c->reason && !c->hidden_by;
}

static char *why_not(const opc_candidate *c) {
  if (!c->hidden_by) return g_strdup(c->reason);
  return g_strdup_printf("hidden by %s%s%s", c->hidden_by,
                         c->reason ? "; " : "", c->reason ? c->reason : "");
}

static JsonObject *as_json(const opc_candidate *c) {
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "id", c->id);
  json_object_set_string_member(o, "path", c->path);
  if (!is_usable(c)) {
    g_autofree char *reason = why_not(c);
    json_object_set_string_member(o, "reason", reason);
    return o;
  }
  json_object_set_string_member(o, "kind", c->kind);
  json_object_set_string_member(o, "version", c->version);
  json_object_set_string_member(o, "licence", c->licence);
  json_object_set_string_member(o, "summary", c->summary);
  return o;
}

static void print_usable(const GPtrArray *list) {
  static const char *const names[] = {"plugin", "kind", "version", "summary"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new();
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    g_ptr_array_add(cells, c->id);
    g_ptr_array_add(cells, c->kind);
    g_ptr_array_add(cells, c->version);
    g_ptr_array_add(cells, c->summary);
  }
  cli_print_rows(names, 4, cells);
}

static void print_failed(const GPtrArray *list) {
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    g_autofree char *reason = why_not(c);
    cli_print("%s: %s\n", c->path, reason);
  }
}

static gboolean failed, json;

static const cli_option options[] = {
    {"failed", "list plugins that cannot be used, with the reasons",
     .flag = &failed},
    {"json", "print the result as JSON", .flag = &json},
    {0}};

static int plugins_run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb, (void)arguments;
  g_autoptr(GPtrArray) all =
      opc_registry_scan(cli_registry(), "", CLI_PATIENCE);
  g_autoptr(GPtrArray) wanted = g_ptr_array_new();
  for (guint i = 0; i < all->len; i++)
    if (is_usable(all->pdata[i]) != failed)
      g_ptr_array_add(wanted, all->pdata[i]);
  if (json) {
    JsonArray *list = json_array_new();
    for (guint i = 0; i < wanted->len; i++)
      json_array_add_object_element(list, as_json(wanted->pdata[i]));
    cli_print_array(list);
  } else if (failed) {
    print_failed(wanted);
  } else {
    print_usable(wanted);
  }
  if (!failed && wanted->len < all->len)
    cli_message("warning",
                "%u more cannot be used, see 'opcflow plugins --failed'",
                all->len - wanted->len);
  return CLI_GOOD;
}

const cli_verb devel_plugins = {CLI_PLUGINS, .options = options,
                                .run = plugins_run};
