/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the descriptor of a plugin from the description that its class in
   Python returns: {"kind", "summary", "parameters": [...], "metrics": [...],
   "methods": [...], "files": [...]}. */
#include <string.h>

#include "py.h"

/* Time limit of the description, and default time limit of a call, s. */
static const double describe_limit = 10;
static const char call_limit[] = "3600 s";

enum { ALIGNMENT = 16 }; /* of fields, bytes: that of all their C types */

int py_defines(const py_plugin *plugin, const char *method) {
  JsonArray *all = py_list(json_node_get_object(plugin->about), "methods");
  for (guint i = 0; i < json_array_get_length(all); i++)
    if (!strcmp(json_array_get_string_element(all, i), method)) return 1;
  return 0;
}

/* ---- parameters and metrics ---- */

/* Types of parameters, with the size of the field; slots are not supported. */
static const struct {
  const char *name;
  uint32_t type;
  size_t width;
} types[] = {{"bool", OPC_BOOL, sizeof(int)},
             {"int", OPC_INT, sizeof(int64_t)},
             {"real", OPC_REAL, sizeof(double)},
             {"text", OPC_TEXT, sizeof(char *)},
             {"choice", OPC_CHOICE, sizeof(int)},
             {"file", OPC_FILE, sizeof(char *)},
             {"output", OPC_OUTPUT, sizeof(char *)},
             {"reals", OPC_REALS, sizeof(opc_reals)},
             {"map", OPC_MAP, sizeof(opc_map)},
             {"input", OPC_INPUT, sizeof(void *)}};

static uint32_t flags_of(JsonObject *o) {
  static const struct {
    const char *name;
    uint32_t flag;
  } flags[] = {{"required", OPC_REQUIRED}, {"at_least", OPC_AT_LEAST},
               {"above", OPC_ABOVE},       {"at_most", OPC_AT_MOST},
               {"below", OPC_BELOW},       {"no_effect", OPC_NO_EFFECT}};
  uint32_t all = 0;
  JsonArray *names = py_list(o, "flags");
  for (guint i = 0; i < json_array_get_length(names); i++)
    for (size_t k = 0; k < G_N_ELEMENTS(flags); k++)
      if (!strcmp(json_array_get_string_element(names, i), flags[k].name))
        all |= flags[k].flag;
  return all;
}

/* Fill a parameter whose field is at *offset, and move *offset behind the
   field. */
static int parameter_set(opc_parameter *p, JsonObject *o, size_t *offset,
                         opc_error *error) {
  const char *type = py_text(o, "type");
  for (size_t i = 0; i < G_N_ELEMENTS(types); i++) {
    if (!type || strcmp(type, types[i].name)) continue;
    *p = (opc_parameter){.name = py_text(o, "name"),
                         .type = types[i].type,
                         .flags = flags_of(o),
                         .unit = py_text(o, "unit"),
                         .preset = py_text(o, "preset"),
                         .min = py_number(o, "min"),
                         .max = py_number(o, "max"),
                         .choices = py_text(o, "choices"),
                         .summary = py_text(o, "summary"),
                         .former = py_text(o, "former"),
                         .follows = py_text(o, "follows"),
                         .offset = *offset,
                         .width = types[i].width};
    *offset += ALIGNMENT;
    return OPC_OK;
  }
  return opc_fail(error, OPC_NO_PLUGIN, NULL,
                  "parameter '%s' has the unknown type '%s'",
                  py_text(o, "name"), type ? type : "");
}

