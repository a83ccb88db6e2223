/* SPDX-License-Identifier: BSD-3-Clause */
/* The store: values and files are returned unchanged, damage of any byte is
   detected, recently used values stay, claims exclude other processes, and
   checksums of files are correct. Facts are compared with earlier facts. */
#include <store/store.h>

#include <fcntl.h>
#include <glib/gstdio.h>
#include <signal.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <store/facts.h>
#include <store/files.h>
#include <store/pack.h>

static char *folder;

static opc_store *open_store(void) {
  opc_error error;
  opc_store *store = opc_store_open(&error);
  g_assert_nonnull(store);
  return store;
}

static GVariant *bytes(gsize n, int with) {
  g_autofree char *data = g_malloc(MAX(n, 1));
  memset(data, with, n);
  return g_variant_new_fixed_array(G_VARIANT_TYPE_BYTE, data, n, 1);
}

static GVariant *store_get(opc_store *store, const char *key) {
  return opc_store_get(store, key, G_VARIANT_TYPE_BYTESTRING);
}

static gboolean store_has(opc_store *store, const char *key) {
  g_autoptr(GVariant) value = store_get(store, key);
  return value != NULL;
}

static char *path_of(const char *key) {
  g_autofree char *first = g_strndup(key, 2);
  return g_build_filename(folder, "entries", first, key + 2, NULL);
}

/* ---- values ---- */

static void test_values(void) {
  opc_store *store = open_store();
  g_assert_false(store_has(store, "ab12.x"));
  g_assert_true(opc_store_put(store, "ab12.x", bytes(1000, 7)));
  opc_store_close(store);
  store = open_store();
  g_autoptr(GVariant) value = store_get(store, "ab12.x");
  g_autoptr(GVariant) same = g_variant_ref_sink(bytes(1000, 7));
  g_assert_true(g_variant_equal(value, same));
  g_assert_true(opc_store_put(store, "ab12.x", bytes(0, 0)));
  g_autoptr(GVariant) other = store_get(store, "ab12.x");
  g_assert_cmpuint(g_variant_get_size(other), ==, 0);
  g_assert_cmpuint(opc_store_measure(store).entries, ==, 1);
  opc_store_close(store);
}

/* Damage every byte, and truncate to every length. */
static void test_damage(void) {
  opc_store *store = open_store();
  g_autofree char *path = path_of("cd34.x"), *sound = NULL;
  gsize n;
  g_assert_true(opc_store_put(store, "cd34.x", bytes(20, 3)));
  g_assert_true(g_file_get_contents(path, &sound, &n, NULL));
  for (gsize i = 0; i < 2 * n; i++) {
    g_autofree char *bad = g_memdup2(sound, n);
    if (i < n) bad[i] ^= 1;
    g_assert_true(
        g_file_set_contents(path, bad, (gssize)(i < n ? n : i - n), NULL));
    g_assert_false(store_has(store, "cd34.x"));
    /* Bytes 14 and 15 are the digit of the format and the line end; another
       format is not reported as damage. */
    g_autofree char *complaint = opc_store_complaint(store);
    g_assert_cmpint(complaint && strstr(complaint, "damaged"), ==,
                    i != 14 && i != 15);
    g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
    g_assert_null(opc_store_complaint(store));
  }
  opc_store_close(store);
}

/* An intact entry under the name of another key, or read as another type,
   counts as damaged. */
static void test_exchanged(void) {
  opc_store *store = open_store();
  g_autofree char *from = path_of("cd34.x"), *to = path_of("cd35.x");
  g_assert_true(opc_store_put(store, "cd34.x", bytes(20, 3)));
  g_assert_cmpint(rename(from, to), ==, 0);
  g_assert_false(store_has(store, "cd35.x"));
  g_autofree char *complaint = opc_store_complaint(store);
  g_assert_nonnull(strstr(complaint, "damaged"));
  g_assert_true(opc_store_put(store, "cd34.x", bytes(20, 3)));
  g_assert_null(opc_store_get(store, "cd34.x", G_VARIANT_TYPE_DOUBLE));
  g_assert_false(g_file_test(from, G_FILE_TEST_EXISTS));
  opc_store_close(store);
}

