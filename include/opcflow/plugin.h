/* SPDX-License-Identifier: BSD-3-Clause */
/* The plugin contract: what a shared object tells of itself, how it gets its
   parameters, and what the host offers it.

   A plugin is one shared object with one exported function, which the macro
   OPC_PLUGIN at the end of its file makes. It includes the headers of this
   folder, links nothing of opcflow's kernel, and calls back through the table
   of `opc_host`. What it works on comes from libraries that it links, such as
   eda.

   Threads. Each function is tagged:
     [main]  called from one thread at a time for one instance;
     [any]   may be called from several threads at once for one instance.

   Errors. See base.h. Nothing is printed, nothing aborts. */
#ifndef OPCFLOW_PLUGIN_H
#define OPCFLOW_PLUGIN_H

#include <opcflow/base.h>

OPC_C_BEGIN

/* The version of the interface that a plugin was built for. The host refuses
   another major, and minors before OPC_ABI_OLDEST. A plugin of any other minor
   runs, older or newer, because of these rules:

   1. Existing fields, functions, flags and names never change their meaning or
      place. opc_error, opc_module, opc_reals, opc_pair, opc_map, opc_progress
      and the first three fields of opc_plugin are frozen.
   2. A struct that ends with OPC_MAY_GROW (base.h) may get fields before that
      line. A plugin passes the size of each struct that it declares, and the
      host reads no more. Fields that an older plugin lacks are 0; the host
      ignores fields that it does not know.
   3. Structs that the host hands out may be longer than the plugin knows; no
      plugin copies them or has arrays of them. A plugin for a later minor asks
      OPC_HAS before it uses a field that was added to a struct with `size`.
   4. Rare functions have a name, such as "opcflow.inner/1". A plugin asks
      opc_host.service for those of the host; the host asks
      opc_plugin.extension for those of the plugin. NULL: there is none. A
      change that rules 1 and 2 forbid gets another name.
   5. The functions of a kind follow rules 1 and 2: functions that must be there
      are those of the kind's first version. */
#define OPC_ABI_MAJOR 0u
#define OPC_ABI_MINOR 8u
#define OPC_ABI_OLDEST 8u

/* Whether `object`, a pointer to a `type` with a `size`, has that field. */
#define OPC_HAS(type, object, member) \
  ((object)->size >= offsetof(type, member) + sizeof(object)->member)

/* ---- parameters ------------------------------------------------------- */

/* The type of a parameter, how a flow writes it, and the type of the field of
   the instance that gets it. What is neither given nor has a default leaves
   the field as the last column says. */
enum {
  OPC_BOOL = 1,   /* true, false            int                  -1 */
  OPC_INT = 2,    /* 12                     int64_t              OPC_NO_INT */
  OPC_REAL = 3,   /* 65 nm                  double, in `unit`    NAN */
  OPC_TEXT = 4,   /*                        const char *         NULL */
  OPC_CHOICE = 5, /* one word of `choices`  int, its index       -1 */
  OPC_FILE = 6,   /* a file that exists; relative to the flow file
                                            const char *, path   NULL */
  OPC_OUTPUT = 7, /* a file's name inside the run folder, for
                     opc_host.output_path   const char *         NULL */
  OPC_REALS = 8,  /* [1 nm, 2 nm]           opc_reals            NULL, 0 */
  OPC_MAP = 9,    /* { poly: 9/0, ... }; `choices` lists the keys, or is
                     NULL for free ones     opc_map              NULL, 0 */
  OPC_INPUT = 10, /* ${step} or ${step.port}; `choices` names the data
                     kinds it may be of     const void *, while  NULL
                                            running */
  OPC_SLOT = 11   /* { use: litho.hopkins, ... }; `choices` names the plugin
                     kind                   const opc_module *   NULL */
};

#define OPC_NO_INT INT64_MIN

typedef struct opc_reals {
  const double *values;
  size_t count;
} opc_reals;

typedef struct opc_pair {
  const char *key, *value;
} opc_pair;

typedef struct opc_map {
  const opc_pair *pairs;
  size_t count;
} opc_map;

