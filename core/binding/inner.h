/* SPDX-License-Identifier: BSD-3-Clause */
/* The flow that a step runs inside of it (opcflow/inner.h): read and checked
   with the flow that the step stands in. */
#ifndef OPCFLOW_CORE_INNER_H
#define OPCFLOW_CORE_INNER_H

#include "core/binding/flow.h"
#include "core/run/run.h"

struct opc_inner {
  const opc_binding *binding; /* whose flow it is */
  opc_recipe *recipe;
  opc_sweep *sweep;
  opc_choice choice; /* of the first point */
  opc_flow *flow;    /* there */
  opc_registry *registry;
  opc_inner_axis **axes;
  const opc_inner_metric **metrics; /* asked for last */
  opc_inner_run whole;              /* the last one that was kept whole */
  GHashTable *wanted; /* names of steps that were asked for; empty: all */
  GHashTable *given;  /* name of a step -> what it gives, void *[1] */

  opc_watch watch; /* while the step runs, from here on */
  char *folder;
  /* What points share: levels[0] has the steps that no axis touches, levels[i]
     those that axis i - 1 is the last one to touch; NULL: there are none. */
  unsigned depth;
  opc_run **levels;
  opc_problems **failures; /* of each that was run; NULL: it was not */
  guint *at;               /* the value of its axis */
  opc_run *run;            /* the last one: of level `depth` */
  size_t runs, done, share;
  gboolean telling; /* messages are passed on */
};

/* Make the binding's inner flow if its plugin declares one, and check it at
   each value that is swept. File names that the binding gives become absolute,
   so that its resolved flow may lie anywhere. `flags` are those of the
   binding. */
void opc_inner_open(opc_binding *binding, opc_registry *registry,
                    unsigned flags, opc_problems *problems);
void opc_inner_free(opc_inner *inner);

/* The step has run: remove what only runs of its flow needed of each other. */
void opc_inner_end(opc_inner *inner);

/* ---- inner.c, for inner_run.c, and the other way round ---- */

opc_inner *opc_inner_of(const opc_host *host);

/* Of the steps of its flow at some point, by number (g_free): which have to run
   for what was asked for. */
gboolean *opc_inner_needed(const opc_inner *inner, const opc_flow *flow);

/* As opc_inner_service has them. */
int opc_inner_begin(const opc_host *host, opc_error *error);
int opc_inner_run_point(const opc_host *host, size_t point, int keep,
                        size_t share, opc_error *error);
int opc_inner_run_whole(const opc_host *host, size_t point, const char *name,
                        size_t share, const opc_inner_run **out,
                        opc_error *error);

/* Free what its runs made. */
void opc_inner_release(opc_inner *inner);

/* What only its instances refuse. NULL has none. */
int opc_inner_check(const opc_inner *inner, opc_error *error);

/* At the first point of its sweep. */
const opc_flow *opc_inner_flow(const opc_inner *inner);

/* Call `visit` with it there and at each value of each axis. */
void opc_inner_visit(const opc_inner *inner,
                     void (*visit)(void *data, const opc_flow *flow),
                     void *data);

/* For the host of an instance with an inner flow; its `data` is the binding. */
extern const opc_inner_service opc_inner_functions;

#endif
