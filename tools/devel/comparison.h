/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow new comparison: an experiment of all methods on files that a process
   leaves open. */
#pragma once

#include <glib.h>

/* Return a template with its words replaced (g_free). `process` is the path of
   a flow that leaves a file open; `inputs` (char *) are such files, as they are
   named in the folder of the comparison. Return NULL and the exit code in
   *code, with messages, if the process lacks a part.

   The word @PROCESS@ is the path, and @CASES@ has a case for each input. The
   word @REMOVED@ removes the steps that draw or report a single run. The word
   @DEMANDS@ removes all requirements. The word @STEP.SLOT@ is the plugin in
   that slot, with its parameters. */
char *comparison_text(const char *template, const char *process,
                      const GPtrArray *inputs, int *code);
