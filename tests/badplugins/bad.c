/* SPDX-License-Identifier: BSD-3-Clause */
/* A plugin with one fault in its declaration, selected by BAD_...; without a
   selection, the plugin is valid. BAD_ID is the id. */
#include <eda/regulator.h>
#include <opcflow/plugin.h>
#include <stdlib.h>
#include <unistd.h>

#include "evil.h"

/* ---- before opcflow_plugin() is called ---- */

static void __attribute__((constructor)) construct(void) { evil("construct"); }

/* ---- state ---- */

typedef struct bad {
  const opc_host *host;
  double size;
  float narrow;
} bad;

/* ---- work ---- */

static int bad_rule(void *self, const eda_printed *printed, eda_ruling *ruling,
                    opc_error *error) {
  (void)self, (void)printed, (void)ruling, (void)error;
  return OPC_OK;
}

#ifndef BAD_FUNCTION
static int bad_violations(void *self, const eda_printed *printed,
                          eda_violation *list, size_t most, size_t *count,
                          opc_error *error) {
  (void)self, (void)printed, (void)list, (void)most, (void)error;
  *count = 0;
  return OPC_OK;
}
#endif

/* ---- parameters ---- */

#define SIZE .name = "size", .type = OPC_REAL, .summary = "a length"

static const opc_parameter parameters[] = {
#ifdef BAD_UNIT
    {SIZE, .unit = "parsec", .preset = "1 nm", OPC_FIELD(bad, size)},
#elif defined BAD_DEFAULT
    {SIZE, .flags = OPC_AT_MOST, .unit = "nm", .preset = "66 nm", .max = 65,
     OPC_FIELD(bad, size)},
#elif defined BAD_WIDTH
    {SIZE, .unit = "nm", .preset = "65 nm", OPC_FIELD(bad, narrow)},
#elif defined BAD_FOLLOWS
    {SIZE, .flags = OPC_REQUIRED, .unit = "nm", .follows = "0.1 lambda/NA",
     OPC_FIELD(bad, size)},
#elif defined BAD_FIELD
    {SIZE, .unit = "nm", .preset = "65 nm", .offset = sizeof(bad),
     .width = sizeof(double)},
#else
    {SIZE, .unit = "nm", .preset = "65 nm", OPC_FIELD(bad, size)},
#endif
#ifdef BAD_TWICE
    {SIZE, .unit = "nm", .preset = "65 nm", OPC_FIELD(bad, size)},
#endif
};

/* ---- entry ---- */

static const eda_regulator functions = {
    .rule = bad_rule,
#ifndef BAD_FUNCTION
    .violations = bad_violations,
#endif
};

/* Declared without OPC_PLUGIN, which would prevent most of the faults. */
static const opc_plugin plugin = {
    .size = sizeof(opc_plugin),
#ifdef BAD_MAJOR
    .abi_major = 9,
    .id = (const char *)1, /* invalid: must not be read */
#else
    .abi_major = OPC_ABI_MAJOR,
    .id = BAD_ID,
#endif
#ifdef BAD_MINOR
    .abi_minor = OPC_ABI_OLDEST - 1,
#else
    .abi_minor = OPC_ABI_MINOR,
#endif
#ifdef BAD_KIND
    .kind = "nothing",
#else
    .kind = "regulator",
#endif
#ifndef BAD_VERSION
    .version = "1.0.0",
#endif
#ifdef BAD_LICENCE
    .licence = "",
#else
    .licence = "BSD-3-Clause",
#endif
#ifndef BAD_SUMMARY
    .summary = "A plugin with a fault",
#endif
    OPC_PARAMETERS(parameters),
#ifdef BAD_INSTANCE
    .instance_size = 4,
#else
    .instance_size = sizeof(bad),
#endif
    .functions = &functions,
#ifdef BAD_FUNCTIONS
    .functions_size = 8,
#else
    .functions_size = sizeof functions,
#endif
};

#ifdef BAD_ENTRY
#define opcflow_plugin opcflow_plug
#endif

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  evil("load");
#ifdef BAD_CRASH
  abort();
#endif
#ifdef BAD_HANG
  for (;;) sleep(1);
#endif
#ifdef BAD_EXIT
  _exit(0);
#endif
#ifdef BAD_NULL
  return NULL;
#endif
  return &plugin;
}
