/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures reading of large layouts: one flat cell of rectangles, as GDSII and
   OASIS, by the command and, if available, by KLayout's Python module. Also
   measures `opcflow check`. Results are wall-clock times and peak memory. */
#include <errno.h>
#include <fcntl.h>
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <store/files.h>
#include "bench/bench.h"

enum { RECTANGLES = 10 * 1000 * 1000, LAYERS = 10, REPEATS = 3, CHECKS = 15 };

/* Time and memory of a process. */
typedef struct cost {
  double seconds, megabytes;
} cost;

static const char *setting(const char *name, const char *preset) {
  const char *value = g_getenv(name);
  return value ? value : preset;
}

/* ---- the rectangles: the same for both formats ---- */

typedef struct rectangle {
  uint32_t layer;
  int32_t x, y, width, height;
} rectangle;

/* Return a random number by the generator of Numerical Recipes, so that the
   files are equal on all machines. */
static uint32_t next_random(uint32_t *state) {
  *state = *state * 1664525u + 1013904223u;
  return *state >> 8;
}

/* Return rectangle i: random size, on a coarse grid. Long sequences are on the
   same layer, as in files of layout tools. */
static rectangle rectangle_at(uint32_t i, uint32_t *state) {
  rectangle r = {.layer = i / (RECTANGLES / LAYERS) + 1};
  r.x = (int32_t)(i % 3163) * 400 + (int32_t)(next_random(state) % 200);
  r.y = (int32_t)(i / 3163) * 400 + (int32_t)(next_random(state) % 200);
  r.width = 40 + (int32_t)(next_random(state) % 160);
  r.height = 40 + (int32_t)(next_random(state) % 160);
  return r;
}

/* ---- GDSII ---- */

static uint8_t *gds_head(uint8_t *p, size_t n, uint8_t type, uint8_t kind) {
  *p++ = (uint8_t)((n + 4) >> 8);
  *p++ = (uint8_t)(n + 4);
  *p++ = type;
  *p++ = kind;
  return p;
}

static uint8_t *gds_number(uint8_t *p, uint32_t v, int bytes) {
  while (bytes--) *p++ = (uint8_t)(v >> 8 * bytes);
  return p;
}

static uint8_t *gds_rectangle(uint8_t *p, rectangle r) {
  int32_t x1 = r.x + r.width, y1 = r.y + r.height;
  const int32_t xy[] = {r.x, r.y, r.x, y1, x1, y1, x1, r.y, r.x, r.y};
  p = gds_head(p, 0, 0x08, 0);
  p = gds_number(gds_head(p, 2, 0x0d, 2), r.layer, 2);
  p = gds_number(gds_head(p, 2, 0x0e, 2), 0, 2);
  p = gds_head(p, 40, 0x10, 3);
  for (int i = 0; i < 10; i++) p = gds_number(p, (uint32_t)xy[i], 4);
  return gds_head(p, 0, 0x11, 0);
}

static void write_gds(FILE *file) {
  /* a database unit is 1e-3 user units and 1e-9 m, as base-16 numbers */
  static const uint8_t units[16] = {0x3e, 0x41, 0x89, 0x37, 0x4b, 0xc6,
                                    0xa7, 0xf0, 0x39, 0x44, 0xb8, 0x2f,
                                    0xa0, 0x9b, 0x5a, 0x54};
  uint8_t head[256] = {0}, *p = head;
  p = gds_number(gds_head(p, 2, 0x00, 2), 600, 2);
  p = gds_head(p, 24, 0x01, 2) + 24;
  p = (uint8_t *)memcpy(gds_head(p, 4, 0x02, 6), "FLAT", 4) + 4;
  p = (uint8_t *)memcpy(gds_head(p, 16, 0x03, 5), units, 16) + 16;
  p = gds_head(p, 24, 0x05, 2) + 24;
  p = (uint8_t *)memcpy(gds_head(p, 4, 0x06, 6), "FLAT", 4) + 4;
  fwrite(head, 1, (size_t)(p - head), file);
  uint32_t state = 1;
  for (uint32_t i = 0; i < RECTANGLES; i++) {
    uint8_t one[64];
    gds_rectangle(one, rectangle_at(i, &state));
    fwrite(one, 1, sizeof one, file);
  }
  p = gds_head(gds_head(head, 0, 0x07, 0), 0, 0x04, 0);
  fwrite(head, 1, (size_t)(p - head), file);
}

/* ---- OASIS ---- */

static uint8_t *oasis_number(uint8_t *p, uint32_t v) {
  for (; v > 127; v >>= 7) *p++ = (uint8_t)(v | 128);
  *p++ = (uint8_t)v;
  return p;
}

