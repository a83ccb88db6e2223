/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow new: files to begin with, of a plugin that works or of a flow that
   runs. The texts are the templates of the plugin's kind; those of steps,
   commands and flows lie in data/templates. */
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/flow/files.h"
#include "core/plugin/declaration.h"
#include "core/plugin/kind.h"
#include "core/text/suggest.h"

static const char *wanted; /* --kind */
static gboolean json;

static const cli_option options[] = {
    {"kind", "by default what NAME begins with", "KIND", .text = &wanted},
    {"json", "tell the files as JSON", .flag = &json},
    {0}};

/* What is made: its name "mine", of a plugin also its id "step.mine" and its
   kind; the folder where everything goes; the files that were written. */
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

/* Write a template into the folder; -1 or the exit code. A file that is there
   stays if `keep`. */
static int put(const char *file, const char *template, gboolean keep) {
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

/* One of the command's own templates. */
static int put_own(const char *group, const char *resource, const char *file,
                   gboolean keep) {
  g_autofree char *path = g_build_path("/", "/opcflow", group, resource, NULL);
  g_autoptr(GBytes) bytes =
      g_resources_lookup_data(path, G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
  g_autofree char *text =
      g_strndup(g_bytes_get_data(bytes, NULL), g_bytes_get_size(bytes));
  return put(file, text, keep);
}

/* The names of those; NULL if there are none. */
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

/* Name, id and kind from what was given of them; -1 or the exit code. */
static int settle_names(const char *given) {
  if (!opc_is_id(given))
    return cli_error(CLI_USAGE,
                     "'%s' is no name for a plugin: lower_case words with dots "
                     "between them",
                     given);
  const char *dot = strrchr(given, '.');
  g_autoptr(GPtrArray) kinds = opc_kind_names(cli_registry());
  kind = wanted ? g_strdup(wanted) : g_strndup(given, strcspn(given, "."));
  id = dot ? g_strdup(given) : g_strconcat(kind, ".", given, NULL);
  name = g_strdup(dot ? dot + 1 : given);
  if (!strcmp(kind, OPC_KIND_COMMAND) && is_own_verb(name))
    return cli_error(CLI_USAGE,
                     "'opcflow %s' is there already: a plugin '%s' would never "
                     "be called",
                     name, id);
  if (g_ptr_array_find_with_equal_func(kinds, kind, g_str_equal, NULL))
    return -1;
  if (!wanted)
    return cli_error(CLI_USAGE,
                     "'new plugin' needs --kind, see 'opcflow help new'");
  g_autofree char *suggestion = opc_suggestion(kind, kinds);
  return cli_error(CLI_USAGE, "unknown kind '%s'%s", kind,
                   *suggestion ? suggestion : ", see 'opcflow help new'");
}

static int make_folder(void) {
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  gboolean taken = dir ? g_dir_read_name(dir) != NULL
                       : g_file_test(folder, G_FILE_TEST_EXISTS);
  if (taken) return cli_error(CLI_IO, "'%s' exists", folder);
  if (!g_mkdir_with_parents(folder, 0777)) return -1;
  return cli_error(CLI_IO, "'%s': %s", folder, g_strerror(errno));
}

/* All templates of its kind; those of the kernel's kinds are the command's own.
 */
static int new_plugin(const GPtrArray *arguments) {
  if (arguments->len < 2)
    return cli_error(CLI_USAGE,
                     "'new plugin' needs NAME, see 'opcflow help new'");
  int code = settle_names(arguments->pdata[1]);
  if (code >= 0) return code;
  opc_error error = {0};
  const opc_kind *its = opc_kind_of(cli_registry(), kind, &error);
  if (!its) return cli_fail(&error);
  g_auto(GStrv) own = own_names(kind);
  if (!own && !its->n_templates)
    return cli_error(CLI_PLUGIN, "the kind '%s' does not say how one begins",
                     kind);
  folder = g_strdup(arguments->len > 2 ? arguments->pdata[2] : id);
  code = make_folder();
  for (guint i = 0; own && own[i] && code < 0; i++)
    code = put_own(kind, own[i], own[i], FALSE);
  for (size_t i = 0; i < its->n_templates && code < 0; i++)
    code = put(its->templates[i].name, its->templates[i].text, FALSE);
  return code;
}

/* ---- a flow ---- */

/* What the flow reads may be there already. */
static int new_flow(const GPtrArray *arguments) {
  const char *path = arguments->len > 1 ? arguments->pdata[1] : "flow.yaml";
  if (arguments->len > 2)
    return cli_error(CLI_USAGE, "'new flow' does not take '%s'",
                     (char *)arguments->pdata[2]);
  g_autofree char *file = g_path_get_basename(path);
  folder = g_path_get_dirname(path);
  name = g_strndup(file, strcspn(file, "."));
  for (char *c = name; *c; c++)
    if (!g_ascii_isalnum(*c) && *c != '-') *c = '_';
  if (!g_ascii_isalnum(*name))
    return cli_error(CLI_USAGE, "'%s' is no name for a flow", file);
  g_auto(GStrv) read = own_names("flow/read");
  int code = put_own("flow", "flow.yaml", file, FALSE);
  for (guint i = 0; read[i] && code < 0; i++)
    code = put_own("flow/read", read[i], read[i], TRUE);
  return code;
}

/* ---- entry ---- */

static int tell(void) {
  if (json) {
    JsonObject *o = json_object_new();
    cli_add_texts(o, "files", files);
    cli_print_object(o);
  }
  for (guint i = 0; i < files->len && !json; i++)
    cli_print("%s\n", (char *)files->pdata[i]);
  return CLI_GOOD;
}

static int run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  const char *what = arguments->pdata[0];
  gboolean plugin = !strcmp(what, "plugin");
  files = g_ptr_array_new_with_free_func(g_free);
  if (!plugin && strcmp(what, "flow") != 0)
    return cli_error(CLI_USAGE, "'new' makes a 'plugin' or a 'flow', not '%s'",
                     what);
  int code = plugin ? new_plugin(arguments) : new_flow(arguments);
  return code < 0 ? tell() : code;
}

const cli_verb cli_new = {.name = "new",
                          .arguments = "plugin NAME [DIR] | flow [FILE]",
                          .summary = "Write a plugin or a flow to begin with",
                          .options = options,
                          .least = 1,
                          .most = 3,
                          .run = run,
                          .words = "flow|plugin"};
