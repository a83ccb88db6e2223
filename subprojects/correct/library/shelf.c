/* SPDX-License-Identifier: BSD-3-Clause */
/* A library's database in SQLite. */
#include <correct/shelf.h>

#include <sqlite3.h>
#include <string.h>

/* In the header of the file: "opcL", and the version of the tables. */
enum { APPLICATION = 0x6f70634c, VERSION = 3 };

/* ms that another process may keep the database locked; each of its
   transactions takes a hundredth of that. */
enum { PATIENCE = 5000 };

struct shelf {
  sqlite3 *db;
  char *path;
};

static const char tables[] =
    "CREATE TABLE cell ("
    " key TEXT PRIMARY KEY, cell TEXT NOT NULL, geometry TEXT NOT NULL,"
    " process TEXT NOT NULL, settings TEXT NOT NULL, method TEXT NOT NULL,"
    " made INTEGER NOT NULL, transistors INTEGER NOT NULL,"
    " simulations INTEGER NOT NULL, ion_mean REAL NOT NULL,"
    " ion_max REAL NOT NULL, seconds REAL NOT NULL,"
    " sum TEXT NOT NULL, data BLOB NOT NULL) WITHOUT ROWID;";

/* ---- errors ---- */

static int shelf_fail(const shelf *s, opc_error *error) {
  int code = sqlite3_errcode(s->db) & 0xff;
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED)
    return opc_fail(
        error, OPC_IO, NULL,
        "'%s' has been locked by another process for more than %d s", s->path,
        PATIENCE / 1000);
  if (code == SQLITE_NOTADB)
    return opc_fail(
        error, OPC_INVALID, NULL,
        "'%s' is not an SQLite database, or the file header is damaged",
        s->path);
  if (code == SQLITE_CORRUPT)
    return opc_fail(error, OPC_IO, NULL,
                    "'%s' is damaged (%s): remove the file, then all cells are "
                    "corrected again",
                    s->path, sqlite3_errmsg(s->db));
  return opc_fail(error, OPC_IO, NULL, "'%s': %s", s->path,
                  sqlite3_errmsg(s->db));
}

static int shelf_execute(const shelf *s, const char *sql, opc_error *error) {
  return sqlite3_exec(s->db, sql, NULL, NULL, NULL) == SQLITE_OK
             ? OPC_OK
             : shelf_fail(s, error);
}

static int shelf_prepare(const shelf *s, const char *sql, sqlite3_stmt **out,
                         opc_error *error) {
  *out = NULL;
  return sqlite3_prepare_v2(s->db, sql, -1, out, NULL) == SQLITE_OK
             ? OPC_OK
             : shelf_fail(s, error);
}

/* The end of a statement that changes something. */
static int statement_finish(const shelf *s, sqlite3_stmt *statement,
                            opc_error *error) {
  int code =
      sqlite3_step(statement) == SQLITE_DONE ? OPC_OK : shelf_fail(s, error);
  (void)sqlite3_finalize(statement);
  return code;
}

/* ---- opening ---- */

char *shelf_place(void) {
  return g_build_filename(g_get_user_data_dir(), "opcflow", "library.sqlite",
                          NULL);
}

static int get_number(const shelf *s, const char *sql, gint64 *out,
                      opc_error *error) {
  sqlite3_stmt *statement;
  int code = shelf_prepare(s, sql, &statement, error);
  if (!code && sqlite3_step(statement) != SQLITE_ROW)
    code = shelf_fail(s, error);
  if (!code) *out = sqlite3_column_int64(statement, 0);
  (void)sqlite3_finalize(statement);
  return code;
}

/* An empty database becomes a library; two processes may try at once. */
static int make_tables(const shelf *s, opc_error *error) {
  gint64 there;
  int code = shelf_execute(s, "BEGIN IMMEDIATE", error);
  if (code) return code;
  code = get_number(s, "SELECT count(*) FROM sqlite_schema", &there, error);
  if (!code && !there) {
    g_autofree char *head =
        g_strdup_printf("PRAGMA application_id=%d; PRAGMA user_version=%d; %s",
                        APPLICATION, VERSION, tables);
    code = shelf_execute(s, head, error);
  }
  opc_error unheard = {0};
  if (code)
    (void)shelf_execute(s, "ROLLBACK", &unheard);
  else
    code = shelf_execute(s, "COMMIT", error);
  return code;
}

