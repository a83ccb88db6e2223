/* SPDX-License-Identifier: BSD-3-Clause */
/* Common declarations of the store. */
#pragma once

#include <store/store.h>

/* A store. */
struct opc_store {
  char *folder;
  guint64 limit;      /* bytes */
  guint64 written;    /* bytes since the last check of the limit */
  char *complaint;    /* problem not yet reported */
  gboolean reported;  /* a write failure was reported, once */
  GHashTable *sums;   /* path -> opc_sum */
  gboolean sums_read; /* stored checksums were loaded */
  gboolean sums_new;  /* checksums were added since the last write */
  int claims;         /* descriptor of the file whose locks are the claims; -1
                         if not open */
};

/* Initialise the checksums of files (sums.c). */
void opc_sums_init(opc_store *store);
/* Store the checksums and free them. */
void opc_sums_clear(opc_store *store);