/* ---- limits ---- */

static void test_limit(void) {
  opc_store *store = open_store();
  opc_error error;
  g_assert_true(opc_store_clear(store, &error));
  g_assert_true(opc_store_set_limit(store, 100000, &error));
  for (int i = 0; i < 30; i++) {
    g_autofree char *key = g_strdup_printf("%02d.x", i);
    g_assert_true(opc_store_put(store, key, bytes(10000, i)));
    g_assert_true(store_has(store, "00.x")); /* used repeatedly */
    g_usleep(2000);
  }
  const opc_store_size size = opc_store_measure(store);
  g_assert_cmpuint(size.bytes, <=, 110000);
  g_assert_cmpuint(size.entries, >, 5);
  g_assert_true(store_has(store, "29.x"));
  g_assert_false(store_has(store, "01.x"));
  g_assert_false(opc_store_put(store, "ee.x", bytes(25001, 1)));
  opc_store_close(store);
  store = open_store(); /* the limit is stored, too */
  g_assert_cmpuint(opc_store_measure(store).limit, ==, 100000);
  g_assert_true(opc_store_clear(store, &error));
  g_assert_cmpuint(opc_store_measure(store).entries, ==, 0);
  g_assert_true(opc_store_set_limit(store, OPC_STORE_LIMIT, &error));
  opc_store_close(store);
}

static void test_sizes(void) {
  static const struct {
    const char *text;
    guint64 bytes;
  } good[] = {{"0", 0},
              {"12", 12},
              {"5 GB", 5000000000},
              {"1.5MB", 1500000},
              {"2 kB", 2000}};
  static const char *const bad[] = {"",     "GB",  "-1 GB", "5 gb",
                                    "1e30", "nan", "5 GB "};
  guint64 n;
  for (size_t i = 0; i < G_N_ELEMENTS(good); i++) {
    g_assert_true(opc_store_read_size(good[i].text, &n));
    g_assert_cmpuint(n, ==, good[i].bytes);
  }
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++)
    g_assert_false(opc_store_read_size(bad[i], &n));
}

/* Unfinished files of a killed process are removed; those of a live process
   stay. */
static void test_remains(void) {
  opc_store *store = open_store();
  opc_error error;
  g_autofree char *dead = g_build_filename(folder, "new", "dead", NULL);
  g_autofree char *live = g_build_filename(folder, "new", "live", NULL);
  g_assert_true(g_file_set_contents(dead, "x", 1, NULL));
  g_assert_true(g_file_set_contents(live, "x", 1, NULL));
  int file = open(live, O_RDWR | O_CLOEXEC);
  g_assert_cmpint(flock(file, LOCK_EX), ==, 0);
  g_assert_true(opc_store_clear(store, &error));
  g_assert_false(g_file_test(dead, G_FILE_TEST_EXISTS));
  g_assert_true(g_file_test(live, G_FILE_TEST_EXISTS));
  close(file);
  g_assert_true(opc_store_clear(store, &error));
  g_assert_false(g_file_test(live, G_FILE_TEST_EXISTS));
  opc_store_close(store);
}

/* A folder with other files, or with a linked subfolder, is not accepted as a
   store; all files stay. */
static void test_foreign(void) {
  g_autofree char *other = g_build_filename(folder, "other", NULL);
  g_autofree char *fresh = g_build_filename(other, "new", NULL);
  g_autofree char *file = g_build_filename(fresh, "file", NULL);
  g_autofree char *empty = g_build_filename(folder, "empty", NULL);
  g_autofree char *link = g_build_filename(empty, "new", NULL);
  opc_error error;
  g_assert_cmpint(g_mkdir_with_parents(fresh, 0700), ==, 0);
  g_assert_true(g_file_set_contents(file, "x", 1, NULL));
  g_setenv("OPCFLOW_STORE", other, TRUE);
  g_assert_null(opc_store_open(&error));
  g_assert_nonnull(strstr(error.message, "'opcflow-store'"));
  g_setenv("OPCFLOW_STORE", empty, TRUE);
  opc_store_close(open_store());
  g_assert_cmpint(symlink(fresh, link), ==, 0);
  g_assert_null(opc_store_open(&error));
  g_assert_nonnull(strstr(error.message, "is a symbolic link"));
  g_assert_true(g_file_test(file, G_FILE_TEST_EXISTS));
  g_setenv("OPCFLOW_STORE", folder, TRUE);
}

