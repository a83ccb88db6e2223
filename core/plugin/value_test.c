/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the conversion of texts to parameter values, for all types. */
#include "core/plugin/value.h"

#include <glib.h>
#include <math.h>
#include <string.h>

static GPtrArray *owned;

/* Convert a text; a list or a map is parsed. The problems must contain
   `expected`, or must be none if `expected` is NULL. */
static opc_setting convert_file(const opc_parameter *p, const char *text,
                                gboolean check_files, const char *expected) {
  static const opc_source source = {.name = (char *)"here"};
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) node =
      *text == '[' || *text == '{'
          ? opc_node_parse(&source, text, strlen(text), problems)
          : opc_node_text_new(&source, text);
  opc_setting value = {0};
  gboolean good =
      opc_setting_convert(p, node, check_files, owned, problems, &value);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpint(good, ==, expected == NULL);
  if (expected ? !strstr(found, expected) : *found != 0)
    g_error("'%s': '%s' is not in '%s'", text, expected, found);
  return value;
}

static opc_setting convert(const opc_parameter *p, const char *text,
                           const char *expected) {
  return convert_file(p, text, FALSE, expected);
}

static void test_words(void) {
  const opc_parameter flag = {.name = "v", .type = OPC_BOOL};
  g_assert_cmpint(convert(&flag, "true", NULL).field.flag, ==, 1);
  g_assert_cmpint(convert(&flag, "false", NULL).field.flag, ==, 0);
  convert(&flag, "yes", "'v' must be 'true' or 'false', found 'yes'");
  convert(&flag, "[true]", "'v' requires 'true' or 'false', found a list");
  const opc_parameter choice = {
      .name = "v", .type = OPC_CHOICE, .choices = "plain|wide"};
  g_assert_cmpint(convert(&choice, "plain", NULL).field.flag, ==, 0);
  g_assert_cmpint(convert(&choice, "wide", NULL).field.flag, ==, 1);
  convert(&choice, "wode", "'v' cannot be 'wode', did you mean 'wide'?");
  convert(&choice, "x", "'v' must be one of 'plain', 'wide', found 'x'");
  const opc_parameter text = {.name = "v", .type = OPC_TEXT};
  g_assert_cmpstr(convert(&text, "a b", NULL).field.text, ==, "a b");
}

static void test_whole(void) {
  const opc_parameter p = {.name = "v",
                           .type = OPC_INT,
                           .flags = OPC_AT_LEAST | OPC_AT_MOST,
                           .min = -3,
                           .max = 12};
  g_assert_cmpint(convert(&p, "12", NULL).field.integer, ==, 12);
  g_assert_cmpint(convert(&p, "-3", NULL).field.integer, ==, -3);
  convert(&p, "13", "'v' must be at most 12, found '13'");
  convert(&p, "-4", "'v' must be at least -3, found '-4'");
  convert(&p, "1.5", "'v' must be a whole number, found '1.5'");
  convert(&p, "-", "'v' must be a whole number, found '-'");
  convert(&p, "99999999999999999999", "'v' is too large");
}

static void test_real(void) {
  const opc_parameter p = {.name = "v",
                           .type = OPC_REAL,
                           .unit = "nm",
                           .flags = OPC_ABOVE | OPC_BELOW,
                           .min = 0,
                           .max = 5};
  g_assert_cmpfloat(convert(&p, "4.5 nm", NULL).field.real, ==, 4.5);
  g_assert_cmpfloat_with_epsilon(convert(&p, "0.002 um", NULL).field.real, 2,
                                 1e-12);
  convert(&p, "0 nm", "'v' must be above 0 nm, found '0 nm'");
  convert(&p, "5 nm", "'v' must be below 5 nm, found '5 nm'");
  convert(&p, "3", "'v'");
  convert(&p, "{ a: 1 }", "'v' requires a length with a unit, found a map");
  const opc_parameter list = {.name = "v",
                              .type = OPC_REALS,
                              .flags = OPC_AT_LEAST,
                              .unit = "nm",
                              .min = 1};
  opc_reals found = convert(&list, "[3 nm, 1 nm, 2.5 nm]", NULL).field.reals;
  g_assert_cmpuint(found.count, ==, 3);
  g_assert_cmpfloat(found.values[0], ==, 3);
  g_assert_cmpfloat(found.values[2], ==, 2.5);
  g_assert_cmpuint(convert(&list, "[]", NULL).field.reals.count, ==, 0);
  convert(&list, "[3 nm, 0.5 nm]", "'v' must be at least 1 nm");
  convert(&list, "[[1 nm]]", "'v' requires");
  convert(&list, "3 nm", "'v' must be a list, as in '[1 nm, ...]'");
}

