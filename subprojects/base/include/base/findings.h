/* SPDX-License-Identifier: BSD-3-Clause */
/* Findings of a run: faults of results that the user must not miss. The path of
   an instance (a plugin in the flow) is the name of its step and of the slots
   to it: "mask.litho". */
#pragma once

#include <glib.h>

/* A finding. */
typedef struct opc_finding {
  size_t point; /* point of a sweep, from 1; 0 for a step that is not part of a
                   point */
  char *path;   /* path of the instance: "step.slot" */
  char *text;   /* message of the plugin */
} opc_finding;

/* The first 100 distinct findings, and the number of further findings. */
typedef struct opc_findings {
  GPtrArray *list; /* opc_finding * */
  size_t more;     /* number of findings not kept, repetitions included */
} opc_findings;

/* opc_findings_init: initialise *findings, without findings.
   opc_findings_clear: free the findings. */
void opc_findings_init(opc_findings *findings);
void opc_findings_clear(opc_findings *findings);

/* Add a finding with copies of the texts, unless an equal one is present. */
void opc_findings_add(opc_findings *findings, size_t point, const char *path,
                      const char *text);

/* Return one line for each finding, "step: text" or "point 3: step: text", and
   the number of findings not kept (char *, freed with the array; the
   caller frees the array). */
GPtrArray *opc_findings_lines(const opc_findings *findings);
