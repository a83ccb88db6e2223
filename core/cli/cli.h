/* SPDX-License-Identifier: BSD-3-Clause */
/* The opcflow command: what its verbs share. docs/reference/command.md tells
 * its use. */
#pragma once

#include <base/cli.h>
#include <base/problem.h>
#include <json-glib/json-glib.h>

#include "core/binding/flow.h"
#include "core/plugin/registry.h"
#include "core/report/table.h"

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

/* ---- verbs ---- */

typedef struct cli_verb cli_verb;
struct cli_verb {
  const char *name;
  const char *arguments; /* "FLOW" */
  const char *summary;
  const cli_option *options; /* the last one is empty; NULL: none */
  guint least, most;         /* how many arguments it takes */
  /* The work, with all options read; returns the exit code. NULL: another
     program has it. */
  int (*run)(const cli_verb *verb, const GPtrArray *arguments);
  const char *words; /* what the first one may be, with | between; NULL */
  gboolean hidden;   /* for shells, not for people */
  const opc_plugin *plugin; /* that brings the verb; NULL: the command's own */
};

extern const cli_verb cli_run, cli_check, cli_version, cli_help;

/* Verbs of the program opcflow-devel (tools/devel), as the help shows them. */
#define CLI_DEVEL "opcflow-devel"
#define CLI_CACHE                                       \
  .name = "cache", .arguments = "[clear | limit SIZE]", \
  .summary = "Show or limit the results that are kept", .words = "clear|limit"
#define CLI_EXPLAIN \
  .name = "explain", .arguments = "RUN", .summary = "Why each step of a run ran"
#define CLI_PLUGINS \
  .name = "plugins", .arguments = "", .summary = "List the plugins"
#define CLI_INSPECT \
  .name = "inspect", .arguments = "ID", .summary = "Tell all about a plugin"
#define CLI_LINT                            \
  .name = "lint", .arguments = "PLUGIN.so", \
  .summary = "Check that a plugin keeps the contract"
#define CLI_SCHEMA                   \
  .name = "schema", .arguments = "", \
  .summary = "Write a JSON Schema of flow files, for editors"
#define CLI_NEW                                                          \
  .name = "new", .arguments = "plugin NAME [DIR] | flow [INPUT] [FILE]", \
  .summary = "Write a plugin or a flow to begin with"
#define CLI_COMPLETE                       \
  .name = "complete", .arguments = "LINE", \
  .summary = "What may stand at the end of a line", .hidden = TRUE

/* The program's verbs, NULL-terminated; the hidden ones come last. Each program
   defines its own. */
extern const cli_verb *const cli_verbs[];

/* Run the verb that a command line names; returns the exit code. */
int cli_main(int argc, char **argv);

/* Replace this process by opcflow-devel, with the same words. Returns an exit
   code if there is no such program. */
int cli_run_devel(const cli_verb *verb);

/* Replace this process by a program, with the same words. Returns if that
   fails. */
void cli_become(const char *program);

/* A verb, one of the command's own or of a plugin, which is loaded; NULL and
 *error if there is none. */
const cli_verb *cli_find_verb(const char *name, opc_error *error);

/* The names of all verbs that are not hidden (char *, freed with the array). */
GPtrArray *cli_verb_names(void);

/* The verb of the plugin "command.NAME"; NULL and *error. */
const cli_verb *cli_plugin_verb(const char *name, opc_error *error);

/* The whole command line, "opcflow" and the verb first; NULL-terminated. */
const char *const *cli_command_line(void);

/* ---- options ---- */

/* The options that every verb takes. */
extern const cli_option cli_common_options[];

/* Read the words behind the verb: what is no option is put into `rest`. -1 to
   go on; otherwise the exit code, everything being said (--help, --version and
   wrong usage are dealt with). */
int cli_parse(const cli_verb *verb, guint n, char **words, GPtrArray *rest);

void cli_print_help(const cli_verb *verb);

/* The flow of a verb: its first argument, or flow.yaml where one lies in the
   current folder; NULL, and it is told that there is none. */
const char *cli_flow(const cli_verb *verb, const GPtrArray *arguments);

/* A required file that a step of a flow was not given. */
typedef struct cli_open_file {
  char *path;          /* "step.parameter", "step.slot.parameter" */
  const char *summary; /* the plugin's */
} cli_open_file;

/* All of a flow (cli_open_file, freed with the array), which may have
   problems. */
GArray *cli_open_files(const opc_flow *flow);

/* The value of --threads, NULL for none. -1, or the exit code. */
int cli_set_threads(const char *text);

/* ---- plugins ---- */

/* Take the folders of all --plugin-path, wherever they stand. */
void cli_take_plugin_path(guint n, char **words);

/* Look into that folder before all others. Before the first cli_registry. */
void cli_look_first(const char *folder);

/* The plugins of those folders and of the standard ones. */
opc_registry *cli_registry(void);

/* How long one plugin may take to load, s. */
#define CLI_PATIENCE 10.0

/* Whether the user asked to stop (stop_on_signals), for opc_watch. */
int cli_is_stopped(void *unused);

/* ---- messages on standard error ---- */

/* An error that ends the command with `code`. */
#define cli_error(code, ...) (cli_message("error", __VA_ARGS__), (code))

/* The same of a library's error. */
int cli_fail(const opc_error *error);

/* All problems; the exit code that they stand for. */
int cli_problems(opc_problems *problems);

/* ---- standard output ---- */

/* A table that fits the terminal; of any width if `cli_wide`, as --wide says.
 */
extern gboolean cli_wide;
void cli_print_table(const opc_table *table);

/* A table of texts under `names`: `cells` has its rows, one after another. */
void cli_print_rows(const char *const *names, size_t n, const GPtrArray *cells);

/* JSON; both are taken. */
void cli_print_object(JsonObject *object);
void cli_print_array(JsonArray *array);

/* Add the member "problems" as documents have it: a list of { file, line,
   column, message, exit }; file, line and column are left out where there is
   none. */
void cli_add_problems(JsonObject *object, opc_problems *problems);

/* Add a list of texts. */
void cli_add_texts(JsonObject *object, const char *name,
                   const GPtrArray *texts);

/* CLI_GOOD, or CLI_IO and a message if standard output could not take it all.
 */
int cli_finish(int code);
