/* SPDX-License-Identifier: BSD-3-Clause */
/* A folder that keeps values under keys, shared by all processes of a user.

   Each value is a file with a checksum, written under another name and then
   renamed. A reader therefore needs no lock and rejects incomplete files. If
   the limit is exceeded, the least recently used values are removed first. All
   functions are [main] (opcflow/plugin.h). */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* The store. */
typedef struct opc_store opc_store;

/* Default limit in bytes, about ten thousand results of 200 kB;
   OPCFLOW_STORE_LIMIT or `opcflow cache limit` sets another limit. */
#define OPC_STORE_LIMIT G_GUINT64_CONSTANT(2000000000)

/* Return the store in the folder OPCFLOW_STORE or, if this variable is unset,
   in the folder `opcflow` of the user's cache folder ($XDG_CACHE_HOME,
   ~/.cache). Return NULL if OPCFLOW_STORE is the empty text. Return NULL and
   fill *error: OPC_IO if the folder cannot be created; OPC_INVALID if the cache
   folder is relative, if OPCFLOW_STORE names a folder with files but without
   the marker `opcflow-store`, or if a subfolder is a symbolic link. A read-only
   folder is accepted. */
opc_store *opc_store_open(opc_error *error);
/* Free the store, which may be NULL. If values were stored, first remove the
   least recently used values beyond the limit. */
void opc_store_close(opc_store *store);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_store, opc_store_close)

/* Return the path of the store. */
const char *opc_store_folder(const opc_store *store);

/* Return the last problem since the previous call (g_free), such as a damaged
   value or a full disk; NULL for none. Only the first failed write of a process
   is reported. */
char *opc_store_complaint(opc_store *store);

/* Return the value under `key` (g_variant_unref), or NULL if there is none. A
   file that is damaged, in another format, stored under another key, or of
   another type than `type` is removed and counts as missing. `key` begins with
   two hexadecimal digits, has at least one more character, and may have a
   suffix. */
GVariant *opc_store_get(opc_store *store, const char *key,
                        const GVariantType *type);

/* Store a value under `key` and replace an earlier value. Takes ownership of a
   floating reference. Return FALSE if the value is too large or not
   writable. */
gboolean opc_store_put(opc_store *store, const char *key, GVariant *value);

/* As opc_store_get. *contents receives a descriptor (close), from which
   opc_files_unpack reads the files stored with the value; -1 without a
   value. */
GVariant *opc_store_get_files(opc_store *store, const char *key,
                              const GVariantType *type, int *contents);

/* As opc_store_put; the contents of `files` (OPC_FILES_TYPE, store/pack.h) in
   `folder` follow the value, copied through a small buffer. Return FALSE also
   if all together are too large, before any file is read, or if a file is
   missing or has another size. */
gboolean opc_store_put_files(opc_store *store, const char *key, GVariant *value,
                             GVariant *files, const char *folder);

/* Return whether a value exists, even if the value is damaged. */
gboolean opc_store_has(const opc_store *store, const char *key);

/* Remove a value. */
void opc_store_drop(const opc_store *store, const char *key);

/* Return the largest allowed size of a value with its files in bytes: a quarter
   of the limit. */
guint64 opc_store_most(const opc_store *store);

/* ---- all values ---- */

/* Number of values, their size in bytes, and the limit in bytes. */
typedef struct opc_store_size {
  guint64 entries, bytes, limit;
} opc_store_size;

/* Return the size of the store. */
opc_store_size opc_store_measure(const opc_store *store);

/* Remove all values. Return FALSE and *error if a value could not be
   removed. */
gboolean opc_store_clear(opc_store *store, opc_error *error);

/* Parse a size, "5 GB", "500 MB", "0", in powers of 1000. Return FALSE for
   other texts. */
gboolean opc_store_read_size(const char *text, guint64 *bytes);

/* Set the limit for this and later processes, and remove values beyond the
   limit. Return FALSE and *error if the limit cannot be stored. */
gboolean opc_store_set_limit(opc_store *store, guint64 bytes, opc_error *error);

/* ---- claims.c: processes that share work ---- */

/* Claim `key` for this process, until opc_store_leave or the end of the
   process. Return FALSE if another process has claimed or joined the key.
   Return TRUE without a claim if the folder is read-only or its file system has
   no locks; processes may then compute the same value. */
gboolean opc_store_claim(opc_store *store, const char *key);

/* Join the processes that use `key`, until opc_store_leave or the end of the
   process. Any number of processes can join a key; none can claim a joined
   key. A key that another process has claimed is not joined. */
void opc_store_join(opc_store *store, const char *key);

/* End the claim of this process to `key`, or leave the processes that joined
   the key. */
void opc_store_leave(opc_store *store, const char *key);

/* ---- sums.c: checksums of files; an unchanged file is read once ---- */

/* Return the SHA-256 of a file (g_free); NULL and *error as in opc_file_sha256.
   If `store` is NULL, the file is always read. */
char *opc_store_sum(opc_store *store, const char *path,
                    const opc_context *context, opc_error *error);

/* Return whether a file has the checksum `sum` and has not changed since this
   process last called opc_store_sum for the file. */
gboolean opc_store_same(opc_store *store, const char *path, const char *sum);

/* Return the checksum of the shared object that contains `address`, or of the
   program if NULL, and of all shared objects that the object needs. NULL if an
   object cannot be read. The text is valid until the process ends. `store` may
   be NULL. */
const char *opc_store_build(opc_store *store, const void *address);
