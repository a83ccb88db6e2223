/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes flow files, checked against the declarations of the real plugins. No
   instance is created, so that only plugin files are opened. */
#include "core/binding/flow.h"
#include "core/binding/resolve.h"
#include "fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static opc_registry *registry;
  if (!registry) registry = opc_registry_new(NULL);
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_load(fuzz_file(data, size), NULL, registry, problems);
  g_autofree char *text = opc_problems_text(problems);
  if (flow && !*text) g_free(opc_flow_resolved(flow, NULL));
  return 0;
}
