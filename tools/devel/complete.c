/* SPDX-License-Identifier: BSD-3-Clause */
/* Shell completion: prints the candidates for the last word of a command line,
   one a line; after a '=', only the part after the '='. Where any file name is
   valid, nothing is printed, and the shell completes file names. */
#include <base/file.h>
#include <string.h>

#include "core/binding/flow.h"
#include "core/cli/cli.h"
#include "core/plugin/kind.h"
#include "core/plugin/value.h"
#include "tools/devel/verbs.h"

/* Parsed command line up to the cursor. */
typedef struct line {
  const char *current;  /* last word, to be completed */
  const cli_verb *verb; /* NULL if not yet typed */
  const char *flow;     /* the flow file among the words, or NULL */
  guint arguments;      /* number of arguments of the verb before `current` */
  const char *awaited;  /* name of the value in the help ("N"), if `current` is
                           the value of an option; else NULL */
} line;

static void offer_word(const line *l, const char *word) {
  if (g_str_has_prefix(word, l->current)) cli_print("%s\n", word);
}

static void offer_all(const line *l, const GPtrArray *words) {
  for (guint i = 0; i < words->len; i++) offer_word(l, words->pdata[i]);
}

/* ---- options ---- */

/* If `to` is not NULL, print the options that begin with to->current. Return
   the name of the value in the help ("N") if `word` is an option with a value;
   otherwise, or if `word` is NULL, return NULL. */
static const char *go_through_options(const line *l, const line *to,
                                      const char *word) {
  const cli_option *const both[] = {l->verb ? l->verb->options : NULL,
                                    cli_common_options};
  for (int i = 0; i < 2; i++)
    for (const cli_option *o = both[i]; o && o->name; o++) {
      g_autofree char *dashed = g_strconcat("--", o->name, NULL);
      if (to) offer_word(to, dashed);
      if (word && !strcmp(dashed, word)) return o->argument;
    }
  return NULL;
}

static void read_words(line *l, const GPtrArray *words) {
  for (guint i = 0; i + 1 < words->len; i++) {
    const char *word = words->pdata[i];
    opc_error error;
    gboolean value = l->awaited != NULL;
    l->awaited = value ? NULL : go_through_options(l, NULL, word);
    if (value || *word == '-') continue;
    if (!l->verb)
      l->verb = cli_find_verb(word, &error);
    else if (!l->arguments++)
      l->flow = word;
  }
}

/* ---- candidates ---- */

static void offer_words(const line *l, const char *choices) {
  g_auto(GStrv) words = opc_choice_list(choices);
  for (guint i = 0; words[i]; i++) offer_word(l, words[i]);
}

static void offer_verbs(const line *l) {
  g_autoptr(GPtrArray) names = cli_verb_names();
  offer_all(l, names);
}

static void offer_plugins(const line *l) {
  g_autoptr(GPtrArray) list =
      opc_registry_usable(cli_registry(), l->current, CLI_PATIENCE);
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    offer_word(l, c->id);
  }
}

/* Print the YAML files and folders that begin with the current word. */
static void offer_flows(const line *l) {
  const char *slash = strrchr(l->current, '/');
  g_autofree char *prefix =
      g_strndup(l->current, slash ? (gsize)(slash - l->current) + 1 : 0);
  g_autoptr(GPtrArray) names = opc_folder_names(*prefix ? prefix : ".");
  for (guint i = 0; names && i < names->len; i++) {
    const char *name = names->pdata[i];
    g_autofree char *path = g_strconcat(prefix, name, NULL);
    g_autofree char *folder = g_strconcat(path, "/", NULL);
    if (*name == '.') continue;
    if (g_file_test(path, G_FILE_TEST_IS_DIR))
      offer_word(l, folder);
    else if (g_str_has_suffix(name, ".yaml") || g_str_has_suffix(name, ".yml"))
      offer_word(l, path);
  }
}

