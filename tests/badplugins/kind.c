/* SPDX-License-Identifier: BSD-3-Clause */
/* A kind that fails while it is loaded. */
#include <opcflow/kind.h>

#include "evil.h"

typedef struct none {
  int nothing;
} none;

static const opc_function required[] = {{"nothing", 0}};
static const opc_template templates[] = {{"@ID@.c", ""}};

static void exercise(const opc_module *module, opc_inspector *inspector) {
  (void)module, (void)inspector;
}

static void __attribute__((constructor)) construct(void) { evil("construct"); }

OPC_KIND("bad", none, "Kind with a fault");
