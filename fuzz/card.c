/* SPDX-License-Identifier: BSD-3-Clause */
/* Model cards. */
#include "core/plugin/host.h"
#include "fuzz/fuzz.h"
#include "plugins/netlist/card.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static opc_host *host;
  static const char *const names[] = {"nmos", "pmos"};
  if (!host) host = opc_host_new(NULL);
  const char *path = fuzz_file(data, size);
  for (int type = 0; type < 2; type++) {
    opc_error error = {0};
    pool p = {0};
    netlist_model model;
    netlist_model_read(host, &p, path, names[type], type, &model, &error);
    pool_clear(&p);
  }
  return 0;
}
