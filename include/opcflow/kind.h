/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds of plugins. The kernel has three: "step" (step.h), "command"
   (command.h) and "kind" itself. Every other kind is brought by a shared object
   of the kind "kind" whose id is "kind.NAME", found as any plugin: how large
   its functions are, how they are tried out, and what a new plugin of it looks
   like. */
#ifndef OPCFLOW_KIND_H
#define OPCFLOW_KIND_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* A function that a plugin of the kind must have. */
typedef struct opc_function {
  const char *name;
  size_t offset; /* in the struct of functions */
  OPC_MAY_GROW
} opc_function;

#define OPC_FUNCTION(type, member) \
  { #member, offsetof(type, member) }

/* What `opcflow lint` hears while it tries a plugin. */
typedef struct opc_inspector opc_inspector;
struct opc_inspector {
  /* Bytes of a result: the same input must give the same ones again, in
     another instance and on any number of threads. */
  void (*add)(opc_inspector *inspector, const void *data, size_t size);
  /* A fault; and what could not be tried, with the reason. */
  void (*find)(opc_inspector *inspector, const char *format, ...)
      OPC_PRINTF(2, 3);
  void (*note)(opc_inspector *inspector, const char *format, ...)
      OPC_PRINTF(2, 3);
  const opc_context *context;
  OPC_MAY_GROW
};

/* A file of a new plugin, for `opcflow new plugin KIND.NAME`. In both texts
   @NAME@ stands for the last word of its id, @ID@ for the id. */
typedef struct opc_template {
  const char *name; /* "@ID@.c" */
  const char *text;
  OPC_MAY_GROW
} opc_template;

/* A small file for plugins that must be given one: what its form is, only the
   plugin knows. */
typedef struct opc_sample {
  const char *name; /* "table.yaml" */
  const void *bytes;
  size_t size;
  OPC_MAY_GROW
} opc_sample;

/* Data for an input of a step, by its data kind. */
typedef struct opc_example {
  const char *kind;
  /* Made at the first call and then constant; NULL and *error if it cannot be.
     [main] */
  const void *(*give)(opc_error *error);
  OPC_MAY_GROW
} opc_example;

typedef struct opc_kind {
  size_t functions_size; /* of the struct of a plugin of this kind */

  /* Those that each plugin must have. Each array with the size of an element.
   */
  size_t n_functions, function_size;
  const opc_function *functions;

  /* Try an instance on made-up inputs, real in form and figures; tell what is
     wrong with what it hands back. In a process of its own. [main] */
  void (*exercise)(const opc_module *module, opc_inspector *inspector);

  size_t n_templates, template_size;
  const opc_template *templates;

  /* What lint gives to plugins of this kind that must have a file, each in turn
     until the plugin works with it, and to the inputs of steps. A plugin
     "kind.step" has them for steps. */
  size_t n_samples, sample_size;
  const opc_sample *samples;
  size_t n_examples, example_size;
  const opc_example *examples;
  OPC_MAY_GROW
} opc_kind;

/* The end of a kind's file, after `static const opc_function required[]`, a
   function `exercise` and the `templates` that are embedded: the plugin
   "kind.NAME" for modules whose functions are a `type`; what else there is as
   designated initialisers (OPC_SAMPLES). */
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
