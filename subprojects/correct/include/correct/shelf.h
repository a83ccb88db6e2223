/* SPDX-License-Identifier: BSD-3-Clause */
/* The database of a library: corrected cells, each under a key that says what
   its correction depends on. SQLite, so that a kill at any moment, or two
   processes at once, lose nothing: each cell is a transaction of its own. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

typedef struct shelf shelf;

/* What is told of a cell. Texts belong to whoever gives them. */
typedef struct shelf_row {
  const char *key;      /* of geometry, settings and how it was cut */
  const char *cell;     /* its name */
  const char *geometry; /* sum of what is drawn */
  const char *process;  /* sum of optics, resist and devices */
  const char *settings; /* sum of all that corrects */
  const char *method;   /* "synthesizer.newton" */
  gint64 made;          /* s since 1970 */
  gint64 transistors, simulations;
  double ion_mean, ion_max; /* of |Ion deviation|, % */
  double seconds;           /* that the correction took */
  gint64 bytes;
} shelf_row;

/* Where the database is if nobody says: opcflow/library.sqlite in the user's
   data folder ($XDG_DATA_HOME). g_free. */
OPC_EXPORT char *shelf_place(void);

/* Open it; made if it is not there and `make`. NULL and *error, with the path:
   OPC_INVALID if it is none or of another version, OPC_IO if it is not there,
   damaged, locked by another process for more than 5 s, or not to be read. */
OPC_EXPORT shelf *shelf_open(const char *path, gboolean make, opc_error *error);
OPC_EXPORT void shelf_close(shelf *shelf);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(shelf, shelf_close)

/* Keep a cell, in place of an earlier one of that key. */
OPC_EXPORT int shelf_put(shelf *shelf, const shelf_row *row, GVariant *data,
                         opc_error *error);

/* The data under a key (g_variant_unref), of that type. *out is NULL if there
   is none, or what is there is damaged, which *damaged says. */
OPC_EXPORT int shelf_get(shelf *shelf, const char *key,
                         const GVariantType *type, GVariant **out,
                         gboolean *damaged, opc_error *error);

/* Visit all rows, by cell, then by time; `data` as of shelf_get, NULL where it
   is damaged or `type` is NULL. A code other than OPC_OK ends it. */
typedef int shelf_visit(void *self, const shelf_row *row, GVariant *data,
                        opc_error *error);
OPC_EXPORT int shelf_each(shelf *shelf, const GVariantType *type,
                          shelf_visit *visit, void *self, opc_error *error);

/* Remove rows: those whose keys are in `keys`, a set of char *. */
OPC_EXPORT int shelf_remove(shelf *shelf, GHashTable *keys, opc_error *error);

/* Whether SQLite finds the file sound; its first complaint in *error, OPC_IO.
 */
OPC_EXPORT int shelf_check(shelf *shelf, opc_error *error);
