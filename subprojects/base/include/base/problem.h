/* SPDX-License-Identifier: BSD-3-Clause */
/* Problems in files and arguments, each with its place. Functions collect
   problems in a list, so that the command reports all at once. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* A place in a file; lines, and columns in characters, count from 1. If `line`
   is 0, `file` has no lines ("--set first.width"). `file` may be NULL. */
typedef struct opc_place {
  const char *file;
  unsigned line, column;
} opc_place;

/* A problem. */
typedef struct opc_problem {
  opc_place at; /* owns its `file` */
  int code;     /* OPC_INVALID, OPC_NO_PLUGIN, OPC_IO ... */
  char *message;
} opc_problem;

/* A list of problems. */
typedef struct opc_problems {
  GPtrArray *list; /* opc_problem *, in the order of their discovery */
} opc_problems;

/* Return an empty list (opc_problems_free). */
opc_problems *opc_problems_new(void);
/* Free a list with its problems (NULL: do nothing). */
void opc_problems_free(opc_problems *problems);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_problems, opc_problems_free)

/* Add a copy of a problem and return FALSE. If `place` is NULL, the problem has
   no file. Unprintable characters are written as escapes, and messages of more
   than 1000 bytes are truncated. Only the first 999 problems are kept; the next
   problem is replaced by "further problems are not listed", and later problems
   are dropped. */
gboolean opc_problem_add(opc_problems *problems, int code,
                         const opc_place *place, const char *format, ...)
    OPC_PRINTF(4, 5);

/* Return whether the list is full; checks may then stop. */
gboolean opc_problems_full(const opc_problems *problems);

/* Add the problems of `from` that are not in `problems`, with `note` (may be
   NULL) appended to the messages. */
void opc_problems_merge(opc_problems *problems, const opc_problems *from,
                        const char *note);

/* Return "file:line:column", "file" for line 0, "" without a file (g_free). */
char *opc_place_text(const opc_place *place);

/* Sort by place. Files are in the order of their first problems. */
void opc_problems_sort(opc_problems *problems);

/* Return "file:line:column: message", "file: message" or "message" (g_free). */
char *opc_problem_text(const opc_problem *problem);

/* Sort the problems and return their texts, one a line, without a final newline
   (g_free). Without problems, return "". */
char *opc_problems_text(opc_problems *problems);

/* Return the common code of all problems; OPC_INVALID if the codes differ,
   OPC_OK without problems. */
int opc_problems_code(const opc_problems *problems);

/* Sort the problems, fill *error with the first problem and the number of
   further problems, and return opc_problems_code. Without problems, return
   OPC_OK and leave *error unchanged. */
int opc_problems_error(opc_problems *problems, opc_error *error);
