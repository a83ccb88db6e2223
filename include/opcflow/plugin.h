/* SPDX-License-Identifier: BSD-3-Clause */
/* The plugin contract: how a shared object describes itself, how its instances
   receive parameters, and which functions the host offers.

   A plugin is one shared object with one exported function, which the macro
   OPC_PLUGIN defines at the end of the source file. A plugin includes the
   headers of this folder, links nothing of opcflow's core, and calls the host
   through the table `opc_host`. Data types and algorithms come from libraries
   that the plugin links, such as eda.

   Terms. A flow is a YAML file that lists steps. The host is the program that
   loads plugins and runs flows. A kind is a class of plugins with the same
   struct of functions, such as "step" or "litho". A step is a plugin that the
   flow runs; a slot is a parameter of a plugin that selects another plugin. An
   instance is the memory of a plugin for one use in a flow, with the values of
   the parameters. A data kind is the type of a step's output. Further terms:
   docs/reference/glossary.md.

   Threads. Each function is tagged:
     [main]  called from one thread at a time for one instance;
     [any]   may be called from several threads at once for one instance.

   Errors: see base.h. A plugin does not print and does not abort. */
#ifndef OPCFLOW_PLUGIN_H
#define OPCFLOW_PLUGIN_H

#include <opcflow/base.h>

OPC_C_BEGIN

/* Version of the interface that a plugin was built for. The host refuses
   plugins of another major version and of minor versions before OPC_ABI_OLDEST.
   Plugins of all other minor versions, older or newer than the host, run
   because of these rules:

   1. Existing fields, functions, flags and names keep their meaning and
      position. opc_error, opc_module, opc_reals, opc_pair, opc_map,
      opc_progress and the first three fields of opc_plugin never change.

   2. A struct that ends with OPC_MAY_GROW (base.h) may get fields before that
      line. A plugin passes the size of each struct that it declares. The host
      reads fields within that size, and takes missing fields as 0.

   3. A struct that the host passes may be longer than the plugin's header
      declares. A plugin must not copy such a struct or make an array of it. The
      host may also be older than the header and lack a field that was added to
      a struct with `size`; a plugin tests this by OPC_HAS.

   4. Functions that few plugins need are in structs that are found by name,
      such as "opcflow.inner/1". opc_host.service returns the structs of the
      host, opc_plugin.extension those of the plugin; both return NULL for an
      unknown name. If rules 1 and 2 forbid a change of a struct, the changed
      struct gets a new name.

   5. The functions of a kind of plugins (kind.h) follow rules 1 and 2. A plugin
      must have the functions of the first version of its kind. */
#define OPC_ABI_MAJOR 0u
#define OPC_ABI_MINOR 8u
#define OPC_ABI_OLDEST 8u

/* True if `object`, a pointer to a `type` with the field `size`, has
   `member`. */
#define OPC_HAS(type, object, member) \
  ((object)->size >= offsetof(type, member) + sizeof(object)->member)

/* ---- parameters ------------------------------------------------------- */

/* Type of a parameter, with the notation in a flow and the C type of the field
   of the instance. The last column is the value of the field if neither the
   flow nor a default sets one. */
enum {
  OPC_BOOL = 1,   /* true, false            int                  -1 */
  OPC_INT = 2,    /* 12                     int64_t              OPC_NO_INT */
  OPC_REAL = 3,   /* 65 nm                  double, in `unit`    NAN */
  OPC_TEXT = 4,   /*                        const char *         NULL */
  OPC_CHOICE = 5, /* one word of `choices`  int, its index       -1 */
  OPC_FILE = 6,   /* a file that exists; relative to the flow file
                                            const char *, path   NULL */
  OPC_OUTPUT = 7, /* name of a file to write in the run folder, for
                     opc_host.output_path   const char *         NULL */
  OPC_REALS = 8,  /* [1 nm, 2 nm]           opc_reals            NULL, 0 */
  OPC_MAP = 9,    /* { poly: 9/0, ... }; `choices` lists the allowed keys; if
                     NULL, any key is allowed. opc_map              NULL, 0 */
  OPC_INPUT = 10, /* ${step} or ${step.port}; `choices` lists the allowed
                     data kinds; the host sets the field only while the step
                     runs                   const void *         NULL */
  OPC_SLOT = 11   /* { use: litho.hopkins, ... }; `choices` names the plugin
                     kind                   const opc_module *   NULL */
};

