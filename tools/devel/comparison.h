/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow new comparison: an experiment of all methods on layouts of a
   process. */
#pragma once

#include <glib.h>

/* Names in the templates of a comparison, and the text for each. */
typedef struct comparison_word {
  const char *word; /* "@LITHO@" */
  char *text;
} comparison_word;

/* Return the words of a comparison of `inputs` (char *), layouts as they are
   named in the flow's folder, that extends the process at `path`: an array of
   comparison_word (g_array_unref). Return NULL and the exit code in *code, with
   messages, if the flow is no process. */
GArray *comparison_words(const char *path, const GPtrArray *inputs, int *code);
