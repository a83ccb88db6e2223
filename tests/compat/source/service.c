/* SPDX-License-Identifier: BSD-3-Clause */
/* A service of the extended interface. The linker replaces opc_binding_service
   of the host by the function below (--wrap). */
#include "compat.added.h"

const void *__real_opc_binding_service(const opc_host *host, const char *name);
const void *__wrap_opc_binding_service(const opc_host *host, const char *name);

static double service_double(const opc_host *host, double value) {
  (void)host;
  return 2 * value;
}

static const compat_added added = {.twice = service_double};

const void *__wrap_opc_binding_service(const opc_host *host, const char *name) {
  return strcmp(name, COMPAT_ADDED) ? __real_opc_binding_service(host, name)
                                    : &added;
}
