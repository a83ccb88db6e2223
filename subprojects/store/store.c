/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of the store. FOLDER/entries/ab/cdef... has a line of 16 bytes, 64
   digits of a SHA-256, 16 digits of the size of a GVariant, the GVariant, and
   the contents of files. The SHA-256 is that of the key, the type of the
   GVariant, and the remainder of the file, so that an entry under another key
   counts as damaged. FOLDER/new/ has files being written, locked by their
   writers. FOLDER/lock is locked while old entries are removed. FOLDER/limit
   has the limit. FOLDER/claims is an empty file with the locks of claims.
   FOLDER/opcflow-store is an empty file that marks the folder as a store. */
#include <store/store.h>

#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <store/files.h>
#include <store/pack.h>
#include "private.h"

static const char mark[] = "opcflow store 3\n";
/* Beginning of the marks of all formats. Formats 1 and 2, whose SHA-256 does
   not cover key and type, are not read. */
static const char older[] = "opcflow store ";
enum { MARK = 16, SUM = 64, SIZE = 16, HEAD = MARK + SUM + SIZE };

/* Size of the buffer through which the contents of files are copied. */
enum { BUFFER = 65536 };

/* ---- opening ---- */

gboolean opc_store_read_size(const char *text, guint64 *bytes) {
  static const struct {
    const char *unit;
    double factor;
  } units[] = {{"", 1},     {"B", 1},    {"kB", 1e3},
               {"MB", 1e6}, {"GB", 1e9}, {"TB", 1e12}};
  char *end;
  double number = g_ascii_strtod(text, &end);
  while (*end == ' ') end++;
  for (size_t i = 0; end > text && i < G_N_ELEMENTS(units); i++) {
    double size = number * units[i].factor;
    if (strcmp(end, units[i].unit) || !(size >= 0) || size > 1e18) continue;
    *bytes = (guint64)size;
    return TRUE;
  }
  return FALSE;
}

static guint64 find_limit(const char *folder) {
  guint64 bytes = OPC_STORE_LIMIT;
  g_autofree char *path = g_build_filename(folder, "limit", NULL);
  g_autofree char *text = NULL;
  const char *own = g_getenv("OPCFLOW_STORE_LIMIT");
  if (own && opc_store_read_size(own, &bytes)) return bytes;
  if (g_file_get_contents(path, &text, NULL, NULL))
    opc_store_read_size(g_strstrip(text), &bytes);
  return bytes;
}

/* Return whether the store may write to a folder and remove files from the
   folder: the folder has the marker, or is empty and receives the marker. If
   `any` is TRUE, a folder with other files also receives the marker (for the
   cache folder of the user). */
static gboolean folder_claim(const char *folder, gboolean any) {
  g_autofree char *marker = g_build_filename(folder, "opcflow-store", NULL);
  GDir *dir = g_dir_open(folder, 0, NULL);
  gboolean empty = !dir || !g_dir_read_name(dir);
  if (dir) g_dir_close(dir);
  if (!access(marker, F_OK)) return TRUE;
  if (!empty && !any) return FALSE;
  int file = open(marker, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file >= 0) close(file);
  return TRUE; /* a read-only folder needs no marker */
}

/* Return whether a folder of the store is a symbolic link. */
static gboolean is_link(const char *folder, const char *name) {
  g_autofree char *path = g_build_filename(folder, name, NULL);
  struct stat about;
  return !lstat(path, &about) && S_ISLNK(about.st_mode);
}

opc_store *opc_store_open(opc_error *error) {
  const char *own = g_getenv("OPCFLOW_STORE");
  if (own && !*own) return NULL;
  g_autofree char *folder =
      own ? g_canonicalize_filename(own, NULL)
          : g_build_filename(g_get_user_cache_dir(), "opcflow", NULL);
  g_autofree char *entries = g_build_filename(folder, "entries", NULL);
  if (!g_path_is_absolute(folder)) {
    opc_fail(error, OPC_INVALID, NULL,
             "the user's cache folder '%s' is relative",
             g_get_user_cache_dir());
    return NULL;
  }
  if (!g_mkdir_with_parents(folder, 0700) && !folder_claim(folder, !own)) {
    opc_fail(error, OPC_INVALID, NULL,
             "'%s' has files, but no file 'opcflow-store': it is not a store "
             "of opcflow; name a new or an empty folder",
             folder);
    return NULL;
  }
  if (is_link(folder, "entries") || is_link(folder, "new")) {
    opc_fail(error, OPC_INVALID, NULL,
             "'%s': 'entries' or 'new' is a symbolic link", folder);
    return NULL;
  }
  if (g_mkdir_with_parents(entries, 0700)) {
    opc_fail(error, OPC_IO, NULL, "'%s': %s", entries, g_strerror(errno));
    return NULL;
  }
  opc_store *store = g_new0(opc_store, 1);
  store->limit = find_limit(folder);
  store->claims = -1;
  store->folder = g_steal_pointer(&folder);
  opc_sums_init(store);
  return store;
}

