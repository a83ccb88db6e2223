/* SPDX-License-Identifier: BSD-3-Clause */
#include <string.h>

#include "core/cli/cli.h"
#include "core/plugin/suggest.h"

/* --plugin-path of the command and of the verb; NULL-terminated on demand. */
static GPtrArray *plugin_path(void) {
  static GPtrArray *folders;
  if (!folders) folders = g_ptr_array_new();
  return folders;
}

const char *const *cli_plugin_path(void) {
  GPtrArray *folders = plugin_path();
  if (!folders->len || folders->pdata[folders->len - 1])
    g_ptr_array_add(folders, NULL);
  return (const char *const *)folders->pdata;
}

/* ---- help ---- */

static void print_option(const cli_option *o) {
  g_autofree char *left =
      g_strdup_printf("--%s%s%s", o->name, o->argument ? " " : "",
                      o->argument ? o->argument : "");
  cli_print("  %-28s %s\n", left, o->help);
}

static void print_help(const cli_verb *verb, const cli_option *options,
                       const cli_option *common, void *data) {
  (void)data;
  cli_print("usage: opcflow %s%s%s%s\n\n%s.\n\n", verb->name,
            *verb->arguments ? " " : "", verb->arguments,
            options && options->name ? " [OPTIONS]" : "", verb->summary);
  for (; options && options->name; options++) print_option(options);
  for (; common->name; common++) print_option(common);
}

/* Who is told the options of a verb that is asked for its help. */
static cli_teller teller = print_help;
static void *teller_data;

void cli_ask(const cli_verb *verb, cli_teller tell, void *data) {
  char *help[] = {(char *)"--help"};
  teller = tell;
  teller_data = data;
  verb->run(verb, 1, help);
  teller = print_help;
}

/* ---- reading ---- */

static const cli_option *find_option(const cli_option *options,
                                     const char *name, size_t length) {
  for (; options && options->name; options++)
    if (strlen(options->name) == length &&
        !strncmp(options->name, name, length))
      return options;
  return NULL;
}

static int unknown_option(const cli_verb *verb, const cli_option *options,
                          const cli_option *common, const char *word) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (; options && options->name; options++)
    g_ptr_array_add(names, (char *)options->name);
  for (; common->name; common++) g_ptr_array_add(names, (char *)common->name);
  const char *bare = word + strspn(word, "-");
  g_autofree char *name = g_strndup(bare, strcspn(bare, "="));
  const char *nearest = opc_nearest(name, names);
  if (nearest)
    cli_message("error", "unknown option '%s' of '%s', did you mean '--%s'?",
                word, verb->name, nearest);
  else
    cli_message("error", "unknown option '%s', see 'opcflow help %s'", word,
                verb->name);
  return CLI_USAGE;
}

/* Take the option at argv[*i], which is `o`; -1 or the exit code. */
static int take_option(const cli_option *o, int argc, char **argv, int *i) {
  const char *equals = strchr(argv[*i], '=');
  if (!o->argument) {
    if (equals) {
      cli_message("error", "option '--%s' takes no value", o->name);
      return CLI_USAGE;
    }
    *o->flag = TRUE;
    return -1;
  }
  if (!equals && *i + 1 == argc) {
    cli_message("error", "option '--%s' needs a value: %s", o->name,
                o->argument);
    return CLI_USAGE;
  }
  const char *value = equals ? equals + 1 : argv[++*i];
  if (o->text)
    *o->text = value;
  else
    g_ptr_array_add(o->list, (char *)value);
  return -1;
}

static int check_rest(const cli_verb *verb, guint least, guint most,
                      const GPtrArray *rest) {
  if (rest->len >= least && rest->len <= most) return -1;
  if (rest->len < least)
    cli_message("error", "'%s' needs %s, see 'opcflow help %s'", verb->name,
                verb->arguments, verb->name);
  else
    cli_message("error", "'%s' does not take '%s', see 'opcflow help %s'",
                verb->name, (char *)rest->pdata[most], verb->name);
  return CLI_USAGE;
}

int cli_parse(const cli_verb *verb, int argc, char **argv,
              const cli_option *options, guint least, guint most,
              GPtrArray *rest) {
  gboolean help = FALSE, bare = FALSE;
  const cli_option common[] = {
      {"plugin-path", "DIR", "look for plugins here first", NULL, NULL,
       plugin_path()},
      {"help", NULL, "show this", &help, NULL, NULL},
      {0}};
  for (int i = 0; i < argc; i++) {
    const char *word = argv[i];
    if (bare || *word != '-' || !word[1]) {
      g_ptr_array_add(rest, argv[i]);
      continue;
    }
    bare = !strcmp(word, "--");
    if (bare) continue;
    if (!strcmp(word, "-h")) word = "--help";
    size_t length = strcspn(word, "=");
    const cli_option *o = NULL;
    if (length > 2 && !strncmp(word, "--", 2)) {
      o = find_option(options, word + 2, length - 2);
      if (!o) o = find_option(common, word + 2, length - 2);
    }
    int code = o ? take_option(o, argc, argv, &i)
                 : unknown_option(verb, options, common, word);
    if (code >= 0) return code;
  }
  if (help) {
    teller(verb, options, common, teller_data);
    return CLI_GOOD;
  }
  return check_rest(verb, least, most, rest);
}