static void test_map(void) {
  const opc_parameter p = {.name = "v", .type = OPC_MAP};
  opc_map found = convert(&p, "{ poly: CP, active: CA }", NULL).field.map;
  g_assert_cmpuint(found.count, ==, 2);
  g_assert_cmpstr(found.pairs[1].key, ==, "active");
  g_assert_cmpstr(found.pairs[1].value, ==, "CA");
  convert(&p, "{ poly: [1, 2] }", "'poly' of 'v' needs a text");
  convert(&p, "{ poly: }", "'poly' of 'v' needs a text");
  convert(&p, "[a, b]", "'v' must be a map, as in '{ key: value }'");
  const opc_parameter any = {
      .name = "v", .type = OPC_MAP, .flags = OPC_MAP_OF_ANY};
  found = convert(&any, "{ a: [1, 2] }", NULL).field.map;
  g_assert_cmpstr(found.pairs[0].value, ==, "[1, 2]");
  convert(&any, "{ a: }", "'a' of 'v' needs a value");
  const opc_parameter axis = {
      .name = "v", .type = OPC_MAP, .flags = OPC_MAP_OF_ANY | OPC_INNER_AXIS};
  found = convert(&axis, "[x, y]", NULL).field.map;
  g_assert_cmpuint(found.count, ==, 2);
  g_assert_cmpstr(found.pairs[1].key, ==, "2");
  g_assert_cmpstr(found.pairs[1].value, ==, "y");
  const opc_parameter named = {
      .name = "v", .type = OPC_MAP, .choices = "poly|active"};
  convert(&named, "{ poly: a }", NULL);
  convert(&named, "{ pole: a }", "pole");
}

static void test_files(void) {
  const opc_parameter in = {.name = "v", .type = OPC_FILE};
  g_autofree char *folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_autofree char *path = g_build_filename(folder, "a", NULL);
  g_assert_cmpstr(convert_file(&in, path, FALSE, NULL).field.text, ==, path);
  convert_file(&in, path, TRUE, "no such file");
  g_assert_true(g_file_set_contents(path, "x", 1, NULL));
  g_assert_cmpstr(convert_file(&in, path, TRUE, NULL).field.text, ==, path);
  convert_file(&in, folder, TRUE, "is a folder, not a regular file");
  g_assert_cmpint(remove(path), ==, 0);
  g_assert_cmpint(remove(folder), ==, 0);
  const opc_parameter out = {.name = "v", .type = OPC_OUTPUT};
  g_assert_cmpstr(convert(&out, "a/b.csv", NULL).field.text, ==, "a/b.csv");
  convert(&out, "../b.csv", "'v' must name a file inside the run folder");
  const opc_parameter input = {.name = "v", .type = OPC_INPUT};
  g_assert_cmpstr(convert(&input, "${mask.out}", NULL).reference, ==,
                  "mask.out");
  convert(&input, "mask", "a reference to a step, as in '${mask}'");
  convert(&input, "${}", "a reference to a step");
  convert(&input, "", "'v' ");
}