const char *opc_store_folder(const opc_store *store) { return store->folder; }

char *opc_store_complaint(opc_store *store) {
  return g_steal_pointer(&store->complaint);
}

static void store_complain(opc_store *store, const char *path,
                           const char *why) {
  g_free(store->complaint);
  store->complaint = g_strdup_printf("'%s': %s", path, why);
}

/* Return the path entries/ab/cdef... of a key. */
static char *path_of(const opc_store *store, const char *key) {
  const char name[3] = {key[0], key[1], 0};
  return g_build_filename(store->folder, "entries", name, key + 2, NULL);
}

/* ---- reading ---- */

/* Read exactly n bytes. */
static gboolean read_all(int file, void *data, gsize n) {
  char *at = data;
  while (n) {
    ssize_t done = read(file, at, n);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return FALSE;
    at += done;
    n -= (gsize)done;
  }
  return TRUE;
}

/* Return the checksum of the key and the type of an entry, both with their
   terminating zeros. */
static GChecksum *sum_new(const char *key, const char *type) {
  GChecksum *sum = g_checksum_new(G_CHECKSUM_SHA256);
  g_checksum_update(sum, (const guchar *)key, (gssize)strlen(key) + 1);
  g_checksum_update(sum, (const guchar *)type, (gssize)strlen(type) + 1);
  return sum;
}

/* Return the bytes of the value of an entry (g_free), and set the position to
   the contents of its files; NULL if the entry is damaged. */
static char *read_sound(int file, const char *key, const GVariantType *type,
                        const char *head, gsize *n) {
  struct stat about;
  g_autofree char *digits = g_strndup(head + MARK + SUM, SIZE);
  guint64 size = g_ascii_strtoull(digits, NULL, 16);
  if (memcmp(head, mark, MARK) || fstat(file, &about) ||
      size > (guint64)about.st_size - HEAD)
    return NULL;
  char *text = g_malloc(MAX(*n = size, 1)), buffer[BUFFER];
  g_autofree char *name = g_variant_type_dup_string(type);
  g_autoptr(GChecksum) sum = sum_new(key, name);
  gboolean good = read_all(file, text, size);
  g_checksum_update(sum, (const guchar *)digits, SIZE);
  g_checksum_update(sum, (const guchar *)text, (gssize)size);
  for (guint64 left = (guint64)about.st_size - HEAD - size; good && left;) {
    gsize next = MIN(left, BUFFER);
    good = read_all(file, buffer, next);
    g_checksum_update(sum, (const guchar *)buffer, (gssize)next);
    left -= next;
  }
  if (good && !memcmp(head + MARK, g_checksum_get_string(sum), SUM) &&
      lseek(file, (off_t)(HEAD + size), SEEK_SET) >= 0)
    return text;
  g_free(text);
  return NULL;
}

GVariant *opc_store_get_files(opc_store *store, const char *key,
                              const GVariantType *type, int *contents) {
  g_autofree char *path = path_of(store, key);
  char head[HEAD];
  gsize n;
  *contents = -1;
  int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return NULL;
  gboolean whole = read_all(file, head, HEAD);
  char *text = whole ? read_sound(file, key, type, head, &n) : NULL;
  if (text) {
    (void)utimensat(AT_FDCWD, path, NULL, 0); /* mark as recently used */
    *contents = file;
    return g_variant_ref_sink(
        g_variant_new_from_data(type, text, n, FALSE, g_free, text));
  }
  close(file);
  if (!whole || !memcmp(head, mark, MARK) ||
      strncmp(head, older, strlen(older)) != 0)
    store_complain(store, path, "was damaged and has been removed");
  (void)unlink(path);
  return NULL;
}

GVariant *opc_store_get(opc_store *store, const char *key,
                        const GVariantType *type) {
  int contents;
  GVariant *value = opc_store_get_files(store, key, type, &contents);
  if (contents >= 0) close(contents);
  return value;
}

