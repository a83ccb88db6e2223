/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes a layout reader, which is linked into this program. Each input gets a
   new instance. */
#include <eda/layout.h>
#include <string.h>

#include "core/binding/binding.h"
#include "fuzz/fuzz.h"

const opc_plugin *opcflow_plugin(void);

/* Bind an instance to the file in memory. */
static opc_binding *reader_bind(const char *path) {
  static opc_source *source;
  static opc_node *volatile map; /* volatile: visible to the leak checker */
  static const opc_place nowhere = {"fuzz", 0, 0};
  g_autoptr(opc_problems) problems = opc_problems_new();
  if (!map) {
    source = opc_source_new("fuzz", "");
    g_autofree char *text = g_strdup_printf("{ file: '%s' }", path);
    map = opc_node_parse(source, text, strlen(text), problems);
  }
  opc_binding *binding = opc_bind_plugin(NULL, opcflow_plugin(), map, "reader",
                                         &nowhere, 0, problems);
  opc_binding_create(binding, NULL, NULL, problems);
  if (problems->list->len) g_error("%s", opc_problems_text(problems));
  return binding;
}

/* Largest number of layers and bytes that are flattened. Larger layouts are
   valid, but take too long. */
enum { MOST_LAYERS = 4, MOST_FLAT = 1 << 22 };

static void layout_flatten(const eda_layout *layout, int32_t top) {
  size_t layers = MIN(eda_layout_layers(layout), MOST_LAYERS);
  for (size_t l = 0; l < layers; l++) {
    opc_error error;
    eda_flat flat;
    if (eda_layout_flat_bytes(layout, top, (int32_t)l) > MOST_FLAT ||
        eda_layout_flatten(layout, top, (int32_t)l, 1, &flat, &error))
      continue;
    eda_flat_clear(&flat);
  }
}

/* Call all query functions of a layout. */
static void look_at(const eda_layout *layout) {
  opc_error error;
  int32_t top = eda_layout_top(layout, &error);
  if (top >= 0) layout_flatten(layout, top);
  for (size_t c = 0; c < eda_layout_cells(layout); c++) {
    size_t n, polygons = eda_layout_polygons(layout, (int32_t)c);
    int32_t layer;
    if (polygons)
      eda_layout_polygon(layout, (int32_t)c, polygons - 1, &n, &layer);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  g_autoptr(opc_binding) binding = reader_bind(fuzz_file(data, size));
  const opc_step *step = binding->module.functions;
  opc_error error = {0};
  void *output = NULL;
  if (!step->run(binding->module.self, &output, &error)) look_at(output);
  if (output) step->outputs[0].release(output);
  return 0;
}
