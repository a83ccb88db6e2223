/* SPDX-License-Identifier: BSD-3-Clause */
/* Shell completion in bash and zsh, and manual pages formatted by groff. */
#include <glib/gstdio.h>
#include <string.h>
#include <sys/wait.h>

#include <store/files.h>

static char *folder, *command;

/* Run a shell script in the folder; return its standard output. Standard error
   must be empty. */
static char *bash(const char *script) {
  const char *const argv[] = {"bash", "-c", script, NULL};
  char *out = NULL;
  g_autofree char *err = NULL;
  int status;
  g_autoptr(GError) error = NULL;
  g_spawn_sync(folder, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL,
               &out, &err, &status, &error);
  g_assert_no_error(error);
  g_assert_cmpstr(err, ==, "");
  g_assert_cmpint(status, ==, 0);
  return out;
}

/* Return the completions of bash at the end of a line, separated by spaces. */
static char *offered(const char *line) {
  g_autofree char *script = g_strdup_printf(
      "source '%s/data/completion/opcflow.bash'\n"
      "COMP_LINE='%s'; COMP_POINT=${#COMP_LINE}\n"
      "_opcflow '%s'\n"
      "printf '%%s ' \"${COMPREPLY[@]}\"\n",
      g_getenv("OPCFLOW_SOURCE"), line, command);
  return bash(script);
}

/* Create a flow, a folder with another flow, and a folder with plugins. */
static void make_flows(void) {
  g_autofree char *second = g_build_filename(folder, "flows", NULL);
  if (g_mkdir(second, 0777)) return;
  g_autofree char *make = g_strdup_printf(
      "'%s' new flow first.yaml && rm ptm65.yaml && "
      "touch flows/second.yaml flows/other && ln -s '%s/tests' own",
      command, g_getenv("OPCFLOW_BUILD"));
  g_free(bash(make));
}

static void test_completion(void) {
  static const char *const cases[][2] = {
      {"opcflow ru", "run "},
      {"opcflow run --qu", "--quiet "},
      {"opcflow --plugin-path x ch", "check "},
      {"opcflow inspect synthesizer.d", "synthesizer.dpb "},
      {"opcflow new ", "comparison flow plugin "},
      {"opcflow new plugin --kind e", "extractor "},
      {"opcflow help ins", "inspect "},
      {"opcflow --plugin-path own ec", "echo "},
      {"opcflow echo --plugin-path=own --max", "--max-cases "},
      {"opcflow echo --plugin-path=own --mode f", "first "},
      {"opcflow run f", "first.yaml flows/ "},
      {"opcflow run flows/", "flows/second.yaml "},
      {"opcflow run first.yaml --set mask.litho.n", "mask.litho.na= "},
      {"opcflow run first.yaml --set=mask.extractor.ru",
       "mask.extractor.rule= "},
      {"opcflow run first.yaml --set mask.extractor.rule=",
       "contour gauss equal "},
      {"opcflow run first.yaml --output ", " "},
      {"opcflow run first.yaml --log d", "debug "},
      {"opcflow run first.yaml --set require.mask.fa", "require.mask.failed= "},
  };
  make_flows();
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *found = offered(cases[i][0]);
    g_test_message("%s", cases[i][0]);
    g_assert_cmpstr(found, ==, cases[i][1]);
  }
}

