/* SPDX-License-Identifier: BSD-3-Clause */
/* For shells: what the last word of a command line may be. One candidate a
   line; after a '=', only what comes behind it. Nothing where any file name
   will do: the shell knows those. */
#include <string.h>

#include "core/cli/cli.h"
#include "core/flow/flow.h"
#include "core/plugin/declaration.h"

/* Where the cursor is. */
typedef struct line {
  char **words; /* behind the command; the last one is unfinished */
  guint n;
  const char *current;
  const cli_verb *verb; /* NULL: not yet there */
  const char *flow;     /* the flow file among the words, NULL for none */
  guint arguments;      /* of the verb, before the current one */
  gboolean awaited;     /* the current word is the value of `option` */
  cli_option option;
} line;

static void offer(const line *l, const char *word) {
  if (g_str_has_prefix(word, l->current)) cli_print("%s\n", word);
}

/* ---- what is being completed ---- */

typedef struct question {
  const char *name; /* of an option, with dashes */
  cli_option *found;
} question;

static void find_option(const cli_verb *verb, const cli_option *options,
                        const cli_option *common, void *data) {
  const question *q = data;
  (void)verb;
  for (int i = 0; i < 2; i++)
    for (const cli_option *o = i ? common : options; o && o->name; o++)
      if (!strcmp(o->name, q->name + 2)) *q->found = *o;
}

/* Whether `word` is an option whose value is the next word. */
static gboolean takes_value(line *l, const char *word) {
  if (strncmp(word, "--", 2) || strchr(word, '=')) return FALSE;
  l->option = (cli_option){0};
  question q = {word, &l->option};
  cli_ask(l->verb ? l->verb : &cli_help, find_option, &q);
  return l->option.argument != NULL;
}

static void read_line(line *l) {
  for (guint i = 0; i + 1 < l->n; i++) {
    const char *word = l->words[i];
    if (l->awaited)
      l->awaited = FALSE;
    else if (takes_value(l, word))
      l->awaited = TRUE;
    else if (*word == '-')
      continue;
    else if (!l->verb)
      l->verb = cli_find_verb(word);
    else if (!l->arguments++)
      l->flow = word;
  }
}

/* ---- candidates ---- */

static void offer_options(const cli_verb *verb, const cli_option *options,
                          const cli_option *common, void *data) {
  (void)verb;
  for (int i = 0; i < 2; i++)
    for (const cli_option *o = i ? common : options; o && o->name; o++) {
      g_autofree char *dashed = g_strconcat("--", o->name, NULL);
      offer(data, dashed);
    }
}

static void offer_verbs(const line *l) {
  for (size_t i = 0; cli_verbs[i] && !cli_verbs[i]->hidden; i++)
    offer(l, cli_verbs[i]->name);
}

static void offer_words(const line *l, const char *choices) {
  g_auto(GStrv) words = opc_choice_list(choices);
  for (guint i = 0; words[i]; i++) offer(l, words[i]);
}

static void offer_plugins(const line *l) {
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  g_autoptr(GPtrArray) list = opc_registry_scan(registry, CLI_PATIENCE);
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    if (!c->reason && !c->hidden_by) offer(l, c->id);
  }
}

