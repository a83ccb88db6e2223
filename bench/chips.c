/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures correction by classes from file to file for layouts of increasing
   size: square arrays of the memory cell and, if OPCFLOW_TEST_DATA has them,
   macros of IHP. Reports processor time, peak memory, number of masks, and size
   of the mask file. */
#include <fcntl.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <store/files.h>
#include "bench/bench.h"

/* Pitch of the memory array, um, and number of transistors in the array cell.
   The pitch is the size of the cell plus a margin. */
enum { PITCH_X = 4, PITCH_Y = 13, TRANSISTORS = 192 };

static const char *setting(const char *name, const char *preset) {
  const char *value = g_getenv(name);
  return value ? value : preset;
}

/* ---- processes ---- */

typedef struct cost {
  double seconds, megabytes; /* CPU time; peak memory */
} cost;

static gboolean program_run(char **argv, cost *c) {
  pid_t child = fork();
  if (!child) {
    int nowhere = open("/dev/null", O_RDWR);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execvp(argv[0], argv);
    _exit(127);
  }
  int status = -1;
  struct rusage usage;
  if (child < 0 || wait4(child, &status, 0, &usage) != child) return FALSE;
  c->seconds = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
               1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  c->megabytes = (double)usage.ru_maxrss / 1024;
  /* exit code 1: the run violates a requirement, but all files are written */
  return WIFEXITED(status) && WEXITSTATUS(status) <= 1;
}

static double size_of(const char *path) {
  struct stat s;
  return stat(path, &s) ? NAN : (double)s.st_size;
}

/* ---- a layout ---- */

static const char rest[] =
    "name: bench\n"
    "steps:\n"
    "  file: { use: write.oasis, mask: \"${mask}\", file: mask.oas }\n"
    "  picture: { use: draw.mask, mask: \"${mask}\" }\n";

static void figure_report(const char *name, const char *what, double value,
                          const char *unit, double reach) {
  g_autofree char *full = g_strdup_printf("%s.%s", name, what);
  bench_report(full, value, unit, reach, BENCH_LOWER);
}

/* Measure a correction with fast simulations by a flow that extends `base`;
   `more` has further arguments. */
static gboolean chip_measure(const char *folder, const char *name,
                             const char *base, char **more, double transistors,
                             double area, const char *layout) {
  g_autofree char *flow = g_build_filename(folder, "bench.yaml", NULL);
  g_autofree char *result = g_build_filename(folder, "run", NULL);
  g_autofree char *mask = g_build_filename(result, "mask.oas", NULL);
  g_autofree char *text =
      g_strdup_printf("opcflow: 1\nextends: %s/flows/%s\n%s",
                      setting("OPCFLOW_SOURCE", "."), base, rest);
  if (!g_file_set_contents(flow, text, -1, NULL)) return FALSE;
  g_autoptr(GPtrArray) argv = g_ptr_array_new();
  char *const fixed[] = {(char *)setting("OPCFLOW_COMMAND", "opcflow"),
                         (char *)"run",
                         flow,
                         (char *)"--output",
                         result,
                         (char *)"--set",
                         (char *)"mask.fine=off"};
  for (size_t i = 0; i < G_N_ELEMENTS(fixed); i++)
    g_ptr_array_add(argv, fixed[i]);
  for (; *more; more++) g_ptr_array_add(argv, *more);
  g_ptr_array_add(argv, NULL);
  cost c;
  opc_remove_tree(result);
  if (!program_run((char **)argv->pdata, &c)) return FALSE;
  figure_report(name, "seconds", c.seconds, "s CPU", INFINITY);
  figure_report(name, "per_transistor", 1e6 * c.seconds / transistors, "us CPU",
                INFINITY);
  figure_report(name, "per_area", 1e6 * c.seconds / area, "us CPU / um^2",
                INFINITY);
  figure_report(name, "memory", c.megabytes, "MB", INFINITY);
  figure_report(name, "mask_file", size_of(mask) / size_of(layout),
                "of the layout's", 3);
  return TRUE;
}

