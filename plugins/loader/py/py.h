/* SPDX-License-Identifier: BSD-3-Clause */
/* Plugins in Python: descriptors, instances, and the functions of each kind.
   Each function of a kind sends a request to the worker of its instance. */
#pragma once

#include <eda/extractor.h>
#include <eda/litho.h>
#include <eda/regulator.h>
#include <eda/resist.h>
#include <opcflow/step.h>

#include "worker.h"

/* A plugin, kept until the process ends. */
typedef struct py_plugin {
  char id[128]; /* first member: the address identifies the plugin */
  opc_plugin descriptor;
  char *path;
  const char **files; /* NULL-terminated */
  JsonNode *about;    /* owner of the texts of the descriptor */
  union {
    eda_synthesizer synthesizer;
    eda_extractor extractor;
    eda_resist resist;
    eda_litho litho;
    eda_regulator regulator;
    opc_step step;
  } functions;
} py_plugin;

/* An instance; the fields of the parameters follow. */
typedef struct py_instance {
  const opc_host *host;
  const py_plugin *plugin;
  py_worker *worker;
  GMutex lock;       /* protects the worker in functions that are [any] */
  double call_limit; /* s */
  uint64_t
      serial; /* eda_gates.serial of the gates that the worker has; 0: none */
  GPtrArray
      *verdicts;  /* char *: verdicts on all gates; NULL: not requested yet */
  double *target; /* [gates], targets of Ion; NULL: not requested yet */
  size_t gates, slices;  /* numbers of gates, and of slices of a gate */
  double *place, *width; /* [slices], as returned by eda_extractor.slicing */
  double band;           /* 1/nm; 0: unknown */
  eda_box *boxes; /* shapes that a regulator adds to the mask, and cut-outs */
} py_instance;

/* Return the descriptor of the plugin in a file; NULL and *error. */
const opc_plugin *py_describe(const char *path, const char *id,
                              opc_error *error);
/* Return whether the Python class defines a method. */
int py_defines(const py_plugin *plugin, const char *method);

/* Return the folder of descriptions and bytecode in the store of results
   (g_free); NULL without a store. */
char *py_cache_folder(void);
/* Return the kept description of a plugin, NULL if none is valid. */
JsonNode *py_cache_get(const py_plugin *plugin);
/* Keep plugin->about. */
void py_cache_put(const py_plugin *plugin);

/* Set the functions of the kinds in a descriptor. */
void py_synthesizer_set(py_plugin *plugin);
void py_regulator_set(py_plugin *plugin);
void py_extractor_set(py_plugin *plugin);
void py_resist_set(py_plugin *plugin);
void py_litho_set(py_plugin *plugin);
void py_step_set(py_plugin *plugin);
#define PY_FUNCTIONS(plugin, kind)                                         \
  ((plugin)->descriptor.functions_size = sizeof((plugin)->functions.kind), \
   (plugin)->descriptor.functions = &(plugin)->functions.kind,             \
   &(plugin)->functions.kind)

/* Begin a request of an instance and return the worker, started at the first
   call; NULL and *error. `parameters`: with the values of all parameters. */
py_worker *py_open(py_instance *instance, const char *call, int parameters,
                   opc_error *error);

/* Send the request of py_open. */
int py_send(py_instance *instance, py_answer *answer, opc_error *error);

/* Call a method without arguments. */
int py_ask(py_instance *instance, const char *call, opc_error *error);

/* ---- data (data.c) ---- */

/* A member of a struct that points to an array of numbers: name, type in the
   notation of NumPy, offset of the pointer. `width`: number of elements for
   each gate; 0: one element, and the array has one dimension. */
typedef struct py_field {
  const char *name, *type;
  size_t offset, width;
} py_field;

/* All arrays of a struct. */
typedef struct py_table {
  const py_field *fields;
  size_t count;
} py_table;

extern const py_table py_gates, py_performance, py_feedback, py_moves,
    py_printed, py_ruling;

/* Add the arrays of a struct of `count` gates to the open object. A NULL
   pointer becomes None in Python. If `lend` is 1, Python can change the arrays.
 */
void py_put_table(py_worker *worker, const py_table *table, size_t count,
                  const void *from, int lend);
/* Add an object: figures (may be NULL), gates, shapes of all layers, a frame, a
   scanner. */
void py_put_performance(py_worker *worker, const char *name,
                        const eda_performance *performance);
void py_put_gates(py_worker *worker, const char *name, const eda_gates *gates);
void py_put_shapes(py_worker *worker, const char *name, size_t layers,
                   const eda_shapes *shapes);
void py_put_frame(py_worker *worker, eda_frame frame);
void py_put_scanner(py_worker *worker, eda_scanner scanner);
/* Add `n` texts (char *const *, NULL: none). */
void py_put_texts(py_worker *worker, const char *name, const void *texts,
                  size_t n);

/* Functions of all descriptors. */
int py_check(void *self, opc_error *error);
void py_clear(void *self);
