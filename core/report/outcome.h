/* SPDX-License-Identifier: BSD-3-Clause */
/* Outcome and reports of a run as JSON. */
#pragma once

#include <base/findings.h>
#include <json-glib/json-glib.h>
#include <store/histories.h>
#include <store/store.h>

#include "core/report/judge.h"
#include "core/report/table.h"

/* Outcome of a run. */
typedef struct opc_outcome {
  char *folder;  /* run folder; NULL if no files were kept */
  char *failure; /* why a step failed; NULL if no step failed */
  GDateTime *started;
  double total;      /* seconds */
  double *seconds;   /* one per step; NAN if not run */
  double *processor; /* processor seconds, one per step */
  GPtrArray *tables; /* opc_table * */
  GArray *metrics;   /* opc_inner_metric */
  GPtrArray *inputs; /* files read: path, SHA-256, path ... */
  opc_findings findings;
  GPtrArray *verdicts; /* opc_verdict * */
  opc_histories histories;
  const opc_sweep *sweep; /* may be NULL */
  opc_table *points;      /* parameters and metrics of all points of a sweep */
  size_t failed_points;   /* including failed points of inner flows */
  int points_code;        /* OPC_LIMIT if all failed points have this code, else
                             OPC_FAILED */
} opc_outcome;

/* Initialize the outcome of a run of `steps` steps that starts now; free it. */
void opc_outcome_init(opc_outcome *outcome, guint steps);
void opc_outcome_clear(opc_outcome *outcome);

/* Count a failed point whose problems have the code `code`. */
void opc_outcome_fail_point(opc_outcome *outcome, int code);

/* Return the metrics by instance, in the order in which they were published. */
JsonNode *opc_outcome_metrics(const opc_outcome *outcome);

/* Add "require" and "findings". */
void opc_outcome_add_findings(JsonObject *object, const opc_outcome *outcome);

/* Return metrics.json (g_free). */
char *opc_outcome_metrics_text(const opc_outcome *outcome);

/* Contents of a run's manifest besides the outcome. */
typedef struct opc_manifest {
  const opc_outcome *outcome;
  const opc_flow *flow;
  const opc_registry *registry;
  opc_store *store;           /* may be NULL */
  const char *const *command; /* may be NULL */
} opc_manifest;

/* Return manifest.json (json_node_unref). */
JsonNode *opc_manifest_json(const opc_manifest *manifest);