enum {
  OPC_REQUIRED = 1 << 0,
  OPC_AT_LEAST = 1 << 1,   /* value >= min */
  OPC_ABOVE = 1 << 2,      /* value >  min */
  OPC_AT_MOST = 1 << 3,    /* value <= max */
  OPC_BELOW = 1 << 4,      /* value <  max */
  OPC_NO_EFFECT = 1 << 5,  /* does not change the result (threads, verbosity) */
  OPC_MAP_OF_ANY = 1 << 6, /* of an OPC_MAP: values of any form, as the flow
                              writes them on one line */
  OPC_INNER_FLOW = 1 << 7, /* of an OPC_FILE: a flow that the step runs;
                              inner.h */
  OPC_INNER_AXIS = 1 << 8, /* of an OPC_MAP of any: layers that are laid over
                              that flow one after another, also as a list */
  OPC_INNER_STEP = 1 << 9, /* of an OPC_INPUT: stands in place of the step of
                              that flow that is called as the parameter */
  OPC_LISTED = 1 << 10,    /* of an OPC_TEXT: the plugin lists the values that
                              it may have; choices.h */
  OPC_BESIDE = 1 << 11     /* of an OPC_FILE: others beside it are read, too */
};

/* A parameter, declared with OPC_PARAMETER. Names are lower_case; a dot makes a
   group, so that "anchor.line" is written `anchor: { line: 65 nm }`. `unit` is
   the unit in which the plugin gets the number ("nm", "%", "V", "A", "C",
   "deg", "s", "1/nm"); the flow may write any unit of the same dimension, and
   must write one. NULL: a plain number. `preset` is the default as a flow would
   write it, NULL for none. `offset` and `width` say where the value goes.
   `given` is the offset of an int that becomes 1 if the flow or the command
   line gave the value and 0 if not, also where it writes the default out; 0
   for no such field. */
typedef struct opc_parameter {
  const char *name;
  uint32_t type;
  uint32_t flags;
  const char *unit;
  const char *preset;
  double min, max;
  const char *choices; /* words with | between them */
  const char *summary; /* one line, no full stop */
  size_t offset, width, given;
  const char *former; /* names it had before, with | between them; told when
                         they are used. NULL: none */
  /* Of an OPC_REAL without `preset`: what a value that is not given follows
     from, as people read it ("0.155 lambda/NA"), shown in the default's place;
     the plugin works it out (opcflow/follow.h). NULL: nothing. */
  const char *follows;
  OPC_MAY_GROW
} opc_parameter;

/* The elements of an array of parameters: the field `member` of an instance of
   the type `state` that gets the value, and what else there is to say, as
   designated initialisers. The parameter is called as the field is, or NAMED.
 */