/* Value of the field of an OPC_INT that has no value. */
#define OPC_NO_INT INT64_MIN

/* Field of an OPC_REALS: numbers in the unit of the parameter. */
typedef struct opc_reals {
  const double *values;
  size_t count;
} opc_reals;

/* An entry of an opc_map. */
typedef struct opc_pair {
  const char *key, *value;
} opc_pair;

/* Field of an OPC_MAP: entries in the order of the flow. */
typedef struct opc_map {
  const opc_pair *pairs;
  size_t count;
} opc_map;

/* Flags of a parameter. */
enum {
  OPC_REQUIRED = 1 << 0,   /* the flow must set the parameter */
  OPC_AT_LEAST = 1 << 1,   /* value >= min */
  OPC_ABOVE = 1 << 2,      /* value >  min */
  OPC_AT_MOST = 1 << 3,    /* value <= max */
  OPC_BELOW = 1 << 4,      /* value <  max */
  OPC_NO_EFFECT = 1 << 5,  /* the value does not affect results (threads,
                              verbosity) */
  OPC_MAP_OF_ANY = 1 << 6, /* for an OPC_MAP: values may also be lists and maps;
                              the plugin receives the text of each value, as
                              written in a flow on one line */
  OPC_INNER_FLOW = 1 << 7, /* for an OPC_FILE: the file is a flow that the step
                              runs, its inner flow; inner.h */
  OPC_INNER_AXIS = 1 << 8, /* for an OPC_MAP with OPC_MAP_OF_ANY: each value is
                              a layer of changes to the inner flow; the flow may
                              write a list instead of a map; inner.h */
  OPC_INNER_STEP = 1 << 9, /* for an OPC_INPUT: replaces the step of the inner
                              flow that has the name of the parameter */
  OPC_LISTED = 1 << 10,    /* for an OPC_TEXT: the plugin lists the allowed
                              values; choices.h */
  OPC_BESIDE = 1 << 11     /* for an OPC_FILE: the plugin also reads other files
                              of the same folder */
};

/* Declaration of a parameter, written with OPC_PARAMETER. Names are lower_case;
   a dot separates a group and its member: "anchor.line" is written `anchor: {
   line: 65 nm }`. `unit` is the unit of the number that the plugin receives
   ("nm", "%", "V", "A", "C", "deg", "s", "1/nm"); the flow must write a unit of
   the same dimension. If `unit` is NULL, the value is a plain number. `preset`
   is the default in the notation of a flow; NULL if the parameter has no
   default. `offset` and `width` are position and size of the field in the
   instance, bytes. `given` is the offset of an int field, or 0 for no field.
   The host sets this field to 1 if the flow or the command line sets a value
   other than the default, else to 0. */
typedef struct opc_parameter {
  const char *name;
  uint32_t type;  /* OPC_BOOL ... */
  uint32_t flags; /* OPC_REQUIRED ... */
  const char *unit;
  const char *preset;
  double min, max;     /* bounds of OPC_AT_LEAST ... */
  const char *choices; /* words, separated by | */
  const char *summary; /* one line, no full stop */
  size_t offset, width, given;
  const char *former; /* earlier names, separated by |, or NULL; the use of an
                         earlier name is reported */
  /* Expression of the derived default of an OPC_REAL without `preset`, or NULL,
     for example "0.155 lambda/NA". The host only shows the expression as the
     default; the plugin computes the value (opcflow/follow.h). */
  const char *follows;
  OPC_MAY_GROW
} opc_parameter;

/* Initialise an element of an array of parameters. `member` is the field of the
   instance type `state` that receives the value. The other arguments are
   designated initialisers of opc_parameter. The name of the parameter is that
   of the field; OPC_PARAMETER_NAMED sets another name. */
