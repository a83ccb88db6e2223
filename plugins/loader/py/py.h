/* SPDX-License-Identifier: BSD-3-Clause */
/* Plugins in Python: descriptors, instances, and the functions of each kind.
   Each function of a kind sends a request to the worker of its instance. */
#pragma once

#include <eda/extractor.h>
#include <eda/resist.h>
#include <eda/synthesizer.h>
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
    opc_step step;
  } functions;
} py_plugin;

/* An instance; the fields of the parameters follow. */
typedef struct py_instance {
  const opc_host *host;
  const py_plugin *plugin;
  py_worker *worker;
  GMutex lock;         /* of the worker, for functions that are [any] */
  double call_limit;   /* s */
  GPtrArray *verdicts; /* char *: of all gates; NULL: not requested yet */
  double *target;      /* of `gates` gates; NULL: not requested yet */
  size_t gates, slices;
  double *place, *width; /* [slices] */
} py_instance;

/* Return the descriptor of the plugin in a file; NULL and *error. */
const opc_plugin *py_describe(const char *path, const char *id,
                              opc_error *error);

/* Set the functions of a kind in a descriptor. Returns 0 for a kind that Python
   cannot implement. */
int py_functions_set(py_plugin *plugin, const char *kind);
/* Return whether the Python class defines a method. */
int py_defines(const py_plugin *plugin, const char *method);

void py_synthesizer_set(py_plugin *plugin);
void py_extractor_set(py_plugin *plugin);
void py_resist_set(py_plugin *plugin);
void py_step_set(py_plugin *plugin);

/* Begin a request of an instance and return the worker, started at the first
   call; NULL and *error. */
py_worker *py_open(py_instance *instance, const char *call, opc_error *error);

/* Send the request of py_open. */
int py_send(py_instance *instance, py_answer *answer, opc_error *error);

/* Add the values of all parameters except inputs to the request. */
void py_add_parameters(py_instance *instance);

/* Add transistors and layers, or the performance of transistors, under names
   that begin with PREFIX and a dot. */
void py_add_gates(py_worker *worker, const char *prefix,
                  const eda_gates *gates);
void py_add_performance(py_worker *worker, const char *prefix,
                        const eda_performance *performance);
void py_add_shapes(py_worker *worker, const char *prefix, size_t layer,
                   const eda_shapes *shapes);
void py_add_scanner(py_worker *worker, eda_scanner scanner);

/* Add an array named PREFIX.NAME. */
void py_add_named(py_worker *worker, const char *prefix, const char *name,
                  const char *type, size_t count, const void *data);

/* Functions of all descriptors. */
int py_check(void *self, opc_error *error);
void py_clear(void *self);
