/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow lint: checks the symbols that a plugin exports, runs each check in a
   child process, and prints the findings. */
#include "tools/devel/lint.h"

#include <errno.h>
#include <fcntl.h>
#include <guard/child.h>
#include <guard/guard.h>
#include <stdlib.h>
#include <store/files.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/cli/cli.h"
#include "tools/devel/verbs.h"

/* ---- one check ---- */

/* Store a line of a check's output; the first letter is the kind of the line
   (report_text in checks.c). Store equal faults and notes only once. Keep the
   first digest in *digest, unless a later digest differs from `first`. */
static void take_line(opc_lint *lint, const char *line, const char *first,
                      char **digest) {
  if (*line == 'S') lint->sample = strtoul(line + 1, NULL, 10);
  if (*line == 'D' && (!*digest || strcmp(line + 1, first ? first : ""))) {
    g_free(*digest);
    *digest = g_strdup(line + 1);
  }
  GPtrArray *list = *line == 'F' ? lint->findings : lint->notes;
  if ((*line != 'F' && *line != 'N') ||
      g_ptr_array_find_with_equal_func(list, line + 1, g_str_equal, NULL))
    return;
  g_ptr_array_add(list, g_strdup(line + 1));
}

typedef struct check_task {
  const opc_lint *lint;
  size_t check;
} check_task;

static void do_in_child(int out, void *data) {
  const check_task *j = data;
  opc_check_do(j->lint, j->check, out);
}

/* Run check i in a child process; see take_line. Return FALSE if the process
   crashed, ended early, or wrote no output within the time limit. */
static gboolean run_check(opc_lint *lint, size_t i, const char *first,
                          char **digest) {
  const char *name = opc_checks[i].name;
  gboolean ended = FALSE, blamed = FALSE;
  int end;
  check_task j = {lint, i};
  g_autoptr(GString) text = child_run(do_in_child, &j, lint->seconds, &end);
  g_auto(GStrv) lines = g_strsplit(text->str, "\n", -1);
  for (guint k = 0; lines[k]; k++) {
    ended |= *lines[k] == 'E';
    blamed |= *lines[k] == 'B';
    take_line(lint, lines[k], first, digest);
  }
  char *crash = NULL;
  if (end == CHILD_LATE)
    crash =
        g_strdup_printf("no sign of life for %g s: %s", lint->seconds, name);
  else if (end > 0)
    crash = g_strdup_printf("crashes (%s): %s", g_strsignal(end), name);
  else if (!ended && !blamed)
    crash = g_strdup_printf("ends the process: %s", name);
  if (crash) g_ptr_array_add(lint->findings, crash);
  return ended && !crash;
}

/* ---- exports ---- */

/* Check the exported symbols with `nm`, which does not execute the object.
   Plugins that are not shared objects, such as Python files, are not checked.
   g_spawn_sync leaves no thread running, so that this process can fork later.
   Return FALSE if the file is not a shared object. */
static gboolean check_exports(opc_lint *lint) {
  g_autofree char *base = g_path_get_basename(lint->path);
  if (!g_str_has_suffix(base, ".so") && strcmp(base, lint->id)) return TRUE;
  const char *const argv[] = {
      "nm", "-D", "--defined-only", "--format=posix", lint->path, NULL};
  g_autofree char *text = NULL;
  int status;
  if (!g_spawn_sync(NULL, (char **)argv, NULL,
                    G_SPAWN_SEARCH_PATH | G_SPAWN_STDERR_TO_DEV_NULL, NULL,
                    NULL, &text, NULL, &status, NULL)) {
    g_ptr_array_add(lint->notes,
                    g_strdup("exports: the program nm is missing"));
    return TRUE;
  }
  if (status) {
    g_ptr_array_add(lint->findings,
                    g_strdup("not a shared object of this machine"));
    return FALSE;
  }
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  for (guint i = 0; lines[i]; i++) {
    g_autofree char *name = g_strndup(lines[i], strcspn(lines[i], " @"));
    /* Linkers and compilers add names that begin with '_'. */
    if (!*name || !strcmp(name, OPC_ENTRY_NAME) || *name == '_') continue;
    g_ptr_array_add(
        lint->findings,
        g_strdup_printf("exports '%s'; only " OPC_ENTRY_NAME " may be exported",
                        name));
  }
  g_ptr_array_add(lint->checked, g_strdup("exports"));
  return TRUE;
}

/* ---- all checks ---- */

/* Start a process that removes the folder when this process ends for any
   reason. Return 0 on failure. */
static int start_cleaner(opc_lint *lint) {
  int ends[2];
  char none;
  if (pipe2(ends, O_CLOEXEC)) return 0;
  lint->cleaner = fork();
  if (!lint->cleaner) {
    setsid(); /* not ended by Ctrl-C */
    guard_remove();
    close(ends[1]);
    while (read(ends[0], &none, 1) < 0) continue;
    opc_remove_tree(lint->folder);
    _exit(0);
  }
  close(ends[0]);
  lint->alive = ends[1];
  return lint->cleaner > 0;
}

/* Initialise a lint. `folder` is NULL if it or its cleaner cannot be created.
 */
