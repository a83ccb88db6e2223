/* SPDX-License-Identifier: BSD-3-Clause */
/* A plugin with one thing wrong with it, chosen by BAD_...; without any, a
   sound one. BAD_ID is its id. */
#include <opcflow/opcflow.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const opc_parameter parameters[] = {
#ifdef BAD_UNIT
    {"size", OPC_REAL, 0, "parsec", "1 nm", 0, 0, NULL, "a length"},
#elif defined BAD_DEFAULT
    {"size", OPC_REAL, OPC_AT_MOST, "nm", "66 nm", 0, 65, NULL, "a length"},
#else
    {"size", OPC_REAL, 0, "nm", "65 nm", 0, 0, NULL, "a length"},
#endif
#ifdef BAD_TWICE
    {"size", OPC_REAL, 0, "nm", "65 nm", 0, 0, NULL, "a length"},
#endif
};

static int rule(void *self, const opc_printed *printed, opc_ruling *ruling,
                opc_error *error) {
  (void)self, (void)printed, (void)ruling, (void)error;
  return OPC_OK;
}

#ifndef BAD_FUNCTION
static int violations(void *self, const opc_printed *printed,
                      opc_violation *list, size_t room, size_t *count,
                      opc_error *error) {
  (void)self, (void)printed, (void)list, (void)room, (void)error;
  *count = 0;
  return OPC_OK;
}
#endif

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  (void)values, (void)error;
  return host->alloc(host, 1, 1);
}

static void destroy(void *self) { free(self); }

static const opc_regulator operations = {
#ifdef BAD_OPERATIONS
    .size = 8,
#else
    .size = sizeof operations,
#endif
    .rule = rule,
#ifndef BAD_FUNCTION
    .violations = violations,
#endif
};

#ifdef BAD_RENAME
static const void *get_extension(const char *id) {
  static const opc_rename old = {"length", "width", "1.1.0", NULL};
  static const opc_renames renames = {sizeof renames, 1, sizeof old, &old};
  return strcmp(id, OPC_RENAMED_PARAMETERS) ? NULL : &renames;
}
#endif

static const opc_plugin plugin = {
#ifdef BAD_SIZE
    .size = sizeof plugin - 8,
#else
    .size = sizeof plugin,
#endif
#ifdef BAD_MAJOR
    .abi_major = OPC_ABI_MAJOR + 1,
    .id = (const char *)1, /* must not be looked at */
#else
    .abi_major = OPC_ABI_MAJOR,
    .id = BAD_ID,
#endif
    .abi_minor = OPC_ABI_MINOR + 1,
    .version = "1.0.0",
    .licence = "BSD-3-Clause",
    .summary = "Not what it seems",
#ifdef BAD_KIND
    .kind = 99,
#else
    .kind = OPC_KIND_DRC,
#endif
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
#ifdef BAD_RENAME
    .get_extension = get_extension,
#endif
};

#ifdef BAD_ENTRY
#define opcflow_plugin opcflow_plug
#endif

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
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
