/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the manifest of a run: the origin of the results. */
#include <math.h>
#include <string.h>
#include <sys/utsname.h>

#include "core/binding/inner.h"
#include "core/binding/lookup.h"
#include "core/report/outcome.h"

static void set_text(JsonObject *o, const char *key, const char *text) {
  json_object_set_string_member(o, key, text);
}

/* Return a NULL-terminated list of texts as JSON; an empty list for NULL. */
static JsonArray *texts_json(const char *const *texts) {
  JsonArray *list = json_array_new();
  for (; texts && *texts; texts++) json_array_add_string_element(list, *texts);
  return list;
}

/* Add the plugins of a flow, each once; `done`: opc_plugin *. */
static void add_plugins(JsonArray *list, GHashTable *done,
                        const opc_manifest *m, const opc_flow *flow) {
  g_autoptr(GPtrArray) all = opc_flow_bindings(flow);
  for (guint i = 0; i < all->len; i++) {
    const opc_binding *b = all->pdata[i];
    if (b->inner) add_plugins(list, done, m, opc_inner_flow(b->inner));
    if (!g_hash_table_add(done, (gpointer)b->plugin)) continue;
    const char *path = opc_registry_path(m->registry, b->plugin);
    g_autofree char *whole = path ? g_canonicalize_filename(path, NULL) : NULL;
    opc_error error;
    g_autofree char *sum =
        whole ? opc_store_sum(m->store, whole, NULL, &error) : NULL;
    JsonObject *o = json_object_new();
    set_text(o, "id", b->plugin->id);
    set_text(o, "version", b->plugin->version);
    set_text(o, "path", whole);
    set_text(o, "sha256", sum);
    json_array_add_object_element(list, o);
  }
}

static JsonArray *inputs_json(const opc_manifest *m) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i + 1 < m->outcome->inputs->len; i += 2) {
    JsonObject *o = json_object_new();
    set_text(o, "path", m->outcome->inputs->pdata[i]);
    set_text(o, "sha256", m->outcome->inputs->pdata[i + 1]);
    json_array_add_object_element(list, o);
  }
  return list;
}

static JsonObject *machine_json(void) {
  struct utsname about;
  if (uname(&about)) memset(&about, 0, sizeof about);
  JsonObject *o = json_object_new();
  set_text(o, "name", about.nodename);
  set_text(o, "system", about.sysname);
  set_text(o, "release", about.release);
  set_text(o, "machine", about.machine);
  json_object_set_int_member(o, "processors", g_get_num_processors());
  return o;
}

/* Return the part about the store; NULL without a store. */
static JsonObject *store_json(const opc_manifest *m) {
  if (!m->store) return NULL;
  JsonObject *o = json_object_new();
  JsonArray *list = json_array_new();
  set_text(o, "folder", opc_store_folder(m->store));
  json_object_set_int_member(o, "steps", (gint64)m->outcome->histories.done);
  json_object_set_int_member(o, "reused", (gint64)m->outcome->histories.reused);
  for (guint i = 0; i < m->outcome->histories.list->len; i++) {
    const opc_history *h = m->outcome->histories.list->pdata[i];
    JsonObject *one = json_object_new();
    if (h->point) json_object_set_int_member(one, "point", (gint64)h->point);
    set_text(one, "step", h->path);
    set_text(one, "result", h->reused ? "reused" : "ran");
    set_text(one, "key", h->key);
    set_text(one, "reason", h->reason);
    json_object_set_double_member(one, "seconds", h->seconds);
    json_array_add_object_element(list, one);
  }
  json_object_set_array_member(o, "results", list);
  return o;
}

static JsonObject *seconds_json(const opc_manifest *m, const double *all) {
  JsonObject *o = json_object_new();
  for (guint i = 0; i < m->flow->order->len; i++) {
    const opc_flow_step *step = m->flow->order->pdata[i];
    if (!isnan(m->outcome->seconds[step->number]))
      json_object_set_double_member(o, step->name, all[step->number]);
  }
  return o;
}

JsonNode *opc_manifest_json(const opc_manifest *m) {
  JsonObject *o = json_object_new();
  JsonArray *plugins = json_array_new();
  g_autoptr(GHashTable) done = g_hash_table_new(NULL, NULL);
  g_autofree char *started = g_date_time_format_iso8601(m->outcome->started);
  add_plugins(plugins, done, m, m->flow);
  set_text(o, "opcflow", OPC_VERSION);
  set_text(o, "flow", m->flow->recipe->path);
  if (m->flow->variant) set_text(o, "variant", m->flow->variant);
  set_text(o, "result", m->outcome->failure ? "failed" : "complete");
  if (m->outcome->failure) set_text(o, "failure", m->outcome->failure);
  if (m->outcome->sweep) {
    json_object_set_int_member(o, "points", (gint64)m->outcome->sweep->points);
    json_object_set_int_member(o, "failed_points",
                               (gint64)m->outcome->failed_points);
  }
  json_object_set_array_member(o, "command", texts_json(m->command));
  set_text(o, "started", started);
  json_object_set_double_member(o, "seconds", m->outcome->total);
  json_object_set_object_member(o, "steps",
                                seconds_json(m, m->outcome->seconds));
  json_object_set_object_member(o, "processor",
                                seconds_json(m, m->outcome->processor));
  JsonObject *store = store_json(m);
  if (store) json_object_set_object_member(o, "store", store);
  json_object_set_int_member(o, "threads", opc_threads());
  json_object_set_object_member(o, "host", machine_json());
  json_object_set_array_member(o, "plugins", plugins);
  json_object_set_array_member(o, "inputs", inputs_json(m));
  JsonNode *node = json_node_new(JSON_NODE_OBJECT);
  json_node_take_object(node, o);
  return node;
}
