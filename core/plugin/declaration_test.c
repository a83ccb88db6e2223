/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the checks of descriptors and of functions, on valid descriptors
   with one fault each, in this process. */
#include "core/plugin/declaration.h"

#include <math.h>
#include <string.h>

#include "core/plugin/kind.h"

typedef struct instance {
  const opc_host *host;
  double size;
  int flag;
  const char *text;
  const void *input;
  const opc_module *slot;
} instance;

/* Parameters of all tests: a number, and a parameter that a test changes. */
static opc_parameter parameters[2];
static opc_metric metrics[2];
static opc_step step;
static opc_port port;
static opc_plugin plugin;

static int nothing_run(void *self, void **outputs, opc_error *error) {
  (void)self, (void)outputs, (void)error;
  return OPC_OK;
}

static int nothing_check(const void *object, opc_error *error) {
  (void)object, (void)error;
  return OPC_OK;
}

static void nothing_release(void *object) { (void)object; }

/* Set up a valid descriptor of a step. */
static void set_up(void) {
  const opc_parameter valid[] = {{.name = "size",
                                  .type = OPC_REAL,
                                  .flags = OPC_AT_LEAST | OPC_AT_MOST,
                                  .unit = "nm",
                                  .min = 1,
                                  .max = 65,
                                  .preset = "60 nm",
                                  .summary = "a length",
                                  .offset = offsetof(instance, size),
                                  .width = sizeof(double)},
                                 {.name = "word",
                                  .type = OPC_TEXT,
                                  .summary = "a text",
                                  .offset = offsetof(instance, text),
                                  .width = sizeof(char *)}};
  memcpy(parameters, valid, sizeof valid);
  metrics[0] = (opc_metric){"sum", "nm", OPC_LOWER, 0.1, "the sum"};
  metrics[1] = (opc_metric){"count", NULL, OPC_NEUTRAL, 0, "the count"};
  port = (opc_port){"out", "number", nothing_check, nothing_release};
  step = (opc_step){.outputs = &port,
                    .n_outputs = 1,
                    .output_size = sizeof port,
                    .run = nothing_run};
  plugin = (opc_plugin){.size = sizeof plugin,
                        .abi_major = OPC_ABI_MAJOR,
                        .abi_minor = OPC_ABI_MINOR,
                        .id = "test.own",
                        .kind = "step",
                        .version = "1",
                        .licence = "x",
                        .summary = "Own",
                        .instance_size = sizeof(instance),
                        .parameters = parameters,
                        .n_parameters = 2,
                        .parameter_size = sizeof *parameters,
                        .metrics = metrics,
                        .n_metrics = 2,
                        .metric_size = sizeof *metrics,
                        .functions = &step,
                        .functions_size = sizeof step};
}

/* Check the fault of the descriptor; NULL: the descriptor is valid. */
static void expect_fault(const char *expected) {
  g_autofree char *found = opc_plugin_fault(&plugin, "test.own");
  g_assert_cmpstr(found, ==, expected);
  set_up();
}

static void expect_flaw(const char *flaw) {
  g_autofree char *text = g_strdup_printf("parameter 'word'%s", flaw);
  expect_fault(text);
}

/* Faults of the descriptor itself and of metrics. */
static void test_descriptor(void) {
  expect_fault(NULL);
  plugin.id = "Test";
  expect_fault("the id does not consist of lower-case words and dots");
  plugin.id = "test.other";
  expect_fault("the id is 'test.other', but the file name is 'test.own'");
  plugin.kind = "";
  expect_fault("the descriptor has no kind");
  plugin.summary = NULL;
  expect_fault("the descriptor has no summary");
  plugin.instance_size = 4;
  expect_fault("the instance is too small for the pointer to the host");
  plugin.functions = NULL;
  expect_fault("the plugin has no functions");
  metrics[1].name = "";
  expect_fault("metric 2 has no name");
  metrics[1].name = "sum";
  expect_fault("metric 'sum' is declared twice");
  metrics[1].better = OPC_HIGHER + 1;
  expect_fault("metric 'count' has no valid direction or no summary");
  metrics[0].summary = NULL;
  expect_fault("metric 'sum' has no valid direction or no summary");
}

