/* SPDX-License-Identifier: BSD-3-Clause */
/* Problems found in files and arguments, each with its place; collected, so
   that all can be reported at once. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* A place in a file; lines and columns (characters) count from 1. Line 0: a
   place without lines ("--set first.width"). `file` may be NULL. */
typedef struct opc_place {
  const char *file;
  unsigned line, column;
} opc_place;

typedef struct opc_problem {
  opc_place at; /* owns its `file` */
  int code;     /* OPC_INVALID, OPC_NO_PLUGIN, OPC_IO ... */
  char *message;
} opc_problem;

typedef struct opc_problems {
  GPtrArray *list; /* opc_problem *, in the order of their discovery */
} opc_problems;

opc_problems *opc_problems_new(void);
void opc_problems_free(opc_problems *problems);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_problems, opc_problems_free)

/* Add a copy of a problem and return FALSE. A NULL place has no file. Long
   messages are cut; only the first problems are kept if there are very many. */
gboolean opc_problem_add(opc_problems *problems, int code,
                         const opc_place *place, const char *format, ...)
    OPC_PRINTF(4, 5);

/* Return whether no more problems are kept, so that checks may stop. */
gboolean opc_problems_full(const opc_problems *problems);

/* Add the problems of `from` that are missing, with `note` (may be NULL)
   appended to their messages. */
void opc_problems_merge(opc_problems *problems, const opc_problems *from,
                        const char *note);

/* Return "file:line:column", "file" for line 0, "" without a file (g_free). */
char *opc_place_text(const opc_place *place);

/* Sort by place; files keep the order of their first problem. */
void opc_problems_sort(opc_problems *problems);

/* Return "file:line:column: message" (g_free). */
char *opc_problem_text(const opc_problem *problem);

/* Return all problems, sorted, one a line, without a final newline; "" for none
   (g_free). */
char *opc_problems_text(opc_problems *problems);

/* Return the common code of all problems, OPC_INVALID if they differ, OPC_OK
   for none. */
int opc_problems_code(const opc_problems *problems);

/* Fill *error with the first of the sorted problems and the number of others;
   return its code. */
int opc_problems_error(opc_problems *problems, opc_error *error);
