/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests widths and spaces of masks against hand calculations and KLayout. */
#include "boxes_test.h"

#include <stdlib.h>

/* ---- masks ---- */

static size_t count_rule(const eda_violation *v, size_t n, const char *name,
                         double value) {
  size_t found = 0;
  for (size_t i = 0; i < n; i++)
    found += !strcmp(v[i].rule, name) && fabs(v[i].value - value) < 1e-9;
  return found;
}

/* Check widths, spaces and corners by hand calculations; the height of a jog is
   neither a width nor a space. */
static void test_mask(void) {
  static const struct {
    const char *name;
    size_t n, spaces, widths;
    int32_t xy[20][2];
    double value;
  } cases[] = {
      {"jog",
       8,
       0,
       0,
       {{-2, 0},
        {100, 0},
        {100, 50},
        {103, 50},
        {103, 200},
        {0, 200},
        {0, 100},
        {-2, 100}},
       0},
      {"narrow", 4, 0, 1, {{0, 0}, {39, 0}, {39, 200}, {0, 200}}, 39},
      {"wide enough", 4, 0, 0, {{0, 0}, {40, 0}, {40, 200}, {0, 200}}, 0},
      {"notch",
       8,
       1,
       0,
       {{0, 0},
        {300, 0},
        {300, 100},
        {160, 100},
        {160, 50},
        {130, 50},
        {130, 100},
        {0, 100}},
       30},
      {"neck",
       8,
       0,
       1,
       {{0, 0},
        {100, 0},
        {100, 70},
        {200, 70},
        {200, 200},
        {70, 200},
        {70, 100},
        {0, 100}},
       30 * M_SQRT2},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) m =
        drc_make("{ min_mask_width: 45 nm, min_space: 40 nm }");
    if (cases[i].value < 40)
      opc_test_module_free(g_steal_pointer(&m)),
          m = drc_make("{ min_mask_width: 40 nm, min_space: 40 nm }");
    chip c = {0};
    eda_violation v[10];
    boxes b = {0};
    for (size_t k = 0; k < cases[i].n; k++)
      b.points[k] = (eda_point){cases[i].xy[k][0], cases[i].xy[k][1]};
    b.start[1] = (uint32_t)cases[i].n;
    chip_show(&c);
    c.mask[EDA_POLY] = (eda_shapes){1, b.start, b.points, NULL};
    size_t n = drc_violations(m, &c.p, v, 10);
    g_test_message("%s", cases[i].name);
    g_assert_cmpuint(n, ==, cases[i].spaces + cases[i].widths);
    g_assert_cmpuint(count_rule(v, n, "mask space", cases[i].value), ==,
                     cases[i].spaces);
    g_assert_cmpuint(count_rule(v, n, "mask width", cases[i].value), ==,
                     cases[i].widths);
    chip_end(&c);
  }
}

static const char script[] =
    "import sys, klayout.db as k\n"
    "r = k.Region()\n"
    "for line in sys.stdin:\n"
    "  r.insert(k.Box(*map(int, line.split())))\n"
    "r.merge()\n"
    "p = k.Region.Projection\n"
    "for c in (r.width_check(40, False, p), r.space_check(40, False, p)):\n"
    "  print(*sorted(e.distance() for e in c.each()))\n";

static eda_shapes random_mask(uint32_t seed, GString *text, int n) {
  g_autoptr(GRand) rand = g_rand_new_with_seed(seed);
  opc_error error;
  g_autofree eda_point *points = g_new(eda_point, 4 * n);
  g_autofree uint32_t *start = g_new0(uint32_t, n + 1);
  for (int i = 0; i < n; i++) {
    int32_t x = g_rand_int_range(rand, 0, 6 * n),
            w = g_rand_int_range(rand, 5, 200);
    int32_t y = g_rand_int_range(rand, 0, 6 * n),
            h = g_rand_int_range(rand, 5, 200);
    eda_point p[4] = {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}};
    memcpy(points + 4 * i, p, sizeof p);
    start[i + 1] = 4 * (uint32_t)(i + 1);
    if (text) g_string_append_printf(text, "%d %d %d %d\n", x, y, x + w, y + h);
  }
  eda_shapes in = {(size_t)n, start, points, NULL}, out;
  g_assert_cmpint(eda_boolean(EDA_OR, &in, NULL, &out, &error), ==, OPC_OK);
  return out;
}

static char *ask_klayout(const char *text) {
  g_autofree char *path = g_build_filename(opc_test_folder(), "boxes", NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  g_autofree char *quoted = g_shell_quote(script);
  g_autofree char *command =
      g_strdup_printf("python3 -c %s < '%s'", quoted, path);
  const char *argv[] = {"sh", "-c", command, NULL};
  char *out = NULL;
  int status = -1;
  if (!g_spawn_sync(NULL, (char **)argv, NULL,
                    G_SPAWN_SEARCH_PATH | G_SPAWN_STDERR_TO_DEV_NULL, NULL,
                    NULL, &out, NULL, &status, NULL) ||
      status != 0) {
    g_free(out);
    return NULL;
  }
  return out;
}

/* Random rectangles: at each distance, the number of facing edges equals that
   of KLayout; some pairs of corners at these distances are found, too. */
static void test_klayout(void) {
  static const char *const rules[] = {"mask width", "mask space"};
  enum { ROOM = 100000 };
  g_autofree eda_violation *v = g_new(eda_violation, ROOM);
  for (uint32_t seed = 1; seed < 6; seed++) {
    g_autoptr(opc_module) m =
        drc_make("{ min_mask_width: 40 nm, min_space: 40 nm }");
    g_autoptr(GString) text = g_string_new(NULL);
    chip c = {0};
    chip_show(&c);
    c.mask[EDA_POLY] = random_mask(seed, text, 300);
    g_autofree char *out = ask_klayout(text->str);
    size_t n = drc_violations(m, &c.p, v, ROOM);
    eda_shapes_clear(&c.mask[EDA_POLY]);
    chip_end(&c);
    if (!out) {
      g_test_skip("no klayout module for python3");
      return;
    }
    g_auto(GStrv) lines = g_strsplit(out, "\n", 0);
    for (int k = 0; k < 2; k++) {
      g_auto(GStrv) words = g_strsplit(lines[k], " ", 0);
      guint theirs[40] = {0}, ours[40] = {0};
      for (size_t i = 0; words[i]; i++) theirs[atoi(words[i])]++;
      for (size_t i = 0; i < n; i++)
        if (!strcmp(v[i].rule, rules[k]) && v[i].value == floor(v[i].value))
          ours[(int)v[i].value]++;
      guint all = 0, more = 0;
      for (int d = 1; d < 40; d++) {
        g_assert_cmpuint(theirs[d], <=, ours[d]);
        all += theirs[d];
        more += ours[d] - theirs[d];
      }
      g_test_message("%s: KLayout %u places, and %u corners", rules[k], all,
                     more);
      g_assert_cmpuint(all, >, 30);
      g_assert_cmpuint(more, <, all / 8);
    }
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/mask", test_mask);
  g_test_add_func("/regulator/klayout", test_klayout);
  return g_test_run();
}
