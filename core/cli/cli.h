/* SPDX-License-Identifier: BSD-3-Clause */
/* The opcflow command: functions shared by the verbs. The user's view is
   described in docs/reference/command.md. */
#pragma once

#include <base/cli.h>
#include <base/problem.h>
#include <json-glib/json-glib.h>

#include "core/binding/flow.h"
#include "core/plugin/registry.h"
#include "core/report/table.h"

/* Exit codes. */
enum {
  CLI_GOOD = 0,
  CLI_LIMIT = 1,    /* a limit or comparison failed */
  CLI_USAGE = 2,    /* wrong usage, or an invalid flow */
  CLI_PLUGIN = 3,   /* a plugin is missing or incompatible */
  CLI_STEP = 4,     /* a step failed */
  CLI_IO = 5,       /* input or output failed */
  CLI_STOPPED = 130 /* Ctrl-C */
};

/* Return the exit code of an OPC_* code. */
int cli_exit_code(int code);

/* ---- verbs ---- */

/* A verb, the first word of a command line: "run", "check". */
typedef struct cli_verb cli_verb;
struct cli_verb {
  const char *name;
  const char *arguments; /* "FLOW" */
  const char *summary;
  const cli_option *options; /* ends with an empty element; may be NULL */
  guint least, most;         /* limits of the number of arguments */
  /* Run the verb after the options are read; returns the exit code. NULL if the
     verb belongs to another program. */
  int (*run)(const cli_verb *verb, const GPtrArray *arguments);
  const char *words;        /* choices of the first argument, separated by |; or
                               NULL */
  gboolean hidden;          /* for shell completion, not in help */
  const opc_plugin *plugin; /* plugin of the verb; NULL if built in */
};

extern const cli_verb cli_run, cli_check, cli_version, cli_help;

/* Texts for the verbs of the program opcflow-devel (tools/devel). */
#define CLI_DEVEL "opcflow-devel"
#define CLI_CACHE                                         \
  .name = "cache", .arguments = "[clear | limit SIZE]",   \
  .summary = "Show, clear or limit the store of results", \
  .words = "clear|limit"
#define CLI_EXPLAIN                      \
  .name = "explain", .arguments = "RUN", \
  .summary = "Show why each step of a run ran"
#define CLI_PLUGINS \
  .name = "plugins", .arguments = "", .summary = "List the plugins"
#define CLI_INSPECT                     \
  .name = "inspect", .arguments = "ID", \
  .summary = "Show the declaration of a plugin"
#define CLI_LINT                            \
  .name = "lint", .arguments = "PLUGIN.so", \
  .summary = "Check a plugin against the contract of its kind"
#define CLI_SCHEMA                   \
  .name = "schema", .arguments = "", \
  .summary = "Write a JSON Schema of flow files, for editors"
#define CLI_NEW                                                        \
  .name = "new",                                                       \
  .arguments =                                                         \
      "plugin NAME [DIR] | flow [INPUT] [FILE] | comparison INPUT...", \
  .summary = "Write a new plugin, flow or comparison from a template"
#define CLI_COMPLETE                       \
  .name = "complete", .arguments = "LINE", \
  .summary = "Print completions of a command line", .hidden = TRUE

/* Verbs of the program, NULL-terminated, hidden verbs last. Each program
   defines this array. */
extern const cli_verb *const cli_verbs[];

/* Run the verb named on a command line and return the exit code. */
int cli_main(int argc, char **argv);

/* Replace this process by opcflow-devel with the same arguments. Returns an
   exit code if the program is not installed. */
int cli_run_devel(const cli_verb *verb);

/* Replace this process by a program with the same arguments, or return. */
void cli_become(const char *program);

/* Return the verb `name`, built in or of a plugin; the plugin of the verb is
   loaded. NULL and *error if unknown. */
const cli_verb *cli_find_verb(const char *name, opc_error *error);

/* Return the names of all visible verbs (char *, freed with the array). */
GPtrArray *cli_verb_names(void);

/* Return the verb of the plugin "command.NAME"; NULL and *error if missing. */
const cli_verb *cli_plugin_verb(const char *name, opc_error *error);

/* Return the whole command line, beginning with "opcflow" and the verb;
   NULL-terminated. */
const char *const *cli_command_line(void);

/* ---- options ---- */

/* Options common to all verbs. */
extern const cli_option cli_common_options[];

/* Read the words after the verb and put the arguments into `rest`. Returns -1
   to continue; otherwise the exit code, after --help, --version or wrong usage
   has been handled. */
int cli_parse(const cli_verb *verb, guint n, char **words, GPtrArray *rest);

/* Print the help text of a verb. */
void cli_print_help(const cli_verb *verb);

/* Return the flow of a verb: the first argument, or flow.yaml if the current
   folder has one. NULL after an error message. */
const char *cli_flow(const cli_verb *verb, const GPtrArray *arguments);

/* A required file that a step of a flow lacks. */
typedef struct cli_open_file {
  char *path;          /* "step.parameter", "step.slot.parameter" */
  const char *summary; /* summary of the parameter */
} cli_open_file;

/* Return all missing files of a flow, which may have problems (cli_open_file,
   freed with the array). */
GArray *cli_open_files(const opc_flow *flow);

/* Return the variants chosen by --variant (char *, owned by the recipe or
   `given`; NULL for the flow itself). Without --variant: the flow and, if
   `every` is set, all variants. Adds a problem for an unknown name. `recipe`
   may be NULL. */
GPtrArray *cli_choose_variants(const opc_recipe *recipe, GPtrArray *given,
                               gboolean every, opc_problems *problems);

/* Set the number of threads from the text of --threads, NULL if not given.
   Returns -1 to continue, or the exit code after a message. */
int cli_set_threads(const char *text);

/* ---- plugins ---- */

/* Read the folders of all --plugin-path options, at any position. */
void cli_take_plugin_path(guint n, char **words);

/* Make `folder` the first folder of the search. Call before cli_registry. */
void cli_look_first(const char *folder);

/* Return the registry of the folders of --plugin-path and of the standard
   folders. */
opc_registry *cli_registry(void);

/* Longest time for loading one plugin, s. */
#define CLI_PATIENCE 10.0

/* Return whether the user asked to stop (stop_on_signals); for opc_watch. */
int cli_is_stopped(void *unused);

/* ---- messages on standard error ---- */

/* Print an error message and return the exit code `code`. */
#define cli_error(code, ...) (cli_message("error", __VA_ARGS__), (code))

/* Print the error of a library and return the exit code. */
int cli_fail(const opc_error *error);

/* Print all problems and return their exit code. */
int cli_problems(opc_problems *problems);

/* ---- standard output ---- */

/* Print a table that fits the terminal, or at full width if `cli_wide` is set
   (--wide). */
extern gboolean cli_wide;
void cli_print_table(const opc_table *table);

/* Print a table of texts under the headings `names`; `cells` has the rows one
   after another. */
void cli_print_rows(const char *const *names, size_t n, const GPtrArray *cells);

/* Print JSON; takes ownership of the object. */
void cli_print_object(JsonObject *object);
void cli_print_array(JsonArray *array);

/* Add the member "problems": a list of { file, line, column, message, exit };
   file, line and column are omitted if unknown. */
void cli_add_problems(JsonObject *object, opc_problems *problems);

/* Add a list of texts. */
void cli_add_texts(JsonObject *object, const char *name,
                   const GPtrArray *texts);

/* Return `code`, or CLI_IO and a message if output could not be written. */
int cli_finish(int code);
