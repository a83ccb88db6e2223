/* SPDX-License-Identifier: BSD-3-Clause */
/* Bindings. A binding connects a plugin with the map of a flow that sets its
   parameters. The binding holds the checked values of the parameters, the
   instance of the plugin, and the bindings of the plugins in its slots. */
#pragma once

#include <opcflow/inner.h>

#include "core/plugin/host.h"
#include "core/plugin/registry.h"
#include "core/plugin/value.h"

typedef struct opc_inner opc_inner; /* inner.h */

/* Functions that a binding calls on the inner flow of its step. */
typedef struct opc_nested {
  const opc_inner_service *service; /* for hosts outside runs */
  int (*check)(const opc_inner *inner, opc_error *error);
  void (*free)(opc_inner *inner);
} opc_nested;

/* A binding. */
typedef struct opc_binding opc_binding;
struct opc_binding {
  const opc_plugin *plugin;
  char *path;               /* step and slots: "first", "first.model" */
  opc_place at;             /* place of the step's or slot's name in the flow */
  opc_setting *values;      /* one per parameter; value.h */
  const opc_node **origin;  /* one per parameter: node that sets it; NULL if the
                               default applies */
  opc_binding **slots;      /* one per parameter: plugin in the slot, or NULL */
  GPtrArray *owned;         /* memory that `values` point to */
  GPtrArray *presets;       /* opc_node *: parsed defaults, and maps with dotted
                               keys made nested */
  GPtrArray *renamed;       /* char *: warnings about former parameter names */
  opc_host *host;           /* set by opc_binding_create; host->data: the
                               binding */
  void *run;                /* `like->data` as passed to opc_binding_create */
  opc_module module;        /* self is NULL before create */
  opc_inner *inner;         /* inner flow of the step, or NULL */
  const opc_nested *nested; /* functions of `inner` */
  struct opc_store *store; /* store of results of an instance outside runs; NULL
                              if results are not stored */
};

/* Flags of opc_bind. */
enum {
  OPC_BIND_NO_INPUTS = 1 << 0, /* a required OPC_INPUT may be missing */
  OPC_BIND_NO_FILES = 1 << 1,  /* a required OPC_FILE may be missing */
  OPC_BIND_INNER = 1 << 2      /* the step belongs to an inner flow; 2 *
                                  OPC_BIND_INNER: to an inner flow of an inner
                                  flow */
};

/* Find the step plugin named by `use` in `map`, and check all parameters.
   `path` is the name of the step, `at` its place. Returns a binding
   (opc_binding_free), valid if no problem was added; NULL if the plugin is not
   found. `map` outlives the binding. */
opc_binding *opc_bind(opc_registry *registry, const opc_node *map,
                      const char *path, const opc_place *at, unsigned flags,
                      opc_problems *problems);

/* Bind a given plugin, for a map without `use`; otherwise as opc_bind. */
opc_binding *opc_bind_plugin(opc_registry *registry, const opc_plugin *plugin,
                             const opc_node *map, const char *path,
                             const opc_place *at, unsigned flags,
                             opc_problems *problems);

/* Create the instances, those in slots first, and call their checks. `watch`
   and `like` are passed to opc_host_new. Returns FALSE and adds a problem if a
   check fails. */
gboolean opc_binding_create(opc_binding *binding, const opc_watch *watch,
                            const opc_host *like, opc_problems *problems);

/* Return a service of a host whose `data` is a binding: the queries of the
   inner flow, or work units (pieces.h) computed in this process. Implements
   opc_host.service outside runs. */
const void *opc_binding_service(const opc_host *host, const char *name);

/* Return the label of a binding for messages (g_free): "step 'first' (sum)",
   "'first.model' (model.wide)", or "command 'hello' (command.hello)". */
char *opc_binding_label(const opc_binding *binding);

/* Mark the begin and the end of a call of a plugin's function, so that a crash
   report names the binding. opc_binding_enter returns the argument of
   opc_binding_leave. */
const char *opc_binding_enter(const opc_binding *binding);
void opc_binding_leave(const char *before);

/* Add the error that a function of the plugin reported in *error as a problem.
   Texts in *error may lack the terminating NUL, which is added. If `run` is
   TRUE, the label includes the plugins in the slots on the path of the error's
   parameter: "step 'first' (sum), model (model.wide)" for "model" or
   "model.width". Returns FALSE. */
gboolean opc_binding_fail(const opc_binding *binding, gboolean run, int code,
                          opc_error *error, opc_problems *problems);

/* Clear the instances, then free the binding. */
void opc_binding_free(opc_binding *binding);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_binding, opc_binding_free)

/* Return the place where parameter i is set; if parameter i is not set, the
   place of the binding. */
const opc_place *opc_binding_origin(const opc_binding *binding, size_t i);

/* Return the place in the flow for an error of this instance: the place of
   `parameter` or, if unknown, of the binding. `parameter` may be the name of a
   parameter of a slot ("NAME" or "slot.NAME"). */
const opc_place *opc_binding_place(const opc_binding *binding,
                                   const char *parameter);

/* Set the field of an OPC_INPUT (in tests, of an OPC_SLOT) to an object. */
void opc_binding_set(opc_binding *binding, size_t parameter,
                     const void *object);

/* Append a binding and all bindings in its slots to `list`, slots first. */
void opc_binding_list(const opc_binding *binding, GPtrArray *list);
