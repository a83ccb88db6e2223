/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds kinds and checks a plugin's functions against its kind. */
#include "core/plugin/kind.h"

#include <base/file.h>
#include <string.h>

#include "core/plugin/declaration.h"

/* ---- built-in kinds ---- */

static const opc_function step_functions[] = {OPC_FUNCTION(opc_step, run)};
static const opc_function command_functions[] = {
    OPC_FUNCTION(opc_command, run)};
static const opc_function loader_functions[] = {
    OPC_FUNCTION(opc_loader, load), OPC_FUNCTION(opc_loader, files)};

static const struct {
  const char *name;
  opc_kind kind;
} own[] = {
    {OPC_KIND_COMMAND,
     {.functions_size = sizeof(opc_command),
      .n_functions = G_N_ELEMENTS(command_functions),
      .functions = command_functions}},
    {OPC_KIND_KIND, {.functions_size = sizeof(opc_kind)}},
    {OPC_KIND_LOADER,
     {.functions_size = sizeof(opc_loader),
      .n_functions = G_N_ELEMENTS(loader_functions),
      .functions = loader_functions}},
    {OPC_KIND_STEP,
     {.functions_size = sizeof(opc_step),
      .n_functions = G_N_ELEMENTS(step_functions),
      .functions = step_functions}},
};

/* ---- search ---- */

const opc_kind *opc_kind_of(opc_registry *registry, const char *name,
                            opc_error *error) {
  for (size_t i = 0; i < G_N_ELEMENTS(own); i++)
    if (!strcmp(own[i].name, name)) return &own[i].kind;
  g_autofree char *id = g_strconcat("kind.", name, NULL);
  const opc_plugin *plugin = opc_registry_find(registry, id, error);
  return plugin ? plugin->functions : NULL;
}

static gint compare_names(gconstpointer a, gconstpointer b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

const opc_kind *opc_kind_trials(opc_registry *registry, const char *name) {
  opc_error none;
  g_autofree char *id = g_strconcat("kind.", name, NULL);
  const opc_plugin *plugin = opc_registry_find(registry, id, &none);
  return plugin ? plugin->functions : opc_kind_of(registry, name, &none);
}

GPtrArray *opc_kind_names(const opc_registry *registry) {
  GPtrArray *names = opc_registry_ids(registry, "kind.");
  for (guint i = 0; i < names->len; i++) {
    char *id = names->pdata[i];
    memmove(id, id + strlen("kind."), strlen(id + strlen("kind.")) + 1);
  }
  for (size_t i = 0; i < G_N_ELEMENTS(own); i++)
    if (!g_ptr_array_find_with_equal_func(names, own[i].name, g_str_equal,
                                          NULL))
      g_ptr_array_add(names, g_strdup(own[i].name));
  g_ptr_array_sort(names, compare_names);
  return names;
}

/* ---- validity ---- */

static char *ports_fault(opc_step *step) {
  step->outputs = OPC_DECLARED_COPY(opc_port, release, step->outputs,
                                    step->n_outputs, step->output_size);
  if (!step->outputs)
    return g_strdup("the outputs are not an array of opc_port");
  for (size_t i = 0; i < step->n_outputs; i++) {
    const opc_port *port = &step->outputs[i];
    if (!port->name || !port->kind || !opc_is_id(port->name))
      return g_strdup_printf("output %zu has no name or kind", i + 1);
    if (!port->check || !port->release)
      return g_strdup_printf("output '%s' has no check or release", port->name);
  }
  return NULL;
}

static char *kind_fault(opc_kind *kind) {
  kind->functions = OPC_DECLARED_COPY(opc_function, offset, kind->functions,
                                      kind->n_functions, kind->function_size);
  kind->templates = OPC_DECLARED_COPY(opc_template, text, kind->templates,
                                      kind->n_templates, kind->template_size);
  kind->samples = OPC_DECLARED_COPY(opc_sample, size, kind->samples,
                                    kind->n_samples, kind->sample_size);
  kind->examples = OPC_DECLARED_COPY(opc_example, give, kind->examples,
                                     kind->n_examples, kind->example_size);
  if (!kind->functions || !kind->templates || !kind->samples || !kind->examples)
    return g_strdup(
        "the functions, templates, samples or examples are not arrays");
  for (size_t i = 0; i < kind->n_functions; i++)
    if (!kind->functions[i].name ||
        kind->functions[i].offset + sizeof(void *) > kind->functions_size)
      return g_strdup_printf(
          "function %zu of the kind is outside of the struct of functions",
          i + 1);
  return NULL;
}

/* Zeros after each struct of functions. A caller that was built for a later
   version of the kind thus reads missing optional functions as NULL. */
enum { SPARE = 64 * sizeof(void (*)(void)) };

char *opc_functions_adopt(opc_registry *registry, opc_plugin *plugin) {
  opc_error error = {0};
  const opc_kind *kind = opc_kind_of(registry, plugin->kind, &error);
  if (!kind)
    return g_strdup_printf("the kind '%s' is unknown: %s", plugin->kind,
                           error.message);
  size_t size = MAX(plugin->functions_size, kind->functions_size) + SPARE;
  void *functions = (void *)opc_declared_copy(plugin->functions, 1,
                                              plugin->functions_size, 0, size);
  if (!functions)
    return g_strdup_printf("the size of the functions, %zu bytes, is not valid",
                           plugin->functions_size);
  plugin->functions = functions;
  for (size_t i = 0; i < kind->n_functions; i++) {
    void *function;
    memcpy(&function, (char *)functions + kind->functions[i].offset,
           sizeof function);
    if (!function)
      return g_strdup_printf("the function '%s' is missing",
                             kind->functions[i].name);
  }
  if (!strcmp(plugin->kind, OPC_KIND_STEP)) return ports_fault(functions);
  if (!strcmp(plugin->kind, OPC_KIND_KIND)) return kind_fault(functions);
  return NULL;
}
