/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow: steps with their plugins and parameters, and what each needs of the
   others. docs/reference/flow.md tells the file. */
#pragma once

#include "core/binding/binding.h"
#include "core/binding/sweep.h"

typedef struct opc_flow_step opc_flow_step;

/* A reference that was found good. */
typedef struct opc_flow_input {
  opc_binding *binding; /* of the step or of a slot in it */
  size_t parameter;
  const opc_flow_step *from;
  size_t port;
} opc_flow_input;

struct opc_flow_step {
  const char *name;
  const opc_node *key;
  opc_binding *binding; /* NULL if there is no plugin to go on with */
  GArray *inputs;       /* opc_flow_input */
  guint number;         /* in the file */
};

/* What a metric must be. */
typedef struct opc_requirement {
  char *path;            /* "step.slot.count" */
  opc_place at;          /* of its key */
  const opc_node *value; /* as written */
  const opc_binding *binding;
  const opc_metric *metric;
  double least, most; /* in its unit; infinite: no bound */
  gboolean open;      /* the bounds themselves are not good */
  char *text;         /* "at most 1 %" */
} opc_requirement;

typedef struct opc_flow opc_flow;
struct opc_flow {
  char *name;
  const char *variant; /* NULL: none */
  const opc_recipe *recipe;
  opc_recipe *owned;       /* the same, if it is the flow's own */
  opc_node *nodes;         /* the map of steps */
  GPtrArray *sources;      /* opc_source *: of each --set */
  GPtrArray *steps;        /* opc_flow_step *, as in the file */
  GPtrArray *order;        /* the same, as they run */
  opc_node *demands;       /* "require", if anything is */
  GPtrArray *requirements; /* opc_requirement * */
};

/* What is laid over the steps of a recipe, in this order. */
typedef struct opc_choice {
  const char *variant;     /* its name; NULL: none */
  const opc_sweep *sweep;  /* NULL: none */
  size_t point;            /* of it */
  const char *const *sets; /* "step.parameter=value", NULL-terminated, may be
                              NULL */
  const opc_node *over;    /* a map of paths and values; NULL: none */
  unsigned bind;           /* OPC_BIND_* of its steps */
} opc_choice;

/* Make the flow and check everything that can be checked without making an
   instance. `choice` may be NULL. Never NULL; it is good if no problem was
   added. Recipe and sweep outlive it. */
opc_flow *opc_flow_make(const opc_recipe *recipe, const opc_choice *choice,
                        opc_registry *registry, opc_problems *problems);

/* Read a flow and make it, without a variant and a sweep. NULL if it cannot be
   read at all. */
opc_flow *opc_flow_load(const char *path, const char *const *sets,
                        opc_registry *registry, opc_problems *problems);
void opc_flow_free(opc_flow *flow);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_flow, opc_flow_free)

/* Add what is wrong with a flow at each value of what `choice` sweeps and was
   not yet told; `watch`: also with its instances; may be NULL. */
void opc_flow_check(const opc_recipe *recipe, const opc_choice *choice,
                    opc_registry *registry, const opc_watch *watch,
                    opc_problems *problems);

/* Make the instances of the steps that are not left out (by their numbers;
   NULL: none is), as opc_binding_create does. FALSE and all problems if one
   refuses. */
gboolean opc_flow_create(const opc_flow *flow, const gboolean *left_out,
                         const opc_watch *watch, const opc_host *like,
                         opc_problems *problems);
