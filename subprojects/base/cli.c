/* SPDX-License-Identifier: BSD-3-Clause */
/* Messages and output of a command, and the options on its command line. */
#include <base/cli.h>
#include <base/shown.h>
#include <base/suggest.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

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
  g_autofree char *message = g_strdup_vprintf(format, args);
  va_end(args);
  g_autofree char *text = opc_shown(message, "");
  const char *colour = g_strcmp0(kind, "error") ? "\033[33m" : "\033[31m";
  gboolean coloured = kind && has_colour();
  if (silent) return;
  if (kind)
    fprintf(stderr, "%s%s:%s ", coloured ? colour : "", kind,
            coloured ? "\033[0m" : "");
  fprintf(stderr, "%s\n", text);
}

/* ---- standard output ---- */

enum {
  FIRST_OWN = 100
}; /* first descriptor used here; lower descriptors are left to other code */

static FILE *out;

/* Open a closed standard stream as an unusable descriptor of /dev/null.
   Otherwise the next opened file would become the standard stream. */
static void hold_places(void) {
  for (int i = STDIN_FILENO; i <= STDERR_FILENO; i++)
    if (fcntl(i, F_GETFD) < 0)
      (void)open("/dev/null", i == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

void cli_keep_output(void) {
  hold_places();
  int kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, FIRST_OWN);
  out = kept < 0 ? NULL : fdopen(kept, "w");
  if (!out) out = stdout; /* the limit of open files is reached */
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
  g_autofree char *message = g_strdup_vprintf(format, args);
  va_end(args);
  g_autofree char *text = opc_shown(message, "\n\t");
  if (!silent) fputs(text, out);
}

void cli_write(const char *text) {
  if (!silent) fputs(text, out);
}

size_t cli_width(void) {
  const char *columns = g_getenv("COLUMNS");
  struct winsize size;
  guint64 value;
  if (columns &&
      g_ascii_string_to_unsigned(columns, 10, 1, 100000, &value, NULL))
    return (size_t)value;
  if (isatty(fileno(out)) && !ioctl(fileno(out), TIOCGWINSZ, &size) &&
      size.ws_col)
    return size.ws_col;
  return SIZE_MAX;
}

void cli_flush(void) { fflush(out); }

gboolean cli_is_written(void) {
  if (!fflush(out) && !ferror(out)) return TRUE;
  cli_message("error", "standard output: %s", g_strerror(errno));
  return FALSE;
}

/* ---- options ---- */

void cli_print_pair(const char *name, const char *value, const char *summary) {
  g_autofree char *left =
      g_strdup_printf("%s%s%s", name, *value ? " " : "", value);
  cli_print("  %-28s  %s\n", left, summary);
}

void cli_print_options(const cli_option *o) {
  for (; o && o->name; o++) {
    g_autofree char *name = g_strconcat("--", o->name, NULL);
    cli_print_pair(name, o->argument ? o->argument : "", o->help);
  }
}

const char *const *cli_list(GPtrArray *list) {
  static const char *const none[] = {NULL};
  if (!list || !list->len) return none;
  if (list->pdata[list->len - 1]) g_ptr_array_add(list, NULL);
  return (const char *const *)list->pdata;
}

static const cli_option *option_find(const cli_option *const *tables,
                                     const char *name, GPtrArray *names) {
  for (; *tables; tables++)
    for (const cli_option *o = *tables; o->name; o++) {
      g_ptr_array_add(names, (char *)o->name);
      if (!strcmp(o->name, name)) return o;
    }
  return NULL;
}

static gboolean option_unknown(const char *verb, const char *word,
                               const char *name, const GPtrArray *names) {
  const char *nearest = opc_nearest(name, names);
  if (nearest)
    return cli_refuse("unknown option '%s' of '%s', did you mean '--%s'?", word,
                      verb, nearest);
  return cli_refuse("unknown option '%s', see 'opcflow help %s'", word, verb);
}

gboolean cli_take_option(const cli_option *const *tables, const char *verb,
                         guint n, char **words, guint *i) {
  const char *word = strcmp(words[*i], "-h") ? words[*i] : "--help";
  const char *equals = strchr(word, '='), *bare = word + strspn(word, "-");
  g_autofree char *name = g_strndup(bare, strcspn(bare, "="));
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  const cli_option *o = option_find(tables, name, names);
  if (!o || strncmp(word, "--", 2) != 0 || bare != word + 2)
    return option_unknown(verb, word, name, names);
  if (!o->argument && equals)
    return cli_refuse("option '--%s' takes no value", o->name);
  if (o->argument && !equals && *i + 1 == n)
    return cli_refuse("option '--%s' requires a value: %s", o->name,
                      o->argument);
  if (o->flag) *o->flag = TRUE;
  if (!o->argument) return TRUE;
  const char *value = equals ? equals + 1 : words[++*i];
  if (o->text) *o->text = value;
  if (o->list && !*o->list) *o->list = g_ptr_array_new();
  if (o->list) g_ptr_array_add(*o->list, (char *)value);
  return TRUE;
}
