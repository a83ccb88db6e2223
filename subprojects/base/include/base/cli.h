/* SPDX-License-Identifier: BSD-3-Clause */
/* Messages and output of a command, and the options on its command line. All
   functions are [main] except cli_message. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* ---- messages on standard error ---- */

/* Write "error: ...", "warning: ..." with colour on a terminal; the message
   alone if `kind` is NULL. [any] */
void cli_message(const char *kind, const char *format, ...) OPC_PRINTF(2, 3);

/* Write an error message and return FALSE. */
#define cli_refuse(...) (cli_message("error", __VA_ARGS__), FALSE)

/* Suppress all later output, because another process writes. */
void cli_be_silent(void);

/* Return whether to move a cursor. */
gboolean cli_is_terminal(void);

/* ---- standard output ---- */

/* Keep standard output for the functions below: the output of plugins and of
   programs they start is redirected to standard error. Call before everything
   else. */
void cli_keep_output(void);

/* Restore standard output before this process executes another program. */
void cli_return_output(void);

/* Print a text; characters that are not printable are escaped. */
void cli_print(const char *format, ...) OPC_PRINTF(1, 2);

/* Print a text unchanged. */
void cli_write(const char *text);

/* Return COLUMNS or the width of the terminal; SIZE_MAX for unlimited width. */
size_t cli_width(void);

/* Flush standard output, so that later messages follow. */
void cli_flush(void);

/* Return whether all output was written; FALSE and a message otherwise. */
gboolean cli_is_written(void);

/* ---- options ---- */

/* An option of a command line. One of `flag`, `text` and `list` is the address
   of a variable that receives the value. A list ends with NULL; an unused list
   is NULL. */
typedef struct cli_option {
  const char *name; /* without dashes; NULL ends a table of options */
  const char *help;
  const char *argument; /* name of the argument in the help; NULL: a flag */
  gboolean *flag;
  const char **text;
  GPtrArray **list;
} cli_option;

/* Read the option at words[*i] of n, by tables of options that end with NULL.
   Return FALSE after a message, which names the verb. */
gboolean cli_take_option(const cli_option *const *tables, const char *verb,
                         guint n, char **words, guint *i);

/* Print a line of the help for "name value", and for each option of a table,
   which may be NULL. */
void cli_print_pair(const char *name, const char *value, const char *summary);
void cli_print_options(const cli_option *options);

/* Return the values of a list option, NULL-terminated. */
const char *const *cli_list(GPtrArray *list);
