/* SPDX-License-Identifier: BSD-3-Clause */
/* Device tables. */
#include "core/plugin/host.h"
#include "fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static opc_host *host;
  if (!host) host = opc_host_new(NULL);
  opc_error error;
  const char *path = fuzz_file(data, size);
  opc_devices *devices = opc_device_functions.load(host, path, &error);
  if (devices) opc_device_functions.release(devices);
  return 0;
}
