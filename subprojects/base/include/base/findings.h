/* SPDX-License-Identifier: BSD-3-Clause */
<<<<<<< HEAD
/* Findings of the steps of a run: faults of the result that the user must not
   miss. */
=======
/* Important findings of the steps of a run. */
>>>>>>> int
#pragma once

#include <glib.h>

/* A finding. */
typedef struct opc_finding {
  size_t point; /* point of a sweep, from 1; 0: all points */
<<<<<<< HEAD
  char *path;   /* of the instance: "step.slot" */
=======
  char *path;   /* path of the instance: "step.slot" */
>>>>>>> int
  char *text;
} opc_finding;

/* Findings without duplicates. At most 100 are kept; further ones are
   counted. */
typedef struct opc_findings {
  GPtrArray *list; /* opc_finding * */
  size_t more;     /* number of findings not kept */
} opc_findings;

void opc_findings_init(opc_findings *findings);
void opc_findings_clear(opc_findings *findings);

<<<<<<< HEAD
/* Add a finding unless an equal one exists. */
void opc_findings_add(opc_findings *findings, size_t point, const char *path,
                      const char *text);

/* Return all findings (char *, freed with the array) as "step: text", "point 3:
   step: text", and a last line with the number of findings not kept. */
=======
/* Add a finding unless it exists. */
void opc_findings_add(opc_findings *findings, size_t point, const char *path,
                      const char *text);

/* Return all findings (char *, freed with the array): "step: text", "point 3:
   step: text", and finally the number of those not kept. */
>>>>>>> int
GPtrArray *opc_findings_lines(const opc_findings *findings);
