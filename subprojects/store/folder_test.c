/* SPDX-License-Identifier: BSD-3-Clause */
/* Run folders on file systems with missing features, and runs that are killed
   at any moment. Calls that file systems may reject are replaced by failing
   functions. Histories and JSON texts of runs. */
#include <store/folder.h>

#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <store/contents.h>
#include <store/files.h>
#include <store/histories.h>
#include <store/json.h>

/* ---- the system ---- */

static gboolean plain_renames, no_locks, failing_sync;
static int renames_left = -1; /* renames until the process is killed; -1:
                                 never */

static void count_rename(void) {
  if (renames_left >= 0 && renames_left-- == 0) _exit(9);
}

int renameat2(int from_dir, const char *from, int to_dir, const char *to,
              unsigned flags) {
  if (plain_renames && flags) {
    errno = EINVAL;
    return -1;
  }
  count_rename();
  return (int)syscall(SYS_renameat2, from_dir, from, to_dir, to, flags);
}

int rename(const char *from, const char *to) {
  count_rename();
  return (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}

int flock(int file, int operation) {
  if (!no_locks) return (int)syscall(SYS_flock, file, operation);
  errno = ENOLCK;
  return -1;
}

int fsync(int file) {
  if (!failing_sync) return (int)syscall(SYS_fsync, file);
  errno = EIO;
  return -1;
}

int syncfs(int file) {
  if (!failing_sync) return (int)syscall(SYS_syncfs, file);
  errno = EIO;
  return -1;
}

/* ---- runs ---- */

static void file_put(const char *folder, const char *name, const char *text) {
  g_autofree char *path = g_build_filename(folder, name, NULL);
  g_autofree char *parent = g_path_get_dirname(path);
  g_assert_cmpint(g_mkdir_with_parents(parent, 0777), ==, 0);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
}

static void put_run(const char *folder, const char *word) {
  opc_error error;
  file_put(folder, "deep/file.txt", word);
  JsonArray *files = opc_contents_json(folder, &error);
  g_autoptr(JsonNode) node = json_node_new(JSON_NODE_OBJECT);
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "opcflow", "test");
  json_object_set_array_member(o, "files", files);
  json_node_take_object(node, o);
  g_autofree char *text = json_to_string(node, FALSE);
  file_put(folder, "manifest.json", text);
}

/* Make a complete run. Return its code. */
static int make_run(const char *target, const char *word) {
  opc_error error;
  g_autofree char *got = NULL;
  opc_folder *f = opc_folder_open(target, TRUE, &error);
  g_assert_nonnull(f);
  put_run(f->work, word);
  int code = opc_folder_close(f, target, TRUE, FALSE, &got, &error);
  opc_folder_free(f);
  return code;
}

/* Return the text that identifies the run in a folder, "" if the run is
   incomplete. */
static char *word_of(const char *folder) {
  opc_error error;
  char *word = NULL;
  g_autofree char *path = g_build_filename(folder, "deep/file.txt", NULL);
  if (!opc_contents_check(folder, &error))
    g_file_get_contents(path, &word, NULL, NULL);
  return word ? word : g_strdup("");
}

static guint entries(const char *folder) {
  guint n = 0;
  GDir *dir = g_dir_open(folder, 0, NULL);
  while (dir && g_dir_read_name(dir)) n++;
  if (dir) g_dir_close(dir);
  return n;
}

static void assert_word(const char *folder, const char *word) {
  g_autofree char *its = word_of(folder);
  g_assert_cmpstr(its, ==, word);
}

/* ---- replacing ---- */

/* Kill a run before each rename in turn. The folder must then contain the old
   or the new run. Without an atomic exchange, the folder may be missing until
   the next run restores the old run. */
static void kill_at_each_rename(const char *target) {
  int at = 0, status = -1;
  g_assert_cmpint(make_run(target, "first"), ==, OPC_OK);
  for (; status != 0; at++) {
    pid_t child = fork();
    if (!child) {
      renames_left = at;
      _exit(make_run(target, "second"));
    }
    g_assert_cmpint(waitpid(child, &status, 0), ==, child);
    g_assert_true(WIFEXITED(status));
    if (!plain_renames) assert_word(target, status ? "first" : "second");
    g_assert_cmpuint(entries("k"), ==, status ? (entries(target) ? 2 : 1) : 1);
    /* The next run first removes the remains of the killed run. */
    opc_error error;
    opc_folder *next = opc_folder_open(target, TRUE, &error);
    g_assert_nonnull(next);
    assert_word(target, status ? "first" : "second");
    opc_folder_free(next);
    g_assert_cmpuint(entries("k"), ==, 1);
  }
  g_assert_cmpint(at, ==, plain_renames ? 3 : 2);
  opc_remove_tree("k");
}

