/* SPDX-License-Identifier: BSD-3-Clause */
/* The JSON Schema of flow files: its content, and the documents that Python's
   jsonschema accepts with the schema. */
#include "tools/devel/schema.h"

#include <glib/gstdio.h>
#include <string.h>

#include <store/files.h>
#include "core/plugin/registry.h"

static char *folder;

static JsonNode *make_schema(void) {
  g_autoptr(opc_registry) registry = opc_registry_new(NULL);
  g_autoptr(GPtrArray) list = opc_registry_scan(registry, "", 10);
  g_autoptr(GPtrArray) plugins = g_ptr_array_new();
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    opc_error error;
    if (!c->reason)
      g_ptr_array_add(plugins,
                      (void *)opc_registry_find(registry, c->id, &error));
  }
  return opc_flow_schema(plugins);
}

/* Return the only match of a path, as text. */
static char *look_up(JsonNode *schema, const char *path) {
  g_autoptr(GError) error = NULL;
  g_autoptr(JsonNode) found = json_path_query(path, schema, &error);
  g_assert_no_error(error);
  JsonArray *matches = json_node_get_array(found);
  if (json_array_get_length(matches) != 1)
    g_error("%s: %u matches", path, json_array_get_length(matches));
  return json_to_string(json_array_get_element(matches, 0), FALSE);
}

static void test_content(void) {
  static const char *const cases[][2] = {
      {"$['$schema']", "\"http://json-schema.org/draft-07/schema#\""},
      {"$.definitions['litho.hopkins'].properties.use.const",
       "\"litho.hopkins\""},
      {"$.definitions['extractor.plain'].properties.slices.maximum", "10000.0"},
      {"$.definitions['litho.hopkins'].properties.na.default", "0.75"},
      {"$.definitions['extractor.plain'].properties.rule.enum",
       "[\"contour\",\"gauss\",\"equal\"]"},
      {"$.definitions['extractor.plain'].properties.slices.type",
       "\"integer\""},
      {"$.definitions['resist.threshold'].properties.active_anchor.properties"
       ".pitch.default",
       "\"0 nm\""},
      {"$.definitions['regulator.drc'].properties.overlay.description",
       "\"largest overlay error (misalignment) between layers (nm); >= 0 nm, "
       "<= 1000 nm; "
       "default: 0.039 lambda/NA\""},
      {"$.definitions['read.gds'].additionalProperties", "false"},
      {"$.definitions.correct.properties.litho.allOf[0]['$ref']",
       "\"#/definitions/any.litho\""},
  };
  g_autoptr(JsonNode) schema = make_schema();
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = look_up(schema, cases[i][0]);
    g_assert_cmpstr(text, ==, cases[i][1]);
  }
}

/* ---- against a validator ---- */

static void document_save(const char *name, JsonNode *node) {
  g_autofree char *text = json_to_string(node, FALSE);
  g_autofree char *path = g_build_filename(folder, name, NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
}

/* Save a flow as JSON. */
static void save_flow(const char *name, const char *text) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_source *source = opc_source_new(name, "");
  g_autoptr(opc_node) node =
      opc_node_parse(source, text, strlen(text), problems);
  if (!node) g_error("%s", opc_problems_text(problems));
  g_autoptr(JsonNode) json = opc_node_json(node);
  document_save(name, json);
  opc_source_free(source);
}

/* Return the verdict on each document, "good" or the fault. Skip the test and
   return NULL if no validator is installed. */
static char **documents_validate(const GPtrArray *names) {
  g_autoptr(GPtrArray) argv = g_ptr_array_new();
  g_autofree char *script = g_build_filename(g_getenv("OPCFLOW_SOURCE"),
                                             "tests", "schema_check.py", NULL);
  g_ptr_array_add(argv, (char *)"python3");
  g_ptr_array_add(argv, script);
  g_ptr_array_add(argv, (char *)"schema.json");
  for (guint i = 0; i < names->len; i++) g_ptr_array_add(argv, names->pdata[i]);
  g_ptr_array_add(argv, NULL);
  g_autofree char *out = NULL;
  int status = -1;
  gboolean ran =
      g_spawn_sync(folder, (char **)argv->pdata, NULL, G_SPAWN_SEARCH_PATH,
                   NULL, NULL, &out, NULL, &status, NULL);
  if (!ran || g_strcmp0(out, "") == 0) {
    g_test_skip("no Python module jsonschema");
    return NULL;
  }
  g_assert_cmpint(status, ==, 0);
  return g_strsplit(out, "\n", -1);
}