static int look_at_head(const shelf *s, gboolean make, opc_error *error) {
  gint64 application, version, there;
  int code = get_number(s, "SELECT count(*) FROM sqlite_schema", &there, error);
  if (!code && !there && make) code = make_tables(s, error);
  if (!code) code = get_number(s, "PRAGMA application_id", &application, error);
  if (!code) code = get_number(s, "PRAGMA user_version", &version, error);
  if (code) return code;
  if (application != APPLICATION)
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s' is a database, but no library of corrected cells",
                    s->path);
  if (version != VERSION)
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%s' is a library of version %d, but this opcflow "
                    "requires version %d: set another 'database'",
                    s->path, (int)version, VERSION);
  return OPC_OK;
}

shelf *shelf_open(const char *path, gboolean make, opc_error *error) {
  g_autofree char *folder = g_path_get_dirname(path);
  if (!make && !g_file_test(path, G_FILE_TEST_EXISTS)) {
    opc_fail(error, OPC_IO, NULL, "library '%s' does not exist", path);
    return NULL;
  }
  if (make) (void)g_mkdir_with_parents(folder, 0777);
  shelf *s = g_new0(shelf, 1);
  s->path = g_strdup(path);
  int flags = SQLITE_OPEN_READWRITE | (make ? SQLITE_OPEN_CREATE : 0);
  int code = sqlite3_open_v2(path, &s->db, flags, NULL) == SQLITE_OK
                 ? OPC_OK
                 : shelf_fail(s, error);
  if (!code) (void)sqlite3_busy_timeout(s->db, PATIENCE);
  if (!code) code = look_at_head(s, make, error);
  if (!code) return s;
  shelf_close(s);
  return NULL;
}

void shelf_close(shelf *s) {
  if (!s) return;
  (void)sqlite3_close(s->db);
  g_free(s->path);
  g_free(s);
}

/* ---- cells ---- */

static char *sum_of(const void *data, size_t size) {
  return g_compute_checksum_for_data(G_CHECKSUM_SHA256, data, size);
}

static void bind_text(sqlite3_stmt *statement, int at, const char *text) {
  (void)sqlite3_bind_text(statement, at, text, -1, SQLITE_TRANSIENT);
}

int shelf_put(shelf *s, const shelf_row *row, GVariant *data,
              opc_error *error) {
  sqlite3_stmt *put;
  int code = shelf_prepare(s,
                           "INSERT OR REPLACE INTO cell VALUES"
                           "(?,?,?,?,?,?,?,?,?,?,?,?,?,?)",
                           &put, error);
  if (code) return code;
  gsize size = g_variant_get_size(data);
  const void *bytes = g_variant_get_data(data);
  g_autofree char *sum = sum_of(bytes, size);
  const char *texts[] = {row->key,     row->cell,     row->geometry,
                         row->process, row->settings, row->method};
  for (int i = 0; i < 6; i++) bind_text(put, i + 1, texts[i]);
  (void)sqlite3_bind_int64(put, 7, row->made);
  (void)sqlite3_bind_int64(put, 8, row->transistors);
  (void)sqlite3_bind_int64(put, 9, row->simulations);
  (void)sqlite3_bind_double(put, 10, row->ion_mean);
  (void)sqlite3_bind_double(put, 11, row->ion_max);
  (void)sqlite3_bind_double(put, 12, row->seconds);
  bind_text(put, 13, sum);
  (void)sqlite3_bind_blob64(put, 14, bytes, size, SQLITE_TRANSIENT);
  return statement_finish(s, put, error);
}

/* Return the data of the columns `at` (hash) and `at` + 1 (data), or NULL if
   the data do not match the hash. */
