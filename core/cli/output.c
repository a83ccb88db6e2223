/* SPDX-License-Identifier: BSD-3-Clause */
/* What the command says on standard error and on standard output. */
#include <base/shown.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "core/cli/cli.h"
#include "core/report/json.h"

int cli_exit_code(int code) {
  switch (code) {
    case OPC_OK:
      return CLI_GOOD;
    case OPC_INVALID:
      return CLI_USAGE;
    case OPC_NO_PLUGIN:
      return CLI_PLUGIN;
    case OPC_IO:
      return CLI_IO;
    case OPC_LIMIT:
      return CLI_LIMIT;
    default:
      return CLI_STEP;
  }
}

static gboolean silent;

void cli_be_silent(void) { silent = TRUE; }

/* ---- standard error ---- */

gboolean cli_is_terminal(void) {
  const char *terminal = g_getenv("TERM");
  return isatty(STDERR_FILENO) && g_strcmp0(terminal, "dumb");
}

static gboolean has_colour(void) {
  const char *none = g_getenv("NO_COLOR");
  return cli_is_terminal() && !(none && *none);
}

void cli_message(const char *kind, const char *format, ...) {
  va_list args;
  va_start(args, format);
  g_autofree char *said = g_strdup_vprintf(format, args);
  va_end(args);
  g_autofree char *text = opc_shown(said, "");
  const char *colour = strcmp(kind, "error") ? "\033[33m" : "\033[31m";
  gboolean coloured = has_colour();
  if (silent) return;
  fprintf(stderr, "%s%s:%s %s\n", coloured ? colour : "", kind,
          coloured ? "\033[0m" : "", text);
}

int cli_fail(const opc_error *error) {
  return cli_error(cli_exit_code(error->code), "%s", error->message);
}

int cli_problems(opc_problems *problems) {
  int code = opc_problems_code(problems);
  opc_problems_sort(problems);
  for (guint i = 0; i < problems->list->len && !silent; i++) {
    const opc_problem *problem = problems->list->pdata[i];
    g_autofree char *text = opc_problem_text(problem);
    if (problem->at.file)
      fprintf(stderr, "%s\n", text);
    else
      cli_message("error", "%s", text);
  }
  return cli_exit_code(code);
}

/* ---- standard output ---- */

enum { FIRST_OWN = 100 }; /* of descriptors: above those that others count on */

static FILE *out;

/* A stream that came closed would be the next file that somebody opens. It
   still can be neither read nor written. */
static void hold_places(void) {
  for (int i = STDIN_FILENO; i <= STDERR_FILENO; i++)
    if (fcntl(i, F_GETFD) < 0)
      (void)open("/dev/null", i == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

void cli_keep_output(void) {
  hold_places();
  int kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, FIRST_OWN);
  out = kept < 0 ? NULL : fdopen(kept, "w");
  if (!out) out = stdout; /* so few files may be open */
  if (out == stdout) return;
  dup2(STDERR_FILENO, STDOUT_FILENO);
  setvbuf(stdout, NULL, _IOLBF, 0);
}

void cli_return_output(void) {
  fflush(out);
  dup2(fileno(out), STDOUT_FILENO);
}

void cli_print(const char *format, ...) {
  va_list args;
  va_start(args, format);
  g_autofree char *said = g_strdup_vprintf(format, args);
  va_end(args);
  g_autofree char *text = opc_shown(said, "\n\t");
  if (!silent) fputs(text, out);
}

gboolean cli_wide;

/* COLUMNS, or the terminal's; what is no terminal takes any width. */
static size_t width_of_output(void) {
  const char *columns = g_getenv("COLUMNS");
  struct winsize size;
  guint64 told;
  if (columns &&
      g_ascii_string_to_unsigned(columns, 10, 1, 100000, &told, NULL))
    return (size_t)told;
  if (isatty(fileno(out)) && !ioctl(fileno(out), TIOCGWINSZ, &size) &&
      size.ws_col)
    return size.ws_col;
  return SIZE_MAX;
}

void cli_print_table(const opc_table *table) {
  g_autofree char *text =
      opc_table_text(table, cli_wide ? 0 : width_of_output());
  cli_print("%s", text);
}

void cli_print_rows(const char *const *names, size_t n,
                    const GPtrArray *cells) {
  size_t rows = cells->len / n;
  g_autofree const char **data = g_new0(const char *, cells->len);
  g_autofree opc_column *columns = g_new0(opc_column, n);
  for (size_t i = 0; i < n; i++) {
    columns[i] = (opc_column){names[i], NULL, OPC_TEXT, 0, data + i * rows};
    for (size_t row = 0; row < rows; row++)
      data[i * rows + row] = cells->pdata[row * n + i];
  }
  if (!rows) return;
  opc_error error;
  opc_table *table =
      opc_table_new("rows", 0, rows, columns, n, sizeof *columns, &error);
  cli_print_table(table);
  opc_table_free(table);
}

static void print_json(JsonNode *node) {
  g_autofree char *text = opc_json_text(node);
  if (!silent) fputs(text, out);
}

void cli_print_object(JsonObject *object) {
  JsonNode *node = json_node_new(JSON_NODE_OBJECT);
  json_node_take_object(node, object);
  print_json(node);
}

void cli_print_array(JsonArray *array) {
  JsonNode *node = json_node_new(JSON_NODE_ARRAY);
  json_node_take_array(node, array);
  print_json(node);
}

void cli_add_problems(JsonObject *object, opc_problems *problems) {
  JsonArray *list = json_array_new();
  opc_problems_sort(problems);
  for (guint i = 0; i < problems->list->len; i++) {
    const opc_problem *problem = problems->list->pdata[i];
    JsonObject *o = json_object_new();
    const opc_place *at = &problem->at;
    if (at->file) json_object_set_string_member(o, "file", at->file);
    if (at->file && at->line) {
      json_object_set_int_member(o, "line", at->line);
      json_object_set_int_member(o, "column", at->column);
    }
    json_object_set_string_member(o, "message", problem->message);
    json_object_set_int_member(o, "exit", cli_exit_code(problem->code));
    json_array_add_object_element(list, o);
  }
  json_object_set_array_member(object, "problems", list);
}

void cli_add_texts(JsonObject *object, const char *name,
                   const GPtrArray *texts) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i < texts->len; i++)
    json_array_add_string_element(list, texts->pdata[i]);
  json_object_set_array_member(object, name, list);
}

void cli_flush(void) { fflush(out); }

int cli_finish(int code) {
  if (!fflush(out) && !ferror(out)) return code;
  cli_message("error", "standard output: %s", g_strerror(errno));
  return code ? code : CLI_IO;
}
