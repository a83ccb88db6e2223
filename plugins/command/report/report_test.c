/* SPDX-License-Identifier: BSD-3-Clause */
/* Pages of synthetic run folders. The embedded data must equal the content of
   the folders: figures, tables, pictures, and texts that contain markup. */
#include <math.h>
#include <opcflow/command.h>

#include "tests/run_folder.h"
#include "tools/devel/testing.h"

static const char evil[] = "</script><b a='1'>";

/* Make a page of folders in the test folder; return the code, the page and the
   embedded data. */
static int page_make(const char *mapping, const char *const *folders,
                     char **page, JsonNode **root, opc_error *error) {
  g_autoptr(GPtrArray) paths = g_ptr_array_new_with_free_func(g_free);
  g_autofree char *path =
      g_build_filename(opc_test_folder(), "page.html", NULL);
  g_autofree char *map = g_strdup_printf("{ output: '%s'%s }", path, mapping);
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("command.report", map, error);
  if (!m) return OPC_INVALID;
  for (; *folders; folders++)
    g_ptr_array_add(paths, g_build_filename(opc_test_folder(), *folders, NULL));
  const opc_command *command = m->functions;
  int code = command->run(m->self, paths->len,
                          (const char *const *)paths->pdata, error);
  *root = NULL;
  *page = code ? NULL : read_page(path, root);
  return code;
}

static JsonObject *report_good(const char *mapping, const char *const *folders,
                               char **page, JsonNode **root) {
  opc_error error;
  if (page_make(mapping, folders, page, root, &error))
    g_error("%s", error.message);
  return json_node_get_object(*root);
}

static void folder_make(const char *name, made_run run) {
  g_autofree char *folder = g_build_filename(opc_test_folder(), name, NULL);
  run.folder = folder;
  make_run(&run);
}

static JsonObject *run_of(JsonObject *page, guint i) {
  return json_array_get_object_element(
      json_object_get_array_member(page, "runs"), i);
}

static const char *text_of(JsonObject *o, const char *name) {
  return json_object_get_string_member(o, name);
}

/* Return the values of a column of a table. */
static JsonArray *column_of(JsonObject *run, const char *table,
                            const char *name) {
  JsonObject *t = json_object_get_object_member(
      json_object_get_object_member(run, "tables"), table);
  JsonArray *columns = json_object_get_array_member(t, "columns");
  for (guint i = 0; i < json_array_get_length(columns); i++) {
    JsonObject *c = json_array_get_object_element(columns, i);
    if (!strcmp(text_of(c, "name"), name))
      return json_object_get_array_member(c, "values");
  }
  g_error("no column '%s' in '%s'", name, table);
}

/* ---- tests ---- */

static void test_figures(void) {
  static const char *const both[] = {"one", "deeper/one", NULL};
  g_autofree char *gates = g_strdup_printf(
      "%sa:1,n,65,100,-1.25,\r\n%s,p,65,200.5,3e-7,2\r\n", gates_head, evil);
  folder_make("one",
              (made_run){.gates = gates, .na = "0.85", .variant = "plain"});
  folder_make("deeper/one",
              (made_run){.metrics = RUN_ION("0.1234567890123456")});
  g_autofree char *page = NULL;
  g_autoptr(JsonNode) root = NULL;
  JsonObject *o = report_good(", title: A title", both, &page, &root);
  g_assert_cmpint(json_object_get_int_member(o, "report"), ==, 1);
  g_assert_cmpstr(text_of(o, "title"), ==, "A title");
  g_assert_cmpuint(
      json_array_get_length(json_object_get_array_member(o, "runs")), ==, 2);
  JsonObject *one = run_of(o, 0), *two = run_of(o, 1);
  g_assert_cmpstr(text_of(one, "label"), ==, "one");
  g_assert_cmpstr(text_of(two, "label"), ==, "one (2)");
  g_assert_cmpstr(text_of(one, "variant"), ==, "plain");
  g_assert_true(json_object_get_null_member(two, "variant"));
  JsonObject *ion = json_object_get_object_member(
      json_object_get_object_member(two, "metrics"), "mask.ion");
  g_assert_true(json_object_get_double_member(ion, "value") ==
                0.1234567890123456);
  g_assert_cmpstr(text_of(ion, "unit"), ==, "%");
  g_assert_cmpstr(text_of(ion, "better"), ==, "lower");
  g_assert_cmpstr(text_of(json_object_get_object_member(one, "parameters"),
                          "mask.litho.na"),
                  ==, "0.85");
  JsonArray *after = column_of(one, "gates", "ion_after");
  g_assert_cmpfloat(json_array_get_double_element(after, 0), ==, -1.25);
  g_assert_cmpfloat(json_array_get_double_element(after, 1), ==, 3e-7);
  JsonArray *leak = column_of(one, "gates", "ioff_after");
  g_assert_true(json_array_get_null_element(leak, 0));
  g_assert_cmpstr(
      json_array_get_string_element(column_of(one, "gates", "transistor"), 1),
      ==, evil);
  g_assert_false(json_object_has_member(
      json_object_get_object_member(two, "tables"), "gates"));
  g_assert_null(strstr(page, evil));
  g_assert_nonnull(strstr(opc_test_log(), "the page is '"));
}