static void test_exchange(void) { kill_at_each_rename("k/x"); }

static void test_plain_renames(void) {
  plain_renames = TRUE;
  kill_at_each_rename("k/x");
  plain_renames = FALSE;
}

/* A run whose name is taken gets a number, with and without renameat2(). */
static void test_numbers(void) {
  for (int plain = 0; plain < 2; plain++) {
    plain_renames = plain;
    for (int i = 0; i < 3; i++) {
      opc_error error;
      g_autofree char *got = NULL;
      opc_folder *f = opc_folder_open("n/x", FALSE, &error);
      put_run(f->work, "word");
      g_assert_cmpint(opc_folder_close(f, "n/x", FALSE, TRUE, &got, &error), ==,
                      OPC_OK);
      opc_folder_free(f);
      assert_word(got, "word");
    }
    assert_word("n/x-3", "word");
    g_assert_cmpuint(entries("n"), ==, 3);
    opc_remove_tree("n");
  }
  plain_renames = FALSE;
}

/* A folder that was created during the run is not replaced, and the new run is
   kept. */
static void test_meanwhile(void) {
  opc_error error;
  g_autofree char *got = NULL;
  g_assert_cmpint(make_run("m/x", "first"), ==, OPC_OK);
  opc_folder *f = opc_folder_open("m/x", TRUE, &error);
  put_run(f->work, "second");
  file_put("m/x", "mine.txt", "mine");
  g_assert_cmpint(opc_folder_close(f, "m/x", TRUE, FALSE, &got, &error), ==,
                  OPC_IO);
  g_assert_nonnull(strstr(error.message, "has the file 'mine.txt'"));
  opc_folder_free(f);
  g_assert_cmpstr(got, ==, "m/x-2");
  assert_word("m/x-2", "second");
  g_assert_true(g_file_test("m/x/mine.txt", G_FILE_TEST_EXISTS));
  opc_remove_tree("m");
}

/* ---- slots ---- */

/* Start runs in other processes, which are killed and leave their slots. */
static void leave_slots(int n, pid_t *child) {
  int ready[2];
  char byte;
  g_assert_cmpint(pipe(ready), ==, 0);
  *child = fork();
  if (!*child) {
    opc_error error;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (int i = 0; i < n; i++)
      file_put(opc_folder_open("s/x", FALSE, &error)->work, "deep/part.txt",
               "part");
    g_assert_cmpint(write(ready[1], "+", 1), ==, 1);
    for (;;) pause();
  }
  g_assert_cmpint(read(ready[0], &byte, 1), ==, 1);
  close(ready[0]);
  close(ready[1]);
}

static void test_slots(void) {
  pid_t child;
  opc_error error;
  leave_slots(3, &child);
  /* The runs are active: nothing is changed. */
  g_assert_null(opc_folder_open("s/x", TRUE, &error));
  g_assert_cmpstr(
      error.message, ==,
      "'s/x': another run is writing this folder, in 's/.x.opcflow-1'");
  opc_folder *fourth = opc_folder_open("s/x", FALSE, &error);
  g_assert_cmpstr(fourth->slot, ==, "s/.x.opcflow-4");
  opc_folder_free(fourth);
  g_assert_true(
      g_file_test("s/.x.opcflow-2/run/deep/part.txt", G_FILE_TEST_EXISTS));
  /* Similar names are not slots. */
  file_put("s/.x.opcflow-mine", "run", "mine");
  file_put("s/.xy.opcflow-1", "run", "mine");
  kill(child, SIGKILL);
  waitpid(child, NULL, 0);
  g_assert_cmpint(make_run("s/x", "word"), ==, OPC_OK);
  g_assert_cmpuint(entries("s"), ==, 3);
  assert_word("s/x", "word");
  opc_remove_tree("s");
}

/* A symbolic link in place of a slot is not followed. */
static void test_link(void) {
  opc_error error;
  file_put("l/other/run", "mine.txt", "mine");
  g_assert_cmpint(symlink("other", "l/.x.opcflow-1"), ==, 0);
  g_assert_null(opc_folder_open("l/x", TRUE, &error));
  g_assert_nonnull(strstr(error.message, "Not a directory"));
  g_assert_true(g_file_test("l/other/run/mine.txt", G_FILE_TEST_EXISTS));
  opc_remove_tree("l");
}

/* Without locks, a slot belongs to the process that created it, even after the
   process ends. */
