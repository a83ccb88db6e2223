/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements verbs of plugins of the kind "command": parameters become options;
   published tables and metrics are printed as text or as one JSON document. */
#include <base/file.h>
#include <base/layers.h>
#include <base/suggest.h>
#include <base/unit.h>
#include <errno.h>
#include <glib/gstdio.h>
#include <guard/stop.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/cli/progress.h"
#include "core/plugin/declaration.h"
#include "core/report/json.h"
#include "tools/devel/published.h"

/* Given options: one text per parameter; for an OPC_BOOL, whether --NAME or
   --no-NAME was given. */
static GPtrArray **texts;
static const char *threads, *wanted;
static gboolean *yes, *no, json, csv, markdown;

static cli_progress progress;
static opc_published published;
static JsonArray *messages;

/* ---- options ---- */

/* Return the option of a parameter (g_free): "max_cases" becomes
   --max-cases. */
static char *option_name(const opc_parameter *p) {
  return g_strdelimit(g_strdup(p->name), "_", '-');
}

static const char *option_argument(const opc_parameter *p) {
  switch (p->type) {
    case OPC_BOOL:
      return NULL;
    case OPC_INT:
    case OPC_REAL:
      return "NUMBER";
    case OPC_CHOICE:
      return p->choices;
    case OPC_FILE:
    case OPC_OUTPUT:
      return "FILE";
    case OPC_TEXT:
      return "TEXT";
    case OPC_REALS:
      return "[NUMBER, ...]";
    default:
      return "{...}";
  }
}

static char *option_help(const opc_parameter *p) {
  g_autofree char *bounds = opc_bounds_text(p);
  GString *help = g_string_new(p->summary);
  if (p->flags & OPC_REQUIRED)
    g_string_append(help, "; required");
  else if (p->preset && *p->preset)
    g_string_append_printf(help, "; default: %s", p->preset);
  if (*bounds) g_string_append_printf(help, "; %s", bounds);
  return g_string_free(help, FALSE);
}

/* ---- published results ---- */

static void take_log(void *data, const char *path, int level,
                     const char *message) {
  static const char *const levels[] = {"debug", "info", "warning", "finding"};
  if (level < OPC_LOG_INFO || level > OPC_LOG_FINDING) return;
  cli_progress_log(data, path, level, message);
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "level", levels[level]);
  json_object_set_string_member(o, "message", message);
  g_mutex_lock(&progress.lock);
  json_array_add_object_element(messages, o);
  g_mutex_unlock(&progress.lock);
}

static GPtrArray *given; /* paths of files that the command writes */

/* Return the path of a new file in the current folder, because a command has no
   run folder. */
static const char *give_path(const opc_host *host, const char *name,
                             opc_error *error) {
  char *path = g_strdup(name);
  g_autofree char *folder = g_path_get_dirname(name);
  g_ptr_array_add(((const opc_binding *)host->data)->owned, path);
  if (!opc_name_is_inside(name))
    opc_fail(error, OPC_INVALID, NULL, "'%s' is outside of the folder", name);
  else if (g_file_test(name, G_FILE_TEST_EXISTS))
    opc_fail(error, OPC_IO, NULL, "'%s' exists", name);
  else if (g_mkdir_with_parents(folder, 0777))
    opc_fail(error, OPC_IO, NULL, "'%s': %s", folder, g_strerror(errno));
  else {
    g_ptr_array_add(given, path);
    return path;
  }
  return NULL;
}

static const opc_watch watch = {.data = &progress,
                                .log = take_log,
                                .progress = cli_progress_show,
                                .cancelled = cli_is_stopped};

static const opc_published_metric *metric_at(guint i) {
  return &g_array_index(published.metrics, opc_published_metric, i);
}

static void show_metrics(void) {
  static const char *const names[] = {"metric", "value", "unit"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < published.metrics->len; i++) {
    const opc_published_metric *m = metric_at(i);
    const char *unit = m->declared->unit;
    g_ptr_array_add(cells, g_strdup(m->name));
    g_ptr_array_add(cells, opc_number_text(m->value));
    g_ptr_array_add(cells, g_strdup(unit ? unit : ""));
  }
  cli_print_rows(names, 3, cells);
}