static void offer_values(const line *l, const opc_parameter *p) {
  const line behind = {.current = strchr(l->current, '=') + 1};
  if (p->type == OPC_BOOL) offer_words(&behind, "false|true");
  if (p->type == OPC_CHOICE) offer_words(&behind, p->choices);
}

static void offer_settings(const line *l, const opc_binding *binding) {
  const char *equals = strchr(l->current, '=');
  for (size_t i = 0; i < binding->plugin->n_parameters; i++) {
    const opc_parameter *p = &binding->plugin->parameters[i];
    if (p->type == OPC_INPUT) continue;
    g_autofree char *word = g_strdup_printf("%s.%s=", binding->path, p->name);
    if (!equals)
      offer_word(l, word);
    else if (!strncmp(word, l->current, strlen(word)))
      offer_values(l, p);
  }
  for (size_t i = 0; !equals && i < binding->plugin->n_metrics; i++) {
    g_autofree char *word = g_strdup_printf("require.%s.%s=", binding->path,
                                            binding->plugin->metrics[i].name);
    if (g_str_has_prefix(l->current, "require.")) offer_word(l, word);
  }
}

/* Print STEP.PARAMETER= for each parameter of the flow on the command line. */
static void offer_sets(line *l) {
  if (!l->flow) return;
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_load(l->flow, NULL, cli_registry(), problems);
  g_autoptr(GPtrArray) all = g_ptr_array_new();
  for (guint i = 0; flow && i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    if (step->binding) opc_binding_list(step->binding, all);
  }
  for (guint i = 0; i < all->len; i++) offer_settings(l, all->pdata[i]);
}

static void offer_argument(line *l, const char *name) {
  g_autoptr(GPtrArray) kinds = opc_kind_names(cli_registry());
  if (!strcmp(name, "STEP.PARAMETER=VALUE")) offer_sets(l);
  if (!strcmp(name, "KIND")) offer_all(l, kinds);
  if (!strcmp(name, "FLOW") || !strcmp(name, "[FLOW]")) offer_flows(l);
  if (!strcmp(name, "ID")) offer_plugins(l);
  if (!strcmp(name, "[VERB]")) offer_verbs(l);
  if (l->awaited && strchr(name, '|')) offer_words(l, name);
}

/* ---- entry ---- */

static void line_complete(line *l) {
  static const char set[] = "--set=";
  if (l->awaited) {
    offer_argument(l, l->awaited);
  } else if (l->verb && g_str_has_prefix(l->current, set)) {
    l->current += strlen(set);
    offer_sets(l);
  } else if (*l->current == '-') {
    go_through_options(l, l, NULL);
  } else if (!l->verb) {
    offer_verbs(l);
  } else if (!l->arguments && l->verb->words) {
    offer_words(l, l->verb->words);
  } else if (!l->arguments) {
    offer_argument(l, l->verb->arguments);
  }
}

/* `arguments` has one text, the command line up to the cursor, which is split
   at blanks. */
static int complete_run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  g_autoptr(GPtrArray) words = g_ptr_array_new();
  g_auto(GStrv) all = g_strsplit_set(arguments->pdata[0], " \t", -1);
  guint last = g_strv_length(all);
  for (guint i = 0, seen = 0; i < last; i++) {
    if (!*all[i] && i + 1 < last) continue;
    char *to = all[i];
    for (const char *from = all[i]; *from; from++)
      if (!strchr("'\"\\", *from)) *to++ = *from;
    *to = 0;
    if (seen++) g_ptr_array_add(words, all[i]);
  }
  if (!words->len) return CLI_GOOD;
  cli_take_plugin_path(words->len, (char **)words->pdata);
  line l = {.current = words->pdata[words->len - 1]};
  read_words(&l, words);
  line_complete(&l);
  return CLI_GOOD;
}

const cli_verb devel_complete = {CLI_COMPLETE, .least = 1, .most = 1,
                                 .run = complete_run};
