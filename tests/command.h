/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs of the opcflow command in a temporary folder. */
#pragma once

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <sys/wait.h>

#include <store/files.h>

static char *folder, *command;

/* Output of the last command. */
static char *out, *err;

/* Remove the lines of steps that took seconds, as on a loaded machine. */
static inline char *without_times(const char *text) {
  g_autoptr(GRegex) times =
      g_regex_new("^(point \\d+/\\d+ )?\\[\\d+/\\d+\\] \\S+: [\\d.]+ s\\n",
                  G_REGEX_MULTILINE | G_REGEX_RAW, 0, NULL);
  return g_regex_replace_literal(times, text, -1, 0, "", 0, NULL);
}

/* Run a program; return its exit code, or 128 plus the signal that ended it. */
static inline int program_spawn(const char *const *argv) {
  int status;
  g_clear_pointer(&out, g_free);
  g_clear_pointer(&err, g_free);
  g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH,
                             NULL, NULL, &out, &err, &status, NULL));
  char *text = without_times(err);
  g_free(err);
  err = text;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* Run opcflow with the words of `line`, in which '~' stands for a space; return
   the exit code. */
static inline int opcflow_call(const char *line) {
  g_auto(GStrv) words = g_strsplit(line, " ", -1);
  g_autoptr(GPtrArray) argv = g_ptr_array_new();
  g_ptr_array_add(argv, command);
  for (guint i = 0; words[i]; i++)
    g_ptr_array_add(argv, g_strdelimit(words[i], "~", ' '));
  g_ptr_array_add(argv, NULL);
  return program_spawn((const char *const *)argv->pdata);
}

/* Start a run. Return after a plugin has reported the start of an endless
   loop. */
static inline GSubprocess *start_loop(const char *flow) {
  const char *argv[] = {command, "run", flow, "--output", "x", NULL};
  GError *fault = NULL;
  GSubprocess *process =
      g_subprocess_newv(argv, G_SUBPROCESS_FLAGS_STDERR_PIPE, &fault);
  g_assert_no_error(fault);
  GInputStream *errors = g_subprocess_get_stderr_pipe(process);
  for (char c = 0; c != '\n';)
    g_assert_cmpint(g_input_stream_read(errors, &c, 1, NULL, NULL), ==, 1);
  return process;
}

static inline void write_text(const char *name, const char *text) {
  g_assert_true(g_file_set_contents(name, text, -1, NULL));
}

static inline char *read_text(const char *name) {
  char *text = NULL;
  g_assert_true(g_file_get_contents(name, &text, NULL, NULL));
  return text;
}

static inline gboolean is_there(const char *name) {
  return g_file_test(name, G_FILE_TEST_EXISTS);
}

/* Return the number of entries in a folder, including hidden entries. */
static inline guint entries(const char *name) {
  guint n = 0;
  GDir *dir = g_dir_open(name, 0, NULL);
  while (dir && g_dir_read_name(dir)) n++;
  if (dir) g_dir_close(dir);
  return n;
}

/* Create the temporary folder with the test plugins and, if `with_own` is set,
   with the plugins of opcflow. */
static inline void set_up(gboolean with_own) {
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  const char *build = g_getenv("OPCFLOW_BUILD");
  command = g_build_filename(build, "opcflow", NULL);
  g_autofree char *own = g_strdup_printf(":%s/plugins", build);
  g_autofree char *path =
      g_strdup_printf("%s/tests%s", build, with_own ? own : "");
  g_setenv("OPCFLOW_PLUGIN_PATH", path, TRUE);
}

/* Write a flow of two steps. The second step in the file runs first. */
static inline void write_two(void) {
  write_text("in.txt", "some input\n");
  write_text("two.yaml",
             "opcflow: 1\nname: two\nsteps:\n"
             "  b: { use: test.numbers, size: 2 nm, add: ${a} }\n"
             "  a: { use: test.numbers, size: 0.065 um, input: in.txt, output: "
             "deep/er/out.txt }\n");
}

/* Run the registered tests, remove the folder, and return the exit code. */
static inline int run_all(void) {
  int failed = g_test_run();
  g_assert_cmpint(g_chdir("/"), ==, 0);
  opc_remove_tree(folder);
  g_free(folder);
  g_free(command);
  g_free(out);
  g_free(err);
  return failed;
}
