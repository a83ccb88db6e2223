/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs of whole flows through the command, and access to their results. */
#pragma once

#include <glib.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <sys/wait.h>

#include <store/files.h>
#include "tests/data.h"

static char *folder; /* parent of all run folders; removed at the end */

/* Run opcflow with the arguments `first`, ..., NULL in `folder`. Return the
   exit code. *errors receives the standard error (g_free) unless `errors` is
   NULL. */
static inline int opcflow(char **errors, const char *first, ...) {
  g_autoptr(GPtrArray) argv = g_ptr_array_new_with_free_func(g_free);
  g_ptr_array_add(argv,
                  g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL));
  va_list args;
  va_start(args, first);
  for (const char *a = first; a; a = va_arg(args, const char *))
    g_ptr_array_add(argv, g_strdup(a));
  va_end(args);
  g_ptr_array_add(argv, NULL);
  g_autoptr(GError) error = NULL;
  g_autofree char *out = NULL, *err = NULL;
  int status;
  g_spawn_sync(folder, (char **)argv->pdata, NULL, 0, NULL, NULL, &out, &err,
               &status, &error);
  g_assert_no_error(error);
  g_assert_true(WIFEXITED(status)); /* not ended by a signal */
  if (errors)
    *errors = g_steal_pointer(&err);
  else if (WEXITSTATUS(status))
    g_test_message("%s", err);
  return WEXITSTATUS(status);
}

static inline char *place(const char *name) {
  return g_build_filename(folder, name, NULL);
}

static inline void write_file(const char *name, const char *text) {
  g_autofree char *path = place(name);
  g_autofree char *parent = g_path_get_dirname(path);
  g_assert_cmpint(g_mkdir_with_parents(parent, 0777), ==, 0);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
}

static inline char *read_file(const char *run, const char *name) {
  g_autofree char *path = g_build_filename(folder, run, name, NULL);
  char *text = NULL;
  if (!g_file_get_contents(path, &text, NULL, NULL))
    g_error("'%s' does not exist", path);
  return text;
}

static inline GBytes *bytes(const char *run, const char *file) {
  g_autofree char *path = g_build_filename(folder, run, file, NULL);
  char *text = NULL;
  gsize length;
  g_file_get_contents(path, &text, &length, NULL);
  g_assert_nonnull(text);
  return g_bytes_new_take(text, length);
}

static inline void expect_equal(const char *run, const char *other,
                                const char *file) {
  g_autoptr(GBytes) a = bytes(run, file), b = bytes(other, file);
  if (!g_bytes_equal(a, b))
    g_error("%s differs between %s and %s", file, run, other);
}

/* Return a metric of a step of a run. */
static inline double metric(const char *run, const char *step,
                            const char *name) {
  g_autoptr(GBytes) text = bytes(run, "metrics.json");
  g_autoptr(JsonParser) parser = json_parser_new();
  g_assert_true(json_parser_load_from_data(parser, g_bytes_get_data(text, NULL),
                                           (gssize)g_bytes_get_size(text),
                                           NULL));
  JsonObject *o = json_node_get_object(json_parser_get_root(parser));
  g_assert_true(json_object_has_member(o, step));
  o = json_object_get_object_member(o, step);
  g_assert_true(json_object_has_member(o, name));
  return json_object_get_double_member(json_object_get_object_member(o, name),
                                       "value");
}

/* Return whether a plugin is available. Some plugins are not built if their
   libraries are missing. */
static inline int plugin_available(const char *id) {
  g_autofree char *errors = NULL;
  if (opcflow(&errors, "inspect", id, NULL) == 0) return TRUE;
  g_test_skip(id);
  return FALSE;
}

/* Create the folder. */
static inline void begin_flows(void) {
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
}

/* Run the registered tests and remove the folder. */
static inline int run_flows(void) {
  int code = g_test_run();
  opc_remove_tree(folder);
  g_free(folder);
  return code;
}