static void show_json(opc_problems *problems) {
  JsonObject *o = json_object_new();
  JsonObject *metrics = json_object_new();
  JsonArray *list = json_array_new();
  for (guint i = 0; i < published.tables->len; i++)
    json_array_add_element(list, opc_table_json(published.tables->pdata[i]));
  for (guint i = 0; i < published.metrics->len; i++) {
    const opc_published_metric *m = metric_at(i);
    json_object_set_member(metrics, m->name,
                           opc_metric_json(m->declared, m->value));
  }
  json_object_set_object_member(o, "metrics", metrics);
  json_object_set_array_member(o, "tables", list);
  json_object_set_array_member(o, "messages", json_array_ref(messages));
  if (problems->list->len) cli_add_problems(o, problems);
  cli_print_object(o);
}

/* Print a table with its name as title (no title for a single CSV table). A
   table without OPC_TABLE_PRINT is printed only as CSV or if chosen by name. */
static void show_table(const opc_table *table) {
  if (!csv && !wanted && !(table->flags & OPC_TABLE_PRINT)) return;
  if (markdown) {
    g_autofree char *text = opc_table_markdown(table);
    cli_print("### %s\n\n%s\n", table->name, text);
  } else if (csv) {
    g_autofree char *text = opc_table_csv(table);
    g_auto(GStrv) lines = g_strsplit(text, "\r\n", -1);
    if (published.tables->len > 1) cli_print("# %s\n", table->name);
    for (char **line = lines; *line && line[1]; line++)
      cli_print("%s\n", *line);
    if (published.tables->len > 1) cli_print("\n");
  } else {
    cli_print("%s\n", table->name);
    cli_print_table(table);
    cli_print("\n");
  }
}

/* Keep only the table chosen by name. */
static void choose_table(opc_problems *problems) {
  g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
  for (guint i = published.tables->len; i-- > 0;) {
    const char *name = ((const opc_table *)published.tables->pdata[i])->name;
    g_ptr_array_add(names, g_strdup(name));
    if (strcmp(name, wanted)) g_ptr_array_remove_index(published.tables, i);
  }
  if (published.tables->len || problems->list->len) return;
  g_autofree char *near = opc_suggestion(wanted, names);
  opc_problem_add(problems, OPC_INVALID, NULL,
                  "--table: table '%s' does not exist%s", wanted, near);
}

static int command_print_results(opc_problems *problems) {
  if (wanted) choose_table(problems);
  if (json) show_json(problems);
  for (guint i = 0; !json && i < published.tables->len; i++)
    show_table(published.tables->pdata[i]);
  if (!json && !csv && !markdown && !wanted) show_metrics();
  int code = cli_problems(problems);
  return code && cli_is_stopped(NULL) ? CLI_STOPPED : code;
}

/* ---- run ---- */

/* Put the value of a parameter into { VERB: { ... } }. Texts and names of files
   are taken literally; other values are parsed as in a flow. */
static void take_value(const cli_verb *verb, const opc_parameter *p,
                       const char *text, opc_node *steps, GPtrArray *sources,
                       opc_problems *problems) {
  gboolean verbatim =
      p->type == OPC_TEXT || p->type == OPC_FILE || p->type == OPC_OUTPUT;
  g_autofree char *name = option_name(p);
  g_autofree char *option = g_strconcat("--", name, NULL);
  g_autofree char *path = g_strconcat(verb->name, ".", p->name, NULL);
  opc_source *source = opc_source_new(option, NULL);
  g_ptr_array_add(sources, source);
  g_autoptr(opc_node) value =
      verbatim ? opc_node_text_new(source, text)
               : opc_node_parse(source, text, strlen(text), problems);
  if (!value) return;
  opc_lay_at(steps, path, &value->at, value, problems);
}

static void command_call(opc_binding *b, const GPtrArray *arguments,
                         opc_problems *problems) {
  const opc_command *command = b->module.functions;
  opc_error error = {0};
  const char *before = opc_binding_enter(b);
  int code = command->run(b->module.self, arguments->len,
                          (const char *const *)arguments->pdata, &error);
  opc_binding_leave(before);
  /* Remove files that may be incomplete. */
  for (guint i = 0; code == OPC_IO && i < given->len; i++)
    (void)remove(given->pdata[i]);
  error.parameter[sizeof error.parameter - 1] = 0;
  error.message[sizeof error.message - 1] = 0;
  if (code)
    opc_problem_add(problems, code, opc_binding_place(b, error.parameter), "%s",
                    *error.message ? error.message : "no error message");
}

