/* SPDX-License-Identifier: BSD-3-Clause */
/* Shared by the tests: availability of the simulator, and hand-written decks
   run by the command `ngspice`. */
#pragma once

#include <eda/simulator.h>

#include "tools/devel/testing.h"

/* Return 1 if ngspice is available; else skip the test. */
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

/* Return the output of the command (g_free); NULL if the command is missing. */
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
