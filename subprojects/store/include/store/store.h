/* SPDX-License-Identifier: BSD-3-Clause */
/* A folder that keeps values under keys, for all processes of a user at once.

   A value is a file of its own, with its sum, which comes to be under its name
   as a whole: one that is killed while it writes leaves nothing that is
   believed, and readers need no lock. What was not used for the longest time
   goes first where there is too much. All functions are [main]. */
#ifndef OPC_STORE_H
#define OPC_STORE_H

#include <glib.h>
#include <opcflow/base.h>

typedef struct opc_store opc_store;

/* Bytes, where neither OPCFLOW_STORE_LIMIT nor `opcflow cache limit` says
   otherwise: some ten thousand results of 200 kB. */
#define OPC_STORE_LIMIT G_GUINT64_CONSTANT(2000000000)

/* The store in OPCFLOW_STORE or, where that is not set, opcflow in the user's
   cache folder ($XDG_CACHE_HOME, ~/.cache). NULL if OPCFLOW_STORE is empty, or
   with *error if there can be no such folder. One that can only be read is
   fine. */
opc_store *opc_store_open(opc_error *error);
/* What is too much goes. NULL is fine. */
void opc_store_close(opc_store *store);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_store, opc_store_close)

const char *opc_store_folder(const opc_store *store);

/* What went wrong since the last call (g_free), NULL for nothing: a damaged
   value, a full disk. It is told once. */
char *opc_store_complaint(opc_store *store);

/* The value under `key` (g_variant_unref), whose type must be `type`; NULL if
   there is none. A damaged one is dropped. `key` is hexadecimal, of two digits
   at least, and may have an ending. */
GVariant *opc_store_get(opc_store *store, const char *key,
                        const GVariantType *type);

/* Keep a value in place of an earlier one; takes it if it is floating. FALSE if
   it is not kept: the disk is full or cannot be written, or it is too large. */
gboolean opc_store_put(opc_store *store, const char *key, GVariant *value);

/* Whether there is a value, be it damaged. */
gboolean opc_store_has(const opc_store *store, const char *key);

/* It is of no more use. */
void opc_store_drop(const opc_store *store, const char *key);

/* The most bytes that one value may have: a quarter of all. */
guint64 opc_store_most(const opc_store *store);

/* ---- all of it ---- */

typedef struct opc_store_size {
  guint64 entries, bytes, limit;
} opc_store_size;

opc_store_size opc_store_measure(const opc_store *store);

/* Remove all values. FALSE and *error if something stays. */
gboolean opc_store_clear(opc_store *store, opc_error *error);

/* "5 GB", "500 MB", "0"; powers of 1000. FALSE if it is no such thing. */
gboolean opc_store_read_size(const char *text, guint64 *bytes);
gboolean opc_store_set_limit(opc_store *store, guint64 bytes, opc_error *error);

/* ---- sums.c: of files, which are read once as long as they stay as they are
   ---- */

/* The SHA-256 of a file (g_free); NULL and *error as opc_file_sha256. `store`
   may be NULL: then it is always read. */
char *opc_store_sum(opc_store *store, const char *path,
                    const opc_context *context, opc_error *error);

/* Whether the file still has that sum. */
gboolean opc_store_same(opc_store *store, const char *path, const char *sum);

/* Return the sum of the shared object that `address` lies in and of all objects
   it needs; of the program for NULL. The text lives as long as the process;
   NULL if an object cannot be read. `store` may be NULL. */
const char *opc_store_build(opc_store *store, const void *address);

#endif
