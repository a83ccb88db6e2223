/* SPDX-License-Identifier: BSD-3-Clause */
#include <base/file.h>
#include <errno.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/stat.h>

static void test_inside(void) {
  g_assert_true(opc_name_is_inside("a"));
  g_assert_true(opc_name_is_inside("a/b..c"));
  g_assert_false(opc_name_is_inside(""));
  g_assert_false(opc_name_is_inside("/a"));
  g_assert_false(opc_name_is_inside("a/../b"));
  g_assert_false(opc_name_is_inside("./a"));
  g_assert_false(opc_name_is_inside("a//b"));
  g_assert_false(opc_name_is_inside("a/"));
}

static void test_names(void) {
  g_assert_true(opc_is_name("a-1_b", FALSE));
  g_assert_true(opc_is_name("a.b", TRUE));
  g_assert_false(opc_is_name("a.b", FALSE));
  g_assert_false(opc_is_name(".a", TRUE));
  g_assert_false(opc_is_name("-a", TRUE));
  g_assert_false(opc_is_name("a b", TRUE));
  g_assert_true(opc_is_id("model.wide_2"));
  g_assert_false(opc_is_id("Model"));
  g_assert_false(opc_is_id("a..b"));
}

static void test_folder(void) {
  g_autofree char *folder = g_dir_make_tmp(NULL, NULL);
  g_assert_null(opc_folder_names("/nowhere/at/all"));
  for (char c = 'c'; c >= 'a'; c--) {
    g_autofree char *path = g_strdup_printf("%s/%c", folder, c);
    g_assert_true(g_file_set_contents(path, "", 0, NULL));
  }
  g_autoptr(GPtrArray) names = opc_folder_names(folder);
  g_assert_cmpuint(names->len, ==, 3);
  for (guint i = 0; i < 3; i++) {
    g_autofree char *path = g_build_filename(folder, names->pdata[i], NULL);
    const char name[] = {(char)('a' + i), 0};
    g_assert_cmpstr(names->pdata[i], ==, name);
    g_unlink(path);
  }
  g_rmdir(folder);
}

static void test_faults(void) {
  g_autofree char *folder = g_dir_make_tmp(NULL, NULL);
  g_autofree char *file = g_build_filename(folder, "file", NULL);
  g_autofree char *pipe = g_build_filename(folder, "pipe", NULL);
  g_autofree char *below = g_build_filename(file, "x", NULL);
  size_t size = 0;
  g_assert_true(g_file_set_contents(file, "four", 4, NULL));
  g_assert_cmpint(mkfifo(pipe, 0600), ==, 0);
  g_assert_cmpstr(opc_file_fault(file, &size), ==, NULL);
  g_assert_cmpuint(size, ==, 4);
  g_assert_cmpstr(opc_file_fault("/nowhere", NULL), ==, "no such file");
  g_assert_cmpstr(opc_file_fault(below, NULL), ==, g_strerror(ENOTDIR));
  g_assert_cmpstr(opc_file_fault(folder, NULL), ==,
                  "is a folder, not a regular file");
  g_assert_cmpstr(opc_file_fault(pipe, NULL), ==,
                  "is a pipe, not a regular file");
  g_assert_cmpstr(opc_file_fault("/dev/null", NULL), ==,
                  "is a device, not a regular file");
  g_unlink(pipe);
  g_unlink(file);
  g_rmdir(folder);
}

/* The folder of this program stands for PREFIX/bin. */
static void test_installed(void) {
  g_autofree char *folder = opc_executable_folder();
  g_autofree char *bin = g_strdup(strrchr(folder, '/'));
  g_autofree char *prefix = g_path_get_dirname(folder);
  g_autofree char *want = g_strconcat(prefix, "/share/opcflow/x", NULL);
  const char *const places[] = {"/no/bin", bin, NULL};
  const char *const whole[] = {folder, NULL}, *const none[] = {"/no", NULL};
  g_autofree char *found = opc_installed(places, "share", "x");
  g_assert_cmpstr(found, ==, want);
  g_autofree char *top = opc_installed(whole, "share", "x");
  g_assert_cmpstr(top, ==, "/share/opcflow/x");
  g_autofree char *absolute = opc_installed(none, "/etc", "x");
  g_assert_cmpstr(absolute, ==, "/etc/opcflow/x");
  g_assert_null(opc_installed(none, "share", "x"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/file/inside", test_inside);
  g_test_add_func("/file/names", test_names);
  g_test_add_func("/file/folder", test_folder);
  g_test_add_func("/file/faults", test_faults);
  g_test_add_func("/file/installed", test_installed);
  return g_test_run();
}
