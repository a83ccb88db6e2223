/* SPDX-License-Identifier: BSD-3-Clause */
/* The plugin contract: what a shared object tells of itself, how it gets its
   parameters, and what the host offers it.

   A plugin is one shared object with one exported function,

     OPC_EXPORT const opc_plugin *opcflow_plugin(void);

   It includes the headers of this folder only, links nothing of opcflow, and
   calls back through the table of `opc_host`.

   Threads. Each function is tagged:
     [main]  called from one thread at a time for one instance;
     [any]   may be called from several threads at once for one instance.

   Errors. A function that can fail returns an OPC_* code (0 is success) and
   describes the failure in its `opc_error *` argument, which is never NULL.
   Nothing is printed, nothing aborts.

   Units. Lengths are nanometres and currents amperes unless a name says
   otherwise; layout coordinates are integers in a unit that stands beside
   them. */
#ifndef OPCFLOW_PLUGIN_H
#define OPCFLOW_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A plugin built for another major is refused; one built for a later minor
   loads, as everything of the earlier minors is still where it was. */
#define OPC_ABI_MAJOR 1u
#define OPC_ABI_MINOR 2u

/* Is the function `field` of a struct of functions there? It may be one of a
   later minor than the struct. */
#define OPC_HAS(operations, field)                                    \
  ((operations)->size >= (size_t)((const char *)(&(operations)->field + 1) - \
                                  (const char *)(operations)) &&      \
   (operations)->field)

#if defined(__GNUC__)
#define OPC_EXPORT __attribute__((visibility("default")))
#define OPC_PRINTF(f, a) __attribute__((format(printf, f, a)))
#else
#define OPC_EXPORT
#define OPC_PRINTF(f, a)
#endif

/* Result codes. The command maps them to its exit codes. */
enum {
  OPC_OK = 0,
  OPC_INVALID = 1,     /* a parameter or an input does not make sense: exit 2 */
  OPC_FAILED = 2,      /* the work could not be done: exit 4 */
  OPC_IO = 3,          /* a file could not be read or written: exit 5 */
  OPC_NO_PLUGIN = 4,   /* a plugin is missing or incompatible: exit 3 */
  OPC_LIMIT = 5,       /* a limit was not kept: exit 1 */
  OPC_CANCELLED = 6    /* the user stopped it: exit 4 */
};

/* Frozen. `parameter` names the parameter at fault, or is empty; the command
   then points at its place in the flow file. Fill it with opc_host.fail. */
typedef struct opc_error {
  int32_t code;
  char parameter[64];
  char message[956];
} opc_error;

enum {
  OPC_KIND_LITHO = 1,
  OPC_KIND_RESIST = 2,
  OPC_KIND_EXTRACT = 3,
  OPC_KIND_MASK = 4,
  OPC_KIND_DRC = 5,
  OPC_KIND_STEP = 6
};

/* ---- parameters ------------------------------------------------------- */

enum {
  OPC_ABSENT = 0,  /* of a value: neither given nor with a default */
  OPC_BOOL = 1,    /* true, false               -> integer */
  OPC_INT = 2,     /* 12                        -> integer */
  OPC_REAL = 3,    /* 65 nm                     -> real, in `unit` */
  OPC_TEXT = 4,    /*                           -> text */
  OPC_CHOICE = 5,  /* one word of `choices`     -> integer: its index; text */
  OPC_FILE = 6,    /* a file that exists; relative to the flow file
                                                -> text: its path */
  OPC_OUTPUT = 7,  /* a file's name inside the run folder -> text: as given;
                      opc_host.output_path gives the place to write to */
  OPC_REALS = 8,   /* [1 nm, 2 nm]              -> reals, count */
  OPC_MAP = 9,     /* { poly: 9/0, ... }; `choices` lists the keys, or is NULL
                      for free ones             -> pairs, count */
  OPC_INPUT = 10,  /* ${step} or ${step.port}; `choices` names the data kind
                                                -> object, while running */
  OPC_SLOT = 11    /* { use: litho.hopkins, ... }; `choices` names the plugin
                      kind                      -> object: opc_module */
};

enum {
  OPC_REQUIRED = 1 << 0,
  OPC_AT_LEAST = 1 << 1,   /* value >= min */
  OPC_ABOVE = 1 << 2,      /* value >  min */
  OPC_AT_MOST = 1 << 3,    /* value <= max */
  OPC_BELOW = 1 << 4,      /* value <  max */
  OPC_NO_EFFECT = 1 << 5   /* does not change the result (threads, verbosity) */
};

