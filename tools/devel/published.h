/* SPDX-License-Identifier: BSD-3-Clause */
/* Collector of the tables, metrics and files that plugins publish outside of a
   flow. */
#pragma once

#include <opcflow/plugin.h>

#include "core/report/table.h"

/* A published metric. */
typedef struct opc_published_metric {
  const char *name;
  double value;
  const opc_metric *declared; /* declaration; NULL if a host without a plugin
                                 published the metric */
} opc_published_metric;

/* The collector. */
typedef struct opc_published {
  opc_host host;      /* template for the hosts of instances */
  const char *inside; /* folder that contains `folder` */
  char *folder;       /* for files; NULL before the first file */
  GPtrArray
      *tables;      /* opc_table *; if names are equal, the last one is valid */
  GPtrArray *paths; /* char *: paths of the files */
  GArray *metrics;  /* opc_published_metric; if names are equal, the last is
                       valid */
} opc_published;

/* Initialise an empty collector. `inside` must outlive the collector. [main] */
void opc_published_init(opc_published *p, const char *inside);

/* Return the folder, created if necessary; opc_published_clear removes the
   folder. */
const char *opc_published_folder(opc_published *p);

/* Discard tables and metrics. */
void opc_published_forget(opc_published *p);

/* Return a checksum of all tables, metrics and files; free it with g_free. */
char *opc_published_digest(const opc_published *p);

/* Free the collector and remove the folder. */
void opc_published_clear(opc_published *p);
