/* SPDX-License-Identifier: BSD-3-Clause */
/* Checksums of files, cached with the attributes that indicate a change, and
   checksums of shared objects with the objects that they need. */
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <linux/magic.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <store/files.h>
#include "private.h"

/* Age, ns, below which the checksum of a file is not cached: a second change
   might leave the times equal. File systems have clock steps of 4 ms in most
   cases and up to 2 s (FAT). */
static const gint64 step = G_GINT64_CONSTANT(2000000000);

/* Number of checksums above which the cache is cleared. A sweep may write a
   file under many names. */
enum { MOST_SUMS = 10000 };

static const char kept_under[] = "00sums-flushed";
#define KEPT_TYPE G_VARIANT_TYPE("a(sttxxxs)")

typedef struct opc_sum {
  guint64 device, inode;
  gint64 size, modified, changed; /* bytes, ns, ns */
  gboolean settled;               /* a later change is visible in the times */
  char *sum;
} opc_sum;

/* ---- state ---- */

static void sum_free(gpointer item) {
  opc_sum *s = item;
  g_free(s->sum);
  g_free(s);
}

void opc_sums_init(opc_store *store) {
  store->sums =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, sum_free);
}

static void read_kept(opc_store *store) {
  store->sums_read = TRUE;
  g_autoptr(GVariant) kept = opc_store_get(store, kept_under, KEPT_TYPE);
  if (!kept) return;
  GVariantIter all;
  const char *path, *sum;
  opc_sum s = {.settled = TRUE};
  g_variant_iter_init(&all, kept);
  while (g_variant_iter_next(&all, "(&sttxxx&s)", &path, &s.device, &s.inode,
                             &s.size, &s.modified, &s.changed, &sum)) {
    opc_sum *own = g_memdup2(&s, sizeof s);
    own->sum = g_strdup(sum);
    g_hash_table_insert(store->sums, g_strdup(path), own);
  }
}

static void sums_keep(opc_store *store) {
  GVariantBuilder all;
  GHashTableIter each;
  gpointer path, item;
  g_variant_builder_init(&all, KEPT_TYPE);
  g_hash_table_iter_init(&each, store->sums);
  while (g_hash_table_iter_next(&each, &path, &item)) {
    const opc_sum *s = item;
    if (s->settled && g_utf8_validate(path, -1, NULL))
      g_variant_builder_add(&all, "(sttxxxs)", (char *)path, s->device,
                            s->inode, s->size, s->modified, s->changed, s->sum);
  }
  (void)opc_store_put(store, kept_under, g_variant_builder_end(&all));
}

void opc_sums_clear(opc_store *store) {
  if (store->sums_new) sums_keep(store);
  g_hash_table_destroy(store->sums);
}

/* ---- files ---- */

static gint64 nanoseconds(const struct timespec *t) {
  return t->tv_sec * G_GINT64_CONSTANT(1000000000) + t->tv_nsec;
}

/* Return the time at which the system started, ns. */
static gint64 boot_time(void) {
  struct timespec now, up;
  clock_gettime(CLOCK_REALTIME, &now);
  clock_gettime(CLOCK_BOOTTIME, &up);
  return nanoseconds(&now) - nanoseconds(&up);
}

/* Return whether the file system sets the times of a file when a process writes
   to a clean page of a shared mapping. Other file systems do not (tmpfs,
   hugetlbfs), are unknown, or consist of several file systems (overlayfs). */
static gboolean has_times_of_mappings(int file) {
  static const unsigned long known[] = {EXT4_SUPER_MAGIC, XFS_SUPER_MAGIC,
                                        BTRFS_SUPER_MAGIC, F2FS_SUPER_MAGIC,
                                        NFS_SUPER_MAGIC};
  struct statfs about;
  if (fstatfs(file, &about)) return FALSE;
  for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
    if ((unsigned long)about.f_type == known[i]) return TRUE;
  return FALSE;
}

/* Get the attributes of a file after its changed pages were written to the
   disk. A later write through a shared mapping then sets the times; a write to
   a page that is already marked as changed would not. *timed receives whether
   the times indicate each change. Return FALSE if the file cannot be opened. */
static gboolean read_attributes(const char *path, struct stat *about,
                                gboolean *timed) {
  enum {
    FLUSH = SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE |
            SYNC_FILE_RANGE_WAIT_AFTER
  };
  int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return FALSE;
  gboolean flushed = !sync_file_range(file, 0, 0, FLUSH);
  gboolean good = !fstat(file, about);
  /* A restart of the system ends all mappings. A file that did not change since
     then has no mapping with older writes. */
  *timed = good && (nanoseconds(&about->st_ctim) < boot_time() - step ||
                    (flushed && has_times_of_mappings(file)));
  close(file);
  return good;
}

static gboolean is_of(const opc_sum *s, const struct stat *about) {
  return s->device == about->st_dev && s->inode == about->st_ino &&
         s->size == about->st_size &&
         s->modified == nanoseconds(&about->st_mtim) &&
         s->changed == nanoseconds(&about->st_ctim);
}

