/* SPDX-License-Identifier: BSD-3-Clause */
/* Faults found in files and arguments, each with its place; gathered, so that
   all of them can be told at once. */
#ifndef OPC_BASE_PROBLEM_H
#define OPC_BASE_PROBLEM_H

#include <glib.h>
#include <opcflow/base.h>

/* A place in a file; lines and columns (characters) from 1, line 0 for a place
   that has none ("--set first.width"). `file` may be NULL. */
typedef struct opc_place {
  const char *file;
  unsigned line, column;
} opc_place;

typedef struct opc_problem {
  opc_place at; /* with a `file` of its own */
  int code;     /* OPC_INVALID, OPC_NO_PLUGIN, OPC_IO ... */
  char *message;
} opc_problem;

typedef struct opc_problems {
  GPtrArray *list; /* opc_problem *, in the order they were found */
} opc_problems;

opc_problems *opc_problems_new(void);
void opc_problems_free(opc_problems *problems);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_problems, opc_problems_free)

/* Copies all. A NULL place has no file. Long messages are cut; of very many
   problems only the first ones are kept. FALSE, always. */
gboolean opc_problem_add(opc_problems *problems, int code,
                         const opc_place *place, const char *format, ...)
    OPC_PRINTF(4, 5);

/* Whether no more are kept: no use looking on. */
gboolean opc_problems_full(const opc_problems *problems);

/* Add those of `from` that are not there yet, with `note` (NULL: nothing)
   behind the message. */
void opc_problems_merge(opc_problems *problems, const opc_problems *from,
                        const char *note);

/* "file:line:column", "file" where there is no line, "" where there is no
   file. */
char *opc_place_text(const opc_place *place);

/* Sort by place; files in the order they came first. */
void opc_problems_sort(opc_problems *problems);

/* "file:line:column: message" */
char *opc_problem_text(const opc_problem *problem);

/* All of them, sorted, one a line, without a last newline; "" for none. */
char *opc_problems_text(opc_problems *problems);

/* The one code of all problems, OPC_INVALID if they differ, OPC_OK if there
   are none. */
int opc_problems_code(const opc_problems *problems);

/* Fill *error with the first of the sorted problems and how many more there
   are; returns its code. */
int opc_problems_error(opc_problems *problems, opc_error *error);

#endif
