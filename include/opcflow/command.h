/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "command": a verb of the command line. The plugin "command.NAME" is
   called as `opcflow NAME [OPTION ...] [ARGUMENT ...]`. Each parameter of the
   plugin is an option: `max_cases` is `--max-cases VALUE`, with VALUE in the
   notation of a flow. An OPC_BOOL is a switch: `--quiet`. The host generates
   help, completion and manual page from the descriptor, and prints tables,
   metrics and messages as text or, with `--json`, as one JSON object. */
#ifndef OPCFLOW_COMMAND_H
#define OPCFLOW_COMMAND_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

typedef struct opc_command {
  const char *arguments; /* shown in the help text: "RUN ..."; NULL if there are
                            no arguments */

  /* Run the command on `n` arguments. Returns the exit code; on failure *error
     is filled. [main] */
  int (*run)(void *self, size_t n, const char *const *arguments,
             opc_error *error);
  OPC_MAY_GROW
} opc_command;

OPC_C_END
#endif