static int parameters_set(opc_plugin *d, JsonObject *about, opc_error *error) {
  JsonArray *list = py_list(about, "parameters");
  guint n = json_array_get_length(list);
  size_t offset = (sizeof(py_instance) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
  opc_parameter *all = g_new0(opc_parameter, n + 1);
  int code = OPC_OK;
  for (guint i = 0; i < n && !code; i++)
    code = parameter_set(&all[i], json_array_get_object_element(list, i),
                         &offset, error);
  all[n] =
      (opc_parameter){.name = "call_limit",
                      .type = OPC_REAL,
                      .flags = OPC_ABOVE | OPC_NO_EFFECT,
                      .unit = "s",
                      .preset = call_limit,
                      .summary = "time limit of one call of a Python function",
                      OPC_FIELD(py_instance, call_limit)};
  d->parameters = all;
  d->n_parameters = n + 1;
  d->parameter_size = sizeof *all;
  d->instance_size = offset;
  return code;
}

static void metrics_set(opc_plugin *d, JsonObject *about) {
  JsonArray *list = py_list(about, "metrics");
  guint n = json_array_get_length(list);
  opc_metric *all = g_new0(opc_metric, n + 1);
  for (guint i = 0; i < n; i++) {
    JsonObject *o = json_array_get_object_element(list, i);
    const char *better = py_text(o, "better");
    all[i] =
        (opc_metric){.name = py_text(o, "name"),
                     .unit = py_text(o, "unit"),
                     .better = !g_strcmp0(better, "lower")    ? OPC_LOWER
                               : !g_strcmp0(better, "higher") ? OPC_HIGHER
                                                              : OPC_NEUTRAL,
                     .tolerance = py_number(o, "tolerance"),
                     .summary = py_text(o, "summary")};
  }
  d->metrics = all;
  d->n_metrics = n;
  d->metric_size = sizeof *all;
}

/* ---- the descriptor ---- */

static int functions_set(py_plugin *plugin, const char *kind) {
  static const struct {
    const char *kind;
    void (*set)(py_plugin *plugin);
  } all[] = {
      {"synthesizer", py_synthesizer_set}, {"regulator", py_regulator_set},
      {"extractor", py_extractor_set},     {"litho", py_litho_set},
      {"resist", py_resist_set},           {"step", py_step_set}};
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    if (g_strcmp0(kind, all[i].kind)) continue;
    all[i].set(plugin);
    return 1;
  }
  return 0;
}

static int descriptor_set(py_plugin *plugin, opc_error *error) {
  JsonObject *about = json_node_get_object(plugin->about);
  opc_plugin *d = &plugin->descriptor;
  *d = (opc_plugin){
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .size = sizeof *d,
      .id = plugin->id,
      .kind = py_text(about, "kind"),
      .version = py_text(about, "version"),
      .licence = py_text(about, "licence"),
      .summary = py_text(about, "summary"),
      .flags = OPC_REENTRANT |
               (py_number(about, "deterministic") != 0 ? OPC_DETERMINISTIC : 0),
      .check = py_check,
      .clear = py_clear};
  if (!functions_set(plugin, d->kind))
    return opc_fail(error, OPC_NO_PLUGIN, NULL,
                    "plugins of the kind '%s' cannot be written in Python",
                    d->kind ? d->kind : "");
  metrics_set(d, about);
  JsonArray *files = py_list(about, "files");
  guint n = json_array_get_length(files);
  plugin->files = g_new0(const char *, n + 1);
  for (guint i = 0; i < n; i++)
    plugin->files[i] = json_array_get_string_element(files, i);
  return parameters_set(d, about, error);
}

/* Ask a process for the description of the plugin. */
static int describe_ask(py_plugin *plugin, opc_error *error) {
  plugin->about = py_cache_get(plugin);
  if (plugin->about) return descriptor_set(plugin, error);
  py_worker *w = py_worker_start(plugin->path, plugin->id, NULL, error);
  if (!w) return error->code;
  py_request(w, "describe");
  int code = py_call(w, NULL, describe_limit, NULL, error);
  if (!code)
    plugin->about = json_node_init_object(json_node_alloc(), py_result(w));
  py_worker_free(w);
  if (!code) code = descriptor_set(plugin, error);
  if (!code) py_cache_put(plugin);
  return code;
}

const opc_plugin *py_describe(const char *path, const char *id,
                              opc_error *error) {
  py_plugin *plugin = g_new0(py_plugin, 1);
  plugin->path = g_strdup(path);
  int code = OPC_OK;
  if (g_strlcpy(plugin->id, id, sizeof plugin->id) >= sizeof plugin->id)
    code =
        opc_fail(error, OPC_NO_PLUGIN, NULL,
                 "the id has more than %zu characters", sizeof plugin->id - 1);
  if (!code) code = describe_ask(plugin, error);
  if (!code) return &plugin->descriptor;
  if (plugin->about) json_node_unref(plugin->about);
  g_free(plugin->path);
  g_free(plugin);
  return NULL;
}
