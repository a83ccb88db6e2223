/* SPDX-License-Identifier: BSD-3-Clause */
/* Files to begin with: a plugin that works, a flow that runs. The texts are
   those of data/templates, with @WORDS@ filled in. */
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/flow/files.h"
#include "core/plugin/declaration.h"

typedef struct request {
  const char *kind; /* "mask" */
  char *id, *name;  /* "mask.mine", "mine" */
  char *folder;     /* where everything goes */
  GPtrArray *files; /* that were written */
  gboolean json;
} request;

/* The plugin of each slot of the flow, with its parameters. */
static const struct {
  const char *kind, *mark, *use;
} slots[] = {
    {"litho", "@LITHO@", "litho.hopkins, na: 0.75, sigma: 0.75"},
    {"resist", "@RESIST@",
     "resist.threshold, anchor: { line: 65 nm, pitch: 250 nm }"},
    {"extract", "@EXTRACT@", "extract.plain, devices: ptm65.yaml"},
    {"mask", "@MASK@", "mask.dpb, max_pde: 0.5 %"},
    {"drc", "@DRC@", "drc.regulator, min_extension: 40 nm"},
};

/* ---- texts ---- */

static void replace(GString *text, const char *mark, const char *by) {
  g_string_replace(text, mark, by, 0);
}

/* A step of its own, for a plugin that is none of a slot. */
static char *own_step(const request *r) {
  if (g_strcmp0(r->kind, "step")) return g_strdup("");
  return g_strdup_printf("  %s:\n    use: %s\n    gates: ${gates}\n", r->name,
                         r->id);
}

static char *fill_in(const request *r, const char *text) {
  GString *out = g_string_new(text);
  g_autofree char *step = own_step(r);
  replace(out, "@STEP@\n", step);
  for (size_t i = 0; i < G_N_ELEMENTS(slots); i++)
    replace(out, slots[i].mark,
            g_strcmp0(r->kind, slots[i].kind) ? slots[i].use : r->id);
  replace(out, "@NAME@", r->name);
  replace(out, "@ID@", r->id ? r->id : "");
  replace(out, "@KIND@", r->kind ? r->kind : "");
  return g_string_free(out, FALSE);
}

/* Write the template as `file` into the folder; -1 or the exit code. A file
   that is there stays if `keep`. */
