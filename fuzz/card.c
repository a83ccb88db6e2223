/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes model cards. */
#include <eda/netlist.h>

#include "fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const char *const names[] = {"nmos", "pmos"};
  const char *path = fuzz_file(data, size);
  for (int type = 0; type < 2; type++) {
    opc_error error = {0};
    eda_pool pool = {0};
    eda_card card;
    eda_card_read(&pool, path, names[type], type, &card, &error);
    eda_pool_clear(&pool);
  }
  return 0;
}
