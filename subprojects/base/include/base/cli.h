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

<<<<<<< HEAD
/* Suppress all messages and output from now on; another process prints. */
=======
/* Suppress all later output, because another process writes. */
>>>>>>> int
void cli_be_silent(void);

/* Return whether the cursor of a terminal can be moved. */
gboolean cli_is_terminal(void);

/* ---- standard output ---- */

<<<<<<< HEAD
/* Reserve standard output for the functions below. Other output, of plugins and
   child processes, goes to standard error. Call first. */
void cli_keep_output(void);

/* Undo cli_keep_output, before this process executes another program. */
=======
/* Keep standard output for the functions below: the output of plugins and of
   programs they start is redirected to standard error. Call before everything
   else. */
void cli_keep_output(void);

/* Restore standard output before this process executes another program. */
>>>>>>> int
void cli_return_output(void);

/* Print a text; characters that are not printable are escaped. */
void cli_print(const char *format, ...) OPC_PRINTF(1, 2);

/* Print a text unchanged. */
void cli_write(const char *text);

/* Return COLUMNS or the width of the terminal; SIZE_MAX for unlimited width. */
size_t cli_width(void);

<<<<<<< HEAD
/* Flush standard output, so that later messages appear after it. */
void cli_flush(void);

/* Return whether all standard output was written; on failure write a message
   and return FALSE. */
=======
/* Flush standard output, so that it precedes later messages. */
void cli_flush(void);

/* Return whether all output was written; FALSE and a message otherwise. */
>>>>>>> int
gboolean cli_is_written(void);

/* ---- options ---- */

<<<<<<< HEAD
/* An option of a command line. One of `flag`, `text` and `list` points to the
   variable that receives the value. A list ends with NULL; the pointer is NULL
   if the option was not given. */
typedef struct cli_option {
  const char *name; /* without dashes; NULL ends a table of options */
  const char *help;
  const char *argument; /* name of the value in the help; NULL: a flag */
=======
/* An option of a command line. One of `flag`, `text` and `list` is the address
   of a variable that receives the value. A list ends with NULL; an unused list
   is NULL. */
typedef struct cli_option {
  const char *name; /* without dashes; NULL ends a table of options */
  const char *help;
  const char *argument; /* name of its argument in the help; NULL: a flag */
>>>>>>> int
  gboolean *flag;
  const char **text;
  GPtrArray **list;
} cli_option;

<<<<<<< HEAD
/* Parse the option at words[*i] of n by tables of options, each ending with
   NULL. On failure write a message with the verb and return FALSE. */
=======
/* Read the option at words[*i] of n, by tables of options that end with NULL.
   Return FALSE after a message, which names the verb. */
>>>>>>> int
gboolean cli_take_option(const cli_option *const *tables, const char *verb,
                         guint n, char **words, guint *i);

/* Print a line of the help for "name value"; the second prints all options of a
   table, which may be NULL. */
void cli_print_pair(const char *name, const char *value, const char *summary);
void cli_print_options(const cli_option *options);

/* Return the values of a list option, NULL-terminated. */
const char *const *cli_list(GPtrArray *list);