/* ---- files ---- */

/* Write a file of n bytes with period 251 in the folder "files". */
static void file_fill(const char *name, gsize n) {
  g_autofree char *path = g_build_filename(folder, "files", name, NULL),
                  *parent = g_path_get_dirname(path), *text = g_malloc(n + 1);
  for (gsize i = 0; i < n; i++) text[i] = (char)(i % 251);
  g_assert_cmpint(g_mkdir_with_parents(parent, 0700), ==, 0);
  g_assert_true(g_file_set_contents(path, text, (gssize)n, NULL));
}

static const char *const names[] = {"a", "in/b", "in/c", "d"};

static gboolean put_listed(opc_store *store, GVariant *files) {
  g_autofree char *from = g_build_filename(folder, "files", NULL);
  return opc_store_put_files(store, "ab99.x", files, files, from);
}

static GVariant *list_files(void) {
  g_autofree char *from = g_build_filename(folder, "files", NULL);
  return g_variant_ref_sink(opc_files_list(from));
}

/* Files of all sizes around the buffer are returned unchanged, even if another
   process removes the entry; a damaged byte of a file is detected. */
static void test_files(void) {
  static const gsize sizes[] = {0, 65536, 200001, 1};
  opc_store *store = open_store();
  opc_error error;
  g_autofree char *to = g_build_filename(folder, "to", NULL),
                  *entry = path_of("ab99.x"), *sound = NULL;
  gsize n;
  int contents;
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
    file_fill(names[i], sizes[i]);
  g_autoptr(GVariant) files = list_files();
  g_assert_cmpuint(opc_files_bytes(files), ==, 265538);
  g_assert_true(put_listed(store, files));
  g_assert_true(g_file_get_contents(entry, &sound, &n, NULL));
  g_autoptr(GVariant) kept =
      opc_store_get_files(store, "ab99.x", OPC_FILES_TYPE, &contents);
  g_assert_true(g_variant_equal(kept, files));
  opc_store_drop(store, "ab99.x");
  if (opc_files_unpack(kept, contents, to, &error))
    g_error("%s", error.message);
  close(contents);
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++) {
    g_autofree char *one = g_build_filename(folder, "files", names[i], NULL),
                    *two = g_build_filename(to, names[i], NULL),
                    *want = opc_file_sha256(one, NULL, &error),
                    *got = opc_file_sha256(two, NULL, &error);
    g_assert_cmpstr(got, ==, want);
  }
  sound[n - 100000] ^= 1;
  g_assert_true(g_file_set_contents(entry, sound, (gssize)n, NULL));
  g_assert_null(
      opc_store_get_files(store, "ab99.x", OPC_FILES_TYPE, &contents));
  g_assert_cmpint(contents, ==, -1);
  opc_store_close(store);
}

/* A file that changed after it was listed is not stored, without a
   complaint. */
static void test_changed_files(void) {
  opc_store *store = open_store();
  for (gsize size = 69999; size <= 70001; size++) {
    file_fill("d", 70000);
    g_autoptr(GVariant) files = list_files();
    file_fill("d", size);
    g_assert_cmpint(put_listed(store, files), ==, size == 70000);
    g_assert_null(opc_store_complaint(store));
    g_assert_cmpint(opc_store_has(store, "ab99.x"), ==, size == 70000);
    opc_store_drop(store, "ab99.x");
  }
  opc_store_close(store);
}

/* Return the largest memory of this process so far, bytes. */
static glong peak(void) {
  struct rusage used;
  g_assert_cmpint(getrusage(RUSAGE_SELF, &used), ==, 0);
  return used.ru_maxrss * 1024;
}

/* A file is stored, read and written without a copy in memory; too large files
   are not read. */
