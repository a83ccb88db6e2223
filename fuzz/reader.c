/* SPDX-License-Identifier: BSD-3-Clause */
/* A reader of layouts, linked into this program: an instance of its own for
   every input. */
#include <string.h>

#include "core/flow/binding.h"
#include "core/plugin/declaration.h"
#include "fuzz/fuzz.h"

const opc_plugin *opcflow_plugin(void);

/* The parameters, whose file is always the one in memory. */
static const opc_binding *parameters(const char *path) {
  /* What stays for the life of the program. */
  static opc_binding *binding;
  static opc_problems *problems;
  static opc_source *source;
  static opc_node *volatile map;   /* volatile: leaves it where it can be seen */
  static const opc_place nowhere = {"fuzz", 0, 0};
  if (binding) return binding;
  problems = opc_problems_new();
  source = opc_source_new("fuzz", "");
  g_autofree char *text = g_strdup_printf("{ file: '%s' }", path);
  map = opc_node_parse(source, text, strlen(text), problems);
  if (map)
    binding = opc_bind_plugin(NULL, opcflow_plugin(), map, "reader", &nowhere,
                              0, problems);
  if (problems->list->len) g_error("%s", opc_problems_text(problems));
  return binding;
}

/* What a layout may be asked. */
static void look_at(const opc_layout *layout) {
  const opc_layout_service *l = &opc_layout_functions;
  opc_error error;
  l->top(layout, &error);
  for (size_t c = 0; c < l->cells(layout); c++) {
    size_t n, polygons = l->polygons(layout, (int32_t)c);
    int32_t layer;
    if (polygons) l->polygon(layout, (int32_t)c, polygons - 1, &n, &layer);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static opc_host *host;
  if (!host) host = opc_host_new(NULL);
  const opc_binding *binding = parameters(fuzz_file(data, size));
  const opc_plugin *plugin = opcflow_plugin();
  const opc_step *step = plugin->operations;
  opc_error error = {0};
  void *output = NULL;
  void *self = plugin->create(host, binding->values, &error);
  if (!self) g_error("%s", error.message);
  if (!step->run(self, &output, &error)) look_at(output);
  if (output) opc_port_at(plugin, 0)->release(output);
  plugin->destroy(self);
  return 0;
}
