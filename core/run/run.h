/* SPDX-License-Identifier: BSD-3-Clause */
/* Running a flow into a run folder; docs/reference/flow.md tells what it holds.
 */
#ifndef OPCFLOW_CORE_RUN_H
#define OPCFLOW_CORE_RUN_H

#include <json-glib/json-glib.h>
#include <opcflow/pieces.h>
#include <opcflow/step.h>
#include <ranks/ranks.h>

#include "core/binding/flow.h"
#include "core/report/folder.h"
#include "core/report/table.h"
#include "core/run/key.h"

typedef struct opc_run_options {
  const char *output; /* NULL: runs/NAME, or the first free NAME-2 ... */
  gboolean force;     /* an earlier run may be replaced */
  gboolean keep;      /* of a sweep: what each point writes stays */
  const char *const *command; /* for the manifest; may be NULL */
  opc_store *store; /* of earlier results; NULL: none, and nothing is kept */
  const ranks_group *ranks; /* that run it together; NULL: this process alone */
} opc_run_options;

/* What a step found that the user must not miss. */
typedef struct opc_finding {
  size_t point; /* of a sweep, from 1; 0: of all */
  char *path;   /* of the instance: "step.slot" */
  char *text;
} opc_finding;

/* Findings that a run keeps. More are counted only. */
enum { OPC_MOST_FINDINGS = 100 };

/* What came of a requirement. All its own. */
typedef struct opc_verdict {
  size_t point;       /* of a sweep, from 1; 0: of all */
  char *path;         /* "step.largest" */
  char *required;     /* "at most 1 %" */
  char *unit;         /* NULL: a plain number */
  double least, most; /* infinite: no bound */
  double value;       /* NAN: not measured */
  gboolean kept;
  opc_place at;
} opc_verdict;

/* A run takes no more from its points: each tells of its own in sweep.csv. */
enum { OPC_MOST_VERDICTS = 1000 };

/* What a step said that is said again when its result is used again. */
typedef struct opc_said {
  int level;
  char *path, *text;
} opc_said;

/* How the result of a step came to be. */
typedef struct opc_history {
  size_t point; /* of a sweep, from 1; 0: of all */
  char *path;   /* of the step; in a flow that step 'a' runs: "a.step" */
  gboolean reused;
  char *key;      /* NULL: it is not kept */
  char *reason;   /* why it ran; NULL: it was reused */
  double seconds; /* that it took, then or now */
} opc_history;

/* A manifest lists no more of them. The others are counted. */
enum { OPC_MOST_HISTORIES = 1000 };

/* A run, and what came of it. */
typedef struct opc_run opc_run;
struct opc_run {
  opc_flow *flow, *own; /* `own`: the same, if it is freed with the run */
  opc_registry *registry;
  opc_watch watch;       /* of its instances: keeps findings, tells `told` */
  const opc_watch *told; /* who looks on */
  GMutex lock;           /* of the findings */
  GPtrArray *findings;   /* opc_finding * */
  size_t more_findings;  /* that were not kept */
  size_t point;          /* of a sweep, that runs now; 0: none */
  GPtrArray *verdicts;   /* opc_verdict * */
  const opc_run_options *options;
  opc_host like;      /* what the hosts of its instances are like */
  char *folder;       /* where the result is; NULL: nothing was kept */
  opc_folder *slot;   /* where it is until it is done; NULL: in another run's */
  char *work;         /* its name until then */
  GPtrArray *tables;  /* opc_table * */
  GArray *metrics;    /* opc_inner_metric */
  GHashTable *claims; /* file in the run folder -> path of who has it */
  GHashTable *outputs; /* the same of files that parameters name */
  GPtrArray *given;    /* paths of files that the step at work writes */
  GPtrArray *inputs;   /* files read: path, SHA-256, path ... */
  GHashTable *summed;  /* path -> SHA-256 of these */
  GHashTable *known;   /* the same of another run, which need not be found
                          again; NULL: none */
  double *seconds;     /* of each step; NAN: it did not run */
  void ***objects;     /* of each step, of each output */
  gboolean *left_out;  /* of each step: not of this run, though its objects may
                          be there */
  opc_key *keys;       /* of each step; empty without a store. What stands here
                          before it runs stays: of what others gave */
  opc_run *base;       /* whose steps, found by their names, are left out here;
                          NULL: nobody's */
  opc_run *main;       /* that it is a part of; NULL: of none */
  const opc_flow_step *at; /* the step that runs */
  gboolean apart;          /* it runs in this rank alone */
  gboolean silent;         /* it runs again, for its outputs alone */
  GPtrArray *said;         /* opc_said * of the step that runs; NULL: more than
                              is kept */
  GPtrArray *piece;        /* opc_said * of the piece of work that is done now;
                              NULL: none is */
  GPtrArray *pieces;    /* names in the store of those of the step that runs */
  GPtrArray *histories; /* opc_history *, of its parts, too */
  size_t steps_done, steps_reused; /* the same, counted */
  const opc_sweep *sweep;          /* NULL: none */
  opc_table *points;    /* of a sweep: parameters and metrics of all points */
  size_t failed_points; /* also of those that a step runs as points */
  int points_code;      /* OPC_LIMIT if they all failed so, OPC_FAILED */
  gboolean guarded;     /* the folder is kept if a plugin crashes */
  opc_error refusal;    /* of something that a step published */
  char *failure;        /* why a step failed */
  GDateTime *started;
  double total; /* seconds */
};

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