gboolean opc_store_has(const opc_store *store, const char *key) {
  g_autofree char *path = path_of(store, key);
  return !access(path, R_OK);
}

/* ---- writing ---- */

static gboolean write_all(int file, const void *data, gsize n) {
  const char *at = data;
  while (n) {
    ssize_t done = write(file, at, n);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return FALSE;
    at += done;
    n -= (gsize)done;
  }
  return TRUE;
}

static gboolean write_part(int file, GChecksum *sum, const void *data,
                           gsize n) {
  g_checksum_update(sum, data, (gssize)n);
  return write_all(file, data, n);
}

/* Append the contents of a file. Return FALSE if the file has another size. */
static gboolean write_file(int file, GChecksum *sum, const char *path,
                           guint64 size) {
  char buffer[BUFFER];
  ssize_t n = 0;
  gboolean good = TRUE;
  int from = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  guint64 left = size;
  while (from >= 0 && good && (n = read(from, buffer, BUFFER)) > 0) {
    if ((guint64)n > left) break;
    good = write_part(file, sum, buffer, (gsize)n);
    left -= (guint64)n;
  }
  if (from >= 0) close(from);
  if (!good) return FALSE;
  errno = ENOENT; /* a changed file is no fault of the store */
  return from >= 0 && !n && !left;
}

/* Append the contents of all files. */
static gboolean write_files(int file, GChecksum *sum, GVariant *files,
                            const char *folder) {
  GVariantIter all;
  const char *name;
  guint64 size;
  gboolean good = TRUE;
  g_variant_iter_init(&all, files);
  while (good && g_variant_iter_next(&all, "(^&ayt)", &name, &size)) {
    g_autofree char *path = g_build_filename(folder, name, NULL);
    good = write_file(file, sum, path, size);
  }
  return good;
}

/* Write a value and files under a temporary name, locked during the write. The
   checksum is written last. */
static gboolean write_value(const char *fresh, int file, const char *path,
                            const char *key, GVariant *value, GVariant *files,
                            const char *from) {
  gsize n = g_variant_get_size(value);
  g_autoptr(GChecksum) sum = sum_new(key, g_variant_get_type_string(value));
  g_autofree char *head = g_strdup_printf("%s%*s", mark, SUM, ""),
                  *size = g_strdup_printf("%0*" G_GINT64_MODIFIER "x", SIZE,
                                          (guint64)n),
                  *folder = g_path_get_dirname(path);
  (void)flock(file, LOCK_EX | LOCK_NB);
  return write_all(file, head, MARK + SUM) &&
         write_part(file, sum, size, SIZE) &&
         write_part(file, sum, g_variant_get_data(value), n) &&
         (!files || write_files(file, sum, files, from)) &&
         lseek(file, MARK, SEEK_SET) >= 0 &&
         write_all(file, g_checksum_get_string(sum), SUM) &&
         !g_mkdir_with_parents(folder, 0700) && !rename(fresh, path);
}

static void store_trim(opc_store *store, guint64 most);

guint64 opc_store_most(const opc_store *store) { return store->limit / 4; }

gboolean opc_store_put_files(opc_store *store, const char *key, GVariant *given,
                             GVariant *files, const char *from) {
  g_autoptr(GVariant) value = g_variant_ref_sink(given);
  guint64 n = g_variant_get_size(value) + (files ? opc_files_bytes(files) : 0);
  if (n > opc_store_most(store)) return FALSE;
  g_autofree char *path = path_of(store, key);
  g_autofree char *folder = g_build_filename(store->folder, "new", NULL);
  g_autofree char *fresh = g_build_filename(folder, "XXXXXX", NULL);
  int file = g_mkdir_with_parents(folder, 0700)
                 ? -1
                 : g_mkstemp_full(fresh, O_WRONLY | O_CLOEXEC, 0600);
  gboolean good =
      file >= 0 && write_value(fresh, file, path, key, value, files, from);
  /* The file may be missing, because another process has cleared the store. */
  if (!good && errno != ENOENT && !store->reported) {
    store->reported = TRUE;
    store_complain(store, store->folder, g_strerror(errno));
  }
  if (!good && file >= 0) (void)unlink(fresh);
  if (file >= 0) close(file);
  store->written += good ? n : 0;
  if (store->written > store->limit / 10) store_trim(store, store->limit);
  return good;
}

gboolean opc_store_put(opc_store *store, const char *key, GVariant *value) {
  return opc_store_put_files(store, key, value, NULL, NULL);
}

