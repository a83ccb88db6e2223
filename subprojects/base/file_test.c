/* SPDX-License-Identifier: BSD-3-Clause */
#include <base/file.h>
#include <glib/gstdio.h>

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

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/file/inside", test_inside);
  g_test_add_func("/file/names", test_names);
  g_test_add_func("/file/folder", test_folder);
  return g_test_run();
}
