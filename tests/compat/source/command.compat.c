/* SPDX-License-Identifier: BSD-3-Clause */
/* A verb that publishes how many arguments it has. */
#include "compat.h"

static int run(void *self, size_t n, const char *const *arguments,
               opc_error *error) {
  const plain *p = (const plain *)self;
  const int64_t count = (int64_t)n;
  const opc_column columns[] = {{"arguments", NULL, OPC_INT, 0, &count},
                                {"first", NULL, OPC_TEXT, 0, arguments}};
  return opc_put_table(p->host, "compat", OPC_TABLE_PRINT, n > 0, columns, 2,
                       error);
}

static const opc_command functions = {.arguments = "WORD ...", .run = run};

COMPAT_PLAIN("command.compat", "command");
