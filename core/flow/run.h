/* SPDX-License-Identifier: BSD-3-Clause */
/* Running a flow into a run folder; docs/flow.md tells what it holds. */
#ifndef OPCFLOW_CORE_RUN_H
#define OPCFLOW_CORE_RUN_H

#include <json-glib/json-glib.h>

#include "core/flow/flow.h"
#include "core/flow/table.h"

typedef struct opc_run_options {
  const char *output; /* NULL: runs/NAME, or the first free NAME-2 ... */
  gboolean force;     /* an earlier run may be replaced */
  gboolean keep;      /* of a sweep: what each point writes stays */
  const char *const *command; /* for the manifest; may be NULL */
} opc_run_options;

/* A run, and what came of it. */
typedef struct opc_run {
  opc_flow *flow, *own; /* `own`: the same, if it is freed with the run */
  opc_registry *registry;
  const opc_watch *watch;
  const opc_run_options *options;
  opc_host like;      /* what the hosts of its instances are like */
  char *folder;       /* where the result is; NULL: nothing was kept */
  char *work;         /* its name until it is done */
  GPtrArray *tables;  /* opc_table * */
  GArray *metrics;    /* opc_inner_metric */
  GHashTable *claims; /* file in the run folder -> path of who has it */
  GPtrArray *inputs;  /* files read: path, SHA-256, path ... */
  GHashTable *summed; /* their paths */
  double *seconds;    /* of each step; NAN: it did not run */
  void ***objects;    /* of each step, of each output */
  gboolean *left_out; /* of each step: not of this run, though its objects may
                         be there */
  const opc_sweep *sweep; /* NULL: none */
  opc_table *points;      /* of a sweep: parameters and metrics of all points */
  size_t failed_points;
  int points_code;   /* OPC_LIMIT if they all failed so, OPC_FAILED */
  gboolean guarded;  /* the folder is kept if a plugin crashes */
  opc_error refusal; /* of something that a step published */
  char *failure;     /* why a step failed */
  GDateTime *started;
  double total; /* seconds */
} opc_run;

/* Run a flow that has no problem: `flow` is the first point of what `choice`
   sweeps. Steps that no swept parameter touches, nor any step they depend on,
   run once, the others for each point; a point that fails is only told of in
   the table. Never NULL; it failed if a problem was added, and `folder` then
   holds what was finished, if anything. */
opc_run *opc_run_flow(opc_flow *flow, const opc_choice *choice,
                      opc_registry *registry, const opc_run_options *options,
                      const opc_watch *watch, opc_problems *problems);

/* With what it made. */
void opc_run_free(opc_run *run);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_run, opc_run_free)

/* ---- run.c, for points.c and inner.c ---- */

opc_run *opc_run_new(opc_flow *flow, opc_registry *registry,
                     const opc_run_options *options, const opc_watch *watch);

/* Make the instances of the steps that are not left out, and run them in the
   folder `path`; the sums of what they read go to `main_run`. */
void opc_run_in(opc_run *run, opc_run *main_run, const char *path,
                opc_problems *problems);

/* Write a file of the run folder; takes the text. */
gboolean opc_run_write(const opc_run *run, const char *name, char *text,
                       opc_problems *problems);

/* ---- publish.c ---- */

/* The functions that instances of a run call back; `data` is for the run. */
extern const opc_host opc_run_publisher;

/* ---- points.c ---- */

/* Run what is swept at all points. */
void opc_run_points(opc_run *trunk, const opc_choice *choice,
                    opc_problems *problems);

/* Of each step: whether it, or one that it needs, is swept. The references of
   a step that is not swept are the same at all points. */
void opc_run_find_swept(const opc_flow *flow, const opc_sweep *sweep,
                        gboolean *swept);

/* A run at the point of a sweep that `choice` says: of the steps that `trunk`
   left out, with what its own gave. NULL and problems if its flow is not good.
 */
opc_run *opc_run_branch(const opc_run *trunk, const opc_choice *choice,
                        opc_problems *problems);

/* Write its resolved flow and metrics into its folder, or remove that. */
void opc_run_branch_close(const opc_run *run, gboolean keep,
                          opc_problems *problems);

/* ---- report.c: JSON ---- */

JsonNode *opc_run_metrics_json(const opc_run *run);
JsonNode *opc_metric_json(const opc_metric *metric, double value);
JsonNode *opc_run_manifest_json(const opc_run *run);
JsonNode *opc_table_json(const opc_table *table);

/* Readable, with a last newline (g_free). Takes the node. */
char *opc_json_text(JsonNode *node);

#endif