static void test_parameters(void) {
  opc_parameter *p = &parameters[1];
  p->name = "use";
  expect_fault("parameter 2 has no valid name");
  p->name = "size";
  expect_fault("parameter 'size' is declared twice");
  p->name = "size.more";
  expect_fault(
      "parameter 'size' and parameter 'size.more' conflict: one is a group of "
      "the other");
  p->type = 77;
  expect_flaw(" has the unknown type 77");
  p->unit = "parsec";
  expect_flaw(" has the unknown unit 'parsec'");
  p->width = 3;
  expect_flaw(": the field has 3 bytes, expected for the type 'text' 8");
  p->summary = NULL;
  expect_flaw(" has no summary");
  p->offset = 0;
  expect_flaw(": the field is outside of the instance");
  p->offset = sizeof(instance) - 4;
  expect_flaw(": the field is outside of the instance");
  p->given = sizeof(instance) - 2;
  expect_flaw(": 'given' is outside of the instance");
  p->flags = OPC_LISTED;
  expect_flaw(
      " is OPC_LISTED, but is no text or the plugin has no function that lists "
      "choices");
  p->type = OPC_INPUT;
  expect_flaw(" has no choices");
  p->choices = "a||b";
  expect_flaw(" has an empty choice");
  p->preset = "x";
  p->flags = OPC_REQUIRED;
  expect_flaw(" is required and has a default");
  p->follows = "size";
  expect_flaw(
      " follows from other values, and must be a number, not required and "
      "without a default");
  p->type = OPC_INPUT;
  p->choices = "number";
  p->preset = "${a}";
  expect_flaw(": an input has no default");
  p->type = OPC_SLOT;
  p->choices = "A Kind";
  expect_flaw(": 'A Kind' is not a kind of plugin");
}

static void test_bounds(void) {
  opc_parameter *p = &parameters[0];
  static const char none[] = "parameter 'size' has bounds that no value meets";
  p->flags = OPC_AT_LEAST | OPC_ABOVE;
  expect_fault(none);
  p->flags = OPC_AT_MOST | OPC_BELOW;
  expect_fault(none);
  p->min = 66;
  expect_fault(none);
  p->max = NAN;
  expect_fault(none);
  p->preset = "66 nm";
  expect_fault(
      "default of parameter 'size': 'size' must be at most 65 nm, found '66 "
      "nm'");
}

/* Copies, and their refusal. */
static void test_copy(void) {
  char *fault = NULL;
  opc_plugin *copy = opc_plugin_copy(&plugin, &fault);
  g_assert_cmpstr(fault, ==, NULL);
  g_assert_true(copy->parameters != parameters);
  g_assert_cmpstr(copy->parameters[1].name, ==, "word");
  g_assert_null(copy->parameters[2].name);
  /* A plugin of a later interface has larger structs; the rest is ignored. */
  struct {
    opc_metric metric;
    double later;
  } more[2] = {{metrics[0], 1}, {metrics[1], 2}};
  plugin.metrics = &more[0].metric;
  plugin.metric_size = sizeof *more;
  copy = opc_plugin_copy(&plugin, &fault);
  g_assert_cmpstr(copy->metrics[1].name, ==, "count");
  set_up();
  g_assert_null(opc_plugin_copy(NULL, &fault));
  g_assert_cmpstr(fault, ==, "opcflow_plugin() returned nothing");
  g_free(fault);
  plugin.abi_major++;
  g_assert_null(opc_plugin_copy(&plugin, &fault));
  g_assert_true(g_str_has_prefix(fault, "built for plugin interface"));
  g_free(fault);
  set_up();
  plugin.size = 8;
  g_assert_null(opc_plugin_copy(&plugin, &fault));
  g_assert_cmpstr(fault, ==,
                  "the size of the descriptor, 8 bytes, is not valid");
  g_free(fault);
  set_up();
  plugin.n_parameters = 100000;
  g_assert_null(opc_plugin_copy(&plugin, &fault));
  g_assert_cmpstr(fault, ==,
                  "the parameters are not an array of opc_parameter");
  g_free(fault);
  set_up();
  plugin.metrics = NULL;
  g_assert_null(opc_plugin_copy(&plugin, &fault));
  g_assert_cmpstr(fault, ==, "the metrics are not an array of opc_metric");
  g_free(fault);
  set_up();
}

static void test_queries(void) {
  opc_error error = {0};
  g_assert_cmpint(opc_parameter_find(&plugin, "word"), ==, 1);
  g_assert_cmpint(opc_parameter_find(&plugin, "words"), ==, -1);
  g_assert_true(opc_metric_find(&plugin, "count") == &metrics[1]);
  g_assert_null(opc_metric_find(&plugin, "none"));
  g_assert_true(opc_metric_check(&plugin, "sum", 1, &error) == &metrics[0]);
  g_assert_null(opc_metric_check(&plugin, "sum", NAN, &error));
  g_assert_cmpstr(error.message, ==,
                  "metric 'sum' of 'test.own' is nan, expected a finite "
                  "number");
  g_assert_null(opc_metric_check(&plugin, "none", 1, &error));
  g_assert_cmpstr(error.message, ==, "'test.own' declares no metric 'none'");
  g_assert_cmpuint(opc_port_count(&plugin), ==, 1);
  g_assert_cmpstr(opc_port_at(&plugin, 0)->name, ==, "out");
  /* The time limit of a step is behind the plugin's part of the instance. */
  char *fault = NULL;
  opc_plugin *copy = opc_plugin_copy(&plugin, &fault);
  g_assert_cmpint(opc_timeout_find(copy), ==, -1);
  opc_timeout_add(copy);
  g_assert_cmpint(opc_timeout_find(copy), ==, 2);
  g_assert_cmpuint(copy->parameters[2].offset, >=, sizeof(instance));
  g_assert_cmpuint(copy->instance_size, >=,
                   copy->parameters[2].offset + sizeof(double));
  size_t size = copy->instance_size;
  opc_timeout_add(copy);
  g_assert_cmpuint(copy->n_parameters, ==, 3);
  g_assert_cmpuint(copy->instance_size, ==, size);
  plugin.kind = "command";
  g_assert_cmpuint(opc_port_count(&plugin), ==, 0);
  copy = opc_plugin_copy(&plugin, &fault);
  opc_timeout_add(copy);
  g_assert_cmpuint(copy->n_parameters, ==, 2);
  set_up();
}

