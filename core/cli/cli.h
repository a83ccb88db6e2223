/* SPDX-License-Identifier: BSD-3-Clause */
/* The opcflow command: what its verbs share. docs/command.md tells its use. */
#ifndef OPCFLOW_CORE_CLI_H
#define OPCFLOW_CORE_CLI_H

#include <json-glib/json-glib.h>

#include "core/flow/problem.h"
#include "core/plugin/registry.h"

enum {
  CLI_GOOD = 0,
  CLI_LIMIT = 1,    /* a limit or comparison failed */
  CLI_USAGE = 2,    /* usage, or an invalid flow */
  CLI_PLUGIN = 3,   /* missing or incompatible */
  CLI_STEP = 4,     /* a step failed */
  CLI_IO = 5,       /* input or output */
  CLI_STOPPED = 130 /* Ctrl-C */
};

/* The exit code of an OPC_* code. */
int cli_exit_code(int code);

/* What stands on a command line: for each option one of `flag`, `text`,
   `list`. `argument` is its name in the help, NULL for a flag. */
typedef struct cli_option {
  const char *name; /* without dashes */
  const char *argument;
  const char *help;
  gboolean *flag;
  const char **text;
  GPtrArray *list;
} cli_option;

typedef struct cli_verb {
  const char *name;
  const char *arguments; /* "FLOW" */
  const char *summary;
  /* The work. `argv` as main got it. */
  int (*run)(const struct cli_verb *verb, int argc, char **argv);
  const char *words; /* what the first argument may be, with | between; NULL */
  gboolean hidden;   /* for shells, not for people */
} cli_verb;

extern const cli_verb cli_run, cli_check, cli_plugins, cli_inspect, cli_lint,
    cli_schema, cli_new, cli_version, cli_help, cli_complete;

/* All verbs, NULL-terminated; the hidden ones come last. */
extern const cli_verb *const cli_verbs[];
const cli_verb *cli_find_verb(const char *name);

/* Tell what a verb takes: `options` and `common` are those of the verb and of
   all, and end with an empty one. */
typedef void (*cli_teller)(const cli_verb *verb, const cli_option *options,
                           const cli_option *common, void *data);

/* Have `tell` called with the options of a verb. */
void cli_ask(const cli_verb *verb, cli_teller tell, void *data);

/* Print the manual page of a verb, of the command itself for NULL; roff. */
void cli_print_manual(const cli_verb *verb);

/* Read options and at least `least`, at most `most` other arguments, which are
   put into `rest`. -1 to go on; otherwise the exit code, everything being said
   (--help, --plugin-path and wrong usage are dealt with). `options` ends with
   an empty one; may be NULL. */
int cli_parse(const cli_verb *verb, int argc, char **argv,
              const cli_option *options, guint least, guint most,
              GPtrArray *rest);

/* The folders of --plugin-path so far, for opc_registry_new. */
const char *const *cli_plugin_path(void);

/* All plugins that can be used, by id: const opc_plugin *. */
GPtrArray *cli_usable_plugins(opc_registry *registry);

/* How long one plugin may take to load, s. */
#define CLI_PATIENCE 10.0

/* ---- messages on standard error ---- */

/* "error: ...", "warning: ..." with colour on a terminal. */
void cli_message(const char *kind, const char *format, ...) OPC_PRINTF(2, 3);

/* What is no fault, but should be changed. */
void cli_warnings(const opc_problems *problems);

/* All problems; the exit code that they stand for. */
int cli_problems(opc_problems *problems);

/* Those problems as they are found in JSON documents: a list of { file, line,
   column, message, exit }; file, line and column are left out where there is
   none. */
JsonNode *cli_problems_json(opc_problems *problems);

/* Whether to move a cursor. */
gboolean cli_is_terminal(void);

/* ---- standard output ---- */

void cli_print(const char *format, ...) OPC_PRINTF(1, 2);
void cli_print_json(JsonNode *node); /* takes the node */

/* CLI_GOOD, or CLI_IO and a message if standard output could not take it all.
 */
int cli_finish(int code);

#endif
