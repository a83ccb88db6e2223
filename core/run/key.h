/* SPDX-License-Identifier: BSD-3-Clause */
/* Keys of step results: checksums over all facts that a result depends on. */
#pragma once

#include <store/facts.h>
#include "core/binding/flow.h"

/* Subject of a fact. */
enum {
  OPC_FACT_COMMAND = 'c',   /* build of the command */
  OPC_FACT_PLUGIN = 'p',    /* plugin and its build */
  OPC_FACT_PARAMETER = 'v', /* value, written as in a flow */
  OPC_FACT_FILE = 'f',      /* name and checksum of a file */
  OPC_FACT_INPUT = 's',     /* step, name of an output, and key of the step */
  OPC_FACT_INNER = 'i'      /* flow that the step runs */
};

/* Key of a step. */
typedef struct opc_key {
  char *sum;        /* the key; NULL if the result is not stored */
  char *why;        /* reason why the result is not stored */
  GVariant *facts;  /* NULL if the result is not stored */
  GPtrArray *files; /* path, checksum, path ...: of the files read */
} opc_key;

/* Free the key and clear the struct. */
void opc_key_clear(opc_key *key);

/* Return whether all files of the key still have the same checksums. A file may
   change while the step runs. */
gboolean opc_key_is_unchanged(const opc_key *key, opc_store *store);

/* Compute the keys of all steps of a flow, by step number, except keys that
   already have a `sum` or a `why`. */
void opc_flow_keys(const opc_flow *flow, opc_store *store, opc_key *keys);

/* Return the key of an instance and of the plugins in its slots (g_free).
   Inputs and the build of the command are not part of the key. NULL and *error
   if the key cannot be computed. */
char *opc_binding_key(const opc_binding *binding, opc_store *store,
                      opc_error *error);

/* Return a text about the change of one fact: "step.size changed from 1 nm to 2
   nm" (g_free). `step` is the name of the step. The function is of the type
   opc_fact_text (store/facts.h). */
char *opc_key_difference(const void *step, char about, const char *path,
                         const char *before, const char *now);
