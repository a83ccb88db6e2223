/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow new: creates a working plugin, a flow or a comparison from templates.
   The kind of a plugin defines templates; data/templates has the templates of
   steps, commands and flows. With --process, the new flow extends a process: a
   flow without input files. */
#include <base/file.h>
#include <base/suggest.h>
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <store/files.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/plugin/declaration.h"
#include "core/plugin/kind.h"
#include "tools/devel/comparison.h"
#include "tools/devel/verbs.h"

static const char *wanted;         /* --kind */
static const char *language = "c"; /* --language */
static const char *process;        /* --process */
static gboolean json;

static const cli_option options[] = {
    {"kind", "kind of the plugin (default: first word of NAME)", "KIND",
     .text = &wanted},
    {"language", "language of the plugin: c (default) or python", "LANGUAGE",
     .text = &language},
    {"process", "process flow that the new flow or comparison extends", "NAME",
     .text = &process},
    {"json", "print the files as JSON", .flag = &json},
    {0}};

/* Name of the new plugin or flow ("mine"); id ("step.mine") and kind of a
   plugin, NULL for other files; folder of the new files. */
static char *name, *id, *kind, *folder;
static GPtrArray *files; /* char * */

/* ---- templates ---- */

static char *fill_in(const char *text) {
  GString *out = g_string_new(text);
  g_string_replace(out, "@NAME@", name, 0);
  g_string_replace(out, "@ID@", id ? id : "", 0);
  g_string_replace(out, "@KIND@", kind ? kind : "", 0);
  return g_string_free(out, FALSE);
}

/* Write a template into the folder. Return -1 or the exit code. An existing
   file is an error, or is left unchanged if `keep` is set. */
static int template_write(const char *file, const char *template,
                          gboolean keep) {
  g_autofree char *filled = fill_in(file);
  g_autofree char *text = fill_in(template);
  g_autofree char *path = g_build_filename(folder, filled, NULL);
  if (g_file_test(path, G_FILE_TEST_EXISTS))
    return keep ? -1 : cli_error(CLI_IO, "'%s' exists", path);
  opc_error error;
  if (opc_write_file(path, text, &error)) return cli_fail(&error);
  g_ptr_array_add(files, g_steal_pointer(&path));
  return -1;
}

