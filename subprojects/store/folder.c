/* SPDX-License-Identifier: BSD-3-Clause */
/* Slots of runs, their locks, and the renaming of a finished run. */
#include <store/folder.h>

#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <store/contents.h>
#include <store/files.h>

/* ---- state ---- */

enum {
  MOST_RUNS = 100000,
  MOST_SLOTS = 1000, /* simultaneous runs of one name */
  MOST_TRIES = 100   /* attempts to lock a slot that another process removes */
};

static gboolean is_there(const char *path) {
  struct stat about;
  return !lstat(path, &about);
}

static opc_folder *name_slot(const char *slot) {
  opc_folder *f = g_new0(opc_folder, 1);
  f->slot = g_strdup(slot);
  f->lock = g_build_filename(slot, "lock", NULL);
  f->work = g_build_filename(slot, "run", NULL);
  f->old = g_build_filename(slot, "old", NULL);
  f->locked = -1;
  return f;
}

static void free_names(opc_folder *f) {
  if (f->locked >= 0) close(f->locked);
  g_free(f->slot);
  g_free(f->lock);
  g_free(f->work);
  g_free(f->old);
  g_free(f);
}

/* ---- replaceable folders ---- */

int opc_folder_allowed(const char *target, gboolean force, opc_error *error) {
  struct stat about;
  if (lstat(target, &about)) return OPC_OK;
  if (S_ISLNK(about.st_mode)) {
    g_autofree char *to = g_file_read_link(target, NULL);
    return opc_fail(
        error, OPC_IO, NULL,
        "'%s' is not replaced, because the name is a symbolic link to '%s'",
        target, to ? to : "?");
  }
  if (!S_ISDIR(about.st_mode))
    return opc_fail(error, OPC_IO, NULL, "'%s' is a file, expected a folder",
                    target);
  if (!force)
    return opc_fail(error, OPC_IO, NULL,
                    "'%s' already exists: use --force to replace the folder",
                    target);
  return opc_contents_check(target, error);
}

/* ---- slots ---- */

/* Return whether `path` is still the name of the open file. */
static gboolean is_same(int file, const char *path) {
  struct stat its, named;
  return !fstat(file, &its) && !lstat(path, &named) &&
         its.st_ino == named.st_ino && its.st_dev == named.st_dev;
}

/* Return whether the file system has no locks. The lock file of a slot then has
   the effect of a lock until the slot is removed. */
static gboolean cannot_lock(int why) {
  return why == ENOLCK || why == EOPNOTSUPP || why == ENOSYS;
}

/* Create a slot unless the slot exists, and lock the slot. On failure, return
   FALSE and set errno: EWOULDBLOCK if another process uses the slot. */
static gboolean lock_slot(opc_folder *f) {
  for (int i = 0; i < MOST_TRIES; i++) {
    gboolean made = !g_mkdir(f->slot, 0777);
    struct stat about;
    if (!made && errno != EEXIST) return FALSE;
    if (!made && !lstat(f->slot, &about) && !S_ISDIR(about.st_mode)) {
      errno = ENOTDIR;
      return FALSE;
    }
    int file = open(f->lock, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file < 0 && errno == ENOENT) continue;
    if (file < 0) return FALSE;
    gboolean locked = !flock(file, LOCK_EX | LOCK_NB);
    int why = errno;
    if ((locked || (made && cannot_lock(why))) && is_same(file, f->lock)) {
      f->locked = file;
      return TRUE;
    }
    close(file);
    errno = cannot_lock(why) ? EWOULDBLOCK : why;
    if (!locked) return FALSE;
  }
  return FALSE;
}

/* Remove the remains of a killed run. An earlier run that the killed run was
   replacing is restored. */
static void clear_slot(const opc_folder *f, const char *target) {
  if (is_there(f->old) && !is_there(target)) (void)rename(f->old, target);
  opc_remove_tree(f->work);
  opc_remove_tree(f->old);
}

/* The lock is released last, because other processes may then use the slot. */
void opc_folder_free(opc_folder *f) {
  if (!f) return;
  if (!f->kept) {
    opc_remove_tree(f->work);
    opc_remove_tree(f->old);
    unlink(f->lock);
    rmdir(f->slot);
  }
  free_names(f);
}

/* Remove all slots of the target that no process uses, except the slot of this
   process. */
static void clear_others(const opc_folder *own, const char *parent,
                         const char *start, const char *target) {
  GDir *dir = g_dir_open(parent, 0, NULL);
  const char *name;
  while (dir && (name = g_dir_read_name(dir))) {
    if (!g_str_has_prefix(name, start)) continue;
    const char *number = name + strlen(start);
    if (!*number || strspn(number, "0123456789") < strlen(number)) continue;
    g_autofree char *path = g_build_filename(parent, name, NULL);
    if (!strcmp(path, own->slot)) continue;
    opc_folder *other = name_slot(path);
    if (lock_slot(other)) {
      clear_slot(other, target);
      opc_folder_free(other);
    } else {
      free_names(other);
    }
  }
  if (dir) g_dir_close(dir);
}

/* Return the first slot that no other process uses. NULL and *error on
   failure. */
