/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects the figures of a benchmark, prints them and writes them as JSON. */
#include "bench/bench.h"

#include <json-glib/json-glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/report/table.h"

enum { MAX_FIGURES = 64 };

static struct {
  size_t n;
  const char *name[MAX_FIGURES], *unit[MAX_FIGURES], *better[MAX_FIGURES];
  const char *reached[MAX_FIGURES];
  double value[MAX_FIGURES], reach[MAX_FIGURES];
} all;

void bench_report(const char *name, double value, const char *unit,
                  double reach, int better) {
  size_t i = all.n++;
  if (i >= MAX_FIGURES) g_error("more than %d figures", MAX_FIGURES);
  all.name[i] = g_intern_string(name);
  all.unit[i] = g_intern_string(unit);
  all.better[i] = better == BENCH_LOWER ? "lower" : "higher";
  all.value[i] = value;
  all.reach[i] = reach;
  int good = better == BENCH_LOWER ? value <= reach : value >= reach;
  all.reached[i] = !isfinite(reach) ? "" : good ? "yes" : "no";
}

static void list_show(const char *name) {
  const opc_column columns[] = {
      {"name", NULL, OPC_TEXT, 0, all.name},
      {"value", NULL, OPC_REAL, 5, all.value},
      {"unit", NULL, OPC_TEXT, 0, all.unit},
      {"reach", NULL, OPC_REAL, 5, all.reach},
      {"better", NULL, OPC_TEXT, 0, all.better},
      {"reached", NULL, OPC_TEXT, 0, all.reached},
  };
  opc_error error;
  opc_table *table = opc_table_new(
      name, 0, all.n, columns, G_N_ELEMENTS(columns), sizeof *columns, &error);
  if (!table) g_error("%s", error.message);
  g_autofree char *text = opc_table_text(table, 0);
  printf("%s\n%s", name, text);
  opc_table_free(table);
}

static JsonNode *figure_list(void) {
  g_autoptr(JsonBuilder) b = json_builder_new();
  json_builder_begin_array(b);
  for (size_t i = 0; i < all.n; i++) {
    json_builder_begin_object(b);
    json_builder_set_member_name(b, "name");
    json_builder_add_string_value(b, all.name[i]);
    json_builder_set_member_name(b, "value");
    json_builder_add_double_value(b, all.value[i]);
    json_builder_set_member_name(b, "unit");
    json_builder_add_string_value(b, all.unit[i]);
    json_builder_set_member_name(b, "reach");
    if (isfinite(all.reach[i]))
      json_builder_add_double_value(b, all.reach[i]);
    else
      json_builder_add_null_value(b);
    json_builder_set_member_name(b, "better");
    json_builder_add_string_value(b, all.better[i]);
    json_builder_end_object(b);
  }
  json_builder_end_array(b);
  return json_builder_get_root(b);
}

int bench_write(const char *name) {
  const char *folder = g_getenv("OPCFLOW_BENCH");
  if (!folder) folder = ".";
  g_autofree char *file = g_strconcat(name, ".json", NULL);
  g_autofree char *path = g_build_filename(folder, file, NULL);
  g_autoptr(JsonNode) list = figure_list();
  g_autofree char *text = json_to_string(list, TRUE);
  g_autofree char *whole = g_strconcat(text, "\n", NULL);
  g_autoptr(GError) error = NULL;
  list_show(name);
  if (g_file_set_contents(path, whole, -1, &error)) return EXIT_SUCCESS;
  fprintf(stderr, "error: %s\n", error->message);
  return EXIT_FAILURE;
}

static int compare_names(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double bench_median(double *values, size_t n) {
  qsort(values, n, sizeof *values, compare_names);
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}
