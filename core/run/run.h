/* SPDX-License-Identifier: BSD-3-Clause */
/* The state of a run: a flow under execution with its published files, messages
   and stored results. The comment above each part names the file that maintains
   the part. */
#pragma once

#include <opcflow/step.h>
#include <ranks/ranks.h>

#include "core/report/outcome.h"
#include "core/run/key.h"

/* Options of a run. */
typedef struct opc_run_options {
  const char *output; /* if NULL, runs/NAME or the first free NAME-2 ... */
  gboolean force;     /* replace an earlier run */
  gboolean keep;      /* keep the files of each point of a sweep */
  const char *const *command; /* for the manifest; may be NULL */
  opc_store *store;           /* earlier results; NULL for no reuse */
  const ranks_group *ranks;   /* ranks that share the run, or NULL */
} opc_run_options;

/* Message of a step, logged again when the result of the step is reused. */
typedef struct opc_message {
  int level;
  char *path, *text;
} opc_message;

/* listen.c: messages of instances. */
typedef struct opc_listener {
  opc_watch watch;     /* watch of the instances: keeps findings, calls
                          `to` */
  const opc_watch *to; /* receiver of the messages */
  GMutex lock;         /* guards findings, `messages` and `piece` */
  size_t point;        /* running point of a sweep, or 0 */
  gboolean silent;     /* a step runs again only to make its outputs */
  GPtrArray *messages; /* opc_message * of the running step; NULL if too many */
  GPtrArray *piece;    /* opc_message * of the running piece, or NULL */
} opc_listener;

/* publish.c: files that instances write. */
typedef struct opc_written {
  char *work;          /* temporary folder until the run has its name */
  gboolean guarded;    /* keep the folder if a plugin crashes */
  GHashTable *claims;  /* file in the folder -> path of the instance that writes
                          the file */
  GHashTable *outputs; /* the same for files named by parameters */
  GPtrArray *given;    /* paths of output files of the running step */
  opc_error refusal;   /* first refused publication */
} opc_written;

/* inputs.c: checksums of the files read. */
typedef struct opc_sums {
  GHashTable *summed; /* path -> SHA-256 */
  GHashTable *known;  /* `summed` of another run, or NULL */
} opc_sums;

/* reuse.c: results in the store. */
typedef struct opc_kept {
  opc_key *keys;     /* one per step; empty without a store. Keys set before the
                        run are kept */
  GPtrArray *pieces; /* names in the store of the running step's pieces */
  struct opc_run *base; /* run whose outputs replace those of the steps left out
                           here (matched by name), or NULL */
} opc_kept;

/* A run. */
typedef struct opc_run opc_run;
struct opc_run {
  opc_flow *flow, *own; /* `own`: `flow` if the run owns it, else NULL */
  opc_registry *registry;
  const opc_run_options *options;
  opc_host like;           /* host functions for the instances */
  void ***objects;         /* [step][output] */
  gboolean *left_out;      /* one per step: the step does not run in this run */
  opc_run *main;           /* run that contains this run; NULL if none does */
  const opc_flow_step *at; /* running step */
  gint64 deadline; /* time limit of the running step on the monotonic clock, us,
                      or 0 */
  gboolean apart;  /* the running step runs in this rank only */
  opc_outcome out;
  opc_listener listener;
  opc_written written;
  opc_sums sums;
  opc_kept kept;
};

/* Return a run of a valid flow (opc_run_free). The hosts of the instances have
   the functions of `like` (if NULL, nothing is published). Messages go to
   `watch` (may be NULL). */
opc_run *opc_run_new(opc_flow *flow, opc_registry *registry,
                     const opc_run_options *options, const opc_watch *watch,
                     const opc_host *like);

/* Free a run and its outputs. */
void opc_run_free(opc_run *run);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_run, opc_run_free)

/* Free the outputs of a step, or of all steps that are not left out. */
void opc_run_release(opc_run *run, const opc_flow_step *step);
void opc_run_release_all(opc_run *run);

/* Return the ranks that take part in the running step; NULL if only this rank
   does. */
const ranks_group *opc_run_ranks(const opc_run *run);

/* Return whether this rank reads, publishes and stores results. */
gboolean opc_run_is_first(const opc_run *run);
