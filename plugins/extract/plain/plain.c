/* SPDX-License-Identifier: BSD-3-Clause */
/* extract.plain: a printed gate as slices in parallel, each with the current of
   a wide transistor of its length (thesis eq. 2.1 to 2.4, after Poppe et al.,
   "From poly line to transistor", SPIE 6156, 2006). */
#include "../slicer.h"

#include <stdlib.h>

/* ---- parameters ---- */

static const opc_parameter parameters[SLICER_PARAMETERS] = {
    SLICER_DECLARATIONS};

static void destroy(void *self) {
  slicer_clear(self);
  free(self);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  slicer *s = calloc(1, sizeof *s);
  if (s && slicer_make(s, host, values, error)) return s;
  if (s) destroy(s);
  else host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  return NULL;
}

/* ---- entry ---- */

static const opc_extract operations = {.size = sizeof operations,
                                       .prepare = slicer_prepare,
                                       .slicing = slicer_slicing,
                                       .extract = slicer_extract,
                                       .slice = slicer_slice};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "extract.plain",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "plain gate slicing: slices in parallel, each of its length",
      .kind = OPC_KIND_EXTRACT,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
