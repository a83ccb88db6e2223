/* SPDX-License-Identifier: BSD-3-Clause */
/* Functions of the tests of plugins in Python. Each test writes its plugins
   into the folder of the test. */
#pragma once

#include <eda/eda.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/devel/testing.h"

static int has_numpy;

/* ---- plugins ---- */

OPC_UNUSED static void write_plugin(const char *id, const char *text) {
  g_autofree char *file = g_strconcat(id, ".py", NULL);
  g_autofree char *path = g_build_filename(opc_test_folder(), file, NULL);
  g_autofree char *whole = g_strconcat(
      "import os, signal, sys\nimport numpy as np\nfrom opcflow import *\n",
      text, NULL);
  g_assert_true(g_file_set_contents(path, whole, -1, NULL));
}

static opc_module *make(const char *id, const char *parameters) {
  opc_error error = {0};
  opc_module *m = opc_test_module(id, parameters, &error);
  if (!m) g_assert_cmpstr(error.message, ==, "");
  return m;
}

/* Skip a test without NumPy. Returns whether NumPy is missing. */
static int is_skipped(void) {
  if (!has_numpy) g_test_skip("python3 has no NumPy");
  return !has_numpy;
}

/* Set the search path of plugins: the folder of the test, and the examples. */
static void set_up(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_autofree char *path =
      g_strjoin(":", opc_test_folder(), g_getenv("OPCFLOW_PLUGIN_PATH"),
                g_getenv("OPCFLOW_SOURCE"), NULL);
  g_autofree char *all =
      g_strconcat(path, "/subprojects/python/examples", NULL);
  g_setenv("OPCFLOW_PLUGIN_PATH", all, TRUE);
  has_numpy = !system("python3 -c 'import numpy' 2>/dev/null");
}
