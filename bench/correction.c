/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures runs of the command from file to file: the NAND2, and circuits if
   test data exist. Figures are the time relative to fast simulations alone, the
   deviations of the currents, and these deviations after a simulation by a
   different model.
   bench_correction [NAME ...]: run only these cases; "library" are circuits
   assembled from the masks of their cells.
   OPCFLOW_BEFORE=FOLDER is the source of another version with a build in
   FOLDER/build. If the results are comparable, the two versions run each flow
   alternately. */
#include <glib.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <store/files.h>
#include "bench/bench.h"

enum { MAX_REPEATS = 9, MAX_SETS = 8, MAX_FIGURES = 8 };

typedef struct figure {
  const char *step, *metric; /* "seconds": run time of the step, from the
                                manifest */
  double reach;              /* goal; 0 for a figure without a goal */
  const char *unit;          /* NULL for a plain number */
} figure;

/* The measured version, or the other version (OPCFLOW_BEFORE). */
typedef struct version {
  const char *command, *source;
  char **environment;
} version;

typedef struct correction_case {
  const char *name;           /* prefix of the figures */
  const char *flow;           /* in flows/ */
  const char *variant;        /* variant of the flow, or NULL */
  const char *circuit;        /* circuit of ISCAS'85; NULL for the layout that
                                 the flow names */
  size_t repeats;             /* number of runs; the median is reported */
  double seconds;             /* goal of the run time; 0 without a goal */
  const char *sets[MAX_SETS]; /* STEP.PARAMETER=VALUE */
  figure figures[MAX_FIGURES];
  /* Settings of the reference run, which uses fast simulations alone, and the
     allowed ratio of the times. Without settings, the reference run is that of
     the other version. Runs alternate with reference runs. */
  const char *cheap[MAX_SETS];
  double times;
} correction_case;

#define SCANNER "wavelength: 193 nm, na: 0.75, sigma: 0.75"

static const correction_case jobs[] = {
    {.name = "demo",
     .flow = "demo.yaml",
     .repeats = 3,
     .seconds = 2,
     .figures = {{"mask", "ion_max", 0.5, "%"}}},
    {.name = "c432.dpb",
     .flow = "dpb.yaml",
     .circuit = "c432",
     .repeats = 3,
     .seconds = 10,
     .figures = {{"mask", "ion_mean", 0, "%"}, {"mask", "ion_max", 0.5, "%"}}},
    {.name = "c432.newton",
     .flow = "newton.yaml",
     .circuit = "c432",
     .repeats = 3,
     .figures = {{"mask", "ion_mean", 0.04, "%"},
                 {"mask", "ion_max", 0.4, "%"},
                 {"mask", "ioff_mean", 3, "%"},
                 {"mask", "ioff_total", 2, "%"}}},
    /* Verification of the same mask by a different model. */
    {.name = "c432.verified",
     .flow = "newton.yaml",
     .variant = "verified",
     .circuit = "c432",
     .repeats = 1,
     .figures = {{"verify", "ion_mean", 0.04, "%"},
                 {"verify", "ion_max", 0.4, "%"},
                 {"verify", "ion_change_max", 0.1, "%"}}},
    /* A correction with accurate simulations and its verification may take at
       most twice the time of the same displacements with fast simulations
       alone. */
    {.name = "c7552.newton_plain",
     .flow = "newton.yaml",
     .circuit = "c7552",
     .repeats = 3,
     .sets = {"picture=~", "mask.synthesizer.target=plain"},
     .figures = {{"mask", "ion_mean", 0.04, "%"},
                 {"mask", "ion_max", 0.4, "%"},
                 {"mask", "simulations", 16,
                  NULL}, /* simulations of both layers */
                 {"mask", "fine_simulations", 4, NULL}},
     .cheap = {"mask.fine=off", "mask.margin=1 um"},
     .times = 2},
    /* The default target, compared with fast simulations and Ion as the only
       target. */
    {.name = "c7552.newton",
     .flow = "newton.yaml",
     .circuit = "c7552",
     .repeats = 1,
     .sets = {"picture=~"},
     .figures = {{"mask", "ion_mean", 0.04, "%"},
                 {"mask", "ion_max", 0.4, "%"},
                 {"mask", "ioff_mean", 3, "%"},
                 {"mask", "ioff_max", 30, "%"},
                 {"mask", "ioff_total", 2, "%"},
                 {"mask", "area_mean", 3, "%"},
                 {"mask", "simulations", 16, NULL},
                 {"mask", "fine_simulations", 4, NULL}},
     .cheap = {"mask.synthesizer.target=plain", "mask.fine=off",
               "mask.margin=1 um"},
     .times = 2},
    {.name = "c7552.newton_full",
     .flow = "newton.yaml",
     .circuit = "c7552",
     .repeats = 1,
     .sets = {"picture=~", "mask.synthesizer.target=full"},
     .figures = {{"mask", "ion_mean", 0.04, "%"},
                 {"mask", "ioff_mean", 3, "%"},
                 {"mask", "ioff_total", 2, "%"},
                 {"mask", "area_mean", 0.5, "%"}}},
    /* One accurate simulation of both layers, with its preparation. */
    {.name = "c7552.fine",
     .flow = "newton.yaml",
     .circuit = "c7552",
     .repeats = 1,
     .variant = "verified",
     .sets = {"verify.litho={ use: litho.hopkins, " SCANNER " }",
              "verify.fine=1e-4"},
     .figures = {{"verify", "seconds", 2.25, "s"}}},
    {.name = "c7552.dpb",
     .flow = "dpb.yaml",
     .circuit = "c7552",
     .repeats = 1,
     .seconds = 8,
     .figures = {{"mask", "ion_mean", 0, "%"}, {"mask", "ion_max", 0.5, "%"}}},
};