/* Write a built-in template. Return -1 or the exit code. */
static int put_own(const char *group, const char *resource, const char *file,
                   gboolean keep) {
  g_autofree char *path = g_build_path("/", "/opcflow", group, resource, NULL);
  g_autoptr(GBytes) bytes =
      g_resources_lookup_data(path, G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
  g_autofree char *text =
      g_strndup(g_bytes_get_data(bytes, NULL), g_bytes_get_size(bytes));
  return template_write(file, text, keep);
}

/* Return the names of built-in templates; NULL if there are none. */
static char **own_names(const char *group) {
  g_autofree char *path = g_build_path("/", "/opcflow", group, NULL);
  return g_resources_enumerate_children(path, G_RESOURCE_LOOKUP_FLAGS_NONE,
                                        NULL);
}

/* ---- a plugin ---- */

static gboolean is_own_verb(const char *word) {
  for (size_t i = 0; cli_verbs[i]; i++)
    if (!strcmp(cli_verbs[i]->name, word)) return TRUE;
  return FALSE;
}

/* Return "; kinds: command, extractor, ..." (g_free). */
static char *kind_list(const GPtrArray *kinds) {
  GString *all = g_string_new(NULL);
  for (guint i = 0; i < kinds->len; i++)
    g_string_append_printf(all, "%s%s",
                           i ? ", " : "; kinds: ", (char *)kinds->pdata[i]);
  return g_string_free(all, FALSE);
}

/* Report that the kind or the name of the new plugin is missing. */
static int lacks_name(const char *given, GPtrArray *kinds) {
  g_autofree char *all = kind_list(kinds);
  if (g_ptr_array_find_with_equal_func(kinds, given, g_str_equal, NULL))
    return cli_error(CLI_USAGE,
                     "'%s' is a kind: give the plugin a name, for example "
                     "'opcflow new plugin %s.mine'",
                     given, given);
  return cli_error(CLI_USAGE,
                   "'%s' has no kind: use 'opcflow new plugin KIND.%s'%s",
                   given, given, all);
}

/* Set name, id and kind from the arguments. Return -1 or the exit code. */
static int settle_names(const char *given) {
  if (!opc_is_id(given))
    return cli_error(CLI_USAGE,
                     "'%s' cannot be the name of a plugin, expected lower_case "
                     "words separated by dots",
                     given);
  const char *dot = strrchr(given, '.');
  g_autoptr(GPtrArray) kinds = opc_kind_names(cli_registry());
  if (!dot && !wanted) return lacks_name(given, kinds);
  kind = wanted ? g_strdup(wanted) : g_strndup(given, strcspn(given, "."));
  id = dot ? g_strdup(given) : g_strconcat(kind, ".", given, NULL);
  name = g_strdup(dot ? dot + 1 : given);
  if (!strcmp(kind, OPC_KIND_COMMAND) && is_own_verb(name))
    return cli_error(
        CLI_USAGE,
        "'opcflow %s' is built in: a plugin '%s' would never be called", name,
        id);
  if (g_ptr_array_find_with_equal_func(kinds, kind, g_str_equal, NULL))
    return -1;
  g_autofree char *suggestion = opc_suggestion(kind, kinds);
  g_autofree char *all = kind_list(kinds);
  return cli_error(CLI_USAGE, "unknown kind '%s'%s%s%s", kind, suggestion, all,
                   wanted ? "" : "; a step has any first word: '--kind step'");
}

static int make_folder(void) {
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  gboolean taken = dir ? g_dir_read_name(dir) != NULL
                       : g_file_test(folder, G_FILE_TEST_EXISTS);
  if (taken) return cli_error(CLI_IO, "'%s' exists", folder);
  if (!g_mkdir_with_parents(folder, 0777)) return -1;
  return cli_error(CLI_IO, "'%s': %s", folder, g_strerror(errno));
}

/* Return the file of a template, "python/FILE", "all/FILE" or of C "FILE"; NULL
   if the template is of another language. */
static const char *template_file(const opc_template *t) {
  const char *slash = strchr(t->name, '/');
  const char *its = slash ? t->name : "c/";
  gsize length = strcspn(its, "/");
  if (strncmp(its, "all/", 4) != 0 &&
      (strncmp(its, language, length) != 0 || language[length]))
    return NULL;
  return slash ? slash + 1 : t->name;
}

/* Return whether the kind has a plugin in the wanted language. */
static gboolean has_language(const opc_kind *its) {
  for (size_t i = 0; i < its->n_templates; i++)
    if (template_file(&its->templates[i]) &&
        !g_str_has_prefix(its->templates[i].name, "all/"))
      return TRUE;
  return FALSE;
}

/* Write the built-in templates and the templates of the kind. Return -1 or the
   exit code. */
static int new_plugin(const GPtrArray *arguments) {
  if (arguments->len < 2)
    return cli_error(CLI_USAGE,
                     "'new plugin' requires NAME, see 'opcflow help new'");
  int code = settle_names(arguments->pdata[1]);
  if (code >= 0) return code;
  opc_error error = {0};
  const opc_kind *its = opc_kind_of(cli_registry(), kind, &error);
  if (!its) return cli_fail(&error);
  g_autofree char *group = strcmp(language, "c") != 0
                               ? g_build_path("/", language, kind, NULL)
                               : g_strdup(kind);
  g_auto(GStrv) own = own_names(group);
  if (!own && !has_language(its))
    return cli_error(CLI_PLUGIN,
                     "the kind '%s' has no template in the language '%s', "
                     "expected 'c' or 'python'",
                     kind, language);
  folder = g_strdup(arguments->len > 2 ? arguments->pdata[2] : id);
  code = make_folder();
  for (guint i = 0; own && own[i] && code < 0; i++)
    code = put_own(group, own[i], own[i], FALSE);
  for (size_t i = 0; i < its->n_templates && code < 0; i++) {
    const char *file = template_file(&its->templates[i]);
    if (file) code = template_write(file, its->templates[i].text, FALSE);
  }
  return code;
}

/* ---- a flow that extends a process ---- */

/* Folders of base flows, inside `flows` beside each plugin folder. */
static const char *const bases[] = {"processes", "scanners"};

/* Return a folder of base flows (g_free). The plugin folder may be missing. */
static char *base_folder(const char *plugins, const char *base) {
  g_autofree char *path = g_build_filename(plugins, "..", "flows", base, NULL);
  return g_canonicalize_filename(path, NULL);
}

static int by_name(gconstpointer a, gconstpointer b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Return the paths of all base flows (char *, freed with the array), in search
   order. */
static GPtrArray *base_flows(void) {
  const GPtrArray *folders = opc_registry_folders(cli_registry());
  GPtrArray *paths = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < folders->len; i++)
    for (size_t k = 0; k < G_N_ELEMENTS(bases); k++) {
      g_autofree char *its = base_folder(folders->pdata[i], bases[k]);
      g_autoptr(GDir) dir = g_dir_open(its, 0, NULL);
      for (const char *n; dir && (n = g_dir_read_name(dir));)
        if (g_str_has_suffix(n, ".yaml"))
          g_ptr_array_add(paths, g_build_filename(its, n, NULL));
    }
  return paths;
}

/* Return the names of flows (char *, freed with the array). */
static GPtrArray *base_names(const GPtrArray *flows) {
  GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < flows->len; i++) {
    char *file = g_path_get_basename(flows->pdata[i]);
    *strrchr(file, '.') = 0;
    g_ptr_array_add(names, file);
  }
  return names;
}

