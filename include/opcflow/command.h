/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "command": a verb of the command line. The plugin "command.NAME" is
   called as `opcflow NAME [OPTION ...] [ARGUMENT ...]`. Its parameters are its
   options: `max_cases` is `--max-cases VALUE`, written as in a flow, and one of
   the type OPC_BOOL is `--quiet`. Help, completion and manual page come from
   the declaration. Tables, metrics and messages are shown, or are one JSON
   object with `--json`. */
#ifndef OPCFLOW_COMMAND_H
#define OPCFLOW_COMMAND_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

typedef struct opc_command {
  const char *arguments; /* for help: "RUN ..."; NULL: it takes none */

  /* Do the work; the code becomes the exit code. [main] */
  int (*run)(void *self, size_t n, const char *const *arguments,
             opc_error *error);
  OPC_MAY_GROW
} opc_command;

OPC_C_END
#endif