/* Write flow.yaml, metrics.json and manifest.json; `last`: nothing will be
   written after them. */
gboolean opc_run_write_reports(const opc_run *run, gboolean last,
                               opc_problems *problems);

/* Write a file of the run folder; takes the text. */
gboolean opc_run_write(const opc_run *run, const char *name, char *text,
                       opc_problems *problems);

/* Say what the files of its flow are, whose sums another run has. */
void opc_run_take_inputs(opc_run *run, const opc_run *from,
                         opc_problems *problems);

/* The ranks that do now what this one does; NULL: it is alone. */
const ranks_group *opc_run_ranks(const opc_run *run);

/* Whether this is the rank that finds results, publishes and keeps them. */
gboolean opc_run_is_first(const opc_run *run);

/* Run a step and look at its outputs, which `run` then holds. */
int opc_run_call(opc_run *run, const opc_flow_step *step, opc_error *error);
/* The same after its forecast; FALSE and a problem if it fails. */
gboolean opc_run_step(opc_run *run, const opc_flow_step *step,
                      opc_problems *problems);
/* Hold outputs against what their kinds say. */
int opc_run_check(const opc_run *run, const opc_flow_step *step,
                  opc_error *error);
void opc_run_release(opc_run *run, const opc_flow_step *step);

/* Put the outputs it needs into the instances of a step, or take them away. */
void opc_run_set_inputs(const opc_run *run, const opc_flow_step *step,
                        gboolean present);

/* ---- result.c: what a step did, as the store has it ---- */

/* The step begins: what it says is listened to. */
void opc_result_begin(opc_run *run);

/* Of the step that ended, since `tables` and `metrics` of the run; NULL if it
   cannot be kept. Floating. */
GVariant *opc_result_new(const opc_run *run, const opc_flow_step *step,
                         guint tables);

/* Do all of it again: files, tables, metrics, warnings. */
int opc_result_publish(opc_run *run, const opc_flow_step *step,
                       GVariant *result, opc_error *error);
extern const char opc_result_type[];

/* What was said, as a(uss), and all of it said again; `said` may be NULL. FALSE
   if some of it was said by another step. */
gboolean opc_said_pack(GVariantBuilder *all, const GPtrArray *said,
                       const opc_flow_step *step);
void opc_said_again(opc_run *run, const opc_flow_step *step, GVariant *said);

/* The files of a folder, and back. NULL or OPC_IO if one cannot be read or
   written. */
GVariant *opc_files_pack(const char *folder, guint64 most);
int opc_files_unpack(GVariant *files, const char *folder, opc_error *error);

/* ---- reuse.c: steps whose results are there ---- */

/* Find the keys of the steps that are not left out. */
void opc_reuse_begin(opc_run *run);

/* Whether the step need not run: its result was there and is published. TRUE
   and a problem, too, if that failed. */
gboolean opc_reuse_take(opc_run *run, const opc_flow_step *step,
                        opc_problems *problems);

/* Keep what it gave. */
void opc_reuse_keep(opc_run *run, const opc_flow_step *step, guint tables);