/* Return "; known: arf, own65" (g_free). */
static char *known_names(GPtrArray *names) {
  GString *all = g_string_new(NULL);
  g_ptr_array_sort(names, by_name);
  for (guint i = 0; i < names->len; i++)
    g_string_append_printf(all, "%s%s",
                           i ? ", " : "; known: ", (char *)names->pdata[i]);
  return g_string_free(all, FALSE);
}

/* Return the path of --process, a path or a name (g_free). Return NULL after a
   message that lists all processes. */
static char *find_process(void) {
  if (g_file_test(process, G_FILE_TEST_IS_REGULAR))
    return g_canonicalize_filename(process, NULL);
  g_autoptr(GPtrArray) flows = base_flows();
  g_autoptr(GPtrArray) names = base_names(flows);
  guint i;
  if (g_ptr_array_find_with_equal_func(names, process, g_str_equal, &i))
    return g_strdup(flows->pdata[i]);
  g_autofree char *all = known_names(names);
  g_autofree char *hint = opc_suggestion(process, names);
  cli_message("error", "no process '%s'%s%s", process, hint, all);
  return NULL;
}

/* Return the required files that a flow does not set, at least one. On failure,
   return NULL and the exit code in *code. */
static GArray *find_open(const char *path, int *code) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_load(path, NULL, cli_registry(), problems);
  g_autoptr(GArray) open = flow ? cli_open_files(flow) : NULL;
  if (open && open->len) return g_steal_pointer(&open);
  *code = flow ? cli_error(CLI_USAGE,
                           "'%s' has no input file left to set and is "
                           "therefore not a process",
                           path)
               : cli_problems(problems);
  return NULL;
}

/* Return the path of an input for use in the flow's folder (g_free). */
static char *from_folder(const char *input) {
  return strcmp(folder, ".") && !g_path_is_absolute(input)
             ? g_canonicalize_filename(input, NULL)
             : g_strdup(input);
}

/* Write a flow that extends --process. `input` sets the first required file;
   comments list the other required files. Return -1 or the exit code. */
static int extend_process(const char *path, const char *input,
                          const char *file) {
  int code = CLI_USAGE;
  g_autoptr(GArray) open = find_open(path, &code);
  if (!open) return code;
  g_autofree char *its = from_folder(input);
  const cli_open_file *left = (const cli_open_file *)(void *)open->data;
  const char *first = left->path, *dot = strchr(first, '.');
  g_autoptr(GString) text = g_string_new("opcflow: 1\nname: @NAME@\nextends: ");
  opc_text_append(text, path);
  g_string_append_printf(
      text, "\nsteps:\n  %.*s:\n    %s: ", (int)(dot - first), first, dot + 1);
  opc_text_append(text, its);
  g_string_append_c(text, '\n');
  for (guint i = 1; i < open->len; i++)
    g_string_append_printf(text, "%s#   --set %s=FILE    %s\n",
                           i == 1 ? "# Parameters to set, here or as\n" : "",
                           left[i].path, left[i].summary);
  return template_write(file, text->str, FALSE);
}

/* ---- input files ---- */

static gboolean is_input(const char *file) {
  static const char *const endings[] = {".gds", ".gds.gz", ".oas", ".cif"};
  g_autofree char *low = g_ascii_strdown(file, -1);
  for (size_t i = 0; i < G_N_ELEMENTS(endings); i++)
    if (g_str_has_suffix(low, endings[i])) return TRUE;
  return FALSE;
}