/* ---- array of the memory cell ---- */

/* Write an array of columns and rows as CIF, by repetition of the last call. */
static gboolean make_square(const char *path, int columns, int rows) {
  g_autofree char *source = g_build_filename(
      setting("OPCFLOW_SOURCE", "."), "data", "cells65", "sram4.cif", NULL);
  g_autofree char *text = NULL;
  if (!g_file_get_contents(source, &text, NULL, NULL)) return FALSE;
  char *call = g_strrstr(text, "C 4;");
  if (!call) return FALSE;
  GString *out = g_string_new_len(text, call - text);
  g_string_append(out, "DS 99 1 10;\n9 square;\n");
  for (int y = 0; y < rows; y++)
    for (int x = 0; x < columns; x++)
      g_string_append_printf(out, "C 4 T %d %d;\n", x * PITCH_X * 1000,
                             y * PITCH_Y * 1000);
  g_string_append(out, "DF;\nC 99;\nE\n");
  gboolean good = g_file_set_contents(path, out->str, (gssize)out->len, NULL);
  g_string_free(out, TRUE);
  return good;
}

static gboolean measure_square(const char *folder, int side) {
  int columns = side / PITCH_X, rows = side / PITCH_Y;
  g_autofree char *path = g_build_filename(folder, "square.cif", NULL);
  g_autofree char *file = g_strconcat("layout.file=", path, NULL);
  g_autofree char *name = g_strdup_printf("square_%d_um", side);
  char *more[] = {(char *)"--set",
                  (char *)"layout.use=read.cif",
                  (char *)"--set",
                  file,
                  (char *)"--set",
                  (char *)"layout.layers={ poly: CP, active: CA, contact: CC, "
                          "nwell: CW }",
                  NULL};
  return make_square(path, columns, rows) &&
         chip_measure(folder, name, "chip.yaml", more,
                      (double)TRANSISTORS * columns * rows,
                      (double)PITCH_X * columns * PITCH_Y * rows, path);
}

/* ---- macros ---- */

static gboolean measure_macro(const char *folder, const char *data,
                              const char *macro, double transistors,
                              double area) {
  g_autofree char *file =
      g_strdup_printf("%s/RM_IHPSG13_1P_%s.gds", data, macro);
  g_autofree char *set = g_strconcat("layout.file=", file, NULL);
  char *more[] = {(char *)"--set", set, NULL};
  return chip_measure(folder, macro, "processes/ihp130.yaml", more, transistors,
                      area, file);
}

int main(void) {
  static const int sides[] = {13, 52, 156, 520};
  static const struct {
    const char *name;
    double transistors, area; /* um^2 */
  } macros[] = {{"256x8_c3_bm_bist", 18283, 237 * 74},
                {"1024x64_c2_bm_bist", 423263, 784 * 336},
                {"8192x32_c4", 1629871, 1520 * 618}};
  g_autoptr(GError) error = NULL;
  g_autofree char *folder = g_dir_make_tmp("opcflow-bench-XXXXXX", &error);
  if (!folder) {
    fprintf(stderr, "error: %s\n", error->message);
    return EXIT_FAILURE;
  }
  gboolean good = TRUE;
  for (size_t i = 0; i < G_N_ELEMENTS(sides) && good; i++)
    good = measure_square(folder, sides[i]);
  const char *data = g_getenv("OPCFLOW_TEST_DATA");
  g_autofree char *ihp = data ? g_build_filename(data, "ihp130", NULL) : NULL;
  if (!ihp) fprintf(stderr, "macros: skipped, no OPCFLOW_TEST_DATA\n");
  for (size_t i = 0; i < G_N_ELEMENTS(macros) && good && ihp; i++)
    good = measure_macro(folder, ihp, macros[i].name, macros[i].transistors,
                         macros[i].area);
  opc_remove_tree(folder);
  if (!good) fprintf(stderr, "error: a chip could not be corrected\n");
  return good ? bench_write("chips") : EXIT_FAILURE;
}
