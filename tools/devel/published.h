/* SPDX-License-Identifier: BSD-3-Clause */
/* What a plugin publishes while `opcflow lint` tries it: a check sum of all
   tables, metrics and files. */
#ifndef OPCFLOW_DEVEL_PUBLISHED_H
#define OPCFLOW_DEVEL_PUBLISHED_H

#include <glib.h>
#include <opcflow/plugin.h>

typedef struct opc_published {
  opc_host host; /* for instances to be like */
  char *folder;  /* where files go, one of its own */
  GChecksum *digest;
  GPtrArray *paths; /* char * */
} opc_published;

/* Files go into a new folder inside of that one. [main] */
void opc_published_init(opc_published *p, const char *inside);

/* Add the files that were written; the digest of all (g_free). */
char *opc_published_clear(opc_published *p);

#endif