#define OPC_PARAMETER(state, member, ...) \
  OPC_PARAMETER_NAMED(#member, state, member, __VA_ARGS__)
#define OPC_PARAMETER_NAMED(label, state, member, ...) \
  { .name = label, OPC_FIELD(state, member), __VA_ARGS__ }
/* Initialise `offset` and `width` for a member of the instance type. */
#define OPC_FIELD(state, member) \
  .offset = offsetof(state, member), .width = sizeof(((state *)0)->member)

/* ---- metrics ---------------------------------------------------------- */

/* Values of opc_metric.better: the direction in which a metric improves. */
enum { OPC_NEUTRAL = 0, OPC_LOWER = 1, OPC_HIGHER = 2 };

/* Declaration of a metric: a number that a plugin publishes as a result, such
   as the largest deviation. */
typedef struct opc_metric {
  const char *name;
  const char *unit;    /* NULL for a plain number */
  uint32_t better;     /* OPC_LOWER ... */
  double tolerance;    /* in `unit`; smaller differences between two runs are
                          insignificant */
  const char *summary; /* one line, no full stop */
  OPC_MAY_GROW
} opc_metric;

/* ---- the host --------------------------------------------------------- */

/* Levels of log messages. A finding is a fault of the result that must not be
   missed. The host shows a finding as a warning at once and again at the end of
   the run, and writes the finding to metrics.json. */
enum {
  OPC_LOG_DEBUG = 0,
  OPC_LOG_INFO = 1,
  OPC_LOG_WARNING = 2,
  OPC_LOG_FINDING = 3
};

/* Progress of a long step. A number is NAN if unknown. */
typedef struct opc_progress {
  double done, total;     /* in any unit that the step counts */
  double worst;           /* the error that the step minimises */
  const char *worst_unit; /* unit of `worst`; NULL for a plain number */
} opc_progress;

enum { OPC_TABLE_PRINT = 1 }; /* the table is also printed to standard output */

/* A column of a published table: `type` is OPC_TEXT, OPC_REAL or OPC_INT and
   `data` an array of const char *, double or int64_t. */
typedef struct opc_column {
  const char *name;
  const char *unit; /* NULL for plain numbers and texts */
  uint32_t type;
  int32_t decimals; /* number of decimals of an OPC_REAL; -1 for the shortest
                       exact form */
  const void *data;
  OPC_MAY_GROW
} opc_column;

/* Functions of the host. Each instance has its own opc_host, valid from before
   `check` until after `clear`. The first argument of every function is a
   pointer to the opc_host of the calling instance. The functions are [any]
   unless stated otherwise. */
typedef struct opc_host opc_host;
struct opc_host {
  size_t size;                /* size of this struct */
  const opc_context *context; /* threads; base.h */
  void *data;                 /* private data of the host */

  /* Log one line for the user; `format` does not end with a newline. */
  void (*log)(const opc_host *host, int level, const char *format, ...)
      OPC_PRINTF(3, 4);
  /* Report the progress of the running step, for display. */
  void (*progress)(const opc_host *host, const opc_progress *progress);

  /* Publish a table; `name` has no '/'. The host writes NAME.csv in the run
     folder, or STEP.NAME.csv if another step or a parameter uses the name
     NAME.csv. The host prints the table if OPC_TABLE_PRINT is set, and copies
     all data. `column_size` is sizeof(opc_column) in the plugin, passed by
     opc_put_table and opc_put_rows (table.h). Returns 0, or an error code with
     *error filled; the step then fails even if the plugin continues. [main],
     while a step runs. */
  int (*table)(const opc_host *host, const char *name, uint32_t flags,
               size_t rows, const opc_column *columns, size_t n_columns,
               size_t column_size, opc_error *error);

  /* Publish the value of a declared metric; a later call replaces the value.
     Returns 0, or OPC_FAILED and *error if the plugin does not declare `name`
     or the value is not finite. The step then fails even if the plugin
     continues. [main] */
  int (*metric)(const opc_host *host, const char *name, double value,
                opc_error *error);

  /* Return the path at which to write the output file `name`, a path relative
     to the run folder. The path is valid as long as the instance. Returns NULL
     and fills *error if `name` is outside the run folder or already in use, or
     if no step runs; a running step then fails even if the plugin continues.
     [main], while a step runs. */
  const char *(*output_path)(const opc_host *host, const char *name,
                             opc_error *error);

  /* Return the service `name`, valid as long as the instance; NULL if this host
     or this instance has no such service. The listed header declares the
     struct:
       "opcflow.inner/1"    flows that a step runs               inner.h
       "opcflow.pieces/1"   distributed work units               pieces.h
       "opcflow.results/1"  results kept beyond a run            results.h */
  const void *(*service)(const opc_host *host, const char *name);
  OPC_MAY_GROW
};

/* ---- the descriptor --------------------------------------------------- */

/* Flags of a plugin. */
enum {
  OPC_DETERMINISTIC = 1 << 0, /* equal inputs produce equal bits */
  OPC_REENTRANT = 1 << 1      /* two instances may run concurrently */
};

/* Descriptor of a plugin. All data that the descriptor points to is constant
   and valid as long as the shared object is loaded. */
typedef struct opc_plugin {
  uint16_t abi_major, abi_minor; /* version of the interface of the build */
  uint32_t size;                 /* size of this struct */
  const char *id; /* "litho.hopkins", lower case; the part before the dot is the
                     family */
  const char *kind;    /* kind of `functions`: "litho"; kind.h */
  const char *version; /* version of the plugin */
  const char *licence; /* SPDX expression */
  const char *summary; /* one line, no full stop */
  uint32_t flags;      /* OPC_DETERMINISTIC, OPC_REENTRANT */

  /* Arrays, each with the size of its elements. */
  uint32_t parameter_size, metric_size;
  size_t n_parameters;
  const opc_parameter *parameters;
  size_t n_metrics;
  const opc_metric *metrics;

  /* Size of an instance: a struct whose first member is `const opc_host *host`.
     The host allocates the instance, fills it with zeros, sets `host` and the
     fields of all parameters, and frees the instance. The host owns data that
     parameters point to; this data is valid as long as the instance. */
  size_t instance_size;

  /* Check constraints that declarations of parameters cannot express, such as
     the order of two bounds, and do the preparations of the instance that take
     little time. The content of files is not checked here. Fields of inputs are
     NULL. The host calls this function for every command that reads the flow,
     such as `opcflow check`. Returns 0, or an error code with *error filled.
     NULL if the plugin needs no check. [main] */
  int (*check)(void *self, opc_error *error);

  /* Release the resources of the instance before the host frees it; also called
     after a failed `check`. NULL if there is nothing to release. [main] */
  void (*clear)(void *self);

  /* The kind's struct of functions, and the size of that struct in the
     plugin. */
  const void *functions;
  size_t functions_size;

  /* Return the extension `name`, a constant struct that the listed header
     declares; NULL if the plugin has no such extension:
       "opcflow.choices/1"  values that a parameter may have     choices.h
     A plugin without extensions sets this field to NULL. [any] */
  const void *(*extension)(const char *name);
  OPC_MAY_GROW
} opc_plugin;

/* Initialise fields of an opc_plugin: arrays of parameters and of metrics, and
   the struct of functions. */
#define OPC_PARAMETERS(array)                         \
  .n_parameters = sizeof(array) / sizeof((array)[0]), \
  .parameter_size = sizeof(opc_parameter), .parameters = (array)
#define OPC_METRICS(array)                         \
  .n_metrics = sizeof(array) / sizeof((array)[0]), \
  .metric_size = sizeof(opc_metric), .metrics = (array)
#define OPC_FUNCTIONS(object) \
  .functions = &(object), .functions_size = sizeof(object)

/* Type and name of the exported function, which returns the descriptor. */
typedef const opc_plugin *(*opc_plugin_entry)(void);
#define OPC_ENTRY_NAME "opcflow_plugin"

/* Define the descriptor, from designated initialisers, and the function that
   returns it, at the end of a plugin's source file. `state` is the type of an
   instance. */
#define OPC_PLUGIN(state, ...)                                        \
  OPC_EXPORT const opc_plugin *opcflow_plugin(void);                  \
  const opc_plugin *opcflow_plugin(void) {                            \
    static const opc_plugin plugin = {.abi_major = OPC_ABI_MAJOR,     \
                                      .abi_minor = OPC_ABI_MINOR,     \
                                      .size = sizeof(opc_plugin),     \
                                      .instance_size = sizeof(state), \
                                      __VA_ARGS__};                   \
    return &plugin;                                                   \
  }                                                                   \
  struct opc_plugin

OPC_C_END
#endif
