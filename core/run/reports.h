/* SPDX-License-Identifier: BSD-3-Clause */
/* Report files that the run itself writes into its folder. */
#pragma once

#include "core/run/run.h"

/* Reserve the names of the report files. */
void opc_reports_reserve(opc_run *run);

/* Return whether the folder has files other than reports. */
gboolean opc_reports_has_others(const opc_run *run);

/* Write a file of the run folder; takes ownership of the text. Returns FALSE
   and adds a problem on failure. */
gboolean opc_reports_write_file(const opc_run *run, const char *name,
                                char *text, opc_problems *problems);

/* Write flow.yaml, metrics.json and manifest.json. If `last` is TRUE, the
   manifest lists the files of the folder, to which no file may be added later.
   Returns FALSE and adds problems on failure. */
gboolean opc_reports_write(const opc_run *run, gboolean last,
                           opc_problems *problems);