/* Names of types, fields of types, and words for messages. */
static void test_types(void) {
  static const struct {
    uint32_t type;
    const char *name;
    size_t width;
    const char *noun;
  } all[] = {
      {OPC_BOOL, "bool", sizeof(int), "'true' or 'false'"},
      {OPC_INT, "int", sizeof(int64_t), "a whole number"},
      {OPC_REAL, "real", sizeof(double), "a number"},
      {OPC_TEXT, "text", sizeof(char *), "a text"},
      {OPC_CHOICE, "choice", sizeof(int), "one of 'a', 'b'"},
      {OPC_FILE, "file", sizeof(char *), "a file name"},
      {OPC_OUTPUT, "output", sizeof(char *), "a file name"},
      {OPC_REALS, "reals", sizeof(opc_reals), "a list of numbers"},
      {OPC_MAP, "map", sizeof(opc_map), "a map"},
      {OPC_INPUT, "input", sizeof(void *), "a reference as in '${step}'"},
      {OPC_SLOT, "slot", sizeof(void *),
       "a plugin, as in '{ use: a|b.NAME }'"}};
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    const opc_parameter p = {.type = all[i].type, .choices = "a|b"};
    g_autofree char *noun = opc_setting_noun(&p);
    g_assert_cmpstr(opc_type_name(all[i].type), ==, all[i].name);
    g_assert_cmpuint(opc_setting_width(all[i].type), ==, all[i].width);
    g_assert_cmpstr(noun, ==, all[i].noun);
  }
  g_assert_null(opc_type_name(1000));
  g_assert_cmpuint(opc_setting_width(1000), ==, 0);
  opc_parameter p = {.type = OPC_REAL, .unit = "nm", .min = 1, .max = 2.5};
  g_autofree char *noun = opc_setting_noun(&p);
  g_assert_cmpstr(noun, ==, "a length with a unit");
  static const struct {
    uint32_t flags;
    const char *text;
  } bounds[] = {{0, ""},
                {OPC_AT_LEAST, ">= 1 nm"},
                {OPC_ABOVE, "> 1 nm"},
                {OPC_AT_MOST, "<= 2.5 nm"},
                {OPC_AT_LEAST | OPC_BELOW, ">= 1 nm, < 2.5 nm"}};
  for (size_t i = 0; i < G_N_ELEMENTS(bounds); i++) {
    p.flags = bounds[i].flags;
    g_autofree char *text = opc_bounds_text(&p);
    g_assert_cmpstr(text, ==, bounds[i].text);
  }
}

/* Presets, missing values, and values in the fields of an instance. */
static void test_stored(void) {
  typedef struct instance {
    double real;
    int given;
    opc_reals list;
  } instance;
  instance to = {0};
  const opc_parameter real = {.name = "v",
                              .type = OPC_REAL,
                              .offset = offsetof(instance, real),
                              .given = offsetof(instance, given),
                              .preset = "7"},
                      list = {.name = "v",
                              .type = OPC_REALS,
                              .offset = offsetof(instance, list),
                              .preset = "[1, 2]"};
  g_assert_true(isnan(opc_setting_absent(&real).field.real));
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) seven = opc_preset_parse(&real, problems);
  g_autoptr(opc_node) two = opc_preset_parse(&list, problems);
  opc_setting value = {0};
  g_assert_true(
      opc_setting_convert(&real, seven, FALSE, owned, problems, &value));
  g_assert_true(value.present);
  value.given = TRUE;
  opc_setting_store(&real, &value, &to);
  g_assert_cmpfloat(to.real, ==, 7);
  g_assert_cmpint(to.given, ==, 1);
  opc_setting more = {0};
  g_assert_true(opc_setting_convert(&list, two, FALSE, owned, problems, &more));
  opc_setting_store(&list, &more, &to);
  g_assert_cmpuint(to.list.count, ==, 2);
  g_assert_cmpfloat(to.list.values[1], ==, 2);
  g_assert_cmpint(to.given, ==, 1);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  owned = g_ptr_array_new_with_free_func(g_free);
  g_test_add_func("/value/words", test_words);
  g_test_add_func("/value/whole", test_whole);
  g_test_add_func("/value/real", test_real);
  g_test_add_func("/value/map", test_map);
  g_test_add_func("/value/files", test_files);
  g_test_add_func("/value/types", test_types);
  g_test_add_func("/value/stored", test_stored);
  int failed = g_test_run();
  g_ptr_array_unref(owned);
  return failed;
}
