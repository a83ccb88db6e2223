/* SPDX-License-Identifier: BSD-3-Clause */
/* All that plugins publish without a flow: tables, metrics and files. */
#pragma once

#include <opcflow/plugin.h>

#include "core/report/table.h"

typedef struct opc_published_metric {
  const char *name;
  double value;
  const opc_metric *declared; /* NULL: the host of no plugin took the metric */
} opc_published_metric;

typedef struct opc_published {
  opc_host host;      /* for instances to be like */
  const char *inside; /* where its folder is made */
  char *folder;       /* for files, made when it is asked for; NULL: not yet */
  GPtrArray *tables;  /* opc_table *, the last one of a name counts */
  GPtrArray *paths;   /* of files, char * */
  GArray *metrics;    /* opc_published_metric, the last one of a name counts */
} opc_published;

/* Begin, with nothing published; `inside` outlives it. [main] */
void opc_published_init(opc_published *p, const char *inside);

/* Return its folder, which is removed with it. */
const char *opc_published_folder(opc_published *p);

/* Forget tables and metrics. */
void opc_published_forget(opc_published *p);

/* Return a check sum of all tables, metrics and files (g_free). */
char *opc_published_digest(const opc_published *p);

/* Free all of it, and remove the folder. */
void opc_published_clear(opc_published *p);
