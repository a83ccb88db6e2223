/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a fixed, reproducible sequence of mutations of seeds: PROGRAM RUNS
   SUFFIX FILE-OR-FOLDER ... Test data, if available, are further seeds. A slow
   input is a failure. After a crash, the file named by OPCFLOW_FUZZ_INPUT, if
   set, has the input. */
#include <glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz.h"

enum { LARGEST = 1 << 15, MUTATIONS = 6 };

/* Time limit of an input, s, sufficient under sanitizers. */
static const double patience = 5;

static uint64_t state = 0x9e3779b97f4a7c15;

/* xorshift64*, Vigna 2016 */
static uint32_t random_below(uint32_t n) {
  state ^= state >> 12;
  state ^= state << 25;
  state ^= state >> 27;
  return (uint32_t)((state * 0x2545f4914f6cdd1d) >> 33) % (n ? n : 1);
}

/* ---- seeds ---- */

static void add_seed(GPtrArray *seeds, const char *path, const char *suffix) {
  char *data;
  gsize size;
  if (!g_str_has_suffix(path, suffix) ||
      !g_file_get_contents(path, &data, &size, NULL))
    return;
  if (size <= LARGEST)
    g_ptr_array_add(seeds, g_bytes_new_take(data, size));
  else
    g_free(data);
}

static gint by_content(gconstpointer a, gconstpointer b) {
  return g_bytes_compare(*(GBytes *const *)a, *(GBytes *const *)b);
}

static void add_seeds(GPtrArray *seeds, const char *path, const char *suffix) {
  g_autoptr(GDir) dir = g_dir_open(path, 0, NULL);
  if (!dir) add_seed(seeds, path, suffix);
  for (const char *name; dir && (name = g_dir_read_name(dir));) {
    g_autofree char *file = g_build_filename(path, name, NULL);
    add_seed(seeds, file, suffix);
  }
}

static void add_test_data(GPtrArray *seeds, const char *suffix) {
  const char *data = g_getenv("OPCFLOW_TEST_DATA");
  const char *source = g_getenv("OPCFLOW_SOURCE");
  g_autofree char *beside =
      g_build_filename(source ? source : ".", "..", "shared", "data", NULL);
  g_autofree char *corpus =
      g_build_filename(data ? data : beside, "gds-corpus", NULL);
  add_seeds(seeds, corpus, suffix);
}

/* ---- mutations ---- */

static void bytes_insert(GByteArray *a, guint at, const guint8 *data, guint n) {
  if (!n || a->len + n > LARGEST) return;
  g_byte_array_set_size(a, a->len + n);
  memmove(a->data + at + n, a->data + at, a->len - n - at);
  memcpy(a->data + at, data, n);
}

/* Insert a boundary value of one to eight bytes. */
static void put_number(GByteArray *a, guint at) {
  static const uint64_t edges[] = {
      0,          1,          2,         3,
      4,          0x7f,       0x80,      0xff,
      0x7fff,     0x8000,     0xffff,    0x7fffffff,
      0x80000000, 0xffffffff, INT64_MAX, (uint64_t)INT64_MIN,
      UINT64_MAX};
  uint64_t v = edges[random_below(G_N_ELEMENTS(edges))];
  guint n = 1u << random_below(4), big = random_below(2);
  for (guint i = 0; i < n && at + i < a->len; i++)
    a->data[at + i] = (guint8)(v >> 8 * (big ? n - 1 - i : i));
}

static void input_mutate(GByteArray *a, const GPtrArray *seeds) {
  guint at = random_below(a->len + 1), n = random_below(1u << random_below(9));
  n = MIN(n, a->len - at);
  gsize size;
  const guint8 *other =
      g_bytes_get_data(seeds->pdata[random_below(seeds->len)], &size);
  guint from = random_below((guint)size),
        some = random_below(1u << random_below(9));
  some = MIN(some, (guint)size - from);
  g_autofree guint8 *copy = NULL;
  switch (random_below(7)) {
    case 0:
      if (at < a->len) a->data[at] ^= (guint8)(1u << random_below(8));
      break;
    case 1:
      if (at < a->len) a->data[at] = (guint8)random_below(256);
      break;
    case 2:
      put_number(a, at);
      break;
    case 3:
      if (n) g_byte_array_remove_range(a, at, n);
      break;
    case 4:
      copy = g_memdup2(a->data + at, n);
      bytes_insert(a, random_below(a->len + 1), copy, n);
      break;
    case 5:
      bytes_insert(a, at, other + from, some);
      break;
    default:
      memcpy(a->data + at, other + from, MIN(some, a->len - at));
  }
}

static void run_one(const GByteArray *a) {
  static const char *keep;
  if (!keep && !(keep = g_getenv("OPCFLOW_FUZZ_INPUT"))) keep = "";
  if (*keep)
    g_file_set_contents(keep, (const char *)a->data, (gssize)a->len, NULL);
  gint64 before = g_get_monotonic_time();
  LLVMFuzzerTestOneInput(a->data, a->len);
  double seconds = (double)(g_get_monotonic_time() - before) * 1e-6;
  if (seconds > patience) g_error("an input took %.1f s", seconds);
}

int main(int argc, char **argv) {
  if (argc < 4) {
    fprintf(stderr, "usage: %s RUNS SUFFIX FILE-OR-FOLDER ...\n", argv[0]);
    return 2;
  }
  g_autoptr(GPtrArray) seeds =
      g_ptr_array_new_with_free_func((GDestroyNotify)g_bytes_unref);
  for (int i = 3; i < argc; i++) add_seeds(seeds, argv[i], argv[2]);
  add_test_data(seeds, argv[2]);
  g_ptr_array_sort(seeds, by_content); /* independent of the order of directory
                                          entries */
  if (!seeds->len) {
    fprintf(stderr, "error: no seeds\n");
    return 1;
  }
  long runs = strtol(argv[1], NULL, 10);
  g_autoptr(GByteArray) input = g_byte_array_new();
  gint64 before = g_get_monotonic_time();
  for (long i = 0; i < runs; i++) {
    gsize size;
    const guint8 *seed =
        g_bytes_get_data(seeds->pdata[(guint)i % seeds->len], &size);
    g_byte_array_set_size(input, 0);
    g_byte_array_append(input, seed, (guint)size);
    guint n = i < (long)seeds->len ? 0 : 1 + random_below(MUTATIONS);
    while (n--) input_mutate(input, seeds);
    run_one(input);
  }
  double seconds = (double)(g_get_monotonic_time() - before) * 1e-6;
  printf("%u seeds, %ld inputs, %.0f a second\n", seeds->len, runs,
         (double)runs / seconds);
  return 0;
}
