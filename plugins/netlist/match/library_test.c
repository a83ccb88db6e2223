/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the cells of the NanGate library, compared with transistors extracted
   by KLayout, and circuits of these cells. */
#include <math.h>

#include "match_test.h"

/* ---- NanGate ---- */

typedef struct known_gate {
  char cell[40], device[48], gate[48], left[48], right[48];
  double x0, y0, x1, y1;
} known_gate;

static GArray *known_gates(void) {
  g_autofree char *path = find_data("nangate45/devices.csv");
  if (!path) return NULL;
  g_autofree char *text = text_of(path);
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  GArray *all = g_array_new(FALSE, FALSE, sizeof(known_gate));
  for (char **l = lines + 1; *l && **l; l++) {
    known_gate k;
    g_assert_cmpint(
        sscanf(*l,
               "%39[^,],%47[^,],%*[^,],%*[^,],%*[^,],%lf,%lf,%lf,%lf,%47[^,],"
               "%47[^,],%47[^,\r]",
               k.cell, k.device, &k.x0, &k.y0, &k.x1, &k.y1, k.gate, k.left,
               k.right),
        ==, 9);
    g_array_append_val(all, k);
  }
  return all;
}

/* Check that two nets correspond in both directions. */
static void same_net(GHashTable *there, GHashTable *back, const char *a,
                     const char *b) {
  const char *known = g_hash_table_lookup(there, a);
  const char *other = g_hash_table_lookup(back, b);
  if (known) g_assert_cmpstr(known, ==, b);
  if (other) g_assert_cmpstr(other, ==, a);
  g_hash_table_insert(there, (void *)a, (void *)b);
  g_hash_table_insert(back, (void *)b, (void *)a);
}

/* Check that the nets of each device equal the nets that KLayout found at its
   gate. Symmetric inner nets may be exchanged. Returns the number of gates that
   have exactly the device chosen by KLayout. */
static size_t check_cell(const eda_circuit *c, const known_gate *k, size_t n) {
  g_autoptr(GHashTable) there = g_hash_table_new(g_str_hash, g_str_equal);
  g_autoptr(GHashTable) back = g_hash_table_new(g_str_hash, g_str_equal);
  size_t same = 0, found = 0;
  g_assert_cmpuint(c->gates->count, ==, n);
  for (size_t i = 0; i < c->ports; i++)
    same_net(there, back, net(c, c->port[i]), net(c, c->port[i]));
  /* Devices with a known net are handled first. */
  for (int pass = 0; pass < 8; pass++)
    for (uint32_t i = 0; i < c->count; i++) {
      const eda_device *d = &c->device[i];
      for (uint32_t f = 0; f < d->fingers; f++) {
        const eda_box *b = &c->gates->box[d->finger[f]];
        size_t at = 0;
        for (; at < n; at++)
          if (fabs(b->x0 * 2.5e-3 - k[at].x0) < 1e-4 &&
              fabs(b->y0 * 2.5e-3 - k[at].y0) < 1e-4)
            break;
        g_assert_cmpuint(at, <, n);
        const char *s = net(c, d->source), *e = net(c, d->drain);
        const char *left = k[at].left, *right = k[at].right;
        const char *ts = g_hash_table_lookup(there, s);
        const char *te = g_hash_table_lookup(there, e);
        int straight = (ts && !strcmp(ts, left)) || (te && !strcmp(te, right));
        int turned = (ts && !strcmp(ts, right)) || (te && !strcmp(te, left));
        if (!straight && !turned && pass < 7) continue;
        same_net(there, back, net(c, d->gate), k[at].gate);
        same_net(there, back, s, straight ? left : right);
        same_net(there, back, e, straight ? right : left);
        if (pass < 7) continue;
        found++;
        same += !strcmp(d->name, k[at].device);
      }
    }
  g_assert_cmpuint(found, ==, n);
  return same;
}

