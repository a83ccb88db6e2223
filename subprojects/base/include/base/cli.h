/* SPDX-License-Identifier: BSD-3-Clause */
/* Messages and output of a command, and the options on its command line. All
   functions are [main] but cli_message. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* ---- messages on standard error ---- */

/* Write "error: ...", "warning: ..." with colour on a terminal; the message
   alone if `kind` is NULL. [any] */
void cli_message(const char *kind, const char *format, ...) OPC_PRINTF(2, 3);

/* Write an error message; FALSE. */
#define cli_refuse(...) (cli_message("error", __VA_ARGS__), FALSE)

/* From now on write and print nothing: another process does. */
void cli_be_silent(void);

/* Return whether to move a cursor. */
gboolean cli_is_terminal(void);

/* ---- standard output ---- */

/* Keep standard output for the functions below: what others print, plugins and
   what they start, goes to standard error. First of all. */
void cli_keep_output(void);

/* Undo that, before this process becomes another program. */
void cli_return_output(void);

/* Print a text; characters that are not printable are escaped. */
void cli_print(const char *format, ...) OPC_PRINTF(1, 2);

/* Print a text as it is. */
void cli_write(const char *text);

/* Return COLUMNS or the width of the terminal; SIZE_MAX for any width. */
size_t cli_width(void);

/* What was printed comes before the messages that follow. */
void cli_flush(void);

/* Return whether standard output took it all; FALSE and a message. */
gboolean cli_is_written(void);

/* ---- options ---- */

/* An option of a command line. One of `flag`, `text` and `list` takes it:
   variables of the verb, as a process runs one. A list ends with NULL; it is
   NULL itself where nothing was given. */
typedef struct cli_option {
  const char *name; /* without dashes; NULL ends a table of options */
  const char *help;
  const char *argument; /* its name in the help; NULL: a flag */
  gboolean *flag;
  const char **text;
  GPtrArray **list;
} cli_option;

/* Take the option at words[*i] of n, by tables of options that end with NULL.
   FALSE and a message, which names the verb. */
gboolean cli_take_option(const cli_option *const *tables, const char *verb,
                         guint n, char **words, guint *i);

/* Print a line of the help for "name value", and for each option of a table,
   which may be NULL. */
void cli_print_pair(const char *name, const char *value, const char *summary);
void cli_print_options(const cli_option *options);

/* Return what a list of options took, NULL-terminated. */
const char *const *cli_list(GPtrArray *list);
