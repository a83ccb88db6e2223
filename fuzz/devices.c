/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes device tables. */
#include <eda/devices.h>

#include "fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  opc_error error;
  eda_devices *devices = eda_devices_read(fuzz_file(data, size), &error);
  if (devices) eda_devices_free(devices);
  return 0;
}