static void test_no_locks(void) {
  pid_t child;
  opc_error error;
  no_locks = TRUE;
  g_assert_cmpint(make_run("s/x", "word"), ==, OPC_OK);
  leave_slots(1, &child);
  kill(child, SIGKILL);
  waitpid(child, NULL, 0);
  g_assert_null(opc_folder_open("s/x", TRUE, &error));
  opc_folder *second = opc_folder_open("s/x", FALSE, &error);
  g_assert_cmpstr(second->slot, ==, "s/.x.opcflow-2");
  opc_folder_free(second);
  no_locks = FALSE;
  opc_remove_tree("s");
}

/* ---- contents ---- */

static void assert_refused(const char *manifest, const char *want) {
  opc_error error;
  if (manifest) file_put("c/x", "manifest.json", manifest);
  g_assert_cmpint(opc_folder_allowed("c/x", TRUE, &error), ==, OPC_IO);
  if (!strstr(error.message, want)) g_error("%s", error.message);
}

static void test_contents(void) {
  static const char *const unsound[] = {
      "",
      "[",
      "[]",
      "{\"opcflow\":\"0\"}",
      "{\"opcflow\":\"0\",\"files\":{}}",
      "{\"opcflow\":\"0\",\"files\":[1]}",
      "{\"opcflow\":\"0\",\"files\":[{\"path\":\"a\",\"sha256\":null}]}",
      "{\"opcflow\":\"0\",\"files\":[{\"path\":\"../a\",\"sha256\":\"\"}]}",
      "{\"opcflow\":0,\"files\":[]}"};
  opc_error error;
  g_assert_cmpint(make_run("c/x", "word"), ==, OPC_OK);
  /* A missing file is accepted. */
  g_assert_cmpint(unlink("c/x/deep/file.txt"), ==, 0);
  g_assert_cmpint(opc_folder_allowed("c/x", TRUE, &error), ==, OPC_OK);
  file_put("c/x", "deep/file.txt", "changed");
  assert_refused(NULL, "the file 'deep/file.txt' has changed since the run");
  file_put("c/x", "deep/file.txt", "word");
  g_assert_cmpint(opc_folder_allowed("c/x", TRUE, &error), ==, OPC_OK);
  file_put("c/x", "deep/mine.txt", "");
  file_put("c/x", "other.txt", "");
  assert_refused(NULL,
                 "has the file 'deep/mine.txt', which the run did not write");
  g_assert_cmpint(unlink("c/x/deep/mine.txt"), ==, 0);
  g_assert_cmpint(unlink("c/x/other.txt"), ==, 0);
  g_assert_cmpint(g_mkdir("c/x/deep/er", 0777), ==, 0);
  assert_refused(NULL, "has the folder 'deep/er'");
  g_assert_cmpint(rmdir("c/x/deep/er"), ==, 0);
  g_assert_cmpint(unlink("c/x/deep/file.txt"), ==, 0);
  g_assert_cmpint(symlink("/dev/zero", "c/x/deep/file.txt"), ==, 0);
  assert_refused(NULL, "has the symbolic link 'deep/file.txt'");
  for (size_t i = 0; i < G_N_ELEMENTS(unsound); i++)
    assert_refused(unsound[i], "does not list the files of a run");
  g_autofree char *deep = g_strnfill(1000000, '[');
  assert_refused(deep, "does not list the files of a run");
  g_assert_cmpint(unlink("c/x/manifest.json"), ==, 0);
  g_assert_cmpint(symlink("/dev/zero", "c/x/manifest.json"), ==, 0);
  assert_refused(NULL, "no readable manifest.json of a run");
  opc_remove_tree("c");
}

/* ---- writing ---- */

/* A failed write leaves the old file and nothing else. */
static void test_write(void) {
  opc_error error;
  file_put("w", "file.txt", "before");
  g_assert_cmpint(opc_write_file("w/file.txt", "after", &error), ==, OPC_OK);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents("w/file.txt", &text, NULL, NULL));
  g_assert_cmpstr(text, ==, "after");
  g_assert_cmpint(opc_write_file("/dev/full", "after", &error), ==, OPC_IO);
  g_assert_cmpstr(error.message, ==, "'/dev/full': No space left on device");
  g_assert_true(g_file_test("/dev/full", G_FILE_TEST_EXISTS));
  g_assert_cmpint(opc_write_file("w/none/file.txt", "", &error), ==, OPC_IO);
  failing_sync = TRUE;
  g_assert_cmpint(opc_sync_tree("w", &error), ==, OPC_IO);
  g_assert_cmpstr(error.message, ==, "'w/file.txt': Input/output error");
  g_assert_cmpuint(entries("w"), ==, 1);
  for (int i = 0; i < 100; i++) {
    g_autofree char *name = g_strdup_printf("%d.txt", i);
    file_put("w", name, "");
  }
  g_assert_cmpint(opc_sync_tree("w", &error), ==, OPC_IO);
  g_assert_cmpstr(error.message, ==, "'w': Input/output error");
  failing_sync = FALSE;
  g_assert_cmpint(opc_sync_tree("w", &error), ==, OPC_OK);
  opc_remove_tree("w");
}

