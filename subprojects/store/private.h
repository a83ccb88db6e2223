/* SPDX-License-Identifier: BSD-3-Clause */
/* Common declarations of the store. */
#pragma once

#include <store/store.h>

struct opc_store {
  char *folder;
  guint64 limit;      /* bytes */
  guint64 written;    /* bytes since the last check of the limit */
  char *complaint;    /* problem not yet reported */
  gboolean reported;  /* a write failure was reported, once */
  GHashTable *sums;   /* path to opc_sum */
  gboolean sums_read; /* stored sums were loaded */
  gboolean sums_new;  /* sums were added since */
};

void opc_sums_init(opc_store *store);
/* Store the sums and free them. */
void opc_sums_clear(opc_store *store);