static opc_folder *find_slot(const char *target, const char *parent,
                             const char *start, gboolean sole,
                             opc_error *error) {
  for (int i = 1; i <= MOST_SLOTS; i++) {
    g_autofree char *name = g_strdup_printf("%s%d", start, i);
    g_autofree char *path = g_build_filename(parent, name, NULL);
    opc_folder *f = name_slot(path);
    if (lock_slot(f)) return f;
    int why = errno;
    free_names(f);
    if (why != EWOULDBLOCK) {
      opc_fail(error, OPC_IO, NULL, "'%s' cannot be created in '%s': %s",
               target, parent, g_strerror(why));
      return NULL;
    }
    if (sole) {
      opc_fail(error, OPC_IO, NULL,
               "'%s': another run is writing this folder, in '%s'", target,
               path);
      return NULL;
    }
  }
  opc_fail(error, OPC_IO, NULL, "'%s': %d runs of this name are active", target,
           MOST_SLOTS);
  return NULL;
}

opc_folder *opc_folder_open(const char *target, gboolean sole,
                            opc_error *error) {
  g_autofree char *parent = g_path_get_dirname(target);
  g_autofree char *base = g_path_get_basename(target);
  g_autofree char *start = g_strdup_printf(".%s.opcflow-", base);
  if (!*target || !strcmp(base, ".") || !strcmp(base, "..") ||
      strchr(base, '/')) {
    opc_fail(error, OPC_INVALID, NULL,
             "'%s' does not end in the name of a run folder", target);
    return NULL;
  }
  if (g_mkdir_with_parents(parent, 0777)) {
    opc_fail(error, OPC_IO, NULL, "'%s' cannot be created: %s", parent,
             g_strerror(errno));
    return NULL;
  }
  opc_folder *f = find_slot(target, parent, start, sole, error);
  if (!f) return NULL;
  clear_slot(f, target);
  clear_others(f, parent, start, target);
  if (!g_mkdir(f->work, 0777)) return f;
  opc_fail(error, OPC_IO, NULL, "'%s': %s", f->work, g_strerror(errno));
  opc_folder_free(f);
  return NULL;
}

/* ---- names ---- */

/* Rename a folder without replacing another folder. Without RENAME_NOREPLACE,
   reserve the name by an empty folder, which rename() may replace. */
static int folder_move(const char *from, const char *to) {
  if (!renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE)) return 0;
  if (errno != EINVAL && errno != ENOSYS) return -1;
  if (mkdir(to, 0777)) return -1;
  if (!rename(from, to)) return 0;
  int why = errno;
  rmdir(to);
  errno = why;
  return -1;
}

/* Exchange the run and the earlier run. Without an atomic exchange, the earlier
   run is first renamed; clear_slot restores that run if this process is killed
   before the second renaming. */
static int folder_exchange(const opc_folder *f, const char *target) {
  if (!renameat2(AT_FDCWD, f->work, AT_FDCWD, target, RENAME_EXCHANGE))
    return 0;
  if (errno != EINVAL && errno != ENOSYS) return -1;
  if (rename(target, f->old)) return -1;
  if (!rename(f->work, target)) return 0;
  int why = errno;
  (void)rename(f->old, target);
  errno = why;
  return -1;
}

static int replace_run(const opc_folder *f, const char *target,
                       opc_error *error) {
  int code = opc_folder_allowed(target, TRUE, error);
  if (code) return code;
  if (!folder_exchange(f, target)) return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "'%s' cannot be replaced: %s", target,
                  g_strerror(errno));
}

/* Rename to the first free name; otherwise the run stays in `work`. */
static int find_name(opc_folder *f, const char *target, gboolean number,
                     char **got, opc_error *error) {
  int code = OPC_OK;
  for (int i = 1; i < MOST_RUNS; i++) {
    g_autofree char *name =
        i == 1 ? g_strdup(target) : g_strdup_printf("%s-%d", target, i);
    if (!folder_move(f->work, name)) {
      *got = g_steal_pointer(&name);
      return code;
    }
    if (errno != EEXIST) break;
    if (!number && !code)
      code = opc_fail(
          error, OPC_IO, NULL,
          "'%s' is not replaced, because the folder was created during the run",
          target);
  }
  f->kept = TRUE;
  *got = g_strdup(f->work);
  return opc_fail(error, OPC_IO, NULL, "'%s': %s", target, g_strerror(errno));
}

int opc_folder_close(opc_folder *f, const char *target, gboolean replace,
                     gboolean number, char **got, opc_error *error) {
  opc_error second;
  int code = OPC_OK;
  *got = NULL;
  if (replace && is_there(target)) {
    code = replace_run(f, target, error);
    if (!code) *got = g_strdup(target);
  }
  /* If the earlier run cannot be replaced, the run receives a number. The
     reported error is that of the replacement. */
  if (code)
    (void)find_name(f, target, TRUE, got, &second);
  else if (!*got)
    code = find_name(f, target, number, got, error);
  g_autofree char *parent = g_path_get_dirname(target);
  return code ? code : opc_sync(parent, error);
}