/* A parameter. Names are lower_case; a dot makes a group, so that
   "anchor.line" is written `anchor: { line: 65 nm }`. `unit` is the unit in
   which the plugin gets the number ("nm", "%", "V", "A", "C", "deg", "s",
   "1/nm"); the flow may write any unit of the same dimension, and must write
   one. NULL: a plain number. `preset` is the default as a flow would write it,
   NULL for none. */
typedef struct opc_parameter {
  const char *name;
  uint32_t type;
  uint32_t flags;
  const char *unit;
  const char *preset;
  double min, max;
  const char *choices;   /* words with | between them */
  const char *summary;   /* one line, no full stop */
} opc_parameter;

typedef struct opc_pair {
  const char *key, *value;
} opc_pair;

/* A checked value, in the order of the declared parameters. Frozen. The host
   owns everything it points to, for the life of the instance. */
typedef struct opc_value {
  uint32_t type;         /* OPC_ABSENT or the parameter's type */
  uint32_t given;        /* 1: by the flow or command line, 0: the default, also
                            where the flow writes it out */
  int64_t integer;
  double real;
  const char *text;
  const double *reals;
  const opc_pair *pairs;
  size_t count;
  void *object;
  void *reserved;
} opc_value;

/* ---- metrics ---------------------------------------------------------- */

enum { OPC_NEUTRAL = 0, OPC_LOWER = 1, OPC_HIGHER = 2 };  /* which is better */

typedef struct opc_metric {
  const char *name;
  const char *unit;      /* NULL: a plain number */
  uint32_t better;
  uint32_t reserved;
  double tolerance;      /* a difference below it means nothing; same unit */
  const char *summary;
} opc_metric;

/* ---- the host --------------------------------------------------------- */

typedef struct opc_layout_service opc_layout_service;      /* layout.h */
typedef struct opc_geometry_service opc_geometry_service;  /* geometry.h */
typedef struct opc_imaging_service opc_imaging_service;    /* imaging.h */
typedef struct opc_device_service opc_device_service;      /* devices.h */

enum { OPC_LOG_DEBUG = 0, OPC_LOG_INFO = 1, OPC_LOG_WARNING = 2 };

/* What a long step tells while it works. NAN where there is nothing to say. */
typedef struct opc_progress {
  size_t size;           /* sizeof(opc_progress) */
  double done, total;    /* in whatever the step counts */
  double worst;          /* the figure that is being driven down */
  const char *worst_unit;
} opc_progress;

enum { OPC_TABLE_PRINT = 1 };   /* show it on standard output too */

/* A column of a table that a step publishes: `type` is OPC_TEXT, OPC_REAL or
   OPC_INT and `data` an array of const char *, double or int64_t. */
typedef struct opc_column {
  const char *name;
  const char *unit;
  uint32_t type;
  int32_t decimals;      /* of an OPC_REAL; -1 for the shortest exact form */
  const void *data;
} opc_column;

/* Append-only. An instance gets a table of its own at `create` and keeps it
   until `destroy`; every function takes that table as its first argument and
   is [any] unless it says otherwise. */
typedef struct opc_host opc_host;
struct opc_host {
  size_t size;           /* of this struct in the host that runs */
  uint32_t abi_major, abi_minor;
  void *context;         /* the host's own */

  /* Fill *error and return `code`, so that one can write
     `return host->fail(host, error, OPC_FAILED, NULL, "...")`. */
  int (*fail)(const opc_host *host, opc_error *error, int code,
              const char *parameter, const char *format, ...) OPC_PRINTF(5, 6);

  /* One line for the user, without a newline. */
  void (*log)(const opc_host *host, int level, const char *format, ...)
      OPC_PRINTF(3, 4);
  void (*progress)(const opc_host *host, const opc_progress *progress);

  /* Non-zero once the user wants to stop: clean up, return OPC_CANCELLED. */
  int (*cancelled)(const opc_host *host);

  /* Zeroed memory of count * size bytes, NULL if there is none or count * size
     overflows; memory that an operation hands to the host comes from here. */
  void *(*alloc)(const opc_host *host, size_t count, size_t size);
  void (*free)(const opc_host *host, void *memory);

