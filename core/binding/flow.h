/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow: steps with their plugins and parameters, and what each needs of the
   others. docs/reference/flow.md tells the file. */
#ifndef OPCFLOW_CORE_FLOW_H
#define OPCFLOW_CORE_FLOW_H

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

/* The flow with every parameter of every step and where its value came from,
   as a flow file that may lie in any folder; behind it the sweep (NULL: none)
   whose first point it is. */
char *opc_flow_resolved(const opc_flow *flow, const opc_sweep *sweep);

/* What "step.parameter" or a deeper path means; NULL if it is no parameter that
   is there. */
const opc_parameter *opc_flow_parameter(const opc_flow *flow, const char *path);

/* The step that a path ("step", "step.slot.parameter") begins with, or NULL. */
opc_flow_step *opc_flow_find(const opc_flow *flow, const char *path);

/* The bindings of all steps of a good flow (opc_binding *), as they run, each
   after those in its slots. */
GPtrArray *opc_flow_bindings(const opc_flow *flow);

/* The files that parameters name: name -> path of the instance that writes it
   (freed with the table). With `problems`, add those that two write, that lie
   in another, or that the run itself writes. */
GHashTable *opc_flow_outputs(const opc_flow *flow, opc_problems *problems);

/* The files that a run itself writes. */
enum { OPC_RESERVED = 4 };
extern const char *const opc_reserved[OPC_RESERVED];

/* The plugin that a path ("step", "step.slot") means, and a metric of one
   ("step.metric"), with whose it is in *binding; NULL and *error if there is
   none. */
const opc_binding *opc_flow_binding(const opc_flow *flow, const char *path,
                                    opc_error *error);
const opc_metric *opc_flow_metric(const opc_flow *flow, const char *path,
                                  const opc_binding **binding,
                                  opc_error *error);

/* Read what a flow with sound steps requires. */
void opc_flow_require(opc_flow *flow, opc_problems *problems);

/* Find out what the steps of `flow` need of each other, and the order in which
   they run. */
void opc_flow_connect(opc_flow *flow, opc_problems *problems);

/* Of each step: whether it is wanted, or one that is wanted needs it, and it is
   not given (g_free); all by their numbers. */
gboolean *opc_flow_needed(const opc_flow *flow, const gboolean *wanted,
                          const gboolean *given);

#endif