static void test_good(void) {
  g_autoptr(JsonNode) schema = make_schema();
  document_save("schema.json", schema);
  g_autofree char *flows =
      g_build_filename(g_getenv("OPCFLOW_SOURCE"), "flows", NULL);
  g_autoptr(GDir) dir = g_dir_open(flows, 0, NULL);
  g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
  for (const char *name; (name = g_dir_read_name(dir));) {
    g_autofree char *path = g_build_filename(flows, name, NULL);
    g_autofree char *text = NULL;
    /* iccad.yaml is excepted: the user names the required files by --set, so
       that the schema reports missing parameters. */
    if (!g_str_has_suffix(name, ".yaml") || !strcmp(name, "iccad.yaml"))
      continue;
    g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
    save_flow(name, text);
    g_ptr_array_add(names, g_strdup(name));
  }
  g_assert_cmpuint(names->len, >=, 3);
  save_flow("dots.json",
            "opcflow: 1\nsteps:\n  one: { use: read.gds, file: a.gds }\n"
            "  two: { use: correct, gates: '${g}', litho: { use: "
            "litho.hopkins, na: 0.7 }, resist: { use: resist.threshold, "
            "anchor.line: 65 nm }, extractor: { use: extractor.plain, devices: "
            "d.yaml }, synthesizer: { use: synthesizer.dpb }, "
            "synthesizer.ion_limit: 1 % }\n"
            "require: { two.failed: 0, two: { ion_max: 1 %, synthesizer: { x: "
            "[1, 2] } } }\n");
  g_ptr_array_add(names, g_strdup("dots.json"));
  g_auto(GStrv) lines = documents_validate(names);
  for (guint i = 0; lines && i < names->len; i++)
    if (strcmp(lines[i], "good"))
      g_error("%s: %s", (char *)names->pdata[i], lines[i]);
}

/* Each entry is a step with one fault. */
static void test_wrong(void) {
  static const char *const steps[] = {
      "{ use: read.gsd, file: a.gds }",
      "{ use: read.gds }",
      "{ use: read.gds, file: a.gds, fiel: b.gds }",
      "{ use: read.gds, file: a.gds, scale: 0 }",
      "{ use: read.gds, file: [ a.gds ] }",
      "{ use: read.gds, file: a.gds, layers: [ 9/0 ] }",
      "{ use: segment.transistors, layout: layout }",
      "{ use: segment.transistors, layout: '${layout}', grid: 1 }",
      "{ use: segment.transistors, layout: '${layout}', grid: 1 V }",
      "{ use: litho.hopkins, na: 0.75 }",
      "{ file: a.gds }",
      "{ use: correct, gates: '${g}', litho: { use: synthesizer.dpb } }",
      "12",
      "{ use: read.gds, file: a.gds }\nrequire: { one.x: true }",
      "{ use: read.gds, file: a.gds }\nrequire: { one.x: [1] }",
  };
  static const char *const slots[] = {
      "litho: { use: litho.hopkins, na: 1.5 }",
      "litho: { use: litho.hopkins, kernels: 2.5 }",
      "resist: { use: resist.threshold, anchor: { lines: 65 nm } }",
      "extractor: { use: extractor.plain, devices: d.yaml, rule: simpson }",
  };
  g_autoptr(JsonNode) schema = make_schema();
  document_save("schema.json", schema);
  g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < G_N_ELEMENTS(steps); i++) {
    g_autofree char *text =
        g_strdup_printf("opcflow: 1\nsteps:\n  one: %s\n", steps[i]);
    g_ptr_array_add(names, g_strdup_printf("step%zu.json", i));
    save_flow(names->pdata[names->len - 1], text);
  }
  for (size_t i = 0; i < G_N_ELEMENTS(slots); i++) {
    g_autoptr(GString) text = g_string_new(
        "opcflow: 1\nsteps:\n  m:\n    use: correct\n    gates: ${g}\n"
        "    litho: { use: litho.hopkins, defocus: 0 }\n"
        "    resist: { use: resist.threshold }\n"
        "    extractor: { use: extractor.plain, devices: d.yaml }\n"
        "    synthesizer: { use: synthesizer.dpb }\n"
        "    regulator: { use: regulator.drc }\n");
    if (!i) {
      save_flow("whole.json", text->str);
      g_ptr_array_insert(names, 0, g_strdup("whole.json"));
    }
    g_autofree char *word = g_strndup(slots[i], strcspn(slots[i], ":"));
    g_autofree char *key = g_strdup_printf("    %s:", word);
    char *at = strstr(text->str, key);
    gssize begin = at - text->str;
    g_string_erase(text, begin, (gssize)strcspn(at, "\n"));
    g_string_insert(text, begin, slots[i]);
    g_string_insert(text, begin, "    ");
    g_ptr_array_add(names, g_strdup_printf("slot%zu.json", i));
    save_flow(names->pdata[names->len - 1], text->str);
  }
  g_auto(GStrv) lines = documents_validate(names);
  if (!lines) return;
  g_assert_cmpstr(lines[0], ==, "good");
  for (guint i = 1; i < names->len; i++)
    if (!strcmp(lines[i], "good") || !*lines[i])
      g_error("%s is taken as good", (char *)names->pdata[i]);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_test_add_func("/schema/content", test_content);
  g_test_add_func("/schema/good", test_good);
  g_test_add_func("/schema/wrong", test_wrong);
  int code = g_test_run();
  opc_remove_tree(folder);
  g_free(folder);
  return code;
}