  /* Call task(data, i) for each i below n, from several threads at once; all
     are done when it returns. Cut the work by its content, never by the number
     of threads, and no result will depend on it. May be nested. */
  void (*parallel)(const opc_host *host, size_t n,
                   void (*task)(void *data, size_t i), void *data);

  /* A table: written as NAME.csv in the run folder, printed if asked to.
     [main], while a step runs. */
  int (*table)(const opc_host *host, const char *name, uint32_t flags,
               size_t rows, const opc_column *columns, size_t n_columns,
               opc_error *error);

  /* The value of a metric that the plugin declares. [main] */
  int (*metric)(const opc_host *host, const char *name, double value,
                opc_error *error);

  /* Where to write the output file `name` (a plain relative name): the path,
     valid as long as the instance; NULL and *error if the name leaves the run
     folder or is taken. [main], while a step runs. */
  const char *(*output_path)(const opc_host *host, const char *name,
                             opc_error *error);

  const opc_layout_service *layout;
  const opc_geometry_service *geometry;
  const opc_imaging_service *imaging;
  const opc_device_service *devices;
};

/* ---- the descriptor --------------------------------------------------- */

enum {
  OPC_DETERMINISTIC = 1 << 0,  /* same input, same bits */
  OPC_REENTRANT = 1 << 1       /* two instances may work at the same time */
};

/* The first three fields are frozen for all time, the rest for this major.
   Everything it points to is constant and lives as long as the object is
   loaded. */
typedef struct opc_plugin {
  uint32_t size;             /* sizeof(opc_plugin) */
  uint16_t abi_major, abi_minor;
  const char *id;            /* "mask.dpb": family.name, lower case */
  const char *version;
  const char *licence;       /* SPDX expression */
  const char *summary;       /* one line, no full stop */
  uint32_t kind;
  uint32_t flags;
  uint32_t n_parameters, parameter_size;   /* size: sizeof(opc_parameter) */
  const opc_parameter *parameters;
  uint32_t n_metrics, metric_size;
  const opc_metric *metrics;

  /* Make an instance. `values` holds the checked parameters and outlives the
     instance; OPC_SLOT values are there, OPC_INPUT objects only while a step
     runs. Check what the declaration cannot say (two bounds against each
     other, a file's content is for later); no heavy work, as `opcflow check`
     calls it too. NULL and *error on failure. [main] */
  void *(*create)(const opc_host *host, const opc_value *values,
                  opc_error *error);
  void (*destroy)(void *self);   /* [main]; not called with NULL */

  /* The kind's struct of functions; it begins with its own size:
     opc_litho, opc_resist, opc_extract, opc_synthesizer, opc_regulator,
     opc_step. */
  const void *operations;

  /* Something that a later host may ask for by name; NULL for what it does
     not know. May itself be NULL. [any] */
  const void *(*get_extension)(const char *id);
} opc_plugin;

/* ---- extensions ------------------------------------------------------- */

/* get_extension(OPC_RENAMED_PARAMETERS) gives an opc_renames: parameters that
   had another name in an earlier version of the plugin. A flow that writes the
   old name works, and is told the new one. */
#define OPC_RENAMED_PARAMETERS "opcflow.renamed-parameters/1"

typedef struct opc_rename {
  const char *from;      /* whole names: "anchor.line" */
  const char *to;        /* a declared parameter */
  const char *since;     /* the version that renamed it */
  const char *note;      /* what else has changed; NULL */
} opc_rename;

typedef struct opc_renames {
  size_t size;           /* sizeof(opc_renames) */
  uint32_t count, rename_size;   /* sizeof(opc_rename) */
  const opc_rename *renames;
} opc_renames;

typedef const opc_plugin *(*opc_plugin_entry)(void);
#define OPC_ENTRY_NAME "opcflow_plugin"

/* An instance of a plugin, as an OPC_SLOT gives it. Frozen. */
typedef struct opc_module {
  const opc_plugin *plugin;
  void *self;
} opc_module;

/* The declaration of a plugin's arrays, for the descriptor's initialiser. */
#define OPC_PARAMETERS(array)                                    \
  .n_parameters = sizeof(array) / sizeof((array)[0]),            \
  .parameter_size = sizeof(opc_parameter), .parameters = (array)
#define OPC_METRICS(array)                                       \
  .n_metrics = sizeof(array) / sizeof((array)[0]),               \
  .metric_size = sizeof(opc_metric), .metrics = (array)

#ifdef __cplusplus
}
#endif
#endif