#define OPC_PARAMETER(state, member, ...) \
  OPC_PARAMETER_NAMED(#member, state, member, __VA_ARGS__)
#define OPC_PARAMETER_NAMED(label, state, member, ...) \
  { .name = label, OPC_FIELD(state, member), __VA_ARGS__ }
#define OPC_FIELD(state, member) \
  .offset = offsetof(state, member), .width = sizeof(((state *)0)->member)

/* ---- metrics ---------------------------------------------------------- */

enum { OPC_NEUTRAL = 0, OPC_LOWER = 1, OPC_HIGHER = 2 }; /* which is better */

typedef struct opc_metric {
  const char *name;
  const char *unit; /* NULL: a plain number */
  uint32_t better;
  double tolerance; /* a difference below it means nothing; same unit */
  const char *summary;
  OPC_MAY_GROW
} opc_metric;

/* ---- the host --------------------------------------------------------- */

/* Levels of what is said. A finding is about the result, and must not be
   missed: it is shown as a warning at once, again as a last line of the run,
   and kept in metrics.json. */
enum {
  OPC_LOG_DEBUG = 0,
  OPC_LOG_INFO = 1,
  OPC_LOG_WARNING = 2,
  OPC_LOG_FINDING = 3
};

/* What a long step tells while it works. NAN where there is nothing to say. */
typedef struct opc_progress {
  double done, total; /* in whatever the step counts */
  double worst;       /* the figure that is being driven down */
  const char *worst_unit;
} opc_progress;

enum { OPC_TABLE_PRINT = 1 }; /* show it on standard output too */

/* A column of a table that a step publishes: `type` is OPC_TEXT, OPC_REAL or
   OPC_INT and `data` an array of const char *, double or int64_t. */
typedef struct opc_column {
  const char *name;
  const char *unit;
  uint32_t type;
  int32_t decimals; /* of an OPC_REAL; -1 for the shortest exact form */
  const void *data;
  OPC_MAY_GROW
} opc_column;

/* An instance gets a table of its own before `check` and keeps it until after
   `clear`; every function takes that table as its first argument and is [any]
   unless it says otherwise. */
typedef struct opc_host opc_host;
struct opc_host {
  size_t size;                /* of this struct */
  const opc_context *context; /* threads; base.h */
  void *data;                 /* the host's own */

  /* One line for the user, without a newline. */
  void (*log)(const opc_host *host, int level, const char *format, ...)
      OPC_PRINTF(3, 4);
  void (*progress)(const opc_host *host, const opc_progress *progress);

  /* Publish a table: it is written as NAME.csv in the run folder, and printed
     if asked to. `column_size` is that of an opc_column; opc_put_table and
     opc_put_rows (table.h) pass it. [main], while a step runs. */
  int (*table)(const opc_host *host, const char *name, uint32_t flags,
               size_t rows, const opc_column *columns, size_t n_columns,
               size_t column_size, opc_error *error);

  /* The value of a metric that the plugin declares. [main] */
  int (*metric)(const opc_host *host, const char *name, double value,
                opc_error *error);

  /* Where to write the output file `name` (a plain relative name): the path,
     valid as long as the instance; NULL and *error if the name leaves the run
     folder or is taken. [main], while a step runs. */
  const char *(*output_path)(const opc_host *host, const char *name,
                             opc_error *error);

  /* Return the service of that name, a struct that its header declares; NULL
     if this host or this instance has none. Valid as long as the instance:
       "opcflow.inner/1"    flows that a step runs               inner.h
       "opcflow.pieces/1"   work that processes share            pieces.h
       "opcflow.results/1"  results kept beyond a run            results.h */
  const void *(*service)(const opc_host *host, const char *name);
  OPC_MAY_GROW
};

/* ---- the descriptor --------------------------------------------------- */

enum {
  OPC_DETERMINISTIC = 1 << 0, /* same input, same bits */
  OPC_REENTRANT = 1 << 1      /* two instances may work at the same time */
};

/* What a plugin tells of itself. Everything it points to is constant and lives
   as long as the object is loaded. */
typedef struct opc_plugin {
  uint16_t abi_major, abi_minor;
  uint32_t size;    /* of this struct */
  const char *id;   /* "litho.hopkins": family.name, lower case */
  const char *kind; /* "litho": of the functions below; kind.h */
  const char *version;
  const char *licence; /* SPDX expression */
  const char *summary; /* one line, no full stop */
  uint32_t flags;      /* OPC_DETERMINISTIC, OPC_REENTRANT */

  /* Each array with the size of an element. */
  uint32_t parameter_size, metric_size;
  size_t n_parameters;
  const opc_parameter *parameters;
  size_t n_metrics;
  const opc_metric *metrics;

  /* The size of an instance: a struct whose first member is
     `const opc_host *host`. The host allocates it, fills it with zeros, sets
     `host` and the fields of all parameters, and frees it. What parameters
     point to belongs to the host and lives as long as the instance. */
  size_t instance_size;

  /* Look at what the declaration cannot say (two bounds against each other, a
     file's content is for later) and prepare what costs nothing, as `opcflow
     check` calls it too; inputs are not there yet. NULL: nothing to do. [main]
   */
  int (*check)(void *self, opc_error *error);

  /* Release what the instance made for itself, before the host frees it; also
     after a `check` that failed. NULL: nothing to do. [main] */
  void (*clear)(void *self);

  /* The kind's struct of functions, and its size in the plugin. */
  const void *functions;
  size_t functions_size;

  /* Return the extension of that name, a constant struct that a header
     declares, or NULL; the field may be NULL, too:
       "opcflow.choices/1"  values that a parameter may have     choices.h
     [any] */
  const void *(*extension)(const char *name);
  OPC_MAY_GROW
} opc_plugin;

#define OPC_PARAMETERS(array)                         \
  .n_parameters = sizeof(array) / sizeof((array)[0]), \
  .parameter_size = sizeof(opc_parameter), .parameters = (array)
#define OPC_METRICS(array)                         \
  .n_metrics = sizeof(array) / sizeof((array)[0]), \
  .metric_size = sizeof(opc_metric), .metrics = (array)
#define OPC_FUNCTIONS(object) \
  .functions = &(object), .functions_size = sizeof(object)

typedef const opc_plugin *(*opc_plugin_entry)(void);
#define OPC_ENTRY_NAME "opcflow_plugin"

/* The end of a plugin's file: its descriptor, as designated initialisers, and
   the function that gives it. `state` is the type of an instance. */
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
