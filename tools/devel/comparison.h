/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow new comparison: an experiment that applies all methods to the input
   files of a process. */
#pragma once

#include <glib.h>

/* Return a template with its words replaced (g_free). `process` is the path of
   a flow without an input file; `inputs` (char *) are paths of input files
   relative to the folder of the comparison. Return NULL, messages, and the exit
   code in *code if the process lacks a part.

   The word @PROCESS@ becomes the path, and @CASES@ a case for each input. The
   word @REMOVED@ removes the steps that draw or report a single run. The word
   @DEMANDS@ removes all requirements. The word @STEP.SLOT@ becomes the plugin
   in that slot, with its parameters. */
char *comparison_text(const char *template, const char *process,
                      const GPtrArray *inputs, int *code);