static void test_nangate(void) {
  g_autofree char *gds = find_data("nangate45/NangateOpenCellLibrary.gds");
  if (!gds) return;
  g_autofree char *cdl = find_data("nangate45/NangateOpenCellLibrary.cdl");
  g_autoptr(GArray) known = known_gates();
  const known_gate *k = (const known_gate *)(void *)known->data;
  run r = read_layout("read.gds", gds,
                      "layers: { poly: 9/0, active: 1/0, contact: 10/0, "
                      "nwell: 3/0 }");
  size_t cells_done = 0, same = 0;
  for (size_t i = 0, e; i < known->len; i = e) {
    for (e = i; e < known->len && !strcmp(k[e].cell, k[i].cell);) e++;
    g_autofree char *map =
        g_strdup_printf("{ top: %s, grid: 2.5 nm }", k[i].cell);
    find_gates(&r, map);
    same += check_cell(circuit_match(&r, cdl, "", NULL), k + i, e - i);
    drop_gates(&r);
    cells_done++;
  }
  g_test_message("%zu cells, %zu of %u gates have KLayout's device", cells_done,
                 same, known->len);
  g_assert_cmpuint(cells_done, ==, 127);
  g_assert_cmpuint(known->len, ==, 2590);
  opc_test_release(r.read, &r.layout);
  opc_test_module_free(r.read);
}

/* ---- placed circuits: no wires between the cells ---- */

static run read_c432(void) {
  g_autofree char *gds = find_data("iscas85/c432/c432.gds");
  if (!gds) return (run){0};
  run r = read_layout("read.gds", gds,
                      "scale: 1.3, layers: { poly: 9/0, active: 1/0, contact: "
                      "10/0, nwell: 3/0, metal1: 11/0 }");
  find_gates(&r, "{ grid: 1 nm }");
  return r;
}

static void test_placed(void) {
  run r = read_c432();
  if (!r.layout) return;
  g_autofree char *path = find_data("iscas85/c432/c432.sp");
  gint64 begin = g_get_monotonic_time();
  const eda_circuit *c = circuit_match(&r, path, ", scale: 1.3", NULL);
  double seconds = (double)(g_get_monotonic_time() - begin) * 1e-6;
  g_test_message("%.3f s", seconds);
  g_assert_cmpfloat(seconds, <, 5);
  g_assert_cmpuint(c->count, ==, 820);
  g_assert_cmpuint(c->ports, ==, 36 + 7 + 2);
  size_t roles[4] = {0};
  for (size_t i = 0; i < c->ports; i++) roles[c->role[i]]++;
  g_assert_cmpuint(roles[EDA_PIN_INPUT], ==, 36);
  g_assert_cmpuint(roles[EDA_PIN_OUTPUT], ==, 7);
  for (size_t i = 0; i < c->count; i++) {
    const eda_device *d = &c->device[i];
    g_assert_cmpuint(d->fingers, ==, 1);
    g_autofree char *start =
        g_strdup_printf("X%s/", c->gates->instance[d->finger[0]]);
    g_assert_true(g_str_has_prefix(d->name, start));
  }
  run_drop(&r);
}

/* Test a missing instance, and a cell other than that of the layout. */
static void test_placed_faults(void) {
  run r = read_c432();
  if (!r.layout) return;
  g_autofree char *path = find_data("iscas85/c432/c432.sp");
  g_autofree char *text = text_of(path);
  static const struct {
    const char *from, *to, *pattern;
  } cases[] = {
      {"\nXU7 ", "\n*XU7 ", "transistor 'U7:*' is not in the netlist"},
      {"\nXU7 ", "\nXV7 ",
       "netlist instance 'XV7' (*) is not in cell 'c432' of the layout"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_auto(GStrv) parts = g_strsplit(text, cases[i].from, -1);
    g_assert_cmpuint(g_strv_length(parts), ==, 2);
    g_autofree char *changed = g_strjoinv(cases[i].to, parts), *message = NULL;
    g_autofree char *bad = in_folder("c.sp", changed, -1);
    g_assert_null(circuit_match(&r, bad, ", scale: 1.3", &message));
    if (!g_pattern_match_simple(cases[i].pattern, message))
      g_error("'%s' is not '%s'", message, cases[i].pattern);
    drop_circuit(&r);
  }
  run_drop(&r);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/library/nangate", test_nangate);
  g_test_add_func("/library/placed", test_placed);
  g_test_add_func("/library/placed-faults", test_placed_faults);
  return g_test_run();
}