void opc_store_drop(const opc_store *store, const char *key) {
  g_autofree char *path = path_of(store, key);
  (void)unlink(path);
}

/* ---- all values ---- */

typedef struct entry {
  char *path;
  guint64 bytes;
  gint64 used; /* ns */
} entry;

static void entry_clear(gpointer e) { g_free(((entry *)e)->path); }

static int take_entry(void *list, const char *path, const char *name,
                      const struct stat *about, opc_error *error) {
  (void)name, (void)error;
  const entry e = {g_strdup(path), (guint64)about->st_size,
                   about->st_mtim.tv_sec * G_GINT64_CONSTANT(1000000000) +
                       about->st_mtim.tv_nsec};
  if (S_ISREG(about->st_mode))
    g_array_append_val((GArray *)list, e);
  else
    g_free(e.path);
  return OPC_OK;
}

/* List all entries; other processes may remove entries at the same time. */
static GArray *list_entries(const opc_store *store) {
  g_autofree char *folder = g_build_filename(store->folder, "entries", NULL);
  GArray *list = g_array_new(FALSE, FALSE, sizeof(entry));
  opc_error none;
  g_array_set_clear_func(list, entry_clear);
  (void)opc_traverse(folder, take_entry, list, &none);
  return list;
}

static gint by_use(gconstpointer a, gconstpointer b) {
  gint64 s = ((const entry *)a)->used, t = ((const entry *)b)->used;
  return (s > t) - (s < t);
}

/* Remove unfinished files of killed writers. */
static void remove_remains(const opc_store *store) {
  g_autofree char *folder = g_build_filename(store->folder, "new", NULL);
  GDir *dir = g_dir_open(folder, 0, NULL);
  for (const char *name; dir && (name = g_dir_read_name(dir));) {
    g_autofree char *path = g_build_filename(folder, name, NULL);
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) continue;
    if (!flock(file, LOCK_EX | LOCK_NB)) (void)unlink(path);
    close(file);
  }
  if (dir) g_dir_close(dir);
}

/* If the values have more than `most` bytes, remove the least recently used
   values until 90 % of `most` remain, so that trimming is rarely needed. One
   process at a time trims. */
static void store_trim(opc_store *store, guint64 most) {
  g_autofree char *path = g_build_filename(store->folder, "lock", NULL);
  int lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  store->written = 0;
  if (lock >= 0 && !flock(lock, LOCK_EX | LOCK_NB)) {
    guint64 bytes = 0;
    g_autoptr(GArray) list = list_entries(store);
    remove_remains(store);
    for (guint i = 0; i < list->len; i++)
      bytes += g_array_index(list, entry, i).bytes;
    if (bytes > most) {
      g_array_sort(list, by_use);
      for (guint i = 0; i < list->len && bytes > most - most / 10; i++) {
        const entry *e = &g_array_index(list, entry, i);
        if (!unlink(e->path)) bytes -= e->bytes;
      }
    }
  }
  if (lock >= 0) close(lock);
}

void opc_store_close(opc_store *store) {
  if (!store) return;
  opc_sums_clear(store);
  if (store->written) store_trim(store, store->limit);
  if (store->claims >= 0) close(store->claims);
  g_free(store->complaint);
  g_free(store->folder);
  g_free(store);
}

opc_store_size opc_store_measure(const opc_store *store) {
  opc_store_size size = {.limit = store->limit};
  g_autoptr(GArray) list = list_entries(store);
  size.entries = list->len;
  for (guint i = 0; i < list->len; i++)
    size.bytes += g_array_index(list, entry, i).bytes;
  return size;
}

gboolean opc_store_clear(opc_store *store, opc_error *error) {
  g_autoptr(GArray) list = list_entries(store);
  remove_remains(store);
  for (guint i = 0; i < list->len; i++) {
    const char *path = g_array_index(list, entry, i).path;
    if (unlink(path) && errno != ENOENT) {
      opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(errno));
      return FALSE;
    }
  }
  return TRUE;
}

gboolean opc_store_set_limit(opc_store *store, guint64 bytes,
                             opc_error *error) {
  g_autofree char *path = g_build_filename(store->folder, "limit", NULL);
  g_autofree char *text = g_strdup_printf("%" G_GUINT64_FORMAT "\n", bytes);
  if (opc_write_file(path, text, error)) return FALSE;
  store->limit = bytes;
  store_trim(store, bytes);
  return TRUE;
}
