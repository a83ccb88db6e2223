/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes texts of --set and --sweep for a flow, one per line. Texts of --sweep
   begin with a sign. */
#include <string.h>

#include "core/binding/flow.h"
#include "core/binding/resolve.h"
#include "core/binding/sweep.h"
#include "fuzz/fuzz.h"

static const char text[] =
    "opcflow: 1\n"
    "steps:\n"
    "  layout: { use: read.cif, file: nand2.cif, layers: { poly: CP } }\n"
    "  gates: { use: segment.transistors, layout: ${layout} }\n"
    "  mask:\n"
    "    use: correct\n"
    "    gates: ${gates}\n"
    "    litho: { use: litho.hopkins, wavelength: 193 nm, na: 0.75 }\n"
    "    resist: { use: resist.threshold, table: [250 nm, 65 nm] }\n"
    "    extractor: { use: extractor.plain, devices: ptm65.yaml }\n"
    "    synthesizer: { use: synthesizer.dpb }\n"
    "variants:\n"
    "  dense: { mask.litho.defocus: 50 nm }\n";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static opc_registry *registry;
  static opc_recipe *recipe;
  g_autoptr(opc_problems) problems = opc_problems_new();
  if (!recipe) {
    registry = opc_registry_new(NULL);
    recipe = opc_recipe_read(fuzz_file((const uint8_t *)text, strlen(text)),
                             problems);
    if (!recipe) g_error("%s", opc_problems_text(problems));
  }
  g_autofree char *words = g_strndup((const char *)data, size);
  g_auto(GStrv) lines = g_strsplit(words, "\n", 64);
  g_autoptr(GPtrArray) sets = g_ptr_array_new();
  g_autoptr(GPtrArray) sweeps = g_ptr_array_new();
  for (char **line = lines; *line; line++)
    if (**line == '*')
      g_ptr_array_add(sweeps, *line + 1);
    else if (**line)
      g_ptr_array_add(sets, *line);
  g_ptr_array_add(sets, NULL);
  g_ptr_array_add(sweeps, NULL);
  g_autoptr(opc_sweep) sweep =
      opc_sweep_new(recipe, (const char *const *)sets->pdata, NULL,
                    (const char *const *)sweeps->pdata, problems);
  const opc_choice choice = {.sweep = sweep,
                             .sets = (const char *const *)sets->pdata};
  g_autoptr(opc_flow) flow = opc_flow_make(recipe, &choice, registry, problems);
  g_autofree char *found = opc_problems_text(problems);
  if (flow && sweep && !*found)
    g_free(opc_flow_resolved(flow, sweep->axes->len ? sweep : NULL));
  return 0;
}