static const char *setting(const char *name, const char *preset) {
  const char *value = g_getenv(name);
  return value ? value : preset;
}

static version this_version(void) {
  return (version){setting("OPCFLOW_COMMAND", "opcflow"),
                   setting("OPCFLOW_SOURCE", "."), g_get_environ()};
}

/* Return the other version; NULL without OPCFLOW_BEFORE. */
static const version *other_version(void) {
  static version before;
  const char *source = g_getenv("OPCFLOW_BEFORE");
  if (!source || before.command) return source ? &before : NULL;
  char *plugins = g_build_filename(source, "build", "plugins", NULL);
  before = (version){
      g_build_filename(source, "build", "opcflow", NULL), source,
      g_environ_setenv(g_get_environ(), "OPCFLOW_PLUGIN_PATH", plugins, TRUE)};
  g_free(plugins);
  return &before;
}

static void add_sets(GPtrArray *argv, const char *const *sets) {
  for (size_t i = 0; i < MAX_SETS && sets[i]; i++) {
    g_ptr_array_add(argv, (char *)"--set");
    g_ptr_array_add(argv, (char *)sets[i]);
  }
}

/* Run a flow into `folder` with the settings of the case and `more`. Return the
   time, s, or -1. A run that violates a requirement is valid. */
static double run_once(const correction_case *j, const version *v,
                       const char *const *more, const char *layout,
                       const char *folder) {
  g_autoptr(GPtrArray) argv = g_ptr_array_new();
  g_autofree char *flow = g_build_filename(v->source, "flows", j->flow, NULL);
  const char *start[] = {v->command, "run",  flow,        "--quiet",
                         "--output", folder, "--variant", j->variant};
  size_t n = G_N_ELEMENTS(start) - (j->variant ? 0 : 2);
  for (size_t i = 0; i < n; i++) g_ptr_array_add(argv, (char *)start[i]);
  g_autofree char *file = g_strdup_printf("layout.file=%s", layout);
  const char *of_circuit[MAX_SETS] = {file, "layout.scale=1.3"};
  if (layout) add_sets(argv, of_circuit);
  add_sets(argv, j->sets);
  if (more) add_sets(argv, more);
  g_ptr_array_add(argv, NULL);
  g_autoptr(GError) error = NULL;
  int status;
  gint64 before = g_get_monotonic_time();
  gboolean good = g_spawn_sync(NULL, (char **)argv->pdata, v->environment,
                               G_SPAWN_SEARCH_PATH, NULL, NULL, NULL, NULL,
                               &status, &error) &&
                  g_spawn_check_wait_status(status, &error);
  double seconds = (double)(g_get_monotonic_time() - before) / 1e6;
  if (good) return seconds;
  fprintf(stderr, "%s: %s\n", j->name, error->message);
  return g_error_matches(error, G_SPAWN_EXIT_ERROR, 1) ? seconds : -1;
}

