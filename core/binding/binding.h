/* SPDX-License-Identifier: BSD-3-Clause */
/* A plugin with its parameters: from a map in a flow to checked values, and on
   to an instance, with the plugins in its slots. */
#pragma once

#include <opcflow/inner.h>

#include "core/plugin/host.h"
#include "core/plugin/registry.h"
#include "core/plugin/value.h"

typedef struct opc_inner opc_inner; /* inner.h */

/* What a binding calls of the flow that its step runs. */
typedef struct opc_nested {
  const opc_inner_service *service; /* of hosts outside of runs */
  int (*check)(const opc_inner *inner, opc_error *error);
  void (*free)(opc_inner *inner);
} opc_nested;

typedef struct opc_binding opc_binding;
struct opc_binding {
  const opc_plugin *plugin;
  char *path;               /* "first", "first.model": step and slots */
  opc_place at;             /* of its name in the flow */
  opc_setting *values;      /* of each parameter; value.h */
  const opc_node **origin;  /* of each: where it was given; NULL: default */
  opc_binding **slots;      /* of each: the plugin in the slot, or NULL */
  GPtrArray *owned;         /* what values point to */
  GPtrArray *presets;       /* opc_node *: defaults, maps without dots */
  GPtrArray *renamed;       /* char *: what was given by a former name */
  opc_host *host;           /* from create on; its `data` is the binding */
  void *run;                /* `data` of the host that it is like */
  opc_module module;        /* self is NULL before create */
  opc_inner *inner;         /* the flow that the step runs; NULL: none */
  const opc_nested *nested; /* its functions */
  struct opc_store *store;  /* of results outside of runs; NULL: none */
};

enum {
  OPC_BIND_NO_INPUTS = 1 << 0, /* a required OPC_INPUT may be missing */
  OPC_BIND_NO_FILES = 1 << 1,  /* a required OPC_FILE may be missing */
  OPC_BIND_INNER = 1 << 2      /* of a flow that a step runs; twice that of one
                                  in such a flow */
};

/* Find the step that the map names with `use` and check all parameters. `path`
   is its name, `at` its place. NULL if there is no plugin to go on with;
   otherwise a binding that is good if no problem was added. `map` outlives it.
 */
opc_binding *opc_bind(opc_registry *registry, const opc_node *map,
                      const char *path, const opc_place *at, unsigned flags,
                      opc_problems *problems);

/* The same for a map without `use`. */
opc_binding *opc_bind_plugin(opc_registry *registry, const opc_plugin *plugin,
                             const opc_node *map, const char *path,
                             const opc_place *at, unsigned flags,
                             opc_problems *problems);

/* Make the instances, those in slots first, and let each check itself. `watch`
   and `like` are for their hosts; host.h. FALSE and a problem if one refuses.
 */
gboolean opc_binding_create(opc_binding *binding, const opc_watch *watch,
                            const opc_host *like, opc_problems *problems);

/* opc_host.service of hosts whose `data` is a binding, where nothing else is
   said: the inner flow, and pieces one after another. */
const void *opc_binding_service(const opc_host *host, const char *name);

/* "step 'first' (sum)", "'first.model' (model.wide)"; of a verb
   "command 'hello' (command.hello)" */
char *opc_binding_label(const opc_binding *binding);

/* Around a call of one of its functions: whose it is, and what is said if it
   crashes. */
const char *opc_binding_enter(const opc_binding *binding);
void opc_binding_leave(const char *before);

/* Add the problem that such a function gave as *error, which becomes sound. The
   label is followed, for `run`, by the plugins in the slots that the error's
   parameter leads to: "step 'first' (sum), model (model.wide)" for
   "model" and "model.width". FALSE. */
gboolean opc_binding_fail(const opc_binding *binding, gboolean run, int code,
                          opc_error *error, opc_problems *problems);

/* Clear the instances, then free all. */
void opc_binding_free(opc_binding *binding);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_binding, opc_binding_free)

/* Where its parameter i was given; else the place of the binding. */
const opc_place *opc_binding_origin(const opc_binding *binding, size_t i);

/* The place in the flow that an error of this instance is about: that of the
   parameter, which may be one of a slot, by its name or as "slot.name"; else
   of the binding. */
const opc_place *opc_binding_place(const opc_binding *binding,
                                   const char *parameter);

/* Put what an OPC_INPUT, or an OPC_SLOT in a test, refers to into the instance.
 */
void opc_binding_set(opc_binding *binding, size_t parameter,
                     const void *object);

/* Add a binding and all in its slots to `list`, slots first. */
void opc_binding_list(const opc_binding *binding, GPtrArray *list);