/* All runs of an experiment folder, with the reason of a failed run. */
static void test_experiment(void) {
  static const char *const folders[] = {"whole", NULL};
  folder_make("whole/A/fast",
              (made_run){.metrics = RUN_ION("1.5"),
                         .more = "\"steps\" : { \"x\" : 6, \"y\" : 2 },"});
  folder_make("whole/A/fine", (made_run){.metrics = RUN_ION("0.5")});
  g_autofree char *top = g_build_filename(opc_test_folder(), "whole", NULL);
  put_file(top, "experiment.csv",
           "case,method,folder,result,seconds (s)\r\nA,fast,A/fast,good,1\r\n"
           "A,fine,A/fine,good,1\r\nB,fast,,no light,\r\n");
  g_autofree char *page = NULL;
  g_autoptr(JsonNode) root = NULL;
  JsonObject *o = report_good("", folders, &page, &root);
  static const char *const methods[] = {"fast", "fine"};
  g_assert_cmpuint(
      json_array_get_length(json_object_get_array_member(o, "runs")), ==, 2);
  for (guint i = 0; i < 2; i++) {
    g_autofree char *label = g_strconcat("A, ", methods[i], NULL);
    JsonObject *run = run_of(o, i);
    g_assert_cmpstr(text_of(run, "case"), ==, "A");
    g_assert_cmpstr(text_of(run, "method"), ==, methods[i]);
    g_assert_cmpstr(text_of(run, "label"), ==, label);
    if (!i) /* the time of the steps, not of the run */
      g_assert_cmpfloat(json_object_get_double_member(run, "seconds"), ==, 8);
    JsonObject *ion = json_object_get_object_member(
        json_object_get_object_member(run, "metrics"), "mask.ion");
    g_assert_true(json_object_get_double_member(ion, "value") == 1.5 - i);
  }
  JsonArray *missing = json_object_get_array_member(o, "missing");
  g_assert_cmpstr(json_array_get_string_element(
                      missing, json_array_get_length(missing) - 1),
                  ==, "B, fast: no light");
}

/* Pictures use at most two thirds of the limit; `<` is escaped, so that a text
   cannot end the element. */
static void test_pictures(void) {
  static const char *const folders[] = {"seen", NULL};
  g_autofree char *blanks = g_strnfill(600 * 1000, ' ');
  g_autofree char *view =
      g_strdup_printf("{ \"view\": 1, \"cell\": \"%s\"%s }", evil, blanks);
  folder_make("seen", (made_run){.view = view});
  for (int fits = 0; fits < 2; fits++) {
    g_autofree char *page = NULL;
    g_autoptr(JsonNode) root = NULL;
    JsonObject *o = report_good(fits ? ", limit: 1" : ", limit: 0.8", folders,
                                &page, &root);
    g_assert_cmpint(json_object_has_member(run_of(o, 0), "view"), ==, fits);
    if (fits)
      g_assert_cmpstr(
          text_of(json_object_get_object_member(run_of(o, 0), "view"), "cell"),
          ==, evil);
    else
      g_assert_nonnull(strstr(page, "seen: pictures of 0.6 MB omitted"));
  }
}

static void test_refused(void) {
  static const char *const none[] = {NULL}, *const gone[] = {"gone", NULL},
                           *const other[] = {"other", NULL},
                           *const good[] = {"good", NULL};
  opc_error error = {0};
  char *page;
  JsonNode *root;
  g_assert_cmpint(page_make("", none, &page, &root, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.message, ==, "no run folder is given");
  g_assert_cmpint(page_make("", gone, &page, &root, &error), !=, OPC_OK);
  g_assert_nonnull(strstr(error.message, "gone"));
  folder_make("other", (made_run){.view = "{ \"view\": 2 }"});
  g_assert_cmpint(page_make("", other, &page, &root, &error), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "view.json' is not a view of a mask"));
  folder_make("good", (made_run){.view = NULL});
  g_assert_cmpint(page_make(", limit: 0", good, &page, &root, &error), !=, 0);
  g_autoptr(opc_module) m = opc_test_module(
      "command.report", "{ output: /nowhere/at/all.html }", &error);
  g_autofree char *folder = g_build_filename(opc_test_folder(), "good", NULL);
  const opc_command *command = m->functions;
  g_assert_cmpint(
      command->run(m->self, 1, (const char *const[]){folder}, &error), ==,
      OPC_IO);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/command.report/figures", test_figures);
  g_test_add_func("/command.report/experiment", test_experiment);
  g_test_add_func("/command.report/pictures", test_pictures);
  g_test_add_func("/command.report/refused", test_refused);
  return g_test_run();
}