static int command_run(const cli_verb *verb, const GPtrArray *arguments) {
  int code = cli_set_threads(threads);
  if (code >= 0) return code;
  const opc_plugin *plugin = verb->plugin;
  const opc_place at = {NULL, 0, 0};
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(GPtrArray) sources =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_source_free);
  opc_source *source = opc_source_new(verb->name, NULL);
  g_ptr_array_add(sources, source);
  g_autoptr(opc_node) steps = opc_node_map_new(source, &at);
  opc_node_add(steps, opc_node_text_new(source, verb->name),
               opc_node_map_new(source, &at));
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    g_autofree char *given_text =
        texts[i] ? g_strjoinv(",", (char **)cli_list(texts[i])) : NULL;
    const char *text = yes[i] ? "true" : no[i] ? "false" : given_text;
    if (text)
      take_value(verb, &plugin->parameters[i], text, steps, sources, problems);
  }
  g_autoptr(opc_binding) b =
      opc_bind_plugin(cli_registry(), plugin, opc_node_get(steps, verb->name),
                      verb->name, &at, 0, problems);
  stop_on_signals(CLI_STOPPED);
  cli_progress_start(&progress, OPC_LOG_INFO, TRUE);
  cli_progress_step(&progress, verb->name, 1, 1);
  if (!problems->list->len &&
      opc_binding_create(b, &watch, &published.host, problems))
    command_call(b, arguments, problems);
  cli_progress_end(&progress);
  return command_print_results(problems);
}

/* ---- the verb ---- */

static void add_options(GArray *list, const opc_plugin *plugin, size_t i) {
  const opc_parameter *p = &plugin->parameters[i];
  if (p->type == OPC_INPUT) return;
  char *name = option_name(p);
  cli_option option = {name, option_help(p), option_argument(p),
                       .list = &texts[i]};
  if (p->type == OPC_BOOL) option.flag = &yes[i];
  g_array_append_val(list, option);
  if (p->type != OPC_BOOL) return;
  option = (cli_option){g_strconcat("no-", name, NULL),
                        g_strconcat("not --", name, NULL), .flag = &no[i]};
  g_array_append_val(list, option);
}

/* Nothing is freed, because the process runs only one verb. */
const cli_verb *cli_plugin_verb(const char *name, opc_error *error) {
  static const cli_option common[] = {
      {"threads", "number of threads (default: number of processors)", "N",
       .text = &threads},
      {"table", "print only this table", "NAME", .text = &wanted},
      {"csv", "print tables as CSV", .flag = &csv},
      {"markdown", "print tables as Markdown", .flag = &markdown},
      {"json", "print the result as JSON", .flag = &json}};
  static cli_verb verb;
  static GArray *options;
  g_autofree char *id = g_strconcat("command.", name, NULL);
  const opc_plugin *plugin = opc_registry_find(cli_registry(), id, error);
  if (!plugin || plugin == verb.plugin) return plugin ? &verb : NULL;
  const opc_command *command = plugin->functions;
  size_t n = plugin->n_parameters;
  options = g_array_new(TRUE, FALSE, sizeof(cli_option));
  texts = g_new0(GPtrArray *, n);
  yes = g_new0(gboolean, n);
  no = g_new0(gboolean, n);
  for (size_t i = 0; i < n; i++) add_options(options, plugin, i);
  g_array_append_vals(options, common, G_N_ELEMENTS(common));
  given = g_ptr_array_new();
  opc_published_init(&published, NULL);
  published.host.output_path = give_path;
  messages = json_array_new();
  verb = (cli_verb){.name = plugin->id + strlen("command."),
                    .arguments = command->arguments ? command->arguments : "",
                    .summary = plugin->summary,
                    .options = (cli_option *)options->data,
                    .most = command->arguments ? G_MAXUINT : 0,
                    .run = command_run,
                    .plugin = plugin};
  return &verb;
}
