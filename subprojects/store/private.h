/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of the store share. */
#pragma once

#include <store/store.h>

struct opc_store {
  char *folder;
  guint64 limit;      /* bytes */
  guint64 written;    /* since it was last looked for too much */
  char *complaint;    /* not yet told */
  gboolean told;      /* that it cannot be written: once is enough */
  GHashTable *sums;   /* path -> opc_sum */
  gboolean sums_read; /* those that were kept */
  gboolean sums_new;  /* there are others than those */
};

void opc_sums_init(opc_store *store);
/* Keep what was found out, and free it. */
void opc_sums_clear(opc_store *store);