/* Whether all files that a step's key is of are still what they were. */
gboolean opc_reuse_is_unchanged(const opc_run *run, const opc_key *key);

/* See to it that the outputs of a step are there; it may run for that. `whom`:
   who wants them. */
gboolean opc_run_provide(opc_run *run, const opc_flow_step *step,
                         const char *whom, opc_problems *problems);
GPtrArray *opc_histories_new(void);
/* Take those of another run. */
void opc_run_take_histories(opc_run *run, const opc_run *from);

/* ---- pieces.c ---- */

/* The service of a run's hosts. */
extern const opc_pieces_service opc_pieces_of_run;

/* Meet the other ranks at `what`, as ranks_group.meet does, with this rank's
   faults in a list: if there is none, the fault of the lowest rank that has one
   is added. FALSE if there is any. `ranks` may be NULL. */
gboolean opc_ranks_agree(const ranks_group *ranks, const char *what,
                         opc_problems *problems);

/* The step's result is kept: its pieces need not be. */
void opc_pieces_drop(opc_run *run);

/* ---- forecast.c ---- */

/* Ask a step whose inputs are there what it will want; refuses, too, if that is
   more memory than there is. All is 0 if it has nothing to say. */
int opc_run_ask(const opc_run *run, const opc_flow_step *step,
                opc_forecast *out, opc_error *error);

typedef struct opc_outlook {
  char *step; /* its name (g_free) */
  opc_forecast forecast;
} opc_outlook;

/* Make the flow, run its light steps, which write nothing, and add what the
   steps that then have their inputs will want (opc_outlook), where they say so.
   Faults are added as by opc_flow_check. */
void opc_run_forecast(const opc_recipe *recipe, const opc_choice *choice,
                      opc_registry *registry, const opc_watch *watch,
                      GArray *outlooks, opc_problems *problems);

/* "work, 1.2 GB" (g_free) */
char *opc_forecast_text(const opc_forecast *forecast);

/* ---- findings.c ---- */

/* Begin to keep what its instances find, and pass all on to `told` (NULL:
   nobody). */
void opc_run_listen(opc_run *run, const opc_watch *told);
/* Instances that outlive the run tell nobody any more. */
void opc_run_listen_end(opc_run *run);

/* Take those of another run. */
void opc_run_take_findings(opc_run *run, const opc_run *from);

/* A piece of work begins: what its step warns of and finds is put aside until
   it ends (opc_said *; to be freed). */
void opc_piece_begin(opc_run *run);
GPtrArray *opc_piece_end(opc_run *run);

/* All of them (char *, freed with the array): "step: text", "point 3: step:
   text", and at last how many more there were. */
GPtrArray *opc_run_findings(const opc_run *run);

/* ---- judge.c ---- */

GPtrArray *opc_verdicts_new(void);

/* Judge all that is required of the steps that are not left out. */
void opc_run_judge(opc_run *run);

/* Take what another run did not keep; `point`: where that was, `prefix`: what
   comes before its paths. */
void opc_run_take_verdicts(opc_run *run, const opc_run *from, size_t point,
                           const char *prefix);

/* Add what was not kept. */
void opc_run_add_broken(const opc_run *run, opc_problems *problems);

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
opc_run *opc_run_branch(opc_run *trunk, const opc_choice *choice,
                        opc_problems *problems);

/* Leave out the steps that `from` ran, and take what these and those it took
   from others made. They are found by their names: a layer may add some, or
   take some away. */
void opc_run_borrow(opc_run *run, opc_run *from);

/* Write its resolved flow and metrics into its folder, or remove that. */
void opc_run_branch_close(const opc_run *run, gboolean keep,
                          opc_problems *problems);

/* ---- report.c: JSON ---- */

JsonNode *opc_run_metrics_json(const opc_run *run);
/* Add "findings" and "require". */
void opc_run_add_findings(JsonObject *object, const opc_run *run);
/* Both, as metrics.json has them. */
char *opc_run_metrics_text(const opc_run *run);
JsonNode *opc_metric_json(const opc_metric *metric, double value);
JsonNode *opc_run_manifest_json(const opc_run *run);
JsonNode *opc_table_json(const opc_table *table);

/* Readable, with a last newline (g_free). Takes the node. */
char *opc_json_text(JsonNode *node);

#endif
