/* SPDX-License-Identifier: BSD-3-Clause */
/* Important findings of the steps of a run. */
#pragma once

#include <glib.h>

/* A finding. */
typedef struct opc_finding {
  size_t point; /* point of a sweep, from 1; 0: all points */
  char *path;   /* path of the instance: "step.slot" */
  char *text;
} opc_finding;

/* Findings, each once. At most 100 are kept, the others are counted. */
typedef struct opc_findings {
  GPtrArray *list; /* opc_finding * */
  size_t more;     /* number of findings not kept */
} opc_findings;

void opc_findings_init(opc_findings *findings);
void opc_findings_clear(opc_findings *findings);

/* Add a finding unless already present. */
void opc_findings_add(opc_findings *findings, size_t point, const char *path,
                      const char *text);

/* Return all findings (char *, freed with the array): "step: text", "point 3:
   step: text", and finally the number of those not kept. */
GPtrArray *opc_findings_lines(const opc_findings *findings);