/* Each entry has a line, the line after Tab, and the completions. */
static void test_zsh(void) {
  static const char *const cases[][2] = {
      {"opcflow ru", "opcflow run |run"},
      {"opcflow run --qu", "opcflow run --quiet |--quiet"},
      {"opcflow --plugin-path x ch", "opcflow --plugin-path x check |check"},
      {"opcflow --plugin-path own ec", "opcflow --plugin-path own echo |echo"},
      {"opcflow inspect synthesizer.d",
       "opcflow inspect synthesizer.dpb |synthesizer.dpb"},
      {"opcflow new ", "opcflow new |comparison flow plugin"},
      {"opcflow new plugin --kind e",
       "opcflow new plugin --kind extractor |extractor"},
      {"opcflow run f", "opcflow run f|first.yaml flows/"},
      {"opcflow run flows/",
       "opcflow run flows/second.yaml |flows/second.yaml"},
      {"opcflow run first.yaml --set mask.litho.n",
       "opcflow run first.yaml --set mask.litho.na=|mask.litho.na="},
      {"opcflow run first.yaml --set=mask.extractor.ru",
       "opcflow run first.yaml "
       "--set=mask.extractor.rule=|mask.extractor.rule="},
      {"opcflow run first.yaml --set mask.extractor.rule=",
       "opcflow run first.yaml --set mask.extractor.rule=|contour equal gauss"},
      {"opcflow run first.yaml --set mask.extractor.rule=g",
       "opcflow run first.yaml --set mask.extractor.rule=gauss |gauss"},
      /* File names are completed by zsh. */
      {"opcflow run first.yaml --output fl",
       "opcflow run first.yaml --output flows/|flows"},
  };
  g_autofree char *zsh = g_find_program_in_path("zsh");
  if (!zsh) {
    g_test_skip("no zsh");
    return;
  }
  make_flows();
  g_autoptr(GString) script = g_string_new("printf '%s\\n'");
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    g_string_append_printf(script, " '%s'", cases[i][0]);
  g_string_append_printf(script, " | zsh -f '%s/tests/completion.zsh'",
                         g_getenv("OPCFLOW_SOURCE"));
  g_autofree char *out = bash(script->str);
  g_auto(GStrv) lines = g_strsplit(out, "\n", -1);
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    g_assert_cmpstr(lines[i], ==, cases[i][1]);
}

/* The build creates a manual page for each verb. The page has all options, and
   groff formats it without a warning. The page of the command lists all
   verbs. */
static void test_pages(void) {
  g_autofree char *groff = g_find_program_in_path("groff");
  g_autofree char *first =
      g_build_filename(g_getenv("OPCFLOW_BUILD"), "data", "opcflow.1", NULL);
  if (!groff || !g_file_test(first, G_FILE_TEST_EXISTS)) {
    g_test_skip("no groff, or no help2man at build time");
    return;
  }
  g_autofree char *list = g_strdup_printf(
      "'%s' help | sed -n 's/^  \\([a-z]*\\) .*/\\1/p'", command);
  g_autofree char *verbs = bash(list);
  g_auto(GStrv) names = g_strsplit(g_strchomp(verbs), "\n", -1);
  g_assert_cmpuint(g_strv_length(names), >=, 8);
  for (guint i = 0; names[i]; i++) {
    g_autofree char *script = g_strdup_printf(
        "groff -man -Tutf8 -ww -P-c '%s/data/opcflow-%s.1' | col -b",
        g_getenv("OPCFLOW_BUILD"), names[i]);
    g_autofree char *page = bash(script);
    g_assert_nonnull(strstr(page, "--plugin-path"));
    g_assert_nonnull(strstr(page, "EXIT STATUS"));
  }
  g_autofree char *script =
      g_strdup_printf("groff -man -Tutf8 -ww -P-c '%s/data/opcflow.1' | col -b",
                      g_getenv("OPCFLOW_BUILD"));
  g_autofree char *page = bash(script);
  for (guint i = 0; names[i]; i++) {
    g_autofree char *reference = g_strdup_printf("opcflow-%s(1)", names[i]);
    if (!strstr(page, reference)) g_error("%s is not there", reference);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  command = g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL);
  g_test_add_func("/shell/completion", test_completion);
  g_test_add_func("/shell/zsh", test_zsh);
  g_test_add_func("/shell/pages", test_pages);
  int code = g_test_run();
  opc_remove_tree(folder);
  g_free(folder);
  g_free(command);
  return code;
}