static uint8_t *oasis_text(uint8_t *p, const char *text) {
  size_t n = strlen(text);
  *p++ = (uint8_t)n;
  return (uint8_t *)memcpy(p, text, n) + n;
}

/* Append a rectangle. Layer and datatype are written only if they differ from
   those of the previous rectangle. */
static uint8_t *oasis_rectangle(uint8_t *p, rectangle r, uint32_t layer) {
  uint8_t more = r.layer != layer ? 0x03 : 0;
  *p++ = 20;
  *p++ = 0x78 | more; /* W H X Y */
  if (more) {
    p = oasis_number(p, r.layer);
    p = oasis_number(p, 0);
  }
  p = oasis_number(p, (uint32_t)r.width);
  p = oasis_number(p, (uint32_t)r.height);
  p = oasis_number(p, (uint32_t)r.x << 1); /* signed: the lowest bit */
  return oasis_number(p, (uint32_t)r.y << 1);
}

static void write_oasis(FILE *file) {
  uint8_t head[256] = {0}, *p = head;
  fputs("%SEMI-OASIS\r\n", file);
  *p++ = 1; /* START: version, units a micrometre, tables at the end */
  p = oasis_text(p, "1.0");
  p = oasis_number(p, 0);
  p = oasis_number(p, 1000);
  p = oasis_number(p, 1);
  *p++ = 14; /* CELL by name */
  p = oasis_text(p, "FLAT");
  fwrite(head, 1, (size_t)(p - head), file);
  uint32_t state = 1, layer = 0;
  for (uint32_t i = 0; i < RECTANGLES; i++) {
    uint8_t one[32];
    rectangle r = rectangle_at(i, &state);
    p = oasis_rectangle(one, r, layer);
    layer = r.layer;
    fwrite(one, 1, (size_t)(p - one), file);
  }
  /* END has 256 bytes: no tables, a padding string, no validation. */
  memset(head, 0, sizeof head);
  p = head;
  *p++ = 2;
  p += 12;
  size_t padding = sizeof head - (size_t)(p - head) - 3;
  oasis_number(p, (uint32_t)padding);
  fwrite(head, 1, sizeof head, file);
}

static gboolean file_make(const char *path, void (*write_file)(FILE *file)) {
  FILE *file = fopen(path, "wb");
  static char buffer[1 << 20];
  if (file) {
    setvbuf(file, buffer, _IOFBF, sizeof buffer);
    write_file(file);
  }
  gboolean good = file && !ferror(file);
  if (file && fclose(file)) good = FALSE;
  if (!good) fprintf(stderr, "error: '%s': %s\n", path, g_strerror(errno));
  return good;
}

/* ---- processes ---- */

/* Run a program to the end, without output if `quiet` is set. Return FALSE on
   failure. */
