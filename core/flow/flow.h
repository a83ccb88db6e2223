/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow: steps with their plugins and parameters, and what each needs of the
   others. docs/flow.md tells the file. */
#ifndef OPCFLOW_CORE_FLOW_H
#define OPCFLOW_CORE_FLOW_H

#include "core/flow/binding.h"

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
  const opc_node *key, *node;
  opc_binding *binding; /* NULL if there is no plugin to go on with */
  GArray *inputs;       /* opc_flow_input */
  guint number;         /* in the file */
};

typedef struct opc_flow {
  char *path;               /* as given */
  char *name, *description; /* description may be NULL */
  opc_node *root;
  GPtrArray *sources; /* opc_source *: the file, the overrides */
  GPtrArray *steps;   /* opc_flow_step *, as in the file */
  GPtrArray *order;   /* the same, as they run */
} opc_flow;

/* Read a flow, put `sets` ("step.parameter=value", NULL-terminated, may be
   NULL) over it, and check everything that can be checked without making an
   instance. NULL if it cannot be read at all; otherwise it is good if no
   problem was added. */
opc_flow *opc_flow_load(const char *path, const char *const *sets,
                        opc_registry *registry, opc_problems *problems);
void opc_flow_free(opc_flow *flow);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_flow, opc_flow_free)

/* Make the instances of all steps, for functions whose `data` is the
   opc_binding. FALSE and all problems if one refuses. */
gboolean opc_flow_create(opc_flow *flow, const opc_sink *sink, void *listener,
                         opc_problems *problems);

/* The flow with every parameter of every step and where its value came from,
   as a flow file that may lie in any folder. */
char *opc_flow_resolved(const opc_flow *flow);

/* Put "step.parameter=value" into the tree of a flow. The new source is added
   to `sources`. */
void opc_override(opc_node *root, const char *set, GPtrArray *sources,
                  opc_problems *problems);

/* Find out what the steps of `flow` need of each other, and the order in which
   they run. */
void opc_flow_connect(opc_flow *flow, opc_problems *problems);

#endif