/* ---- kinds ---- */

static opc_registry *registry;

static void expect_adopted(const char *expected) {
  g_autofree char *found = opc_functions_adopt(registry, &plugin);
  g_assert_cmpstr(found, ==, expected);
  set_up();
}

static void test_functions(void) {
  g_assert_null(opc_functions_adopt(registry, &plugin));
  const opc_step *copy = plugin.functions;
  g_assert_true(copy != &step && copy->run == nothing_run);
  g_assert_true(copy->outputs != &port);
  set_up();
  /* Functions that an older plugin lacks are NULL. */
  plugin.functions_size = offsetof(opc_step, run) + sizeof step.run;
  g_assert_null(opc_functions_adopt(registry, &plugin));
  copy = plugin.functions;
  g_assert_true(copy->run == nothing_run && !copy->restore);
  set_up();
  step.run = NULL;
  expect_adopted("the function 'run' is missing");
  plugin.functions_size = 100000;
  expect_adopted("the size of the functions, 100000 bytes, is not valid");
  step.outputs = NULL;
  expect_adopted("the outputs are not an array of opc_port");
  port.kind = NULL;
  expect_adopted("output 1 has no name or kind");
  port.check = NULL;
  expect_adopted("output 'out' has no check or release");
  plugin.kind = "nothing";
  expect_adopted(
      "the kind 'nothing' is unknown: unknown plugin 'kind.nothing'");
}

static void test_kinds(void) {
  opc_function function = {.name = "run", .offset = 8};
  opc_kind kind = {.functions_size = 16,
                   .functions = &function,
                   .n_functions = 1,
                   .function_size = sizeof function};
  plugin.kind = "kind";
  plugin.functions = &kind;
  plugin.functions_size = sizeof kind;
  g_assert_null(opc_functions_adopt(registry, &plugin));
  g_assert_cmpstr(((const opc_kind *)plugin.functions)->functions[0].name, ==,
                  "run");
  plugin.functions = &kind;
  plugin.functions_size = sizeof kind;
  function.offset = 9;
  expect_adopted(
      "function 1 of the kind is outside of the struct of functions");
  plugin.kind = "kind";
  plugin.functions = &kind;
  plugin.functions_size = sizeof kind;
  kind.functions = NULL;
  expect_adopted(
      "the functions, templates, samples or examples are not arrays");
  opc_error error = {0};
  static const char *const own[] = {"command", "kind", "loader", "step"};
  g_autoptr(GPtrArray) names = opc_kind_names(registry);
  for (size_t i = 0; i < G_N_ELEMENTS(own); i++) {
    g_assert_nonnull(opc_kind_of(registry, own[i], &error));
    g_assert_true(
        g_ptr_array_find_with_equal_func(names, own[i], g_str_equal, NULL));
  }
  for (guint i = 1; i < names->len; i++)
    g_assert_cmpint(strcmp(names->pdata[i - 1], names->pdata[i]), <, 0);
  g_assert_null(opc_kind_of(registry, "none", &error));
  g_assert_true(opc_kind_trials(registry, "command") ==
                opc_kind_of(registry, "command", &error));
  g_assert_null(opc_kind_trials(registry, "none"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  const char *folders[] = {NULL};
  registry = opc_registry_new(folders);
  set_up();
  g_test_add_func("/declaration/descriptor", test_descriptor);
  g_test_add_func("/declaration/parameters", test_parameters);
  g_test_add_func("/declaration/bounds", test_bounds);
  g_test_add_func("/declaration/copy", test_copy);
  g_test_add_func("/declaration/queries", test_queries);
  g_test_add_func("/declaration/functions", test_functions);
  g_test_add_func("/declaration/kinds", test_kinds);
  int failed = g_test_run();
  opc_registry_free(registry);
  return failed;
}
