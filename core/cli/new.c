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

static const char *kind;
static gboolean json;

static const cli_option options[] = {
    {"kind", "by default what NAME begins with", "KIND", .text = &kind},
    {"json", "tell the files as JSON", .flag = &json},
    {0}};

/* What is made. */
typedef struct work {
  char *id, *name; /* "step.mine", "mine" */
  char *kind;
  char *folder;     /* where everything goes */
  GPtrArray *files; /* char *: that were written */
} work;

/* ---- templates ---- */

static char *fill_in(const work *w, const char *text) {
  GString *out = g_string_new(text);
  g_string_replace(out, "@NAME@", w->name, 0);
  g_string_replace(out, "@ID@", w->id, 0);
  g_string_replace(out, "@KIND@", w->kind, 0);
  return g_string_free(out, FALSE);
}

/* Write a template into the folder; -1 or the exit code. A file that is there
   stays if `keep`. */
static int put(work *w, const char *name, const char *template, gboolean keep) {
  g_autofree char *file = fill_in(w, name);
  g_autofree char *text = fill_in(w, template);
  g_autofree char *path = g_build_filename(w->folder, file, NULL);
  if (g_file_test(path, G_FILE_TEST_EXISTS))
    return keep ? -1 : cli_error(CLI_IO, "'%s' exists", path);
  opc_error error;
  if (opc_write_file(path, text, &error)) return cli_fail(&error);
  g_ptr_array_add(w->files, g_steal_pointer(&path));
  return -1;
}

/* One of the command's own templates, as a file of that name. */
static int put_own(work *w, const char *group, const char *resource,
                   const char *name, gboolean keep) {
  g_autofree char *path = g_build_path("/", "/opcflow", group, resource, NULL);
  g_autoptr(GBytes) bytes =
      g_resources_lookup_data(path, G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
  g_autofree char *text =
      g_strndup(g_bytes_get_data(bytes, NULL), g_bytes_get_size(bytes));
  return put(w, name, text, keep);
}

/* All templates of a kind of plugin. */
static int put_all(work *w) {
  opc_error error = {0};
  const opc_kind *its = opc_kind_of(cli_registry(), w->kind, &error);
  if (!its) return cli_fail(&error);
  g_autofree char *group = g_build_path("/", "/opcflow", w->kind, NULL);
  g_auto(GStrv) own =
      g_resources_enumerate_children(group, G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
  int code = -1;
  for (guint i = 0; own && own[i] && code < 0; i++)
    code = put_own(w, w->kind, own[i], own[i], FALSE);
  for (size_t i = 0; i < its->n_templates && code < 0; i++)
    code = put(w, its->templates[i].name, its->templates[i].text, FALSE);
  if (own || its->n_templates) return code;
  return cli_error(CLI_PLUGIN, "the kind '%s' does not say how one begins",
                   w->kind);
}

/* ---- a plugin ---- */

/* The id and the kind from what was given of them; -1 or the exit code. */
static int settle_names(work *w, const char *name) {
  if (!opc_is_id(name))
    return cli_error(CLI_USAGE,
                     "'%s' is no name for a plugin: lower_case words with dots "
                     "between them",
                     name);
  const char *dot = strrchr(name, '.');
  g_autoptr(GPtrArray) kinds = opc_kind_names(cli_registry());
  w->kind = kind ? g_strdup(kind) : g_strndup(name, strcspn(name, "."));
  w->id = dot ? g_strdup(name) : g_strconcat(w->kind, ".", name, NULL);
  w->name = g_strdup(dot ? dot + 1 : name);
  if (g_ptr_array_find_with_equal_func(kinds, w->kind, g_str_equal, NULL))
    return -1;
  if (!kind)
    return cli_error(CLI_USAGE,
                     "'new plugin' needs --kind, see 'opcflow help new'");
  g_autofree char *suggestion = opc_suggestion(kind, kinds);
  return cli_error(CLI_USAGE, "unknown kind '%s'%s", kind,
                   *suggestion ? suggestion : ", see 'opcflow help new'");
}

static int make_folder(const char *path) {
  g_autoptr(GDir) dir = g_dir_open(path, 0, NULL);
  gboolean taken = dir ? g_dir_read_name(dir) != NULL
                       : g_file_test(path, G_FILE_TEST_EXISTS);
  if (taken) return cli_error(CLI_IO, "'%s' exists", path);
  if (!g_mkdir_with_parents(path, 0777)) return -1;
  return cli_error(CLI_IO, "'%s': %s", path, g_strerror(errno));
}

static int new_plugin(work *w, const GPtrArray *arguments) {
  if (arguments->len < 2)
    return cli_error(CLI_USAGE,
                     "'new plugin' needs NAME, see 'opcflow help new'");
  int code = settle_names(w, arguments->pdata[1]);
  if (code >= 0) return code;
  w->folder = g_strdup(arguments->len > 2 ? arguments->pdata[2] : w->id);
  code = make_folder(w->folder);
  return code < 0 ? put_all(w) : code;
}

/* ---- a flow ---- */

/* What the flow reads may be there already. */
static int new_flow(work *w, const GPtrArray *arguments) {
  const char *path = arguments->len > 1 ? arguments->pdata[1] : "flow.yaml";
  if (arguments->len > 2)
    return cli_error(CLI_USAGE, "'new flow' does not take '%s'",
                     (char *)arguments->pdata[2]);
  g_autofree char *file = g_path_get_basename(path);
  w->folder = g_path_get_dirname(path);
  w->id = g_strdup("");
  w->kind = g_strdup("");
  w->name = g_strndup(file, strcspn(file, "."));
  for (char *c = w->name; *c; c++)
    if (!g_ascii_isalnum(*c) && *c != '-') *c = '_';
  if (!g_ascii_isalnum(*w->name))
    return cli_error(CLI_USAGE, "'%s' is no name for a flow", file);
  int code = put_own(w, "flow", "flow.yaml", file, FALSE);
  g_auto(GStrv) read = g_resources_enumerate_children(
      "/opcflow/flow/read", G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
  for (guint i = 0; read[i] && code < 0; i++)
    code = put_own(w, "flow/read", read[i], read[i], TRUE);
  return code;
}

/* ---- entry ---- */

static void tell(const work *w) {
  if (json) {
    JsonObject *o = json_object_new();
    cli_add_texts(o, "files", w->files);
    cli_print_object(o);
    return;
  }
  for (guint i = 0; i < w->files->len; i++)
    cli_print("%s\n", (char *)w->files->pdata[i]);
}

static int run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  const char *what = arguments->pdata[0];
  work w = {.files = g_ptr_array_new_with_free_func(g_free)};
  int code;
  if (!strcmp(what, "plugin"))
    code = new_plugin(&w, arguments);
  else if (!strcmp(what, "flow"))
    code = new_flow(&w, arguments);
  else
    code = cli_error(CLI_USAGE, "'new' makes a 'plugin' or a 'flow', not '%s'",
                     what);
  if (code < 0) tell(&w);
  g_free(w.id);
  g_free(w.name);
  g_free(w.kind);
  g_free(w.folder);
  g_ptr_array_free(w.files, TRUE);
  return MAX(code, CLI_GOOD);
}

const cli_verb cli_new = {.name = "new",
                          .arguments = "plugin NAME [DIR] | flow [FILE]",
                          .summary = "Write a plugin or a flow to begin with",
                          .options = options,
                          .least = 1,
                          .most = 3,
                          .run = run,
                          .words = "flow|plugin"};
