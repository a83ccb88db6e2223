/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "kind": a plugin declares another kind of plugins. The kinds "step"
   (step.h), "command" (command.h) and "kind" are built in. The plugin
   "kind.NAME" declares the kind NAME: size of its struct of functions, test and
   template of its plugins. [main]: see plugin.h. */
#ifndef OPCFLOW_KIND_H
#define OPCFLOW_KIND_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* A function that each plugin of the kind must have. */
typedef struct opc_function {
  const char *name; /* name of the member: "image" */
  size_t offset; /* offset of the pointer in the kind's struct of functions */
  OPC_MAY_GROW
} opc_function;

/* Initialise an element of an array of required functions: the member of the
   struct `type`. */
#define OPC_FUNCTION(type, member) \
  { #member, offsetof(type, member) }

/* Receives results and faults of a plugin that `opcflow lint` tests. */
typedef struct opc_inspector opc_inspector;
struct opc_inspector {
  /* Record the bytes of a result. The same input must produce the same bytes in
     every instance and for any number of threads. */
  void (*add)(opc_inspector *inspector, const void *data, size_t size);
  /* `find`: report a fault. `note`: report why a test was skipped. */
  void (*find)(opc_inspector *inspector, const char *format, ...)
      OPC_PRINTF(2, 3);
  void (*note)(opc_inspector *inspector, const char *format, ...)
      OPC_PRINTF(2, 3);
  const opc_context *context; /* threads for the test */
  OPC_MAY_GROW
};

/* A file of a new plugin, written by `opcflow new plugin KIND.NAME`. In `name`
   and `text`, the host replaces @ID@ by the id of the plugin and @NAME@ by the
   last word of the id. Names of files of plugins in Python begin with
   "python/", names of files for all languages with "all/"; other files belong
   to plugins in C. */
typedef struct opc_template {
  const char *name; /* "@ID@.c" */
  const char *text; /* contents */
  OPC_MAY_GROW
} opc_template;

/* A small valid input file, for plugins with a required file parameter. */
typedef struct opc_sample {
  const char *name;  /* "table.yaml" */
  const void *bytes; /* contents */
  size_t size;       /* of `bytes` */
  OPC_MAY_GROW
} opc_sample;

/* Example object of a data kind, for inputs of steps. */
typedef struct opc_example {
  const char *kind; /* the data kind, such as "layout" */
  /* Return the object, created by the first call and constant afterwards; NULL
     and *error on failure. [main] */
  const void *(*give)(opc_error *error);
  OPC_MAY_GROW
} opc_example;

/* Declaration of a kind; the functions of the plugin "kind.NAME". */
typedef struct opc_kind {
  size_t functions_size; /* size of the struct of functions of this kind */

  /* Functions that each plugin must have. Each array is given with the size of
     an element. */
  size_t n_functions, function_size;
  const opc_function *functions;

  /* Test an instance on synthetic inputs of realistic form and size; report
     faults of the results to `inspector`. Runs in a separate process. [main] */
  void (*exercise)(const opc_module *module, opc_inspector *inspector);

  /* Files of a new plugin of this kind. */
  size_t n_templates, template_size;
  const opc_template *templates;

  /* `opcflow lint` passes the sample files one after another to a plugin with a
     required file parameter, until the plugin accepts one. As inputs of a step,
     lint passes the `examples` of the plugin "kind.step", which also has the
     samples for steps. */
  size_t n_samples, sample_size;
  const opc_sample *samples;
  size_t n_examples, example_size;
  const opc_example *examples;
  OPC_MAY_GROW
} opc_kind;

/* Initialise the fields of an opc_kind for an array. */
#define OPC_REQUIRED_FUNCTIONS(array)                \
  .n_functions = sizeof(array) / sizeof((array)[0]), \
  .function_size = sizeof(opc_function), .functions = (array)
#define OPC_TEMPLATES(array)                         \
  .n_templates = sizeof(array) / sizeof((array)[0]), \
  .template_size = sizeof(opc_template), .templates = (array)
#define OPC_SAMPLES(array)                         \
  .n_samples = sizeof(array) / sizeof((array)[0]), \
  .sample_size = sizeof(opc_sample), .samples = (array)
#define OPC_EXAMPLES(array)                         \
  .n_examples = sizeof(array) / sizeof((array)[0]), \
  .example_size = sizeof(opc_example), .examples = (array)

/* Define the plugin "kind.NAME" at the end of a kind's source file. The file
   defines `static const opc_function required[]`, a function `exercise` and the
   embedded `templates`. `type`: struct of functions of the kind. `text`:
   summary of the plugin. Further fields of opc_kind (OPC_SAMPLES) are passed as
   designated initialisers. */
#define OPC_KIND(kind_name, type, text, ...)                                 \
  static const opc_kind functions = {.functions_size = sizeof(type),         \
                                     OPC_REQUIRED_FUNCTIONS(required),       \
                                     .exercise = exercise,                   \
                                     OPC_TEMPLATES(templates),               \
                                     __VA_ARGS__};                           \
  typedef struct kind_state {                                                \
    const opc_host *host;                                                    \
  } kind_state;                                                              \
  OPC_PLUGIN(kind_state, .id = "kind." kind_name, .kind = "kind",            \
             .version = "0.2.0", .licence = "BSD-3-Clause", .summary = text, \
             .flags = OPC_DETERMINISTIC | OPC_REENTRANT,                     \
             OPC_FUNCTIONS(functions))

OPC_C_END
#endif