static int put(const request *r, const char *name, const char *file,
               gboolean keep) {
  g_autofree char *path = g_build_filename(r->folder, file, NULL);
  g_autofree char *resource = g_strconcat("/opcflow/", name, NULL);
  if (g_file_test(path, G_FILE_TEST_EXISTS)) {
    if (keep) return -1;
    cli_message("error", "'%s' exists", path);
    return CLI_IO;
  }
  g_autoptr(GBytes) bytes =
      g_resources_lookup_data(resource, G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
  g_autofree char *text =
      g_strndup(g_bytes_get_data(bytes, NULL), g_bytes_get_size(bytes));
  g_autofree char *whole = fill_in(r, text);
  opc_error error;
  if (opc_write_file(path, whole, &error)) {
    cli_message("error", "%s", error.message);
    return CLI_IO;
  }
  g_ptr_array_add(r->files, g_strdup(path));
  return -1;
}

static int tell(const request *r) {
  if (!r->json) {
    for (guint i = 0; i < r->files->len; i++)
      cli_print("%s\n", (char *)r->files->pdata[i]);
    return CLI_GOOD;
  }
  g_autoptr(JsonBuilder) b = json_builder_new();
  json_builder_begin_object(b);
  json_builder_set_member_name(b, "files");
  json_builder_begin_array(b);
  for (guint i = 0; i < r->files->len; i++)
    json_builder_add_string_value(b, r->files->pdata[i]);
  json_builder_end_array(b);
  json_builder_end_object(b);
  cli_print_json(json_builder_get_root(b));
  return CLI_GOOD;
}

/* ---- a plugin ---- */

/* The id and the kind from what was given of them; -1 or the exit code. */
static int settle_names(request *r, const char *name) {
  if (!opc_is_id(name)) {
    cli_message("error",
                "'%s' is no name for a plugin: lower_case words with dots "
                "between them",
                name);
    return CLI_USAGE;
  }
  const char *dot = strrchr(name, '.');
  g_autofree char *family =
      dot ? g_strndup(name, strcspn(name, ".")) : g_strdup("");
  if (!r->kind && opc_kind_find(family))
    r->kind = opc_kind_name(opc_kind_find(family));
  if (!r->kind || !opc_kind_find(r->kind)) {
    cli_message("error", "%s%s%s, see 'opcflow help new'",
                r->kind ? "unknown kind '" : "'new plugin' needs --kind",
                r->kind ? r->kind : "", r->kind ? "'" : "");
    return CLI_USAGE;
  }
  r->id = dot ? g_strdup(name) : g_strconcat(r->kind, ".", name, NULL);
  r->name = g_strdup(dot ? dot + 1 : name);
  return -1;
}

static int make_folder(const char *path) {
  g_autoptr(GDir) dir = g_dir_open(path, 0, NULL);
  gboolean taken = dir ? g_dir_read_name(dir) != NULL
                       : g_file_test(path, G_FILE_TEST_EXISTS);
  if (taken) {
    cli_message("error", "'%s' exists", path);
    return CLI_IO;
  }
  if (!g_mkdir_with_parents(path, 0777)) return -1;
  cli_message("error", "'%s': %s", path, g_strerror(errno));
  return CLI_IO;
}

static int new_plugin(request *r, const GPtrArray *rest) {
  if (rest->len < 2) {
    cli_message("error", "'new plugin' needs NAME, see 'opcflow help new'");
    return CLI_USAGE;
  }
  int code = settle_names(r, rest->pdata[1]);
  if (code >= 0) return code;
  r->folder = g_strdup(rest->len > 2 ? rest->pdata[2] : r->id);
  code = make_folder(r->folder);
  g_autofree char *source = g_strconcat(r->kind, ".c", NULL);
  g_autofree char *file = g_strconcat(r->name, ".c", NULL);
  const char *const files[][2] = {{source, file},
                                  {"meson.build", "meson.build"},
                                  {"flow.yaml", "flow.yaml"},
                                  {"README.md", "README.md"},
                                  {"nand2.cif", "nand2.cif"},
                                  {"ptm65.yaml", "ptm65.yaml"}};
  for (size_t i = 0; i < G_N_ELEMENTS(files) && code < 0; i++)
    code = put(r, files[i][0], files[i][1], FALSE);
  return code < 0 ? tell(r) : code;
}

/* ---- a flow ---- */

static int new_flow(request *r, const GPtrArray *rest) {
  const char *path = rest->len > 1 ? rest->pdata[1] : "flow.yaml";
  if (rest->len > 2) {
    cli_message("error", "'new flow' does not take '%s'",
                (char *)rest->pdata[2]);
    return CLI_USAGE;
  }
  g_autofree char *file = g_path_get_basename(path);
  r->folder = g_path_get_dirname(path);
  r->name = g_strndup(file, strcspn(file, "."));
  for (char *c = r->name; *c; c++)
    if (!g_ascii_isalnum(*c) && *c != '-') *c = '_';
  if (!g_ascii_isalnum(*r->name)) {
    cli_message("error", "'%s' is no name for a flow", file);
    return CLI_USAGE;
  }
  int code = put(r, "flow.yaml", file, FALSE);
  if (code < 0) code = put(r, "nand2.cif", "nand2.cif", TRUE);
  if (code < 0) code = put(r, "ptm65.yaml", "ptm65.yaml", TRUE);
  return code < 0 ? tell(r) : code;
}

/* ---- entry ---- */

static int run(const cli_verb *verb, int argc, char **argv) {
  request r = {0};
  const cli_option options[] = {
      {"kind", "KIND",
       "litho, resist, extract, mask, drc or step; by default what NAME begins "
       "with",
       NULL, &r.kind, NULL},
      {"json", NULL, "tell the files as JSON", &r.json, NULL, NULL},
      {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 1, 3, rest);
  if (code >= 0) return code;
  const char *what = rest->pdata[0];
  g_autoptr(GPtrArray) files = g_ptr_array_new_with_free_func(g_free);
  r.files = files;
  if (!strcmp(what, "plugin")) {
    code = new_plugin(&r, rest);
  } else if (!strcmp(what, "flow")) {
    code = new_flow(&r, rest);
  } else {
    cli_message("error", "'new' makes a 'plugin' or a 'flow', not '%s'", what);
    code = CLI_USAGE;
  }
  g_free(r.id);
  g_free(r.name);
  g_free(r.folder);
  return code;
}

const cli_verb cli_new = {.name = "new",
                          .arguments = "plugin NAME [DIR] | flow [FILE]",
                          .summary = "Write a plugin or a flow to begin with",
                          .run = run,
                          .words = "flow|plugin"};