/* Add the input files in a folder, by name. Return -1 or the exit code. */
static int add_folder(GPtrArray *inputs, const char *path) {
  g_autoptr(GPtrArray) names = opc_folder_names(path);
  guint before = inputs->len;
  if (!names) return cli_error(CLI_IO, "'%s': %s", path, g_strerror(errno));
  g_ptr_array_sort(names, by_name);
  for (guint i = 0; i < names->len; i++) {
    g_autofree char *file = g_build_filename(path, names->pdata[i], NULL);
    if (is_input(names->pdata[i]) && g_file_test(file, G_FILE_TEST_IS_REGULAR))
      g_ptr_array_add(inputs, g_steal_pointer(&file));
  }
  if (inputs->len > before) return -1;
  return cli_error(CLI_IO,
                   "the folder '%s' has no input, expected a file that ends "
                   "with .gds, .gds.gz, .oas or .cif",
                   path);
}

/* Add the files that arguments from the second to before `end` name. Return -1
   or the exit code. */
static int take_inputs(const GPtrArray *arguments, guint end,
                       GPtrArray *inputs) {
  int code = -1;
  for (guint i = 1; i < end && code < 0; i++) {
    const char *path = arguments->pdata[i];
    if (g_file_test(path, G_FILE_TEST_IS_DIR))
      code = add_folder(inputs, path);
    else if (g_file_test(path, G_FILE_TEST_IS_REGULAR))
      g_ptr_array_add(inputs, g_strdup(path));
    else
      code =
          cli_error(CLI_IO, "'%s': %s", path,
                    g_file_test(path, G_FILE_TEST_EXISTS) ? "not a regular file"
                                                          : "no such file");
  }
  return code;
}

/* ---- a comparison, and a flow of several files ---- */

/* Return the text of a template of an experiment on input files (g_free); NULL
   and the exit code in *code. */
static char *experiment_text(const char *group, const char *resource,
                             const char *path, const GPtrArray *inputs,
                             int *code) {
  g_autofree char *from = g_build_path("/", "/opcflow", group, resource, NULL);
  g_autoptr(GBytes) bytes =
      g_resources_lookup_data(from, G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
  g_autofree char *template =
      g_strndup(g_bytes_get_data(bytes, NULL), g_bytes_get_size(bytes));
  return comparison_text(template, path, inputs, code);
}

/* Write the templates of an experiment on files of the process `path`, into
   `file` if it is not NULL. Return -1 or the exit code. */
static int write_experiment(const char *group, const char *path,
                            const char *file, const GPtrArray *inputs) {
  g_auto(GStrv) own = own_names(group);
  int code = -1;
  g_autoptr(GPtrArray) texts = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; own[i] && code < 0; i++)
    g_ptr_array_add(texts, experiment_text(group, own[i], path, inputs, &code));
  for (guint i = 0; own[i] && code < 0; i++)
    code = template_write(file ? file : own[i], texts->pdata[i], FALSE);
  return code;
}

static int new_comparison(const GPtrArray *arguments) {
  if (!process || arguments->len < 2)
    return cli_error(CLI_USAGE,
                     "'new comparison' needs --process NAME and files, see "
                     "'opcflow help new'");
  g_autoptr(GPtrArray) inputs = g_ptr_array_new_with_free_func(g_free);
  int code = take_inputs(arguments, arguments->len, inputs);
  name = g_strdup("comparison");
  folder = g_strdup(".");
  g_autofree char *path = code < 0 ? find_process() : NULL;
  if (!path) return code < 0 ? CLI_USAGE : code;
  return write_experiment("comparison", path, NULL, inputs);
}

/* ---- a flow ---- */

/* Set `name`: "mine" for "mine.yaml". Return -1 or the exit code. */
static int name_after(const char *file) {
  name = g_strndup(file, strcspn(file, "."));
  for (char *c = name; *c; c++)
    if (!g_ascii_isalnum(*c) && *c != '-') *c = '_';
  if (g_ascii_isalnum(*name)) return -1;
  return cli_error(CLI_USAGE, "'%s' cannot be the name of a flow", file);
}

/* Set `folder`; return the name of the flow's file (g_free). */
static char *set_folder(const char *path) {
  folder = g_path_get_dirname(path);
  return g_path_get_basename(path);
}

/* Write a flow for the input files of a process. One file: a flow that extends
   the process. Several files or a folder: an experiment. The last of several
   arguments is the path of the flow if it ends with ".yaml". */
