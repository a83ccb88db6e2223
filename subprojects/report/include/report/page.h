/* SPDX-License-Identifier: BSD-3-Clause */
/* Report page: one HTML file with all figures of some runs and the code that
   draws the figures. Call all functions on the main thread. */
#pragma once

#include <glib.h>
#include <opcflow/plugin.h>

/* A page under construction. */
typedef struct page {
  GString *runs;      /* JSON, separated by commas */
  GString *missing;   /* JSON texts: missing parts of the page */
  GHashTable *labels; /* set of char * */
  GPtrArray *places;  /* char *: case, method and folder of each complete run */
  double capacity;    /* bytes left for pictures */
} page;

/* Initialise a page of about `megabytes` MB at most; pictures that exceed this
   size are omitted. */
void page_init(page *p, double megabytes);
/* Free the contents of a page. */
void page_clear(page *p);

/* Add a run folder, or all runs of an experiment. Returns OPC_OK or an error
   code. */
int page_add(page *p, const char *folder, opc_error *error);

/* Add one run of the case `of_case` (may be NULL) by a method; if `method` is
   NULL, the name of the folder is used. `running` is 1 for the run in progress
   that writes the page. Returns OPC_OK or an error code. */
int page_add_run(page *p, const char *folder, const char *of_case,
                 const char *method, int running, opc_error *error);

/* Add a note on a missing part. */
void page_lacks(page *p, const char *format, ...) OPC_PRINTF(2, 3);

/* Write the page. If `title` is NULL, the title consists of the case and the
   methods of the runs. Returns OPC_OK, or OPC_IO with the parameter `file`. */
int page_write(page *p, const char *title, const char *path, opc_error *error);

/* Parameter of page_init; the page of the default size loads in two seconds. */
#define PAGE_LIMIT(state, member)                                        \
  OPC_PARAMETER_NAMED(                                                   \
      "size_limit", state, member, .type = OPC_REAL, .flags = OPC_ABOVE, \
      .former = "limit", .preset = "15",                                 \
      .summary = "Largest size of the page in MB, kept by omitting pictures")
