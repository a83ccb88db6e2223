/* SPDX-License-Identifier: BSD-3-Clause */
/* For the tests beside it: whether there is a simulator, and decks by hand run
   by the command `ngspice`. */
#pragma once

#include <eda/simulator.h>

#include "tools/devel/testing.h"

/* Skips where there is none. */
static inline int have_ngspice(void) {
  static int known = -1;
  static opc_error error;
  eda_spice_result r;
  if (known < 0) {
    known = eda_spice_run(NULL, "t\nv1 a 0 1\n.end", "op", 20, &r, &error) !=
            OPC_NO_PLUGIN;
    eda_spice_clear(&r);
  }
  if (!known) g_test_skip(error.message);
  return known;
}

/* What the command prints (g_free); NULL if it is not there. */
static inline char *by_hand(const char *deck) {
  g_autofree char *program = g_find_program_in_path("ngspice");
  if (!program) return NULL;
  g_autofree char *path = g_build_filename(opc_test_folder(), "h.sp", NULL);
  const char *argv[] = {program, "-b", path, NULL};
  char *out = NULL;
  g_assert_true(g_file_set_contents(path, deck, -1, NULL));
  g_assert_true(g_spawn_sync(opc_test_folder(), (char **)argv, NULL,
                             G_SPAWN_STDERR_TO_DEV_NULL, NULL, NULL, &out, NULL,
                             NULL, NULL));
  return out;
}