static gint by_name(gconstpointer a, gconstpointer b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* YAML files, and folders on the way to some. */
static void offer_flows(const line *l) {
  const char *slash = strrchr(l->current, '/');
  g_autofree char *prefix =
      slash ? g_strndup(l->current, (size_t)(slash - l->current) + 1)
            : g_strdup("");
  g_autoptr(GDir) dir = g_dir_open(*prefix ? prefix : ".", 0, NULL);
  g_autoptr(GPtrArray) found = g_ptr_array_new_with_free_func(g_free);
  for (const char *name; dir && (name = g_dir_read_name(dir));) {
    g_autofree char *path = g_strconcat(prefix, name, NULL);
    if (*name == '.') continue;
    if (g_file_test(path, G_FILE_TEST_IS_DIR))
      g_ptr_array_add(found, g_strconcat(path, "/", NULL));
    else if (g_str_has_suffix(name, ".yaml") || g_str_has_suffix(name, ".yml"))
      g_ptr_array_add(found, g_strdup(path));
  }
  g_ptr_array_sort(found, by_name);
  for (guint i = 0; i < found->len; i++) offer(l, found->pdata[i]);
}

static void offer_values(const line *l, const opc_parameter *p) {
  const line behind = {.current = strchr(l->current, '=') + 1};
  if (p->type == OPC_BOOL) offer_words(&behind, "false|true");
  if (p->type == OPC_CHOICE) offer_words(&behind, p->choices);
}

static void offer_settings(opc_binding *binding, void *data) {
  const line *l = data;
  const char *equals = strchr(l->current, '=');
  for (size_t i = 0; i < binding->plugin->n_parameters; i++) {
    const opc_parameter *p = opc_parameter_at(binding->plugin, i);
    if (p->type == OPC_INPUT) continue;
    g_autofree char *word = g_strdup_printf("%s.%s=", binding->path, p->name);
    if (!equals)
      offer(l, word);
    else if (!strncmp(word, l->current, strlen(word)))
      offer_values(l, p);
  }
}

/* STEP.PARAMETER= of the flow that the line names. */
static void offer_sets(line *l) {
  if (!l->flow) return;
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = opc_flow_load(l->flow, NULL, registry, problems);
  for (guint i = 0; flow && i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    if (step->binding) opc_binding_visit(step->binding, offer_settings, l);
  }
}

static void offer_argument(line *l, const char *name) {
  if (!strcmp(name, "STEP.PARAMETER=VALUE")) offer_sets(l);
  if (!strcmp(name, "KIND"))
    for (uint32_t kind = 1; opc_kind_name(kind); kind++)
      offer(l, opc_kind_name(kind));
  if (!strcmp(name, "FLOW")) offer_flows(l);
  if (!strcmp(name, "ID")) offer_plugins(l);
  if (!strcmp(name, "[VERB]")) offer_verbs(l);
}

static void complete(line *l) {
  static const char set[] = "--set=";
  if (l->awaited) {
    offer_argument(l, l->option.argument);
  } else if (l->verb && g_str_has_prefix(l->current, set)) {
    l->current += strlen(set);
    offer_sets(l);
  } else if (*l->current == '-') {
    cli_ask(l->verb ? l->verb : &cli_help, offer_options, l);
  } else if (!l->verb) {
    offer_verbs(l);
  } else if (!l->arguments && l->verb->words) {
    offer_words(l, l->verb->words);
  } else if (!l->arguments) {
    offer_argument(l, l->verb->arguments);
  }
}

static int run(const cli_verb *verb, int argc, char **argv) {
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, NULL, 1, 1, rest);
  if (code >= 0) return code;
  g_autoptr(GPtrArray) words = g_ptr_array_new();
  g_auto(GStrv) all = g_strsplit_set(rest->pdata[0], " \t", -1);
  guint last = g_strv_length(all);
  for (guint i = 0, seen = 0; i < last; i++) {
    if (!*all[i] && i + 1 < last) continue;
    g_strdelimit(all[i], "'\"\\", '\x01');
    char *to = all[i];
    for (char *from = all[i]; *from; from++)
      if (*from != '\x01') *to++ = *from;
    *to = 0;
    if (seen++) g_ptr_array_add(words, all[i]);
  }
  if (!words->len) return CLI_GOOD;
  line l = {.words = (char **)words->pdata, .n = words->len};
  l.current = l.words[l.n - 1];
  read_line(&l);
  complete(&l);
  return CLI_GOOD;
}

const cli_verb cli_complete = {.name = "complete",
                               .arguments = "LINE",
                               .summary = "What may stand at the end of a line",
                               .run = run,
                               .hidden = TRUE};
