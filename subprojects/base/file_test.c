/* SPDX-License-Identifier: BSD-3-Clause */
#include <base/file.h>

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

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/file/inside", test_inside);
  return g_test_run();
}