static opc_lint lint_begin(const char *path, opc_registry *registry,
                           const char *parameters, double seconds) {
  g_autofree char *base = g_path_get_basename(path);
  opc_lint lint = {.path = path,
                   .id = opc_registry_id(registry, path),
                   .registry = registry,
                   .parameters = parameters,
                   .seconds = seconds,
                   .folder = g_dir_make_tmp("opcflow-lint-XXXXXX", NULL),
                   .findings = g_ptr_array_new_with_free_func(g_free),
                   .checked = g_ptr_array_new_with_free_func(g_free),
                   .notes = g_ptr_array_new_with_free_func(g_free)};
  if (!lint.folder || start_cleaner(&lint)) return lint;
  opc_remove_tree(lint.folder);
  g_clear_pointer(&lint.folder, g_free);
  return lint;
}

/* Add notes that check i and all later checks were skipped. */
static void give_up(opc_lint *lint, size_t i, const char *why) {
  for (; opc_checks[i].name; i++)
    g_ptr_array_add(lint->notes,
                    g_strdup_printf("%s: %s", opc_checks[i].name, why));
}

/* Run all checks. Checks that compare digests require a first digest. */
static void lint_run(opc_lint *lint) {
  g_autofree char *first = NULL;
  if (!lint->folder)
    g_ptr_array_add(lint->findings, g_strdup("no folder for example files"));
  if (!lint->folder || !check_exports(lint)) {
    give_up(lint, 0, "the plugin was not loaded");
    return;
  }
  for (size_t i = 0; opc_checks[i].name; i++) {
    guint findings = lint->findings->len, notes = lint->notes->len;
    g_autofree char *digest = NULL;
    const opc_check *check = &opc_checks[i];
    if (check->differs && !first) continue; /* nothing to compare with */
    gboolean survived = run_check(lint, i, first, &digest);
    if (!survived || (i == 0 && lint->findings->len > findings &&
                      strstr(lint->findings->pdata[findings], "cannot use"))) {
      give_up(lint, i + 1,
              "an earlier check failed to complete, or the plugin cannot be "
              "used");
      return;
    }
    if (check->differs && digest && g_strcmp0(first, digest))
      g_ptr_array_add(lint->findings, g_strdup(check->differs));
    if (check->works ? digest != NULL : lint->notes->len == notes)
      g_ptr_array_add(lint->checked, g_strdup(check->name));
    if (!first) first = g_steal_pointer(&digest);
  }
}

static void lint_end(opc_lint *lint) {
  if (lint->folder) {
    close(lint->alive);
    while (waitpid(lint->cleaner, NULL, 0) < 0 && errno == EINTR) continue;
  }
  g_free(lint->folder);
  g_free(lint->id);
  g_ptr_array_free(lint->findings, TRUE);
  g_ptr_array_free(lint->checked, TRUE);
  g_ptr_array_free(lint->notes, TRUE);
}

/* ---- the verb ---- */

/* Value of opc_lint.seconds. */
static const double patience = 15;

/* Unless GLIBC_TUNABLES is set, restart the command with guard pages around the
   arrays of plugins, and without malloc's per-thread cache. Free memory in that
   cache counts as used and would be reported as a leak. */
static void restart_without_cache(void) {
  if (g_getenv("GLIBC_TUNABLES")) return;
  g_setenv("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0", TRUE);
  g_setenv("OPCFLOW_GUARD", "pages", TRUE);
  cli_become("/proc/self/exe");
}

static void print_json(const opc_lint *lint) {
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "plugin", lint->id);
  cli_add_texts(o, "findings", lint->findings);
  cli_add_texts(o, "checked", lint->checked);
  cli_add_texts(o, "not_checked", lint->notes);
  cli_print_object(o);
}

static void append_all(GString *line, const GPtrArray *texts, const char *gap) {
  if (!texts->len) g_string_append(line, "nothing");
  for (guint i = 0; i < texts->len; i++)
    g_string_append_printf(line, "%s%s", i ? gap : "", (char *)texts->pdata[i]);
}

/* Print the findings, then a line of completed and skipped checks. */
static void print_text(const opc_lint *lint) {
  for (guint i = 0; i < lint->findings->len; i++)
    cli_print("%s: %s\n", lint->path, (char *)lint->findings->pdata[i]);
  g_autoptr(GString) line = g_string_new("checked: ");
  append_all(line, lint->checked, ", ");
  g_string_append(line, "; not checked: ");
  append_all(line, lint->notes, "; ");
  cli_message("note", "%s", line->str);
}

static gboolean json, strict;
static const char *parameters = "{}";

static const cli_option options[] = {
    {"with", "parameters of the plugin, as in a flow", "{ PARAMETER: VALUE }",
     .text = &parameters},
    {"strict", "fail if a check was skipped", .flag = &strict},
    {"json", "print the result as JSON", .flag = &json},
    {0}};

static int lint_verb_run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  const char *path = arguments->pdata[0];
  if (!g_file_test(path, G_FILE_TEST_IS_REGULAR))
    return cli_error(CLI_IO, "'%s': no such file", path);
  restart_without_cache();
  g_autofree char *folder = g_path_get_dirname(path);
  cli_look_first(folder);
  opc_lint lint = lint_begin(path, cli_registry(), parameters, patience);
  lint_run(&lint);
  if (json)
    print_json(&lint);
  else
    print_text(&lint);
  gboolean bad = lint.findings->len || (strict && lint.notes->len);
  lint_end(&lint);
  return bad ? CLI_LIMIT : CLI_GOOD;
}

const cli_verb devel_lint = {CLI_LINT, .options = options, .least = 1,
                             .most = 1, .run = lint_verb_run};