static gboolean program_run(char **argv, gboolean quiet, cost *c) {
  gint64 before = g_get_monotonic_time();
  pid_t child = fork();
  if (!child) {
    int nowhere = open("/dev/null", O_RDWR);
    dup2(nowhere, STDOUT_FILENO);
    if (quiet) dup2(nowhere, STDERR_FILENO);
    execvp(argv[0], argv);
    _exit(127);
  }
  int status = -1;
  struct rusage usage;
  if (child < 0 || wait4(child, &status, 0, &usage) != child) return FALSE;
  c->seconds = (double)(g_get_monotonic_time() - before) * 1e-6;
  c->megabytes = (double)usage.ru_maxrss / 1024;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/* Measure the median time and the peak memory of several runs. */
static gboolean program_repeat(char **argv, size_t n, const char *folder,
                               cost *c) {
  double seconds[CHECKS];
  c->megabytes = 0;
  for (size_t i = 0; i < n; i++) {
    cost one;
    if (folder) opc_remove_tree(folder);
    if (!program_run(argv, FALSE, &one)) return FALSE;
    seconds[i] = one.seconds;
    c->megabytes = MAX(c->megabytes, one.megabytes);
  }
  c->seconds = bench_median(seconds, n);
  return TRUE;
}

static void figure_report(const char *name, cost c, double seconds,
                          double megabytes) {
  g_autofree char *time = g_strconcat(name, ".seconds", NULL);
  g_autofree char *memory = g_strconcat(name, ".memory", NULL);
  bench_report(time, c.seconds, "s", seconds, BENCH_LOWER);
  bench_report(memory, c.megabytes, "MB", megabytes, BENCH_LOWER);
}

/* ---- reading ---- */

static gboolean read_by_command(const char *folder, const char *plugin,
                                const char *path, cost *c) {
  g_autofree char *flow = g_build_filename(folder, "read.yaml", NULL);
  g_autofree char *result = g_build_filename(folder, "run", NULL);
  g_autofree char *text = g_strdup_printf(
      "opcflow: 1\nsteps:\n  layout: { use: %s, file: '%s' }\n", plugin, path);
  if (!g_file_set_contents(flow, text, -1, NULL)) return FALSE;
  char *argv[] = {(char *)setting("OPCFLOW_COMMAND", "opcflow"),
                  (char *)"run",
                  flow,
                  (char *)"--quiet",
                  (char *)"--output",
                  result,
                  NULL};
  return program_repeat(argv, REPEATS, result, c);
}

static gboolean has_klayout(void) {
  char *argv[] = {(char *)"python3", (char *)"-c", (char *)"import klayout.db",
                  NULL};
  cost c;
  return program_run(argv, TRUE, &c);
}

static gboolean read_by_klayout(const char *path, cost *c) {
  char *argv[] = {(char *)"python3", (char *)"-c",
                  (char *)"import sys, klayout.db\n"
                          "klayout.db.Layout().read(sys.argv[1])",
                  (char *)path, NULL};
  return program_repeat(argv, REPEATS, NULL, c);
}

/* Goals: three quarters of KLayout's time, and half of its memory. */
static gboolean reader_measure(const char *folder, const char *name,
                               const char *plugin,
                               void (*write_file)(FILE *file),
                               gboolean klayout) {
  g_autofree char *path = g_build_filename(folder, name, NULL);
  g_autofree char *theirs = g_strconcat("klayout.", name, NULL);
  cost ours, other = {NAN, NAN};
  gboolean good = file_make(path, write_file) &&
                  read_by_command(folder, plugin, path, &ours) &&
                  (!klayout || read_by_klayout(path, &other));
  unlink(path);
  if (!good) {
    fprintf(stderr, "error: %s could not be read\n", name);
    return FALSE;
  }
  figure_report(name, ours, klayout ? 0.75 * other.seconds : INFINITY,
                klayout ? other.megabytes / 2 : INFINITY);
  if (klayout) figure_report(theirs, other, INFINITY, INFINITY);
  return TRUE;
}

/* ---- checking ---- */

/* Remove the files of a folder from the kernel's cache. */
static void cache_forget(const char *folder) {
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  for (const char *name; dir && (name = g_dir_read_name(dir));) {
    g_autofree char *path = g_build_filename(folder, name, NULL);
    int file = open(path, O_RDONLY);
    if (file < 0) continue;
    posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
    close(file);
  }
}

static gboolean measure_check(void) {
  const char *source = setting("OPCFLOW_SOURCE", ".");
  const char *command = setting("OPCFLOW_COMMAND", "opcflow");
  g_autofree char *flows = g_build_filename(source, "flows", NULL);
  g_autofree char *flow = g_build_filename(flows, "demo.yaml", NULL);
  g_autofree char *bin = g_path_get_dirname(command);
  char *argv[] = {(char *)command, (char *)"check", flow, NULL};
  cost cold, warm;
  cache_forget(flows);
  cache_forget(bin);
  cache_forget(setting("OPCFLOW_PLUGIN_PATH", "plugins"));
  if (!program_repeat(argv, 1, NULL, &cold) ||
      !program_repeat(argv, CHECKS, NULL, &warm)) {
    fprintf(stderr, "error: '%s' could not be checked\n", flow);
    return FALSE;
  }
  bench_report("check.warm", 1e3 * warm.seconds, "ms", 20, BENCH_LOWER);
  bench_report("check.cold", 1e3 * cold.seconds, "ms", 200, BENCH_LOWER);
  return TRUE;
}

int main(void) {
  g_autoptr(GError) error = NULL;
  g_autofree char *folder = g_dir_make_tmp("opcflow-bench-XXXXXX", &error);
  if (!folder) {
    fprintf(stderr, "error: %s\n", error->message);
    return EXIT_FAILURE;
  }
  gboolean klayout = has_klayout();
  if (!klayout) fprintf(stderr, "klayout: skipped, no Python module\n");
  gboolean good =
      measure_check() &&
      reader_measure(folder, "flat.gds", "read.gds", write_gds, klayout) &&
      reader_measure(folder, "flat.oas", "read.oasis", write_oasis, klayout);
  opc_remove_tree(folder);
  return good ? bench_write("layout") : EXIT_FAILURE;
}