static void test_large_files(void) {
  enum { LARGE = 1 << 27 };
  opc_store *store = open_store();
  opc_error error;
  int contents;
  g_autofree char *path = g_build_filename(folder, "files", "d", NULL),
                  *to = g_build_filename(folder, "to", NULL);
  glong before = peak();
  g_assert_cmpint(before, <, LARGE);
  file_fill("d", 0);
  g_assert_cmpint(truncate(path, LARGE), ==, 0);
  g_autoptr(GVariant) files = list_files();
  g_assert_true(put_listed(store, files));
  g_autoptr(GVariant) kept =
      opc_store_get_files(store, "ab99.x", OPC_FILES_TYPE, &contents);
  g_assert_false(opc_files_unpack(kept, contents, to, &error));
  close(contents);
  g_assert_cmpint(peak() - before, <, LARGE / 8);
  g_assert_true(opc_store_set_limit(store, 4 * (guint64)LARGE, &error));
  g_assert_false(put_listed(store, files));
  g_assert_true(opc_store_set_limit(store, OPC_STORE_LIMIT, &error));
  g_assert_true(opc_store_clear(store, &error));
  g_assert_cmpint(truncate(path, 1), ==, 0);
  opc_store_close(store);
}

/* An entry in an earlier format is removed without a complaint. */
static void test_older(void) {
  opc_store *store = open_store();
  g_autofree char *path = path_of("ab12.x"),
                  *text = g_strdup_printf("opcflow store 1\n%0100d", 0);
  g_assert_true(opc_store_put(store, "ab12.x", bytes(1, 1)));
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  g_assert_false(store_has(store, "ab12.x"));
  g_assert_null(opc_store_complaint(store));
  g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
  opc_store_close(store);
}

/* ---- sums ---- */

static void write_at(const char *path, const char *text, time_t when) {
  const struct timespec times[] = {{when, 0}, {when, 0}};
  int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  g_assert_cmpint(write(file, text, strlen(text)), ==, (ssize_t)strlen(text));
  close(file);
  g_assert_cmpint(utimensat(AT_FDCWD, path, times, 0), ==, 0);
}

/* A change of a file is detected even if size and time stay equal. */
static void test_sums(void) {
  opc_store *store = open_store();
  opc_error error;
  g_autofree char *path = g_build_filename(folder, "in", NULL);
  for (int i = 0; i < 50; i++) {
    /* the last texts are longer than one buffer */
    g_autofree char *text =
        g_strdup_printf("%0*d", i < 40 ? 6 : 21000 * (i - 39), i);
    g_autofree char *truth =
        g_compute_checksum_for_string(G_CHECKSUM_SHA256, text, -1);
    write_at(path, text, 1000000000);
    g_autofree char *sum = opc_store_sum(store, path, NULL, &error);
    g_assert_cmpstr(sum, ==, truth);
    g_assert_true(opc_store_same(store, path, sum));
    text[0] = 'o';
    write_at(path, text, 1000000000);
    g_assert_false(opc_store_same(store, path, sum));
  }
  g_assert_null(opc_store_sum(store, "/nowhere/at/all", NULL, &error));
  opc_store_close(store);
  /* Checksums of recently changed files are not cached. */
  store = open_store();
  g_assert_false(store_has(store, "00sums-flushed"));
  opc_store_close(store);
}

/* Write a byte of a shared mapping and check that the checksum changes. */
static void change_mapped(opc_store *store, const char *path, char *bytes) {
  opc_error error;
  g_autofree char *before = opc_store_sum(store, path, NULL, &error);
  g_assert_true(opc_store_same(store, path, before));
  bytes[1]++;
  g_assert_false(opc_store_same(store, path, before));
  g_autofree char *now = opc_store_sum(store, path, NULL, &error);
  g_assert_cmpstr(now, !=, before);
  /* After a change of attributes, the content may have changed twice. */
  g_assert_cmpint(g_chmod(path, 0400), ==, 0);
  g_assert_false(opc_store_same(store, path, now));
}

/* A write to a page that is already marked as changed does not set the times of
   a file; on tmpfs, no write through a mapping sets the times. */