static GVariant *read_data(sqlite3_stmt *from, int at,
                           const GVariantType *type) {
  const void *bytes = sqlite3_column_blob(from, at + 1);
  gsize size = (gsize)sqlite3_column_bytes(from, at + 1);
  const char *kept = (const char *)sqlite3_column_text(from, at);
  g_autofree char *sum = sum_of(bytes, size);
  if (!kept || strcmp(sum, kept)) return NULL;
  g_autoptr(GBytes) own = g_bytes_new(bytes, size);
  GVariant *v = g_variant_ref_sink(g_variant_new_from_bytes(type, own, FALSE));
  if (g_variant_is_normal_form(v)) return v;
  g_variant_unref(v);
  return NULL;
}

int shelf_get(shelf *s, const char *key, const GVariantType *type,
              GVariant **out, gboolean *damaged, opc_error *error) {
  sqlite3_stmt *get;
  *out = NULL;
  *damaged = FALSE;
  int code =
      shelf_prepare(s, "SELECT sum, data FROM cell WHERE key=?", &get, error);
  if (code) return code;
  bind_text(get, 1, key);
  int found = sqlite3_step(get);
  if (found == SQLITE_ROW) {
    *out = read_data(get, 0, type);
    *damaged = !*out;
  } else if (found != SQLITE_DONE) {
    code = shelf_fail(s, error);
  }
  (void)sqlite3_finalize(get);
  return code;
}

static const char *text_at(sqlite3_stmt *from, int at) {
  const char *text = (const char *)sqlite3_column_text(from, at);
  return text ? text : "";
}

static shelf_row row_at(sqlite3_stmt *from) {
  return (shelf_row){.key = text_at(from, 0),
                     .cell = text_at(from, 1),
                     .geometry = text_at(from, 2),
                     .process = text_at(from, 3),
                     .settings = text_at(from, 4),
                     .method = text_at(from, 5),
                     .made = sqlite3_column_int64(from, 6),
                     .transistors = sqlite3_column_int64(from, 7),
                     .simulations = sqlite3_column_int64(from, 8),
                     .ion_mean = sqlite3_column_double(from, 9),
                     .ion_max = sqlite3_column_double(from, 10),
                     .seconds = sqlite3_column_double(from, 11),
                     .bytes = sqlite3_column_bytes(from, 13)};
}

int shelf_each(shelf *s, const GVariantType *type, shelf_visit *visit,
               void *self, opc_error *error) {
  sqlite3_stmt *all;
  int found = SQLITE_DONE;
  int code = shelf_prepare(s, "SELECT * FROM cell ORDER BY cell, made, key",
                           &all, error);
  while (!code && (found = sqlite3_step(all)) == SQLITE_ROW) {
    shelf_row row = row_at(all);
    GVariant *data = type ? read_data(all, 12, type) : NULL;
    code = visit(self, &row, data, error);
    if (data) g_variant_unref(data);
  }
  if (!code && found != SQLITE_DONE) code = shelf_fail(s, error);
  (void)sqlite3_finalize(all);
  return code;
}

int shelf_remove(shelf *s, GHashTable *keys, opc_error *error) {
  GHashTableIter each;
  gpointer key;
  sqlite3_stmt *gone;
  int code = shelf_execute(s, "BEGIN IMMEDIATE", error);
  if (code) return code;
  g_hash_table_iter_init(&each, keys);
  while (!code && g_hash_table_iter_next(&each, &key, NULL)) {
    code = shelf_prepare(s, "DELETE FROM cell WHERE key=?", &gone, error);
    if (code) break;
    bind_text(gone, 1, key);
    code = statement_finish(s, gone, error);
  }
  opc_error unheard = {0};
  if (code)
    (void)shelf_execute(s, "ROLLBACK", &unheard);
  else
    code = shelf_execute(s, "COMMIT", error);
  return code ? code : shelf_execute(s, "VACUUM", error);
}

int shelf_check(shelf *s, opc_error *error) {
  sqlite3_stmt *check;
  int code = shelf_prepare(s, "PRAGMA integrity_check(1)", &check, error);
  if (code) return code;
  if (sqlite3_step(check) != SQLITE_ROW)
    code = shelf_fail(s, error);
  else if (strcmp(text_at(check, 0), "ok") != 0)
    code = opc_fail(error, OPC_IO, NULL, "'%s' is damaged: %s", s->path,
                    text_at(check, 0));
  (void)sqlite3_finalize(check);
  return code;
}
