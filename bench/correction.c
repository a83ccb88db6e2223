/* SPDX-License-Identifier: BSD-3-Clause */
/* Whole runs of the command, as a user starts them, from file to file: our
   NAND2, and circuits where there are test data. How long they take, how far
   drive currents are from their design values, and what a finer model says of
   that. */
#include <glib.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/bench.h"
#include "core/flow/files.h"

enum { MAX_REPEATS = 9, MAX_SETS = 8, MAX_FIGURES = 5 };

typedef struct figure {
  const char *step, *metric;
  double reach; /* % */
} figure;

typedef struct job {
  const char *name;           /* of its figures */
  const char *flow;           /* in flows/ */
  const char *variant;        /* of it, or "base" */
  const char *circuit;        /* of ISCAS'85, NULL: what the flow has */
  size_t repeats;             /* the median counts */
  double seconds;             /* to reach; 0: not told */
  const char *sets[MAX_SETS]; /* STEP.PARAMETER=VALUE */
  figure figures[MAX_FIGURES];
} job;

static const job jobs[] = {
    {"demo",
     "demo.yaml",
     "base",
     NULL,
     3,
     2,
     {NULL},
     {{"mask", "ion_max", 0.5}}},
    {"c432.dpb",
     "dpb.yaml",
     "base",
     "c432",
     3,
     10,
     {"picture=~"},
     {{"mask", "ion_mean", 0}, {"mask", "ion_max", 0.5}}},
    {"c432.newton",
     "newton.yaml",
     "base",
     "c432",
     3,
     0,
     {"picture=~"},
     {{"mask", "ion_mean", 0.05}, {"mask", "ion_max", 0.5}}},
    {"c432.newton_area",
     "newton.yaml",
     "base",
     "c432",
     1,
     0,
     {"picture=~", "mask.synthesizer.weight.area=1"},
     {{"mask", "ion_mean", 0.2}, {"mask", "area_mean", 0.2}}},
    {"c432.verified",
     "newton.yaml",
     "verified",
     "c432",
     1,
     0,
     {"picture=~"},
     {{"verify", "ion_mean", 0.2}, {"verify", "ion_max", 0}}},
    {"c7552.newton",
     "newton.yaml",
     "base",
     "c7552",
     3,
     1.5,
     {"picture=~"},
     {{"mask", "ion_mean", 0.05}, {"mask", "ion_max", 0.5}}},
    {"c7552.dpb",
     "dpb.yaml",
     "base",
     "c7552",
     1,
     8,
     {"picture=~"},
     {{"mask", "ion_mean", 0}, {"mask", "ion_max", 0.5}}},
};

static const char *setting(const char *name, const char *preset) {
  const char *value = g_getenv(name);
  return value ? value : preset;
}

/* Run a flow into `folder`; the seconds it took, or -1. */
static double run_once(const job *j, const char *layout, const char *folder) {
  g_autoptr(GPtrArray) argv = g_ptr_array_new();
  g_autofree char *flow =
      g_build_filename(setting("OPCFLOW_SOURCE", "."), "flows", j->flow, NULL);
  g_ptr_array_add(argv, (char *)setting("OPCFLOW_COMMAND", "opcflow"));
  g_ptr_array_add(argv, (char *)"run");
  g_ptr_array_add(argv, flow);
  g_ptr_array_add(argv, (char *)"--quiet");
  g_ptr_array_add(argv, (char *)"--output");
  g_ptr_array_add(argv, (char *)folder);
  g_ptr_array_add(argv, (char *)"--variant");
  g_ptr_array_add(argv, (char *)j->variant);
  g_autofree char *file = g_strdup_printf("layout.file=%s", layout);
  const char *of_circuit[] = {file, "layout.scale=1.3"};
  for (size_t i = 0; layout && i < G_N_ELEMENTS(of_circuit); i++) {
    g_ptr_array_add(argv, (char *)"--set");
    g_ptr_array_add(argv, (char *)of_circuit[i]);
  }
  for (size_t i = 0; i < MAX_SETS && j->sets[i]; i++) {
    g_ptr_array_add(argv, (char *)"--set");
    g_ptr_array_add(argv, (char *)j->sets[i]);
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

/* A metric of a run, from its metrics.json. */
static gboolean read_metric(const char *folder, const figure *f,
                            double *value) {
  g_autofree char *path = g_build_filename(folder, "metrics.json", NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_autoptr(GError) error = NULL;
  g_autofree char *where = g_strdup_printf("$.%s.%s.value", f->step, f->metric);
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

/* What a figure without a reach is compared with: nothing. */
static void tell(const job *j, const char *what, double value, const char *unit,
                 double reach) {
  g_autofree char *name = g_strdup_printf("%s.%s", j->name, what);
  bench_report(name, value, unit, reach > 0 ? reach : INFINITY, BENCH_LOWER);
}

static gboolean measure(const job *j, const char *folder) {
  g_autofree char *beside = g_build_filename(setting("OPCFLOW_SOURCE", "."),
                                             "..", "shared", "data", NULL);
  g_autofree char *layout = NULL, *run = NULL;
  if (j->circuit) {
    g_autofree char *name = g_strconcat(j->circuit, ".gds", NULL);
    layout = g_build_filename(setting("OPCFLOW_TEST_DATA", beside), "iscas85",
                              j->circuit, name, NULL);
  }
  if (layout && !g_file_test(layout, G_FILE_TEST_EXISTS)) {
    fprintf(stderr, "%s: skipped, no '%s'\n", j->name, layout);
    return TRUE;
  }
  double seconds[MAX_REPEATS];
  for (size_t i = 0; i < j->repeats; i++) {
    g_autofree char *name = g_strdup_printf("%s-%zu", j->name, i);
    g_free(run);
    run = g_build_filename(folder, name, NULL);
    seconds[i] = run_once(j, layout, run);
    if (seconds[i] < 0) return FALSE;
  }
  tell(j, "seconds", bench_median(seconds, j->repeats), "s", j->seconds);
  for (size_t i = 0; i < MAX_FIGURES && j->figures[i].step; i++) {
    double value;
    if (!read_metric(run, &j->figures[i], &value)) return FALSE;
    tell(j, j->figures[i].metric, value, "%", j->figures[i].reach);
  }
  return TRUE;
}

int main(void) {
  g_autoptr(GError) error = NULL;
  g_autofree char *folder = g_dir_make_tmp("opcflow-bench-XXXXXX", &error);
  if (!folder) {
    fprintf(stderr, "error: %s\n", error->message);
    return EXIT_FAILURE;
  }
  gboolean good = TRUE;
  for (size_t i = 0; i < G_N_ELEMENTS(jobs) && good; i++)
    good = measure(&jobs[i], folder);
  opc_remove_tree(folder);
  return good ? bench_write("correction") : EXIT_FAILURE;
}
