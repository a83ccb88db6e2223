/* SPDX-License-Identifier: BSD-3-Clause */
/* Inner flows: flows that a step runs (opcflow/inner.h), read and checked with
   the flow of the step. */
#pragma once

#include <opcflow/inner.h>

#include "core/binding/flow.h"

typedef struct opc_inner_runs opc_inner_runs; /* run/inner_run.h */

/* An inner flow. */
struct opc_inner {
  const opc_binding *binding; /* binding of the step */
  opc_recipe *recipe;
  opc_sweep *sweep;
  opc_choice choice; /* choice of the first point */
  opc_flow *flow;    /* flow at the first point */
  opc_registry *registry;
  opc_inner_axis **axes;
  GHashTable *wanted;   /* names of the requested steps; empty: all */
  GHashTable *given;    /* step that an input of `binding` replaces -> its
                           output, void *[1] */
  opc_inner_runs *runs; /* NULL if no run was started */
  void (*runs_end)(opc_inner_runs *runs);  /* called when the step has run */
  void (*runs_free)(opc_inner_runs *runs); /* called before the inner flow is
                                              freed */
};

/* Build the inner flows that the plugins of a valid binding and its slots
   declare, and check the inner flows at each swept value. File names in the
   bindings become absolute, so that resolved flows can be moved. `flags` as in
   opc_bind. */
void opc_inner_open(opc_binding *binding, opc_registry *registry,
                    unsigned flags, opc_problems *problems);

/* Return, by step number of `flow`, whether the step must run so that all
   requested steps can run (g_free). */
gboolean *opc_inner_needed(const opc_inner *inner, const opc_flow *flow);

/* End the runs of an inner flow after the step has run. `inner` may be NULL. */
void opc_inner_end(opc_inner *inner);

/* Return the flow at the first point of the sweep. */
const opc_flow *opc_inner_flow(const opc_inner *inner);

/* Call `visit` with the flow at the first point and each value of each axis. */
void opc_inner_visit(const opc_inner *inner,
                     void (*visit)(void *data, const opc_flow *flow),
                     void *data);

/* Return the inner flow of a host's instance. */
opc_inner *opc_inner_of(const opc_host *host);

/* Implement the functions of opc_inner_service that need no run. */
const opc_inner_axis *const *opc_inner_axes(const opc_host *host,
                                            size_t *count);
int opc_inner_find_axis(const opc_host *host, const char *path,
                        opc_error *error);
const opc_metric *opc_inner_find_metric(const opc_host *host, const char *path,
                                        opc_error *error);
const char *opc_inner_find_output(const opc_host *host, const char *name,
                                  const char *kind, opc_error *error);

/* Return the index of the first output of a data kind, -1 if missing. */
int opc_inner_port(const opc_plugin *plugin, const char *kind);
