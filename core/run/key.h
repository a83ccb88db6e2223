/* SPDX-License-Identifier: BSD-3-Clause */
/* What a step's result depends on, and the key that is made of it. */
#pragma once

#include <store/facts.h>
#include "core/binding/flow.h"

/* What a fact is about. */
enum {
  OPC_FACT_COMMAND = 'c',   /* the command's build */
  OPC_FACT_PLUGIN = 'p',    /* a plugin and its build */
  OPC_FACT_PARAMETER = 'v', /* a value, as a flow would have it */
  OPC_FACT_FILE = 'f',      /* a file's name and sum */
  OPC_FACT_INPUT = 's',     /* a step, with an output's name, and its key */
  OPC_FACT_INNER = 'i'      /* the flow that the step runs */
};

typedef struct opc_key {
  char *sum;        /* the key; NULL: the result is not kept */
  char *why;        /* it is not */
  GVariant *facts;  /* NULL: it is not kept */
  GPtrArray *files; /* path, sum, path ...: of what it reads */
} opc_key;

void opc_key_clear(opc_key *key);

/* Return whether all files of the key still have their sums: a file may change
   while the step runs. */
gboolean opc_key_is_unchanged(const opc_key *key, opc_store *store);

/* The keys of a flow's steps, by their numbers. Those that have a sum, or a
   reason to have none, are left as they are. */
void opc_flow_keys(const opc_flow *flow, opc_store *store, opc_key *keys);

/* The same of an instance alone, with what stands in its slots, but without its
   inputs and the command (g_free); NULL and *error if it cannot be told. */
char *opc_binding_key(const opc_binding *binding, opc_store *store,
                      opc_error *error);

/* Describe the change of a fact of the step of that name, as opc_fact_text:
   "mask.limit changed from 1 % to 2 %" (g_free). */
char *opc_key_difference(const void *step, char about, const char *path,
                         const char *before, const char *now);
