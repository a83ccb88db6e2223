/* SPDX-License-Identifier: BSD-3-Clause */
/* The files that a run itself writes into its folder. */
#pragma once

#include "core/run/run.h"

/* Claim the names of these files. */
void opc_reports_reserve(opc_run *run);

/* Return whether there are other files. */
gboolean opc_reports_has_others(const opc_run *run);

/* Write a file of the run folder; takes the text. FALSE and a problem. */
gboolean opc_reports_write_file(const opc_run *run, const char *name,
                                char *text, opc_problems *problems);

/* Write flow.yaml, metrics.json and manifest.json; `last`: nothing will be
   written after them. FALSE and problems. */
gboolean opc_reports_write(const opc_run *run, gboolean last,
                           opc_problems *problems);
