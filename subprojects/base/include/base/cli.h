/* SPDX-License-Identifier: BSD-3-Clause */
/* Messages and output of the command `opcflow`, and options on its command
   line. All functions but cli_message are [main]: see opcflow/plugin.h. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* ---- messages on standard error ---- */

/* Write the line "KIND: message", where KIND is `kind` ("error", "warning"),
   with colour on a terminal; without "KIND: " if `kind` is NULL. [any] */
void cli_message(const char *kind, const char *format, ...) OPC_PRINTF(2, 3);

/* Write an error message and return FALSE. */
#define cli_refuse(...) (cli_message("error", __VA_ARGS__), FALSE)

/* Suppress all later output of this process. For all but the first of several
   processes that run one flow together, which would print the same output. */
void cli_be_silent(void);

/* Return whether messages go to a terminal whose cursor can be moved. */
gboolean cli_is_terminal(void);

/* ---- standard output ---- */

/* Reserve standard output for the functions below; redirect the output of
   plugins, and of programs that they start, to standard error. Call first. */
void cli_keep_output(void);

/* Restore standard output, before this process executes another program. */
void cli_return_output(void);

/* Print a text with escapes for characters that are not printable. */
void cli_print(const char *format, ...) OPC_PRINTF(1, 2);

/* Print a text unchanged. */
void cli_write(const char *text);

/* Return COLUMNS or the width of the terminal, characters; SIZE_MAX if the
   width is unlimited. */
size_t cli_width(void);

/* Flush standard output before a message is written. */
void cli_flush(void);

/* Return TRUE if all output was written; otherwise write a message. */
gboolean cli_is_written(void);

/* ---- options ---- */

/* An option of a command line. One of `flag`, `text` and `list` is the address
   of a variable that receives the value; initialise the variable. Arguments are
   not copied. Read *list by cli_list; it stays NULL if the option is not used,
   otherwise the caller frees the array. */
typedef struct cli_option {
  const char *name;     /* without dashes; NULL ends a table of options */
  const char *help;     /* one line for --help */
  const char *argument; /* name of the argument in the help; NULL for a flag */
  gboolean *flag;       /* set to TRUE */
  const char **text;    /* set to the argument */
  GPtrArray **list;     /* collects the arguments; the option may be repeated */
} cli_option;

/* Read the option at words[*i] of n words and advance *i to the last word of
   the option. `tables` is a NULL-terminated list of tables. On failure, write a
   message that names `verb` and return FALSE. */
gboolean cli_take_option(const cli_option *const *tables, const char *verb,
                         guint n, char **words, guint *i);

/* cli_print_pair: print one line of the help, "name value" and a summary.
   cli_print_options: print one line for each option of a table, which may be
   NULL. */
void cli_print_pair(const char *name, const char *value, const char *summary);
void cli_print_options(const cli_option *options);

/* Return the values of a list option, NULL-terminated: the array of `list`,
   which the function terminates, or an empty list if `list` is NULL. */
const char *const *cli_list(GPtrArray *list);
