/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow: steps with their plugins, parameters and dependencies. The file
   format is in docs/reference/flow.md. */
#pragma once

#include "core/binding/binding.h"
#include "core/binding/sweep.h"

/* A step of a flow. */
typedef struct opc_flow_step opc_flow_step;

/* A resolved reference: the parameter receives output `port` of the step
   `from`. */
typedef struct opc_flow_input {
  opc_binding *
      binding; /* step, or plugin in a slot of the step, that takes the input */
  size_t parameter;
  const opc_flow_step *from;
  size_t port;
} opc_flow_input;

/* Members of a step. */
struct opc_flow_step {
  const char *name;
  const opc_node *key;
  opc_binding *binding; /* NULL if the plugin was not found */
  GArray *inputs;       /* opc_flow_input */
  guint number;         /* index in the file */
};

/* Required range of a metric. */
typedef struct opc_requirement {
  char *path;            /* "step.slot.count" */
  opc_place at;          /* place of the key */
  const opc_node *value; /* bound as written in the flow */
  const opc_binding *binding;
  const opc_metric *metric;
  double least, most; /* bounds in the unit of the metric; +-infinity: no
                         bound */
  gboolean open;      /* the bounds are excluded */
  char *text;         /* "at most 1 %" */
} opc_requirement;

/* A flow. */
typedef struct opc_flow opc_flow;
struct opc_flow {
  char *name;
  const char *variant; /* may be NULL */
  const opc_recipe *recipe;
  opc_recipe *owned;       /* the recipe, if the flow owns it */
  opc_node *nodes;         /* the map of steps */
  GPtrArray *sources;      /* opc_source *: one per --set */
  GPtrArray *steps;        /* opc_flow_step *, in file order */
  GPtrArray *order;        /* opc_flow_step *, in order of execution */
  opc_node *demands;       /* section "require" of the flow, or NULL */
  GPtrArray *requirements; /* opc_requirement * */
};

/* Changes applied to the steps of a recipe, in this order. */
typedef struct opc_choice {
  const char *variant;     /* name; may be NULL */
  const opc_sweep *sweep;  /* may be NULL */
  size_t point;            /* index in the sweep */
  const char *const *sets; /* "step.parameter=value", NULL-terminated, may be
                              NULL */
  const opc_node *over;    /* a map of paths and values, or NULL */
  unsigned bind;           /* OPC_BIND_* of the steps */
} opc_choice;

/* Build the flow and do all checks that need no instance. `choice` may be NULL.
   Returns a flow (opc_flow_free), valid if no problem was added; never NULL.
   Recipe and sweep outlive the flow. */
opc_flow *opc_flow_make(const opc_recipe *recipe, const opc_choice *choice,
                        opc_registry *registry, opc_problems *problems);

/* Read a flow file and build the flow, without variant and sweep. Returns NULL
   if the file cannot be read. Free the flow with opc_flow_free. */
opc_flow *opc_flow_load(const char *path, const char *const *sets,
                        opc_registry *registry, opc_problems *problems);
void opc_flow_free(opc_flow *flow);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_flow, opc_flow_free)

/* Check a flow at each value of each axis of `choice`, and add each problem
   once. Unless `watch` is NULL, also create the instances. */
void opc_flow_check(const opc_recipe *recipe, const opc_choice *choice,
                    opc_registry *registry, const opc_watch *watch,
                    opc_problems *problems);

/* Call opc_binding_create for all steps except those with left_out[number] set;
   `left_out` may be NULL. Returns FALSE and adds all problems on failure. */
gboolean opc_flow_create(const opc_flow *flow, const gboolean *left_out,
                         const opc_watch *watch, const opc_host *like,
                         opc_problems *problems);