static int new_flow_of(const GPtrArray *arguments) {
  guint end = arguments->len;
  const char *last = arguments->pdata[end - 1];
  gboolean named = end > 2 && g_str_has_suffix(last, ".yaml");
  g_autofree char *file = set_folder(named ? last : "flow.yaml");
  g_autofree char *made = g_build_filename(folder, file, NULL);
  g_autoptr(GPtrArray) inputs = g_ptr_array_new_with_free_func(g_free);
  int code = take_inputs(arguments, named ? end - 1 : end, inputs);
  g_autofree char *path = code < 0 ? find_process() : NULL;
  if (!path) return code < 0 ? CLI_USAGE : code;
  if (g_file_test(made, G_FILE_TEST_EXISTS))
    return cli_error(CLI_IO,
                     "'%s' exists; another file: 'opcflow new flow --process "
                     "%s %s%s NAME.yaml'",
                     made, process, (char *)arguments->pdata[1],
                     inputs->len > 1 ? " ..." : "");
  g_autofree char *input = g_path_get_basename(inputs->pdata[0]);
  code = name_after(inputs->len > 1 ? file : input);
  if (code >= 0) return code;
  if (inputs->len == 1) return extend_process(path, inputs->pdata[0], file);
  for (guint i = 0; i < inputs->len; i++) {
    g_autofree char *given = inputs->pdata[i];
    inputs->pdata[i] = from_folder(given);
  }
  return write_experiment("several", path, file, inputs);
}

/* Report that an input file needs --process. */
static int lacks_process(const char *path) {
  g_autoptr(GPtrArray) flows = base_flows();
  g_autoptr(GPtrArray) names = base_names(flows);
  g_autofree char *all = known_names(names);
  return cli_error(CLI_USAGE,
                   "'%s' exists: create a flow for this file by 'opcflow new "
                   "flow --process NAME %s'%s",
                   path, path, all);
}

/* Write a flow and the files that the flow reads. Existing files are left
   unchanged. */
static int new_flow(const GPtrArray *arguments) {
  if (process)
    return arguments->len > 1
               ? new_flow_of(arguments)
               : cli_error(CLI_USAGE,
                           "'--process' requires INPUT, the input file of the "
                           "flow, several files or a folder");
  const char *path = arguments->len > 1 ? arguments->pdata[1] : "flow.yaml";
  if (!g_str_has_suffix(path, ".yaml") && g_file_test(path, G_FILE_TEST_EXISTS))
    return lacks_process(path);
  if (arguments->len > 2)
    return cli_error(CLI_USAGE, "'new flow' does not take '%s'",
                     (char *)arguments->pdata[2]);
  g_autofree char *file = set_folder(path);
  int code = name_after(file);
  g_auto(GStrv) read = own_names("flow/read");
  if (code < 0) code = put_own("flow", "flow.yaml", file, FALSE);
  for (guint i = 0; read[i] && code < 0; i++)
    code = put_own("flow/read", read[i], read[i], TRUE);
  return code;
}

/* ---- entry ---- */

static int files_print(void) {
  if (json) {
    JsonObject *o = json_object_new();
    cli_add_texts(o, "files", files);
    cli_print_object(o);
  }
  for (guint i = 0; i < files->len && !json; i++)
    cli_print("%s\n", (char *)files->pdata[i]);
  return CLI_GOOD;
}

static int new_run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  const char *what = arguments->pdata[0];
  gboolean plugin = !strcmp(what, "plugin");
  files = g_ptr_array_new_with_free_func(g_free);
  gboolean comparison = !strcmp(what, "comparison");
  if (!plugin && !comparison && strcmp(what, "flow") != 0)
    return cli_error(
        CLI_USAGE,
        "'new' creates a 'plugin', a 'flow' or a 'comparison', found '%s'",
        what);
  if (plugin && process)
    return cli_error(CLI_USAGE,
                     "'--process' requires 'new flow' and 'new comparison'");
  if (plugin && arguments->len > 3)
    return cli_error(CLI_USAGE, "'new plugin' does not take '%s'",
                     (char *)arguments->pdata[3]);
  int code = plugin       ? new_plugin(arguments)
             : comparison ? new_comparison(arguments)
                          : new_flow(arguments);
  return code < 0 ? files_print() : code;
}

const cli_verb devel_new = {CLI_NEW,        .options = options,
                            .least = 1,     .most = G_MAXUINT,
                            .run = new_run, .words = "comparison|flow|plugin"};
