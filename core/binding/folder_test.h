/* SPDX-License-Identifier: BSD-3-Clause */
/* Temporary folder of a test program, and flows of the test plugins in this
   folder. */
#pragma once

#include <glib/gstdio.h>
#include <store/files.h>

#include "core/binding/flow.h"

static char *trial_folder; /* current folder of the program */

/* Return the registry of the test plugins, which is never freed. */
static inline opc_registry *trial_registry(void) {
  static opc_registry *registry;
  if (registry) return registry;
  const char *build = g_getenv("OPCFLOW_BUILD");
  g_autofree char *tests = g_build_filename(build, "tests", NULL);
  const char *folders[] = {tests, NULL};
  return registry = opc_registry_new(folders);
}

static inline void put_text(const char *name, const char *text) {
  g_assert_true(g_file_set_contents(name, text, -1, NULL));
}

/* Read a flow that has no problems. Free with opc_flow_free. */
static inline opc_flow *trial_load(const char *text) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  put_text("flow.yaml", text);
  opc_flow *flow = opc_flow_load("flow.yaml", NULL, trial_registry(), problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==, "");
  return flow;
}

/* Create the temporary folder. */
static inline void trial_begin(void) {
  trial_folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(trial_folder), ==, 0);
}

/* Run the registered tests, remove the folder and return the exit code. */
static inline int trial_end(void) {
  int code = g_test_run();
  g_assert_cmpint(g_chdir("/"), ==, 0);
  opc_remove_tree(trial_folder);
  g_free(trial_folder);
  return code;
}
