/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of a plugin against the contract of its kind. Each check runs in a
   separate process, so that a crash becomes a finding. */
#pragma once

#include "core/binding/binding.h"

/* Value of opc_lint.sample: the plugin accepts no sample file. */
#define OPC_NO_SAMPLE G_MAXSIZE

/* State of the checks of one plugin. */
typedef struct opc_lint {
  const char *path; /* shared object, ID.so */
  char *id;
  opc_registry *registry; /* provides kinds, and plugins for slots */
  const char *parameters; /* in flow syntax; override generated parameters */
  double seconds;         /* limit without output of a check */
  char *folder;           /* for sample files and output of plugins */
  int alive, cleaner;     /* pipe that ends with this process; process that then
                             removes `folder` */
  size_t sample;          /* number of the sample file in use */
  GPtrArray *findings;    /* char *: faults */
  GPtrArray *checked;     /* char *: names of checks */
  GPtrArray *notes;       /* char *: skipped checks with reasons */
} opc_lint;

/* State of one check in its process. */
typedef struct opc_inspection opc_inspection;

/* A check. */
typedef struct opc_check {
  const char *name;
  gboolean works;      /* the check reports a digest of results, if the kind has
                          a test */
  const char *differs; /* finding if the digest differs from that of the first
                          check; NULL if digests are not compared */
  void (*work)(opc_inspection *in);
} opc_check;

/* All checks. The first check loads the plugin. The list ends with an element
   without a name. */
extern const opc_check opc_checks[];

/* Run check i and write the report to `out`. Each line is a letter and a text.
   F: fault; N: reason why a check was skipped; D: digest of the results; S:
   number of the sample file; T: the check is still running; B: the plugin
   changed the process, which then ends; E: end of the report. */
void opc_check_do(const opc_lint *lint, size_t i, int out);
