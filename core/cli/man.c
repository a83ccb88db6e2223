/* SPDX-License-Identifier: BSD-3-Clause */
/* Manual pages, from the same declarations as the help. */
#include "core/cli/cli.h"

static const struct {
  int code;
  const char *meaning;
} codes[] = {
    {CLI_GOOD, "good"},
    {CLI_LIMIT, "a limit was not kept, or a comparison failed"},
    {CLI_USAGE, "wrong usage, or a flow that is not valid"},
    {CLI_PLUGIN, "a plugin is missing or incompatible"},
    {CLI_STEP, "a step failed"},
    {CLI_IO, "a file or standard output could not be read or written"},
    {CLI_STOPPED, "stopped with Ctrl-C or SIGTERM"},
};

static const struct {
  const char *name, *meaning;
} variables[] = {
    {"OPCFLOW_PLUGIN_PATH", "folders of plugins, with colons between them"},
    {"OPCFLOW_NO_SYSTEM_PLUGINS",
     "if set, plugins of the user's data folder and of the installation are "
     "left out"},
    {"NO_COLOR", "if set, messages have no colour"},
};

/* A text in which nothing is a command to roff; for a terminal's hyphens. */
static char *roff(const char *text) {
  GString *out = g_string_new(*text == '.' || *text == '\'' ? "\\&" : NULL);
  for (; *text; text++) {
    if (*text == '\\')
      g_string_append(out, "\\e");
    else if (*text == '-')
      g_string_append(out, "\\-");
    else
      g_string_append_c(out, *text);
  }
  return g_string_free(out, FALSE);
}

static void print_head(const char *name, const char *summary) {
  g_autofree char *upper = g_ascii_strup(name, -1);
  g_autofree char *title = roff(upper), *page = roff(name),
                  *what = roff(summary);
  cli_print(".TH %s 1 \"\" \"opcflow %s\" \"opcflow\"\n.nh\n.ad l\n", title,
            OPC_VERSION);
  cli_print(".SH NAME\n%s \\- %c%s\n", page, g_ascii_tolower(*what), what + 1);
}

static void print_item(const char *name, const char *argument,
                       const char *text) {
  g_autofree char *left = roff(name), *right = roff(text);
  g_autofree char *middle = argument ? roff(argument) : NULL;
  cli_print(".TP\n\\fB%s\\fR%s%s%s\n%s\n", left, middle ? " \\fI" : "",
            middle ? middle : "", middle ? "\\fR" : "", right);
}

static void print_tail(void) {
  cli_print(".SH EXIT STATUS\n");
  for (size_t i = 0; i < G_N_ELEMENTS(codes); i++) {
    g_autofree char *number = g_strdup_printf("%d", codes[i].code);
    print_item(number, NULL, codes[i].meaning);
  }
  cli_print(".SH ENVIRONMENT\n");
  for (size_t i = 0; i < G_N_ELEMENTS(variables); i++)
    print_item(variables[i].name, NULL, variables[i].meaning);
}

static void print_verb(const cli_verb *verb, const cli_option *options,
                       const cli_option *common, void *data) {
  (void)data;
  g_autofree char *name = g_strconcat("opcflow-", verb->name, NULL);
  g_autofree char *arguments = roff(verb->arguments);
  print_head(name, verb->summary);
  cli_print(".SH SYNOPSIS\n\\fBopcflow %s\\fR%s%s [OPTIONS]\n", verb->name,
            *arguments ? " " : "", arguments);
  cli_print(".SH OPTIONS\n");
  for (int i = 0; i < 2; i++)
    for (const cli_option *o = i ? common : options; o && o->name; o++) {
      g_autofree char *dashed = g_strconcat("--", o->name, NULL);
      print_item(dashed, o->argument, o->help);
    }
  print_tail();
  cli_print(".SH SEE ALSO\n\\fBopcflow\\fR(1)\n");
}

static void print_command(void) {
  print_head("opcflow", "correct photomasks by the performance of transistors");
  cli_print(
      ".SH SYNOPSIS\n\\fBopcflow\\fR \\fIVERB\\fR ...\n"
      ".SH DESCRIPTION\nopcflow runs flows: YAML files that say which plugins "
      "work one after another, with which parameters.\n.SH VERBS\n");
  for (size_t i = 0; cli_verbs[i] && !cli_verbs[i]->hidden; i++)
    print_item(cli_verbs[i]->name,
               *cli_verbs[i]->arguments ? cli_verbs[i]->arguments : NULL,
               cli_verbs[i]->summary);
  print_tail();
  cli_print(".SH SEE ALSO\n");
  for (size_t i = 0; cli_verbs[i] && !cli_verbs[i]->hidden; i++)
    cli_print("%s\\fBopcflow\\-%s\\fR(1)", i ? ",\n" : "", cli_verbs[i]->name);
  cli_print("\n");
}

void cli_print_manual(const cli_verb *verb) {
  if (verb)
    cli_ask(verb, print_verb, NULL);
  else
    print_command();
}