/* Read a metric of a run from metrics.json, or the run time of a step from the
   manifest. */
static gboolean read_metric(const char *folder, const figure *f,
                            double *value) {
  gboolean time = !strcmp(f->metric, "seconds");
  g_autofree char *path =
      g_build_filename(folder, time ? "manifest.json" : "metrics.json", NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_autoptr(GError) error = NULL;
  g_autofree char *where =
      time ? g_strdup_printf("$.steps.%s", f->step)
           : g_strdup_printf("$.%s.%s.value", f->step, f->metric);
  g_autoptr(JsonNode) found = NULL;
  if (json_parser_load_from_file(parser, path, &error))
    found = json_path_query(where, json_parser_get_root(parser), &error);
  JsonArray *matches = found ? json_node_get_array(found) : NULL;
  if (matches && json_array_get_length(matches) == 1) {
    *value = json_array_get_double_element(matches, 0);
    return TRUE;
  }
  fprintf(stderr, "error: '%s': %s\n", path,
          error ? error->message : "the metric does not exist");
  return FALSE;
}

/* Report a figure. A figure without a goal has the goal INFINITY. */
static void figure_report(const correction_case *j, const char *what,
                          double value, const char *unit, double reach) {
  g_autofree char *name = g_strdup_printf("%s.%s", j->name, what);
  bench_report(name, value, unit, reach > 0 ? reach : INFINITY, BENCH_LOWER);
}

static gboolean correction_measure(const correction_case *j,
                                   const char *folder) {
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
  const version this = this_version(), *other = other_version();
  double seconds[MAX_REPEATS], beside_it[MAX_REPEATS];
  for (size_t i = 0; i < j->repeats; i++) {
    g_autofree char *name = g_strdup_printf("%s-%zu", j->name, i);
    g_autofree char *cheap = g_strdup_printf("%s-beside-%zu", j->name, i);
    g_autofree char *second = g_build_filename(folder, cheap, NULL);
    g_free(run);
    run = g_build_filename(folder, name, NULL);
    seconds[i] = run_once(j, &this, NULL, layout, run);
    if (seconds[i] < 0) return FALSE;
    if (!j->cheap[0]) continue;
    beside_it[i] = other ? run_once(j, other, NULL, layout, second)
                         : run_once(j, &this, j->cheap, layout, second);
    if (beside_it[i] < 0) return FALSE;
  }
  double median = bench_median(seconds, j->repeats);
  figure_report(j, "seconds", median, "s", j->seconds);
  if (j->cheap[0]) {
    double cheap = bench_median(beside_it, j->repeats);
    figure_report(j, other ? "seconds_before" : "seconds_cheap", cheap, "s", 0);
    figure_report(j, other ? "times_before" : "times_cheap", median / cheap, "",
                  j->times);
  }
  for (size_t i = 0; i < MAX_FIGURES && j->figures[i].step; i++) {
    const figure *f = &j->figures[i];
    double value;
    if (!read_metric(run, f, &value)) return FALSE;
    figure_report(j, f->metric, value, f->unit ? f->unit : "", f->reach);
  }
  return TRUE;
}

/* ---- by cells (thesis table 4.2) ---- */

/* Variants of flows/library-methods.yaml: expected speed relative to DPB-OPC of
   the flat circuit, and deviation of the currents in the reference model. */
static const struct by_cells {
  const char *variant;
  double times;
  gboolean judged; /* compare the deviation with that of the flat circuit */
} by_cells[] = {
    {"dpb_placed", 40, FALSE}, {"dpb_2", 10, FALSE}, {"dpb_0", 5, TRUE}};

/* Run a variant. Return the time of the correction, s; -1 on failure. */
static double run_by_cells(const char *circuit, const char *variant,
                           const char *folder, double *ion) {
  g_autofree char *run = g_build_filename(folder, variant, NULL);
  g_autofree char *file = g_strconcat(circuit, ".gds", NULL);
  g_autofree char *layout = g_build_filename(setting("OPCFLOW_TEST_DATA", ""),
                                             "iscas85", circuit, file, NULL);
  correction_case j = {
      .name = "library",
      .flow = "library-methods.yaml",
      .variant = variant,
      .sets = {"layout.layers.outline=235/0", "mask.neighbours=outline"}};
  const version this = this_version();
  double seconds;
  opc_remove_tree(run);
  if (run_once(&j, &this, NULL, layout, run) < 0) return -1;
  const figure mask = {"mask", "seconds", 0, NULL},
               off = {"verify", "ion_mean", 0, NULL};
  return read_metric(run, &mask, &seconds) && read_metric(run, &off, ion)
             ? seconds
             : -1;
}

static gboolean measure_by_cells(const char *folder) {
  static const char *const circuits[] = {"c432", "c5315"};
  if (!g_getenv("OPCFLOW_TEST_DATA")) return TRUE;
  for (size_t c = 0; c < G_N_ELEMENTS(circuits); c++) {
    double ion, flat_ion,
        flat = run_by_cells(circuits[c], "dpb_flat", folder, &flat_ion);
    /* The first run corrects the cells. */
    if (flat < 0 || run_by_cells(circuits[c], "dpb_placed", folder, &ion) < 0)
      return FALSE;
    for (size_t i = 0; i < G_N_ELEMENTS(by_cells); i++) {
      const struct by_cells *b = &by_cells[i];
      double own = run_by_cells(circuits[c], b->variant, folder, &ion);
      if (own < 0) return FALSE;
      g_autofree char *name =
          g_strdup_printf("%s.library.%s", circuits[c], b->variant);
      g_autofree char *mean = g_strconcat(name, ".ion_mean", NULL);
      g_autofree char *times = g_strconcat(name, ".times", NULL);
      bench_report(times, flat / own, "", b->times, BENCH_HIGHER);
      bench_report(mean, ion, "%", b->judged ? flat_ion : INFINITY,
                   BENCH_LOWER);
    }
  }
  return TRUE;
}

static gboolean case_wanted(const correction_case *j, int argc, char **argv) {
  for (int i = 1; i < argc; i++)
    if (!strcmp(argv[i], j->name)) return TRUE;
  return argc == 1;
}

int main(int argc, char **argv) {
  g_autoptr(GError) error = NULL;
  g_autofree char *folder = g_dir_make_tmp("opcflow-bench-XXXXXX", &error);
  if (!folder) {
    fprintf(stderr, "error: %s\n", error->message);
    return EXIT_FAILURE;
  }
  gboolean good = TRUE;
  for (size_t i = 0; i < G_N_ELEMENTS(jobs) && good; i++)
    if (case_wanted(&jobs[i], argc, argv))
      good = correction_measure(&jobs[i], folder);
  const correction_case library = {.name = "library"};
  if (good && case_wanted(&library, argc, argv))
    good = measure_by_cells(folder);
  opc_remove_tree(folder);
  return good ? bench_write("correction") : EXIT_FAILURE;
}
