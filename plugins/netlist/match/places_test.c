/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the assignment by places on NAND2, whose netlist states the place of
   each gate, with the boxes of the gates in the layout. */
#include "match_test.h"

static run read_nand(void) {
  g_autofree char *path = source_path("data/cells65/nand2.cif");
  run r = read_layout("read.cif", path,
                      "layers: { poly: CP, active: CA, nwell: CW }");
  find_gates(&r, "{ grid: 0.5 nm }");
  return r;
}

/* Write the netlist with one line replaced, and return its path. */
static char *replace_line(int number, const char *line) {
  g_autofree char *path = source_path("data/cells65/nand2.sp");
  g_autofree char *text = text_of(path);
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  g_free(lines[number - 1]);
  lines[number - 1] = g_strdup(line);
  g_autofree char *all = g_strjoinv("\n", lines);
  return in_folder("places.sp", all, -1);
}

/* Check that a device has the only gate whose centre is at a place, nm. */
static void assert_at(const eda_circuit *c, const char *name, double x,
                      double y) {
  for (size_t i = 0; i < c->count; i++) {
    if (strcmp(c->device[i].name, name) != 0) continue;
    const eda_box *box = &c->gates->box[c->device[i].finger[0]];
    g_assert_cmpuint(c->device[i].fingers, ==, 1);
    g_assert_cmpfloat((box->x0 + box->x1) / 4.0, ==, x);
    g_assert_cmpfloat((box->y0 + box->y1) / 4.0, ==, y);
    return;
  }
  g_error("no device '%s'", name);
}

/* A netlist without some of the gates describes a part of the layout. Nets are
   not checked: MP1 has another net at its gate. */
static void test_places(void) {
  run r = read_nand();
  g_autofree char *path = replace_line(5, "* no MN2");
  const eda_circuit *c = circuit_match(&r, path, ", assign: places", NULL);
  g_assert_cmpuint(c->count, ==, 3);
  assert_at(c, "MN1", 250.5, 400);
  assert_at(c, "MP1", 250.5, 1130);
  assert_at(c, "MP2", 500.5, 1130);
  opc_error error;
  g_assert_cmpint(eda_circuit_check(c, &error), ==, OPC_OK);
  drop_circuit(&r);
  g_autofree char *other =
      replace_line(6, "MP1 Y Q VDD VDD pmos w=450n l=65n $ x=250.5 y=1130 nm");
  c = circuit_match(&r, other, ", assign: places", NULL);
  g_assert_cmpuint(c->count, ==, 4);
  for (size_t i = 0; i < c->count; i++)
    if (strcmp(c->device[i].name, "MP1") == 0)
      g_assert_cmpstr(net(c, c->device[i].gate), ==, "Q");
  assert_at(c, "MP1", 250.5, 1130);
  run_drop(&r);
}

/* Expect an error for another line of the transistor MP1. */
static void refused(const char *rest, const char *pattern) {
  run r = read_nand();
  g_autofree char *line = g_strdup_printf("MP1 Y A VDD VDD %s", rest);
  g_autofree char *path = replace_line(6, line), *message = NULL;
  g_autofree char *whole =
      g_strdup_printf("netlist device 'MP1' (*places.sp:6) %s", pattern);
  g_assert_null(circuit_match(&r, path, ", assign: places", &message));
  if (!g_pattern_match_simple(whole, message))
    g_error("'%s' is not '%s'", message, whole);
  run_drop(&r);
}

static void test_faults(void) {
  refused("pmos w=450n l=65n", "has no place*");
  refused("pmos w=450n l=65n $ x=370 y=1130 nm",
          "has no gate at (370, 1130) nm");
  refused("nmos w=400n l=65n $ x=250.5 y=400 nm",
          "is at the gate 'nand2:1' of another device");
  refused("nmos w=450n l=65n $ x=250.5 y=1130 nm",
          "is of another type than the gate 'nand2:?'");
  refused("pmos w=450n l=70n $ x=250.5 y=1130 nm",
          "has L 70 nm, but the gate 'nand2:?' has 65 nm");
  refused("pmos w=440n l=65n $ x=250.5 y=1130 nm",
          "has W 440 nm, but the gate 'nand2:?' has 450 nm");
  refused("pmos w=450n l=65n m=2 $ x=250.5 y=1130 nm",
          "has 2 fingers, but one place");
}

/* Return the number of devices of a memory cell, which all have gates in one
   cell of the array. The nets of the cell end with `number`. */
static size_t count_devices(const eda_circuit *c, const char *number,
                            char **member) {
  size_t devices = 0;
  for (size_t i = 0; i < c->count; i++) {
    if (!g_str_has_suffix(c->device[i].name, number)) continue;
    const char *path = c->gates->instance[c->device[i].finger[0]];
    g_autofree char *first = g_strndup(path, strcspn(path, "/"));
    if (!*member) *member = g_strdup(first);
    g_assert_cmpstr(first, ==, *member);
    devices++;
  }
  return devices;
}

/* Test the netlist of a flow with an array of SkyWater's cells. The four cells
   of the netlist are four cells of the array, one of each orientation, and have
   all transistors. */
static void check_array(const char *cell, const char *netlist, size_t devices) {
  g_autofree char *name =
      g_strdup_printf("sky130_sram/sky130_fd_bd_sram__sram_%s.gds", cell);
  g_autofree char *path = find_data(name);
  if (!path) return;
  run r = read_layout(
      "read.gds", path,
      "layers: { poly: 66/20, contact: 66/44, nwell: 64/20, core: 81/2, "
      "active: '65/20 - grow((66/20 & 65/20) - grow(shrink(66/20 & 65/20, 60 "
      "nm), 60 nm), 5 nm)' }");
  opc_error error;
  opc_module *array =
      module_of("layout.array", "{ columns: 6, rows: 6, boundary: core }");
  void *one = r.layout;
  opc_test_input(array, "layout", one);
  if (opc_test_run(array, &r.layout, &error)) g_error("%s", error.message);
  find_gates(&r, "{ grid: 1 nm }");
  g_autofree char *file = source_path(netlist);
  const eda_circuit *c =
      circuit_match(&r, file, ", assign: places, top: foundry", NULL);
  static const char *const numbers[] = {"22", "32", "23", "33"};
  char *member[4] = {NULL};
  for (int i = 0; i < 4; i++) {
    g_assert_cmpuint(count_devices(c, numbers[i], &member[i]), ==, devices);
    g_assert_true(g_str_has_suffix(member[i], "[1,1]"));
    for (int k = 0; k < i; k++) g_assert_cmpstr(member[i], !=, member[k]);
  }
  /* The cell has no transistors besides those of the netlist. */
  g_assert_cmpuint(c->gates->count, ==, 36 * devices);
  for (int i = 0; i < 4; i++) g_free(member[i]);
  drop_gates(&r);
  opc_test_release(array, &r.layout);
  opc_test_module_free(array);
  r.layout = one;
  opc_test_release(r.read, &r.layout);
  opc_test_module_free(r.read);
}

static void test_arrays(void) {
  check_array("sp_cell_opt1", "flows/foundry.sp", 6);
  check_array("dp_cell_opt1a", "flows/foundry-dual.sp", 10);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/match/places", test_places);
  g_test_add_func("/match/misplaced", test_faults);
  g_test_add_func("/match/arrays", test_arrays);
  return g_test_run();
}
