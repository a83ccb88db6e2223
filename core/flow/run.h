/* SPDX-License-Identifier: BSD-3-Clause */
/* Running a flow into a run folder; docs/flow.md tells what it holds. */
#ifndef OPCFLOW_CORE_RUN_H
#define OPCFLOW_CORE_RUN_H

#include <json-glib/json-glib.h>

#include "core/flow/flow.h"
#include "core/flow/table.h"

/* Who looks on. log, progress and cancelled may come from any thread. `path`
   is that of the instance ("mask.litho"). Functions may be NULL. */
typedef struct opc_watch {
  void *data;
  void (*log)(void *data, const char *path, int level, const char *message);
  void (*step)(void *data, const char *name, size_t number, size_t count);
  void (*progress)(void *data, const char *path, const opc_progress *progress);
  int (*cancelled)(void *data);
  /* Of a sweep: the point that begins, from 1. */
  void (*point)(void *data, size_t number, size_t count);
} opc_watch;

typedef struct opc_run_options {
  const char *output; /* NULL: runs/NAME, or the first free NAME-2 ... */
  gboolean force;     /* an earlier run may be replaced */
  gboolean keep;      /* of a sweep: what each point writes stays */
  const char *const *command; /* for the manifest; may be NULL */
} opc_run_options;

typedef struct opc_run_table {
  char *step, *file;
  opc_table *table;
} opc_run_table;

/* A run, and what came of it. */
typedef struct opc_run {
  opc_flow *flow;
  opc_registry *registry;
  const opc_watch *watch;
  const opc_run_options *options;
  char *folder;        /* where the result is; NULL: nothing was kept */
  char *work;          /* its name until it is done */
  GPtrArray *tables;   /* opc_run_table * */
  GArray *metrics;     /* opc_inner_metric */
  GHashTable *claims;  /* file in the run folder -> path of who has it */
  GPtrArray *paths;    /* that were given out */
  GPtrArray *inputs;   /* files read: path, SHA-256, path ... */
  GHashTable *summed;  /* their paths */
  GHashTable *seconds; /* step -> double * */
  void ***objects;     /* of each step, of each output */
  gboolean *left_out;  /* of each step: not of this run, though its objects may
                          be there */
  const opc_sweep *sweep; /* NULL: none */
  opc_table *points;      /* of a sweep: parameters and metrics of all points */
  size_t failed_points;
  int points_code;    /* OPC_LIMIT if they all failed so, OPC_FAILED */
  gboolean guarded;   /* the folder is kept if a plugin crashes */
  opc_error refusal;  /* of something that a step published */
  const char *failed; /* the step that failed */
  char *failure;      /* and why */
  GDateTime *started;
  double total; /* seconds */
} opc_run;

/* Run a flow that has no problem. Never NULL; it failed if a problem was
   added, and `folder` then holds what was finished, if anything. */
opc_run *opc_run_flow(opc_flow *flow, opc_registry *registry,
                      const opc_run_options *options, const opc_watch *watch,
                      opc_problems *problems);
void opc_run_free(opc_run *run);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_run, opc_run_free)

/* The same for a sweep: `flow` is its first point. Steps that no swept
   parameter touches, nor any step they depend on, run once, the others for
   each point. A point that fails is only told of in the table. */
opc_run *opc_run_sweep(opc_flow *flow, const opc_choice *choice,
                       opc_registry *registry, const opc_run_options *options,
                       const opc_watch *watch, opc_problems *problems);

/* ---- run.c, for points.c ---- */

opc_run *opc_run_new(opc_flow *flow, opc_registry *registry,
                     const opc_run_options *options, const opc_watch *watch);

/* Make the instances of the steps that are not left out. */
gboolean opc_run_create(opc_run *run, opc_problems *problems);
/* Add the sums of all files that `flow` reads, before any step may change one.
 */
gboolean opc_run_sum(opc_run *run, const opc_flow *flow,
                     opc_problems *problems);
/* Make the folder, at `target`. */
char *opc_run_target(const opc_run *run);
gboolean opc_run_open(opc_run *run, const char *target, opc_problems *problems);
void opc_run_reserve(opc_run *run);
gboolean opc_run_steps(opc_run *run, opc_problems *problems);
void opc_run_release(const opc_run *run);
gboolean opc_run_write(const opc_run *run, const char *name, char *text,
                       opc_problems *problems); /* takes the text */
void opc_run_close(opc_run *run, const char *target, opc_problems *problems);

/* The functions that instances of a run call back with their bindings, whose
   listeners are the opc_run. */
extern const opc_sink opc_run_sink;

/* ---- points.c, for inner.c ---- */

/* Of each step: whether it, or one that it needs, is swept. The references of
   a step that is not swept are the same at all points. */
void opc_run_find_swept(const opc_flow *flow, const opc_sweep *sweep,
                        gboolean *swept);

/* A run at the point of a sweep that `choice` says: of the steps that `trunk`
   left out, with what its own gave. It has a flow of its own. NULL and problems
   if that is not good. */
opc_run *opc_run_branch(const opc_run *trunk, const opc_choice *choice,
                        opc_problems *problems);
/* Run its steps in the folder `path`; the sums of what they read go to `main_run`.
 */
void opc_run_branch_steps(opc_run *run, opc_run *main_run, const char *path,
                          opc_problems *problems);
/* Write its resolved flow and metrics into its folder, or remove that. */
void opc_run_branch_close(const opc_run *run, gboolean keep,
                          opc_problems *problems);
/* With what it made and its flow. */
void opc_run_branch_free(opc_run *run);

/* Make the folder `path` for a run within that of another. */
gboolean opc_run_open_at(opc_run *run, const char *path,
                         opc_problems *problems);

/* ---- report.c: JSON ---- */

JsonNode *opc_run_metrics_json(const opc_run *run);
JsonNode *opc_metric_json(const opc_metric *metric, double value);
JsonNode *opc_run_manifest_json(const opc_run *run);
JsonNode *opc_table_json(const opc_table *table);

/* Readable, with a last newline (g_free). Takes the node. */
char *opc_json_text(JsonNode *node);

#endif