static char *read_sum(opc_store *store, const char *path,
                      const struct stat *about, gboolean timed,
                      const opc_context *context, opc_error *error) {
  gint64 now = g_get_real_time() * 1000;
  char *sum = opc_file_sha256(path, context, error);
  if (!sum) return NULL;
  if (g_hash_table_size(store->sums) >= MOST_SUMS)
    g_hash_table_remove_all(store->sums);
  opc_sum *s = g_new(opc_sum, 1);
  *s = (opc_sum){about->st_dev,
                 about->st_ino,
                 about->st_size,
                 nanoseconds(&about->st_mtim),
                 nanoseconds(&about->st_ctim),
                 .sum = g_strdup(sum)};
  s->settled = timed && s->changed < now - step && s->modified < now - step;
  store->sums_new |= s->settled;
  g_hash_table_insert(store->sums, g_strdup(path), s);
  return sum;
}

char *opc_store_sum(opc_store *store, const char *path,
                    const opc_context *context, opc_error *error) {
  struct stat about;
  gboolean timed;
  if (!store || !read_attributes(path, &about, &timed))
    return opc_file_sha256(path, context, error);
  if (!store->sums_read) read_kept(store);
  const opc_sum *s = g_hash_table_lookup(store->sums, path);
  return s && s->settled && timed && is_of(s, &about)
             ? g_strdup(s->sum)
             : read_sum(store, path, &about, timed, context, error);
}

gboolean opc_store_same(opc_store *store, const char *path, const char *sum) {
  struct stat about;
  gboolean timed;
  opc_error none;
  const opc_sum *s = g_hash_table_lookup(store->sums, path);
  /* An equal checksum does not suffice: the file may have changed, been read,
     and changed back. */
  if (s && (!read_attributes(path, &about, &timed) || !is_of(s, &about)))
    return FALSE;
  g_autofree char *now = opc_store_sum(store, path, NULL, &none);
  return now && !strcmp(now, sum);
}

/* ---- shared objects ---- */

static struct link_map *find_object(struct link_map *any, const char *name) {
  while (any->l_prev) any = any->l_prev;
  while (any && strcmp(basename(any->l_name), name)) any = any->l_next;
  return any;
}

/* Add an object and all objects that it needs, in the order in which the
   objects name them. Return FALSE if an object is not found. */
static gboolean add_object(GPtrArray *all, struct link_map *object) {
  const char *names = NULL;
  gboolean good = TRUE;
  if (g_ptr_array_find(all, object, NULL)) return TRUE;
  g_ptr_array_add(all, object);
  for (const ElfW(Dyn) *d = object->l_ld; d->d_tag != DT_NULL; d++)
    if (d->d_tag == DT_STRTAB) names = (const char *)d->d_un.d_ptr;
  if (!names) return TRUE;
  for (const ElfW(Dyn) *d = object->l_ld; good && d->d_tag != DT_NULL; d++) {
    if (d->d_tag != DT_NEEDED) continue;
    struct link_map *other = find_object(object, names + d->d_un.d_val);
    good = other && add_object(all, other);
  }
  return good;
}

/* Return the object that contains `address`; the program for NULL. */
static struct link_map *object_of(const void *address) {
  Dl_info about;
  struct link_map *map = NULL;
  if (address)
    return dladdr1(address, &about, (void **)&map, RTLD_DL_LINKMAP) ? map
                                                                    : NULL;
  for (map = _r_debug.r_map; map && map->l_prev; map = map->l_prev) continue;
  return map;
}

/* A loaded object does not change: the checksum is valid for the process. */
static const char *sum_object(opc_store *store, const struct link_map *object) {
  static GHashTable *known; /* path -> checksum */
  const char *path = *object->l_name ? object->l_name : "/proc/self/exe";
  if (!known) known = g_hash_table_new(g_str_hash, g_str_equal);
  char *sum = g_hash_table_lookup(known, path);
  opc_error none;
  if (!sum && (sum = opc_store_sum(store, path, NULL, &none)))
    g_hash_table_insert(known, g_strdup(path), sum);
  return sum;
}

static char *sum_objects(opc_store *store, const void *address) {
  g_autoptr(GPtrArray) all = g_ptr_array_new();
  g_autoptr(GChecksum) whole = g_checksum_new(G_CHECKSUM_SHA256);
  struct link_map *first = object_of(address);
  if (!first || !add_object(all, first)) return NULL;
  for (guint i = 0; i < all->len; i++) {
    const char *sum = sum_object(store, all->pdata[i]);
    if (!sum) return NULL;
    g_checksum_update(whole, (const guchar *)sum, -1);
  }
  return g_strdup(g_checksum_get_string(whole));
}

const char *opc_store_build(opc_store *store, const void *address) {
  static GHashTable *known; /* address -> checksum */
  gpointer sum;
  if (!known) known = g_hash_table_new(NULL, NULL);
  if (!g_hash_table_lookup_extended(known, address, NULL, &sum)) {
    sum = sum_objects(store, address);
    g_hash_table_insert(known, (gpointer)address, sum);
  }
  return sum;
}
