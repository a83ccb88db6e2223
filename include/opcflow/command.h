/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "command": a verb of the command line. The plugin "command.NAME" is
   called as `opcflow NAME [OPTION ...] [ARGUMENT ...]`. Each parameter of the
   plugin is an option: `max_cases` is `--max-cases VALUE`, with VALUE in the
   notation of a flow. An OPC_BOOL is a switch: `--quiet`. The host generates
   help, completion and manual page from the descriptor. It prints the tables,
   metrics and messages of the command as text or, with `--json`, as one JSON
   object. [main]: see plugin.h. */
#ifndef OPCFLOW_COMMAND_H
#define OPCFLOW_COMMAND_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* Functions of a command. */
typedef struct opc_command {
  const char *arguments; /* shown in the help text: "RUN ..."; NULL if there are
                            no arguments */

  /* Run the command on `n` arguments. Returns the exit code of the process;
     fills *error if the command fails. [main] */
  int (*run)(void *self, size_t n, const char *const *arguments,
             opc_error *error);
  OPC_MAY_GROW
} opc_command;

OPC_C_END
#endif
