/* SPDX-License-Identifier: BSD-3-Clause */
/* A run: a flow that is worked through, with what it publishes, hears and
   reuses. Each part of the struct belongs to the file that it names. */
#pragma once

#include <opcflow/step.h>
#include <ranks/ranks.h>

#include "core/report/outcome.h"
#include "core/run/key.h"

typedef struct opc_run_options {
  const char *output; /* NULL: runs/NAME, or the first free NAME-2 ... */
  gboolean force;     /* an earlier run may be replaced */
  gboolean keep;      /* of a sweep: what each point writes stays */
  const char *const *command; /* for the manifest; may be NULL */
  opc_store *store; /* of earlier results; NULL: none, and nothing is kept */
  const ranks_group *ranks; /* that run it together; NULL: this process alone */
} opc_run_options;

/* A message of a step, to be repeated when its result is used again. */
typedef struct opc_said {
  int level;
  char *path, *text;
} opc_said;

/* listen.c: what instances say. */
typedef struct opc_heard {
  opc_watch watch;       /* of the instances: keeps findings, calls `told` */
  const opc_watch *told; /* who looks on */
  GMutex lock;           /* of findings, `said` and `piece` */
  size_t point;          /* of a sweep, that runs now; 0: none */
  gboolean silent;       /* a step runs again, for its outputs alone */
  GPtrArray *said;       /* opc_said * of the step that runs; NULL: too many */
  GPtrArray *piece;      /* opc_said * of the piece of work; NULL: none runs */
} opc_heard;

/* publish.c: what instances write. */
typedef struct opc_written {
  char *work;          /* the folder, until the run has its name */
  gboolean guarded;    /* the folder is kept if a plugin crashes */
  GHashTable *claims;  /* file in the folder -> path of the instance */
  GHashTable *outputs; /* the same of files that parameters name */
  GPtrArray *given;    /* paths of files that the step at work writes */
  opc_error refusal;   /* of something that a step published */
} opc_written;

/* inputs.c: sums of the files that are read. */
typedef struct opc_sums {
  GHashTable *summed; /* path -> SHA-256 */
  GHashTable *known;  /* the same of another run; NULL: none */
} opc_sums;

/* reuse.c: results that are in the store. */
typedef struct opc_kept {
  opc_key *keys;     /* of each step; empty without a store. A key that is set
                        before the run stays */
  GPtrArray *pieces; /* names in the store of those of the step at work */
  struct opc_run *base; /* has steps that are left out here, found by their
                           names; NULL: none */
} opc_kept;

typedef struct opc_run opc_run;
struct opc_run {
  opc_flow *flow, *own; /* `own`: the same, if it is freed with the run */
  opc_registry *registry;
  const opc_run_options *options;
  opc_host like;           /* the functions of its instances' hosts */
  void ***objects;         /* of each step, of each output */
  gboolean *left_out;      /* of each step: it does not run here */
  opc_run *main;           /* that it is a part of; NULL: of none */
  const opc_flow_step *at; /* the step that runs */
  gboolean apart;          /* it runs in this rank alone */
  opc_outcome out;
  opc_heard heard;
  opc_written written;
  opc_sums sums;
  opc_kept kept;
};

/* Make a run of a good flow. Its instances get hosts like `like` (NULL: nothing
   is published), and report to `watch` (NULL: nobody). */
opc_run *opc_run_new(opc_flow *flow, opc_registry *registry,
                     const opc_run_options *options, const opc_watch *watch,
                     const opc_host *like);

/* Free a run with its outputs. */
void opc_run_free(opc_run *run);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_run, opc_run_free)

/* Free the outputs of a step, or of all steps that are not left out. */
void opc_run_release(opc_run *run, const opc_flow_step *step);
void opc_run_release_all(opc_run *run);

/* Return the ranks that now do what this one does; NULL: it is alone. */
const ranks_group *opc_run_ranks(const opc_run *run);

/* Return whether this rank finds results, publishes and keeps them. */
gboolean opc_run_is_first(const opc_run *run);