/* ---- histories, JSON ---- */

static void test_histories(void) {
  opc_histories a, b;
  opc_histories_init(&a);
  opc_histories_init(&b);
  opc_history h = {.path = (char *)"x", .reused = TRUE, .key = (char *)"k"};
  for (int i = 0; i < 3; i++, h.point++) opc_histories_add(&a, &h);
  h = (opc_history){.path = (char *)"y", .reason = (char *)"new"};
  for (int i = 0; i < 999; i++) opc_histories_add(&b, &h);
  opc_histories_rerun(&a, "x", "lost", 2);
  g_assert_cmpuint(a.reused, ==, 2);
  opc_histories_take(&b, &a);
  g_assert_cmpuint(b.done, ==, 1002);
  g_assert_cmpuint(b.reused, ==, 2);
  g_assert_cmpuint(b.list->len, ==, 1000);
  const opc_history *first = b.list->pdata[0], *next = b.list->pdata[1],
                    *changed = a.list->pdata[2];
  g_assert_cmpstr(first->path, ==, "x");
  g_assert_cmpstr(first->key, ==, "k");
  g_assert_cmpstr(next->path, ==, "y");
  g_assert_cmpstr(next->reason, ==, "new");
  g_assert_cmpuint(changed->point, ==, 2);
  g_assert_false(changed->reused);
  g_assert_cmpstr(changed->reason, ==, "lost");
  g_assert_cmpfloat(changed->seconds, ==, 2);
  opc_histories_clear(&a);
  opc_histories_clear(&b);
}

/* A parser reads the same numbers and texts from the JSON text. */
static void test_json(void) {
  static const double numbers[] = {0.1, 1e-7, -2.5e-10, 3, 1e300, 1 / 3.0, 0};
  static const char text[] = "1.50 \"2.50\" \\ 3.10\x1b\n";
  JsonArray *list = json_array_new();
  json_array_add_string_element(list, text);
  json_array_add_string_element(list, "even");
  json_array_add_int_element(list, 1234567);
  for (size_t i = 0; i < G_N_ELEMENTS(numbers); i++)
    json_array_add_double_element(list, numbers[i]);
  JsonNode *node = json_node_init_array(json_node_alloc(), list);
  json_array_unref(list);
  g_autofree char *out = opc_json_text(node);
  g_autoptr(GError) error = NULL;
  g_autoptr(JsonNode) read = json_from_string(out, &error);
  g_assert_no_error(error);
  JsonArray *back = json_node_get_array(read);
  g_assert_cmpstr(json_array_get_string_element(back, 0), ==, text);
  g_assert_cmpint(json_array_get_int_element(back, 2), ==, 1234567);
  for (guint i = 0; i < G_N_ELEMENTS(numbers); i++) {
    JsonNode *one = json_array_get_element(back, i + 3);
    g_assert_true(json_node_get_value_type(one) == G_TYPE_DOUBLE);
    g_assert_true(json_node_get_double(one) == numbers[i]);
  }
  g_assert_nonnull(strstr(out, "\n  0.1,\n"));
  g_assert_nonnull(strstr(out, "\n  3.0,\n"));
  g_assert_nonnull(strstr(out, "\n  1e-07,\n"));
  g_assert_null(strchr(out, 0x1b));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_autofree char *folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  g_test_add_func("/folder/exchange", test_exchange);
  g_test_add_func("/folder/plain-renames", test_plain_renames);
  g_test_add_func("/folder/numbers", test_numbers);
  g_test_add_func("/folder/meanwhile", test_meanwhile);
  g_test_add_func("/folder/slots", test_slots);
  g_test_add_func("/folder/link", test_link);
  g_test_add_func("/folder/no-locks", test_no_locks);
  g_test_add_func("/folder/contents", test_contents);
  g_test_add_func("/folder/write", test_write);
  g_test_add_func("/histories", test_histories);
  g_test_add_func("/json", test_json);
  int failed = g_test_run();
  g_assert_cmpint(g_chdir("/"), ==, 0);
  opc_remove_tree(folder);
  return failed;
}
