/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "command": a verb of the command line. The plugin "command.NAME" is
   called as `opcflow NAME [OPTION ...] [ARGUMENT ...]`. The plugin's parameters
   are the options: `max_cases` is `--max-cases VALUE`, written as in a flow; a
   parameter of the type OPC_BOOL is a switch, `--quiet`. Help, completion and
   manual page are made from the declaration. The host prints tables, metrics
   and messages as text, or as one JSON object with `--json`. */
#ifndef OPCFLOW_COMMAND_H
#define OPCFLOW_COMMAND_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

typedef struct opc_command {
  const char *arguments; /* for the help text: "RUN ..."; NULL: no arguments */

  /* Run the command on `n` arguments. Returns the exit code; on failure *error
     is filled. [main] */
  int (*run)(void *self, size_t n, const char *const *arguments,
             opc_error *error);
  OPC_MAY_GROW
} opc_command;

OPC_C_END
#endif
