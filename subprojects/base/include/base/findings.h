/* SPDX-License-Identifier: BSD-3-Clause */
/* What the steps of a run found that the user must not miss. */
#pragma once

#include <glib.h>

/* A finding. */
typedef struct opc_finding {
  size_t point; /* of a sweep, from 1; 0: of all */
  char *path;   /* of the instance: "step.slot" */
  char *text;
} opc_finding;

/* Findings, each once. At most 100 are kept, the others are counted. */
typedef struct opc_findings {
  GPtrArray *list; /* opc_finding * */
  size_t more;     /* not kept */
} opc_findings;

void opc_findings_init(opc_findings *findings);
void opc_findings_clear(opc_findings *findings);

/* Add a finding, unless it is known. */
void opc_findings_add(opc_findings *findings, size_t point, const char *path,
                      const char *text);

/* Return all of them (char *, freed with the array): "step: text", "point 3:
   step: text", and at last how many were not kept. */
GPtrArray *opc_findings_lines(const opc_findings *findings);
