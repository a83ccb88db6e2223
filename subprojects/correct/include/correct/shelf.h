/* SPDX-License-Identifier: BSD-3-Clause */
/* The database of a library of corrected cells (SQLite). The key of a cell is
   the hash of everything that determines the correction. Each cell is written
   in a separate transaction, so that neither a kill nor a second process loses
   cells. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

typedef struct shelf shelf;

/* Record of a cell. The caller owns the texts. */
typedef struct shelf_row {
  const char *key;      /* hash of geometry, settings and fragmentation */
  const char *cell;     /* name of the cell */
  const char *geometry; /* hash of the drawn shapes */
  const char *process;  /* hash of optics, resist and devices */
  const char *settings; /* hash of the settings of the correction */
  const char *method;   /* "synthesizer.newton" */
  gint64 made;          /* s since 1970 */
  gint64 transistors, simulations;
  double ion_mean, ion_max; /* of |Ion deviation|, % */
  double seconds;           /* duration of the correction */
  gint64 bytes;
} shelf_row;

/* Return the default path of the database: opcflow/library.sqlite in the user's
   data folder ($XDG_DATA_HOME). The caller frees the path with g_free. */
OPC_EXPORT char *shelf_place(void);

/* Open the database at `path`, or create the file if `make` is set. Returns
   NULL and sets *error, with the path, on failure: OPC_INVALID if the file is
   no database of cells or has another version; OPC_IO if the file does not
   exist, cannot be read, is damaged, or is locked by another process for more
   than 5 s. */
OPC_EXPORT shelf *shelf_open(const char *path, gboolean make, opc_error *error);
OPC_EXPORT void shelf_close(shelf *shelf);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(shelf, shelf_close)

/* Write a cell; replaces an earlier cell of the same key. */
OPC_EXPORT int shelf_put(shelf *shelf, const shelf_row *row, GVariant *data,
                         opc_error *error);

/* Return the data of a key in *out (free with g_variant_unref). *out is NULL if
   the key does not exist, or if the data are damaged or not of the type; then
   *damaged is set. */
OPC_EXPORT int shelf_get(shelf *shelf, const char *key,
                         const GVariantType *type, GVariant **out,
                         gboolean *damaged, opc_error *error);

/* Visit all rows, by cell, then by time. `data` is NULL if damaged or if `type`
   is NULL. A code other than OPC_OK ends the visit and is returned. */
typedef int shelf_visit(void *self, const shelf_row *row, GVariant *data,
                        opc_error *error);
OPC_EXPORT int shelf_each(shelf *shelf, const GVariantType *type,
                          shelf_visit *visit, void *self, opc_error *error);

/* Remove the rows whose keys are in `keys`, a set of char *. */
OPC_EXPORT int shelf_remove(shelf *shelf, GHashTable *keys, opc_error *error);

/* Check the file by SQLite. Returns OPC_OK, or OPC_IO with the first fault that
   SQLite reports in *error. */
OPC_EXPORT int shelf_check(shelf *shelf, opc_error *error);
