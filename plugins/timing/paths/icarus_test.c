/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares a random circuit with Icarus Verilog and the SDF file of the step:
   the events at all outputs must be equal to the fs. Skipped if iverilog is
   missing. */
#include "library_test.h"

enum { GATES = 120, INPUTS = 9, OUTPUTS = 12, TRANSITIONS = 1000 };

/* Return a random circuit: the inputs of a gate are earlier nets, the last nets
   are outputs. */
static char *random_circuit(GRand *r) {
  GString *text = g_string_new(NULL);
  for (int i = 0; i < GATES; i++) {
    int cell = g_rand_int_range(r, 0, 3);
    g_string_append_printf(text, "XG%d", i);
    int last = -1;
    for (int k = 0; k < (cell ? 2 : 1); k++) {
      int from, low = i > 12 ? INPUTS + i - 12 : 0;
      do from = g_rand_int_range(r, low, INPUTS + i);
      while (from == last);
      last = from;
      g_string_append_printf(text, " n%d", from);
    }
    static const char *const names[] = {"INV", "NAND2", "XOR2"};
    g_string_append_printf(text, " n%d VDD VSS %s\n", INPUTS + i, names[cell]);
  }
  return g_string_free(text, FALSE);
}

static char *random_ports(void) {
  GString *text = g_string_new(NULL);
  for (int i = 0; i < INPUTS; i++) g_string_append_printf(text, "n%d ", i);
  for (int i = 0; i < OUTPUTS; i++)
    g_string_append_printf(text, "n%d ", INPUTS + GATES - OUTPUTS + i);
  return g_string_free(text, FALSE);
}

static char *program_run(const char *const *argv) {
  char *out = NULL;
  g_autofree char *words = NULL;
  g_autoptr(GError) fault = NULL;
  int status;
  if (!g_spawn_sync(opc_test_folder(), (char **)argv, NULL, G_SPAWN_SEARCH_PATH,
                    NULL, NULL, &out, &words, &status, &fault))
    g_error("%s", fault->message);
  if (status) g_error("%s: %s", argv[0], words);
  return out;
}

static int by_text(gconstpointer a, gconstpointer b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

static void sort_lines(char **lines) {
  qsort(lines, g_strv_length(lines), sizeof *lines, by_text);
}

static char **our_lines(void) {
  size_t n = opc_test_rows("events");
  char **lines = g_new0(char *, n + 1);
  for (size_t i = 0; i < n; i++) {
    double number[3];
    static const char *const names[] = {"transition", "level", "time"};
    for (int k = 0; k < 3; k++)
      number[k] = opc_test_number("events", names[k], i);
    lines[i] = g_strdup_printf("%.0f,%s,%.0f,%.3f", number[0],
                               opc_test_text("events", "output", i), number[1],
                               number[2]);
  }
  return lines;
}

static void test_same(void) {
  static const char *const compile[] = {"iverilog",
                                        "-gspecify",
                                        "-s",
                                        "bench",
                                        "-o",
                                        "b.vvp",
                                        "-DSDF=\"top.drawn.sdf\"",
                                        "top.v",
                                        NULL};
  static const char *const simulate[] = {"vvp", "b.vvp", NULL};
  g_autofree char *there = g_find_program_in_path("iverilog");
  opc_error error;
  if (!there) {
    g_test_skip("iverilog is not installed");
    return;
  }
  g_autoptr(GRand) r = g_rand_new_with_seed(7);
  g_autofree char *circuit = random_circuit(r), *ports = random_ports();
  eda_timing *t = library();
  g_autofree char *more = g_strdup_printf(
      ", delays: arcs, verilog: top.v, events: %d, transitions: %d, seed: 3",
      TRANSITIONS, TRANSITIONS);
  if (run_paths(t, ports, circuit, more, NULL, NULL, &error))
    g_error("%s", error.message);
  g_free(program_run(compile));
  g_autofree char *out = program_run(simulate);
  g_auto(GStrv) theirs = g_strsplit(g_strchomp(out), "\n", -1),
                ours = our_lines();
  sort_lines(theirs);
  sort_lines(ours);
  g_assert_cmpuint(g_strv_length(ours), >, 2 * TRANSITIONS);
  for (size_t i = 0; ours[i] || theirs[i]; i++)
    g_assert_cmpstr(ours[i], ==, theirs[i]);
  g_test_message("%u events are the same", g_strv_length(ours));
  eda_timing_free(t);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/paths/icarus", test_same);
  return g_test_run();
}