static void test_mapped(void) {
  const char *const folders[] = {folder, "/dev/shm"};
  enum { FOLDERS = G_N_ELEMENTS(folders), SIZE = 4096 };
  g_autofree char *text = g_strnfill(SIZE, 'a');
  opc_store *store = open_store();
  char *path[FOLDERS], *bytes[FOLDERS];
  for (size_t i = 0; i < FOLDERS; i++) {
    path[i] = g_build_filename(folders[i], "mapped-XXXXXX", NULL);
    int file = g_mkstemp(path[i]);
    if (file < 0) continue; /* no /dev/shm */
    g_assert_cmpint(write(file, text, SIZE), ==, SIZE);
    bytes[i] = mmap(NULL, SIZE, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    g_assert_true(bytes[i] != MAP_FAILED);
    close(file);
    bytes[i][0] = 'b';
  }
  g_usleep(2200000); /* times of the last 2 s are not trusted */
  for (size_t i = 0; i < FOLDERS; i++) {
    if (g_file_test(path[i], G_FILE_TEST_EXISTS)) {
      change_mapped(store, path[i], bytes[i]);
      munmap(bytes[i], SIZE);
      g_assert_cmpint(unlink(path[i]), ==, 0);
    }
    g_free(path[i]);
  }
  opc_store_close(store);
}

/* ---- claims ---- */

/* Return whether another process gets the claim to a key. */
static gboolean other_claims(const char *key) {
  int status, child = fork();
  if (!child) _exit(opc_store_claim(open_store(), key));
  g_assert_cmpint(waitpid(child, &status, 0), ==, child);
  g_assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

/* Start a process that joins a key, and that runs until it is killed. */
static int other_joins(const char *key) {
  int ready[2];
  char byte = 0;
  g_assert_cmpint(pipe2(ready, O_CLOEXEC), ==, 0);
  int child = fork();
  if (!child) {
    opc_store_join(open_store(), key);
    g_assert_cmpint(write(ready[1], &byte, 1), ==, 1);
    for (;;) pause();
  }
  g_assert_cmpint(read(ready[0], &byte, 1), ==, 1);
  close(ready[0]);
  close(ready[1]);
  return child;
}

/* A claim excludes other processes, joining excludes claims only, and a killed
   process loses claims and joined keys. */
static void test_claims(void) {
  const char *key = "fedcba9876543210.x", *next = "fedcba9876543220.x";
  opc_store *store = open_store();
  g_assert_true(opc_store_claim(store, key));
  g_assert_true(opc_store_claim(store, key));
  g_assert_false(other_claims(key));
  g_assert_true(other_claims(next));
  opc_store_leave(store, key);
  g_assert_true(other_claims(key));
  g_assert_true(opc_store_claim(store, key)); /* the other process has ended */
  opc_store_leave(store, key);

  int child = other_joins(key);
  opc_store_join(store, key);
  g_assert_false(opc_store_claim(store, key));
  g_assert_cmpint(kill(child, SIGKILL), ==, 0);
  g_assert_cmpint(waitpid(child, NULL, 0), ==, child);
  g_assert_true(opc_store_claim(store, key)); /* only this process has joined */
  g_assert_false(other_claims(key));
  opc_store_close(store);
  g_assert_true(other_claims(key));
}

/* The checksum of a build covers the libraries that the program needs. */
static void test_builds(void) {
  opc_error error = {0};
  opc_store *store = open_store();
  const char *own = opc_store_build(store, NULL);
  g_assert_nonnull(own);
  g_assert_cmpuint(strlen(own), ==, 64);
  g_assert_true(own == opc_store_build(store, NULL));
  g_autofree char *sum = opc_file_sha256("/proc/self/exe", NULL, &error);
  g_autofree char *alone =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, sum, -1);
  g_assert_cmpstr(own, !=, alone);
  const char *library = opc_store_build(store, g_free);
  g_assert_nonnull(library);
  g_assert_cmpstr(own, !=, library);
  opc_store_close(store);
}

/* ---- facts ---- */

/* Return a list of facts "AVALUE", where A is the path (g_variant_unref). */
static GVariant *facts_of(const char *text) {
  g_auto(GStrv) words = g_strsplit(text, " ", -1);
  GVariantBuilder facts;
  g_variant_builder_init(&facts, OPC_FACTS_TYPE);
  for (char **w = words; *w; w++) {
    const char path[] = {**w, 0};
    opc_facts_add(&facts, 'v', path, *w + 1, "");
  }
  return g_variant_ref_sink(g_variant_builder_end(&facts));
}

static char *describe(const void *data, char about, const char *path,
                      const char *before, const char *now) {
  g_assert_true(about == 'v');
  return g_strdup_printf("%s%s %s>%s", (const char *)data, path,
                         before ? before : "", now ? now : "");
}

static void expect_reason(opc_store *store, const char *facts,
                          const char *expected) {
  g_autoptr(GVariant) now = facts_of(facts);
  g_autofree char *found = opc_facts_reason(store, "step", now, describe, "s.");
  g_assert_cmpstr(found, ==, expected);
}

static void facts_keep(opc_store *store, const char *text) {
  g_autoptr(GVariant) facts = facts_of(text);
  opc_facts_keep(store, "step", facts);
}

/* Reasons are the differences from the most similar of the last 32 lists. */
static void test_facts(void) {
  opc_store *store = open_store();
  expect_reason(store, "a1", "not seen before");
  facts_keep(store, "a1 b1 c1 d1");
  expect_reason(store, "a1 b1 c1 d1", "the stored result was removed");
  expect_reason(store, "a1 b2 c1 e1", "s.b 1>2; s.e >1; s.d 1>");
  expect_reason(store, "a5 b5 c5 d5 e5",
                "s.a 1>5; s.b 1>5; s.c 1>5; and 2 more");
  facts_keep(store, "a5 b5 c5 d5");
  expect_reason(store, "a5 b5 c5 d5 e5", "s.e >5");
  expect_reason(store, "a1 b1 c5 d1", "s.c 1>5");
  expect_reason(store, "a1 b1 c5 d5", "s.a 5>1; s.b 5>1"); /* the later one */
  for (int i = 2; i < 33; i++) {
    g_autofree char *text = g_strdup_printf("x%d y%d z%d", i, i, i);
    facts_keep(store, text);
    facts_keep(store, text); /* equal lists count once */
  }
  expect_reason(store, "a5 b5 c5 d5", "the stored result was removed");
  expect_reason(store, "x2 y2 z2 a1", "s.a >1");
  facts_keep(store, "x1 y1 z1");
  expect_reason(store, "x5 y5 z5 w1", "s.w >1");
  g_autoptr(GVariant) gone = facts_of("a5 b5 c5 d5");
  g_autofree char *far = opc_facts_reason(store, "step", gone, describe, "s.");
  g_assert_cmpstr(far, !=, "the stored result was removed");
  opc_store_close(store);
}

/* Lists with different bytes have different checksums, also if the bytes are no
   UTF-8 text. */
static void test_fact_sums(void) {
  static const char *const lists[] = {"a1", "a1 b1", "b1",
                                      "a2", "a\xff", "a\xfe"};
  g_autoptr(GHashTable) seen =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(lists); i++) {
    g_autoptr(GVariant) one = facts_of(lists[i]), same = facts_of(lists[i]);
    g_autofree char *again = opc_facts_sum(same);
    char *sum = opc_facts_sum(one);
    g_assert_cmpstr(sum, ==, again);
    g_assert_true(g_hash_table_add(seen, sum));
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("store-XXXXXX", NULL);
  g_setenv("OPCFLOW_STORE", folder, TRUE);
  g_test_add_func("/store/values", test_values);
  g_test_add_func("/store/damage", test_damage);
  g_test_add_func("/store/exchanged", test_exchanged);
  g_test_add_func("/store/limit", test_limit);
  g_test_add_func("/store/sizes", test_sizes);
  g_test_add_func("/store/remains", test_remains);
  g_test_add_func("/store/foreign", test_foreign);
  g_test_add_func("/store/files", test_files);
  g_test_add_func("/store/changed-files", test_changed_files);
  g_test_add_func("/store/large-files", test_large_files);
  g_test_add_func("/store/older", test_older);
  g_test_add_func("/store/sums", test_sums);
  g_test_add_func("/store/mapped", test_mapped);
  g_test_add_func("/store/claims", test_claims);
  g_test_add_func("/store/builds", test_builds);
  g_test_add_func("/store/facts", test_facts);
  g_test_add_func("/store/fact-sums", test_fact_sums);
  int code = g_test_run();
  opc_remove_tree(folder);
  g_free(folder);
  return code;
}
