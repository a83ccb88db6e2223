/* SPDX-License-Identifier: BSD-3-Clause */
/* The page: one HTML file with all figures of some runs, and what draws them.
   All [main]. */
#ifndef OPCFLOW_REPORT_PAGE_H
#define OPCFLOW_REPORT_PAGE_H

#include <glib.h>
#include <opcflow/plugin.h>

typedef struct page {
  GString *runs;      /* JSON, with commas between */
  GString *missing;   /* JSON texts: what the page has to do without */
  GHashTable *labels; /* char *, each once */
  double room;        /* bytes that are left for pictures */
} page;

/* A page of about `megabytes` at most, where that depends on pictures. */
void page_init(page *p, double megabytes);
void page_clear(page *p);

/* Add a run folder, or all runs of an experiment's. */
int page_add(page *p, const char *folder, opc_error *error);

/* Add one run: of a case (NULL: none) by a method (NULL: called as its folder).
   `running`: it is the one that this belongs to, not yet at its end. */
int page_add_run(page *p, const char *folder, const char *of_case,
                 const char *method, int running, opc_error *error);

/* Say that something is not there. */
void page_lacks(page *p, const char *format, ...) OPC_PRINTF(2, 3);

/* Write it. `title`: NULL for the names of the runs. Errors that are the file's
   have the parameter `file`. */
int page_write(const page *p, const char *title, const char *path,
               opc_error *error);

/* The parameter of page_init: what loads in two seconds. */
#define PAGE_LIMIT(state, member)                                            \
  OPC_PARAMETER_NAMED("size_limit", state, member, .type = OPC_REAL,         \
                      .flags = OPC_ABOVE, .former = "limit", .preset = "15", \
                      .summary =                                             \
                          "Pictures are left out where the page would be "   \
                          "larger than so many MB")

#endif
