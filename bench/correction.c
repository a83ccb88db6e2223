/* SPDX-License-Identifier: BSD-3-Clause */
/* Whole runs of the command, as a user starts them: our NAND2, and the circuit
   c432 where there are test data. How long they take, and how far the drive
   current of the worst transistor is from its design value. */
#include <glib.h>
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/bench.h"
#include "core/flow/files.h"

enum { MAX_REPEATS = 9 };

typedef struct job {
  const char *name;        /* of its figures */
  const char *flow;        /* in flows/ */
  const char *const *sets; /* STEP.PARAMETER=VALUE, NULL */
  size_t repeats;          /* the median counts */
  double seconds, ion_max; /* to reach: s, % */
} job;

static const char *setting(const char *name, const char *preset) {
  const char *value = g_getenv(name);
  return value ? value : preset;
}

/* Run a flow into `folder`; the seconds it took, or -1. */
static double run_once(const job *j, const char *folder) {
  g_autoptr(GPtrArray) argv = g_ptr_array_new();
  g_autofree char *flow =
      g_build_filename(setting("OPCFLOW_SOURCE", "."), "flows", j->flow, NULL);
  g_ptr_array_add(argv, (char *)setting("OPCFLOW_COMMAND", "opcflow"));
  g_ptr_array_add(argv, (char *)"run");
  g_ptr_array_add(argv, flow);
  g_ptr_array_add(argv, (char *)"--quiet");
  g_ptr_array_add(argv, (char *)"--output");
  g_ptr_array_add(argv, (char *)folder);
  for (const char *const *set = j->sets; set && *set; set++) {
    g_ptr_array_add(argv, (char *)"--set");
    g_ptr_array_add(argv, (char *)*set);
  }
  g_ptr_array_add(argv, NULL);
  g_autoptr(GError) error = NULL;
  int status;
  gint64 before = g_get_monotonic_time();
  gboolean good =
      g_spawn_sync(NULL, (char **)argv->pdata, NULL, G_SPAWN_SEARCH_PATH, NULL,
                   NULL, NULL, NULL, &status, &error) &&
      g_spawn_check_wait_status(status, &error);
  double seconds = (double)(g_get_monotonic_time() - before) / 1e6;
  if (good) return seconds;
  fprintf(stderr, "error: %s: %s\n", j->name, error->message);
  return -1;
}

/* A metric of the step `mask` of a run, from its metrics.json. */
static gboolean read_metric(const char *folder, const char *name,
                            double *value) {
  g_autofree char *path = g_build_filename(folder, "metrics.json", NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_autoptr(GError) error = NULL;
  g_autofree char *where = g_strdup_printf("$.mask.%s.value", name);
  g_autoptr(JsonNode) found = NULL;
  if (json_parser_load_from_file(parser, path, &error))
    found = json_path_query(where, json_parser_get_root(parser), &error);
  JsonArray *matches = found ? json_node_get_array(found) : NULL;
  if (matches && json_array_get_length(matches) == 1) {
    *value = json_array_get_double_element(matches, 0);
    return TRUE;
  }
  fprintf(stderr, "error: '%s': %s\n", path,
          error ? error->message : "the metric is not there");
  return FALSE;
}

static gboolean measure(const job *j, const char *folder) {
  double seconds[MAX_REPEATS], ion_max = 0;
  for (size_t i = 0; i < j->repeats; i++) {
    g_autofree char *name = g_strdup_printf("%s-%zu", j->name, i);
    g_autofree char *run = g_build_filename(folder, name, NULL);
    seconds[i] = run_once(j, run);
    if (seconds[i] < 0 || !read_metric(run, "ion_max", &ion_max)) return FALSE;
  }
  g_autofree char *time = g_strconcat(j->name, ".seconds", NULL);
  g_autofree char *worst = g_strconcat(j->name, ".ion_max", NULL);
  bench_report(time, bench_median(seconds, j->repeats), "s", j->seconds,
               BENCH_LOWER);
  bench_report(worst, ion_max, "%", j->ion_max, BENCH_LOWER);
  return TRUE;
}

static gboolean measure_c432(const char *folder) {
  g_autofree char *beside = g_build_filename(setting("OPCFLOW_SOURCE", "."),
                                             "..", "shared", "data", NULL);
  g_autofree char *layout =
      g_build_filename(setting("OPCFLOW_TEST_DATA", beside), "iscas85", "c432",
                       "c432.gds", NULL);
  if (!g_file_test(layout, G_FILE_TEST_EXISTS)) {
    fprintf(stderr, "c432: skipped, no '%s'\n", layout);
    return TRUE;
  }
  g_autofree char *file = g_strconcat("layout.file=", layout, NULL);
  const char *const sets[] = {file, "layout.scale=1.3", NULL};
  const job c432 = {"c432", "dpb.yaml", sets, 1, 10, 0.5};
  return measure(&c432, folder);
}

int main(void) {
  static const job demo = {"demo", "demo.yaml", NULL, 3, 2, 0.5};
  g_autoptr(GError) error = NULL;
  g_autofree char *folder = g_dir_make_tmp("opcflow-bench-XXXXXX", &error);
  if (!folder) {
    fprintf(stderr, "error: %s\n", error->message);
    return EXIT_FAILURE;
  }
  gboolean good = measure(&demo, folder) && measure_c432(folder);
  opc_remove_tree(folder);
  return good ? bench_write("correction") : EXIT_FAILURE;
}
