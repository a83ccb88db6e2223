/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the cells of this project, whose netlists contain the place of each
   gate, hand-made layouts, and faulty netlists. */
#include "match_test.h"

#include <eda/layout.h>
#include <math.h>

static const opc_host *host;

/* ---- our own cells ---- */

static run read_cell(const char *cell) {
  g_autofree char *name = g_strdup_printf("data/cells65/%s.cif", cell);
  g_autofree char *path = source_path(name);
  run r = read_layout("read.cif", path,
                      strcmp(cell, "nmos") == 0
                          ? "layers: { poly: CP, active: CA, nimplant: CSN }"
                          : "layers: { poly: CP, active: CA, nwell: CW }");
  find_gates(&r, "{ grid: 0.5 nm }");
  return r;
}

static char *netlist_of(const char *cell) {
  g_autofree char *name = g_strdup_printf("data/cells65/%s.sp", cell);
  g_autofree char *path = source_path(name);
  return text_of(path);
}

static const char *const cells[] = {"nmos",  "pmos",          "inverter",
                                    "nand2", "nor2",          "nand2h",
                                    "sram4", "inverter_chain"};

/* Check the gates against their places in the netlist. If `by_name` is set, the
   device must be the same; otherwise any device with the same nets is accepted.
 */
static void check_places(const eda_circuit *c, const char *text, int by_name) {
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  g_autofree uint32_t *owner = g_new0(uint32_t, c->gates->count);
  size_t checked = 0;
  for (uint32_t i = 0; i < c->count; i++) {
    g_assert_cmpuint(c->device[i].fingers, ==, 1);
    owner[c->device[i].finger[0]] = i;
  }
  for (char **l = lines; *l; l++) {
    char name[32], d[32], g[32], s[32], b[32];
    double x, y;
    const char *at = strstr(*l, "$ x=");
    if (!at) continue;
    g_assert_cmpint(sscanf(*l, "%31s %31s %31s %31s %31s", name, d, g, s, b),
                    ==, 5);
    g_assert_cmpint(sscanf(at, "$ x=%lf y=%lf", &x, &y), ==, 2);
    size_t gate = 0;
    for (; gate < c->gates->count; gate++) {
      const eda_box *box = &c->gates->box[gate];
      if (fabs((box->x0 + box->x1) * 0.25 - x) < 0.6 &&
          fabs((box->y0 + box->y1) * 0.25 - y) < 0.6)
        break;
    }
    g_assert_cmpuint(gate, <, c->gates->count);
    const eda_device *found = &c->device[owner[gate]];
    if (by_name) g_assert_cmpstr(found->name, ==, name);
    g_assert_cmpstr(net(c, found->drain), ==, d);
    g_assert_cmpstr(net(c, found->gate), ==, g);
    g_assert_cmpstr(net(c, found->source), ==, s);
    g_assert_cmpstr(net(c, found->bulk), ==, b);
    g_assert_cmpint(found->type, ==, c->gates->type[gate]);
    checked++;
  }
  g_assert_cmpuint(checked, ==, c->count);
  g_assert_cmpuint(checked, ==, c->gates->count);
}

/* Return the netlist without places, so that only connectivity decides. */
static char *without_places(const char *text) {
  GString *out = g_string_new("");
  for (const char *s = text; *s; s++) {
    if (*s == '$') s = strchr(s, '\n');
    g_string_append_c(out, *s);
  }
  return g_string_free(out, FALSE);
}

static void test_cells(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(cells); i++) {
    run r = read_cell(cells[i]);
    g_autofree char *text = netlist_of(cells[i]);
    g_autofree char *bare = without_places(text);
    g_autofree char *path = in_folder("a.sp", text, -1);
    check_places(circuit_match(&r, path, "", NULL), text, 1);
    g_assert_cmpfloat(opc_test_metric("by_order"), ==, 0);
    drop_circuit(&r);
    g_autofree char *bare_path = in_folder("b.sp", bare, -1);
    /* Only the chain has interchangeable fingers. */
    int chain = strcmp(cells[i], "inverter_chain") == 0;
    check_places(circuit_match(&r, bare_path, "", NULL), text, !chain);
    g_assert_cmpfloat(opc_test_metric("by_order"), ==, chain ? 108 : 0);
    run_drop(&r);
  }
}

/* Test ports whose names differ from the labels: connectivity alone decides. */
static void test_no_labels(void) {
  run r = read_cell("nand2");
  g_autofree char *path =
      in_folder("n.sp",
                "* other names\n"
                ".subckt nand2 P1 P2 P3 P4 P5\n"
                "MN1 P5 P1 n1 P5 nmos w=0.4u l=0.065u\n"
                "MN2 P3 P2 n1 P5 nmos w=0.4u l=0.065u\n"
                "MP1 P3 P1 P4 P4 pmos w=0.45u l=0.065u\n"
                "MP2 P3 P2 P4 P4 pmos w=0.45u l=0.065u\n.ends\n",
                -1);
  const eda_circuit *c = circuit_match(&r, path, "", NULL);
  for (uint32_t i = 0; i < 4; i++)
    g_assert_cmpuint(c->device[i].finger[0], ==, i);
  run_drop(&r);
}

static void test_roles(void) {
  run r = read_cell("nand2");
  g_autofree char *text = netlist_of("nand2");
  g_autofree char *path = in_folder("a.sp", text, -1);
  const eda_circuit *c = circuit_match(&r, path, "", NULL);
  static const uint8_t usual[] = {EDA_PIN_INPUT, EDA_PIN_INPUT, EDA_PIN_OUTPUT,
                                  EDA_PIN_SUPPLY, EDA_PIN_GROUND};
  g_assert_cmpuint(c->ports, ==, 5);
  g_assert_cmpmem(c->role, 5, usual, 5);
  g_assert_cmpstr(c->name, ==, "nand2");
  g_assert_cmpuint(c->nets, ==, 6);
  drop_circuit(&r);
  c = circuit_match(&r, path, ", supply: 'vcc a', ground: 'vdd'", NULL);
  static const uint8_t odd[] = {EDA_PIN_SUPPLY, EDA_PIN_INPUT, EDA_PIN_OUTPUT,
                                EDA_PIN_GROUND, EDA_PIN_OUTPUT};
  g_assert_cmpmem(c->role, 5, odd, 5);
  run_drop(&r);
}

/* ---- notations ---- */

/* Test each stage of the chain as one device, with and without the number of
   fingers; parameters, expressions, subcircuits missing in the layout, an
   include. */
static void test_fingers(void) {
  static const uint32_t fingers[] = {1, 1, 1, 4, 12, 41};
  run r = read_cell("inverter_chain");
  double wn[6] = {0}, wp[6] = {0};
  for (size_t i = 0; i < 120; i++) {
    const eda_gates *g = r.gates;
    /* Stages follow one another: 250 nm per finger and 500 nm in between. */
    size_t stage = 0;
    double x = g->box[i].x0 * 0.5, end = 217.5 - 125;
    for (; stage < 6; stage++)
      if ((end += 250.0 * fingers[stage] + 500) > x + 250) break;
    (g->type[i] ? wp : wn)[stage] += g->width[i];
  }
  for (int stated = 0; stated < 2; stated++) {
    GString *s = g_string_new(
        "* folded\n.include 'inv.sp'\n.param one=1\n"
        ".subckt inverter_chain IN OUT VDD VSS\n");
    for (int k = 0; k < 6; k++) {
      g_autofree char *in = k ? g_strdup_printf("m%d", k) : g_strdup("in");
      g_autofree char *out =
          k < 5 ? g_strdup_printf("m%d", k + 1) : g_strdup("out");
      g_autofree char *nf =
          stated ? g_strdup_printf("f=%u", fingers[k]) : g_strdup("");
      g_string_append_printf(
          s, "x%d %s %s vdd\n+ vss / %s wn=%gn wp='%g*1n*one' %s\n", k, in, out,
          stated ? "inv_f" : "inv", wn[k], wp[k], nf);
    }
    g_string_append(s, ".ends\n");
    g_autofree char *inv =
        in_folder("inv.sp",
                  ".subckt inv a z p n wn=1 wp=1\nmn z a n n nmos l=65n w=wn\n"
                  "mp z a p p pmos l={60n+5*1n} w=wp $ a comment\n.ends inv\n"
                  ".subckt inv_f a z p n params: wn=1 wp=1 f=1\n"
                  "mn z a n n nmos (l=65n w='wn/f' m=f)\n"
                  "mp z a p p pmos l=65n w=wp nf='f'\n.ends\n",
                  -1);
    g_autofree char *path = in_folder("a.sp", s->str, -1);
    const eda_circuit *c = circuit_match(&r, path, ", tolerance: 2 %", NULL);
    g_assert_cmpuint(c->count, ==, 12);
    for (uint32_t i = 0; i < 12; i++) {
      g_assert_cmpuint(c->device[i].fingers, ==, fingers[i / 2]);
      g_assert_cmpint(c->device[i].type, ==, i % 2 ? EDA_PMOS : EDA_NMOS);
    }
    g_assert_cmpstr(c->device[11].name, ==, "x5/mp");
    g_string_free(s, TRUE);
    drop_circuit(&r);
  }
  run_drop(&r);
}

/* Test sizes in micrometres, a wrapped transistor, models by name, globals. */
static void test_units(void) {
  run r = read_cell("inverter");
  g_autofree char *path = in_folder(
      "u.sp",
      "* units\n.option scale=1e-6 post\n.global VDD VSS\n"
      ".model strange pmos level=54\nR1 a b 5\n"
      ".subckt inverter a y\nC1 a y 1f\n"
      "Xn y a vss vss some_nfet_01v8 w=0.15 l=0.0325\n"
      "Mp y a vdd vdd strange w=0.225 l=0.0325\n.ends\n.end\nwhatever\n",
      -1);
  const eda_circuit *c = circuit_match(&r, path, ", scale: 2", NULL);
  g_assert_cmpuint(c->ports, ==, 4);
  g_assert_cmpstr(net(c, c->port[2]), ==, "VDD");
  g_assert_cmpint(c->role[2], ==, EDA_PIN_SUPPLY);
  g_assert_cmpint(c->role[3], ==, EDA_PIN_GROUND);
  g_assert_cmpint(c->device[0].type, ==, EDA_NMOS);
  g_assert_cmpfloat(fabs(c->device[1].width - 450), <, 1e-9);
  run_drop(&r);
}

/* Test a tree of 2^40 instances without a transistor. */
static void test_empty(void) {
  run r = read_cell("nand2");
  g_autofree char *text = netlist_of("nand2");
  g_autoptr(GString) netlist = g_string_new("* title\n.subckt e0 a\n.ends\n");
  for (int i = 1; i <= 40; i++)
    g_string_append_printf(
        netlist, ".subckt e%d a\nx1 a e%d\nx2 a e%d\n.ends\n", i, i - 1, i - 1);
  char *end = strstr(text, ".ends");
  g_string_append_printf(netlist, "%.*sxe A e40\n%s", (int)(end - text), text,
                         end);
  g_autofree char *path = in_folder("empty.sp", netlist->str, -1);
  check_places(circuit_match(&r, path, "", NULL), text, 1);
  run_drop(&r);
}

/* ---- faults ---- */

static void assert_refused(const char *cell, const char *netlist,
                           const char *rest, const char *pattern) {
  run r = read_cell(cell);
  g_autofree char *path = in_folder("f.sp", netlist, -1), *message = NULL;
  const eda_circuit *c = circuit_match(&r, path, rest, &message);
  if (c || !g_pattern_match_simple(pattern, message))
    g_error("'%s' is not '%s'", message, pattern);
  run_drop(&r);
}

/* Expect an error for a NAND2 with one line replaced. */
static void refused_line(int line, const char *instead, const char *pattern) {
  g_autofree char *text = netlist_of("nand2");
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  g_free(lines[line - 1]);
  lines[line - 1] = g_strdup(instead);
  g_autofree char *changed = g_strjoinv("\n", lines);
  assert_refused("nand2", changed, "", pattern);
}

static void test_mismatch(void) {
  refused_line(5, "", "transistor 'nand2:2' is not in the netlist");
  refused_line(7, "*", "transistor 'nand2:4' is not in the netlist");
  refused_line(8, "M9 Y A VSS VSS nmos w=1u l=1u\n.ends",
               "netlist device 'M9' (*f.sp:8) has no gate in the layout");
  /* A is adjacent to the ground in the layout. */
  refused_line(4, "MN1 VSS B X VSS nmos w=400e-9 l=65e-9",
               "netlist device 'MN1' (*f.sp:4) has no gate in the layout; "
               "transistor 'nand2:1' is not in the netlist");
  refused_line(4, "MN1 VSS A X VSS pmos w=400e-9 l=65e-9",
               "netlist device 'MN1' (*f.sp:4) has no gate in the layout; "
               "transistor 'nand2:1' is not in the netlist");
  refused_line(4, "MN1 VSS A X VSS nmos w=410e-9 l=65e-9",
               "netlist device 'MN1' (*f.sp:4) has W 410 nm, but the gate "
               "'nand2:1' has 400 nm");
  refused_line(7, "MP2 Y B VDD VDD pmos w=450e-9 l=70e-9",
               "netlist device 'MP2' (*f.sp:7) has L 70 nm, but the gate "
               "'nand2:4' has 65 nm");
  /* Two devices, but one gate in the layout. */
  refused_line(7,
               "MP2 Y B VDD VDD pmos w=450n l=65n\n"
               "MP3 Y B VDD VDD pmos w=450n l=65n",
               "netlist device 'MP3' (*f.sp:8) has no gate in the layout");
  refused_line(3, ".subckt nand3 A B Y VDD VSS",
               "*:8:7: .ends of 'nand2' in 'nand3'");
  assert_refused("nor2", "*\n.subckt other a\n.ends\n", "",
                 "'*f.sp' has no subcircuit 'nor2'; it has 'other'");
  assert_refused("nor2", "*\n", ", layers: { metal1: M1 }",
                 "'metal1': the layout has no layer 'M1'");
}

static void test_syntax(void) {
  static const struct {
    const char *text, *pattern;
  } cases[] = {
      {"M1 a b c d nmos", "*f.sp:3:1: 'M1' has no w"},
      {"M1 a b c d nmos w=1u", "*f.sp:3:1: 'M1' has no l"},
      {"M1 a b c nmos w=1u l=1u", "*:3:1: 'M1' must have four nodes, *"},
      {"M1", "*:3:1: 'M1' must have four nodes, *"},
      {"M1 a b c d nmos w= l=1u", "*:3:21: no name before '='"},
      {"M1 a b c d nmos w=1u l", "*:3:22: 'l' is not followed by '='"},
      {"M1 a b c d nmos w=x l=1u", "*:3:19: unknown parameter 'x'"},
      {"M1 a b c d nmos w='1u*(2' l=1u",
       "*:3:19: a bracket is not closed in '1u?(2'"},
      {"M1 a b c d nmos w='1u*' l=1u", "*:3:19: a number is missing in *"},
      {"M1 a b c d nmos w=-1u l=1u", "*:3:19: w of 'M1' is not above 0: '-1u'"},
      {"M1 a b c d nmos w=1/0 l=1u", "*:3:19: a number is not finite in '1/0'"},
      {"M1 a b c d nmos w=1u l=1u m=1.5",
       "*:3:1: m of 'M1' is not a whole number: 1.5"},
      {"M1 a b c d what w=1u l=1u",
       "*:3:12: the type of model 'what' is unknown*"},
      {"M1 a b c d nmos w='1u l=1u", "*:3:19: ''' is not closed"},
      {"M1 a b c d nmos w=1u l=1u\nm1 a b c d nmos w=1u l=1u",
       "*:4:1: 'm1' is already defined in line 3"},
      {"X1 a b c", "*:3:8: no subcircuit 'c'"},
      {"X1 a nand2", "*:3:6: subcircuit 'nand2' contains itself"},
      {"Xi a b sub\n.ends\n.subckt sub a",
       "*:3:1: 'Xi' has 2 nodes, but 'sub' has 1 ports"},
      {"R1 a b 5", "*:3:1: 'R1' is neither a transistor nor *"},
      {".subckt b a", "*:3:1: .subckt inside of 'nand2'"},
      {".what", "*:3:1: unknown card '.what'"},
      {".include nowhere.sp", "*:3:10: '*nowhere.sp': *"},
      {".include f.sp", "*f.sp:2:1: .subckt inside of 'nand2'"},
      {".param a=b b=a\nM1 a b c d nmos w=a l=1u",
       "*parameters are nested too deep or depend on each other in a cycle in "
       "*"},
      {".ends\n.ends", "*:4:1: .ends without .subckt"},
      {".ends\n.subckt NAND2 a", "*:4:9: 'NAND2' is already defined in line 2"},
      {"X1 a b\n"
       ".ends\n"
       ".subckt b c C",
       "*:3:1: 'X1' has 1 nodes, but 'b' has 2 ports"},
      {"X1 a a b\n"
       ".ends\n"
       ".subckt b c C",
       "*:5:9: port 'C' of 'b' is declared twice"},
      {"M\x01 a b c d nmos w=1u l=1u", "*:3:1: byte 0x01 in a word"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text =
        g_strdup_printf("* title\n.subckt nand2 a\n%s\n.ends\n", cases[i].text);
    assert_refused("nand2", text, "", cases[i].pattern);
  }
  assert_refused("nand2", "* no end\n.subckt nand2 a", "",
                 "*:2:9: 'nand2' has no .ends");
  assert_refused("nand2", "* plus\n+ a", "",
                 "*:2:1: '+' has no statement to continue");
}

/* Test that truncated or garbled files are refused or matched, without other
   effects. */
static void test_garbage(void) {
  run r = read_cell("nand2");
  g_autofree char *text = netlist_of("nand2");
  size_t n = strlen(text), good = 0;
  GRand *random = g_rand_new_with_seed(1);
  for (size_t i = 0; i < n + 1000; i++) {
    g_autofree char *cut = g_strndup(text, i < n ? i : n), *message = NULL;
    for (int k = 0; i >= n && k < 3; k++)
      cut[g_rand_int_range(random, 0, (int)n)] =
          "()='{}$*+./x9M \n\t\xff"[g_rand_int_range(random, 0, 18)];
    g_autofree char *path = in_folder("g.sp", cut, (gssize)(i < n ? i : n));
    good += circuit_match(&r, path, "", &message) != NULL;
    drop_circuit(&r);
  }
  g_rand_free(random);
  g_test_message("%zu matched", good);
  g_assert_cmpuint(good, >, 100);
  g_assert_cmpuint(good, <, 1000);
  run_drop(&r);
}

/* ---- layouts by hand ---- */

/* Test that contacts join only the layers below and above. */
static void test_contacts(void) {
  static const char *const netlists[] = {
      "* open\n.subckt pair g h a b c\nM1 a g b z nmos w=200n l=65n\n"
      "M2 b h c z nmos w=200n l=65n\n.ends\n",
      "* joined\n.subckt pair g h a b\nM1 a g b z nmos w=200n l=65n\n"
      "M2 b h a z nmos w=200n l=65n\n.ends\n"};
  for (int joined = 0; joined < 2; joined++) {
    int32_t cell;
    run r = {.layout = two_in_a_row(&cell)};
    box(r.layout, cell, "contact", 20, 60, 40, 80);
    /* A contact that touches only the corner of the metal does not connect. */
    if (joined)
      box(r.layout, cell, "contact", 500, 60, 520, 80);
    else
      box(r.layout, cell, "contact", 600, 100, 620, 120);
    find_gates(&r, "{}");
    for (int k = 0; k < 2; k++) {
      g_autofree char *path = in_folder("c.sp", netlists[k], -1),
                      *message = NULL;
      const eda_circuit *c = circuit_match(&r, path, "", &message);
      g_assert_true((c != NULL) == (k == joined));
      drop_circuit(&r);
    }
    drop_gates(&r);
    eda_layout_free(r.layout);
  }
}

static const char ring[] =
    "* both ends are one net\n.subckt pair g h a b\n"
    "M1 a g b z nmos w=200n l=65n\nM2 b h a z nmos w=200n l=65n\n.ends\n";

/* Test that nets with equal labels are joined, and separate label layers. */
static void test_same_label(void) {
  for (int labelled = 0; labelled < 2; labelled++) {
    int32_t cell;
    run r = {.layout = two_in_a_row(&cell)};
    text(r.layout, cell, "pins", 50, 150, "a");
    text(r.layout, cell, "pins", 550, 150, labelled ? "A" : "c");
    find_gates(&r, "{}");
    g_autofree char *path = in_folder("l.sp", ring, -1), *message = NULL;
    const eda_circuit *c =
        circuit_match(&r, path, ", labels: { active: pins }", &message);
    g_assert_true((c != NULL) == labelled);
    drop_gates(&r);
    eda_layout_free(r.layout);
  }
}

/* Test that the log names the number of ignored elements, and of labels beside
   the shapes of their layer. */
static void test_warnings(void) {
  for (int k = 0; k < 2; k++) {
    int32_t cell;
    run r = {.layout = two_in_a_row(&cell)};
    text(r.layout, cell, "active", 50, 150, "a");
    if (k) text(r.layout, cell, "active", 9000, 150, "x");
    find_gates(&r, "{}");
    g_autofree char *deck = g_strdup_printf(
        "*\n.subckt pair g h a b c\n"
        "M1 a g b z nmos w=200n l=65n\n%s"
        "M2 b h c z nmos w=200n l=65n\n.ends\n",
        k ? "C1 a b 1f\nD1 a b diode\n" : "");
    g_autofree char *path = in_folder("w.sp", deck, -1);
    opc_test_forget();
    circuit_match(&r, path, "", NULL);
    g_assert_true(k == !!strstr(opc_test_log(), "1 labels are on no shape"));
    g_assert_true(k == !!strstr(opc_test_log(), "ignored: 2"));
    drop_gates(&r);
    eda_layout_free(r.layout);
  }
}

/* Test that sizes, or labels of inner nets, decide between nets of equal
   connectivity. */
static void test_hints(void) {
  opc_error error;
  for (int by_name = 0; by_name < 2; by_name++) {
    void *layout = eda_layout_new(1, &error);
    int32_t cell = eda_layout_cell(layout, "two", &error);
    for (int k = 0; k < 2; k++) {
      int32_t x = k * 2000, w = k && !by_name ? 300 : 200;
      box(layout, cell, "active", x, 0, x + 400, w);
      box(layout, cell, "poly", x + 150, -100, x + 215, w + 100);
      if (by_name) text(layout, cell, "poly", x + 180, -50, k ? "q" : "p");
    }
    box(layout, cell, "nimplant", -50, -50, 3000, 500);
    run r = {.layout = layout};
    find_gates(&r, "{}");
    g_autofree char *deck = g_strdup_printf(
        "*\n.subckt two\nM1 a q b z nmos w=%dn l=65n\n"
        "M2 c p d z nmos w=200n l=65n\n.ends\n",
        by_name ? 200 : 300);
    g_autofree char *path = in_folder("h.sp", deck, -1);
    const eda_circuit *c = circuit_match(&r, path, "", NULL);
    g_assert_cmpuint(c->device[0].finger[0], ==, 1);
    g_assert_cmpuint(c->device[1].finger[0], ==, 0);
    g_assert_cmpfloat(opc_test_metric("by_order"), ==, 0);
    drop_gates(&r);
    eda_layout_free(layout);
  }
}

/* Test that labels rotate with their instances: exchanging g and h is detected
   in each orientation. */
static void test_orientations(void) {
  for (int k = 0; k < 8; k++) {
    opc_error error;
    int32_t cell;
    run r = {.layout = two_in_a_row(&cell)};
    text(r.layout, cell, "poly", 180, 290, "g");
    text(r.layout, cell, "poly", 430, 290, "h");
    text(r.layout, cell, "active", 50, 180, "a");
    int32_t middle = eda_layout_cell(r.layout, "middle", &error);
    int32_t top = eda_layout_cell(r.layout, "top", &error);
    eda_placement p = {.origin = {1000 * k, -700},
                       .magnification = 1,
                       .angle = 90.0 * (k % 4),
                       .mirror = k / 4,
                       .columns = 1,
                       .rows = 1};
    eda_layout_add_instance(r.layout, middle, cell, &p, "U1", &error);
    p = (eda_placement){.origin = {0, 500},
                        .magnification = 1,
                        .angle = 90,
                        .columns = 1,
                        .rows = 1};
    eda_layout_add_instance(r.layout, top, middle, &p, "U0", &error);
    find_gates(&r, "{}");
    g_autofree char *path =
        in_folder("o.sp",
                  "*\n.subckt pair g h a b c\nM1 a g b z nmos w=200n l=65n\n"
                  "M2 b h c z nmos w=200n l=65n\n.ends\n"
                  ".subckt middle x y\nXU1 x x y y y pair\n.ends\n"
                  ".subckt top\nXU0 1 2 middle\n.ends\n",
                  -1);
    const eda_circuit *c = circuit_match(&r, path, "", NULL);
    g_assert_cmpstr(c->device[0].name, ==, "XU0/XU1/M1");
    g_assert_cmpfloat(opc_test_metric("by_order"), ==, 0);
    /* The place of the gate of M1, at (182.5, 100) in its cell. */
    double x = 182.5, y = k / 4 ? -100 : 100,
           turned[4][2] = {{x, y}, {-y, x}, {-x, -y}, {y, -x}};
    const eda_box *b = &c->gates->box[c->device[0].finger[0]];
    double ax = turned[k % 4][0] + 1000 * k, ay = turned[k % 4][1] - 700;
    g_assert_cmpfloat(fabs((b->x0 + b->x1) / 2.0 + ay), <, 1);
    g_assert_cmpfloat(fabs((b->y0 + b->y1) / 2.0 - ax - 500), <, 1);
    drop_gates(&r);
    eda_layout_free(r.layout);
  }
}

/* Test the second via by its number in FreePDK45. If no wire layer is named,
   the number is used, so that a slanted edge on this layer is an error.
   Otherwise the layer is ignored, because it may be an implant of another
   process. */
static void test_numbers(void) {
  opc_error error;
  for (int named = 0; named < 2; named++) {
    int32_t cell;
    run r = {.layout = eda_layout_new(1, &error)};
    cell = eda_layout_cell(r.layout, "one", &error);
    box(r.layout, cell, "active", 0, 0, 300, 200);
    box(r.layout, cell, "poly", 150, -100, 215, 300);
    box(r.layout, cell, "nimplant", -50, -50, 350, 250);
    box(r.layout, cell, named ? "metal1" : "11/0", 0, 50, 100, 100);
    eda_point p[] = {{0, 300}, {100, 300}, {0, 400}};
    int32_t layer = eda_layout_layer(r.layout, "14/0", &error);
    eda_layout_add_polygon(r.layout, cell, layer, p, 3, &error);
    find_gates(&r, "{}");
    g_autofree char *message = NULL;
    g_autofree char *path = in_folder(
        "v.sp", "*\n.subckt one\nM1 a b c d n w=200n l=65n\n.ends\n", -1);
    const eda_circuit *c = circuit_match(&r, path, "", &message);
    if (named)
      g_assert_nonnull(c);
    else
      g_assert_true(message &&
                    strstr(message, "layer '14/0' has a slanted edge"));
    drop_gates(&r);
    eda_layout_free(r.layout);
  }
}

static void test_slanted(void) {
  opc_error error;
  int32_t cell;
  run r = {.layout = two_in_a_row(&cell)};
  eda_point p[] = {{0, 300}, {100, 300}, {0, 400}};
  int32_t layer = eda_layout_layer(r.layout, "metal1", &error);
  eda_layout_add_polygon(r.layout, cell, layer, p, 3, &error);
  find_gates(&r, "{}");
  g_autofree char *message = NULL;
  g_autofree char *path =
      in_folder("s.sp", "*\n.subckt pair\nM1 a b c d n w=1 l=1\n.ends\n", -1);
  g_assert_null(circuit_match(&r, path, "", &message));
  g_assert_cmpstr(message, ==,
                  "layer 'metal1' has a slanted edge from (100, 300) to (0, "
                  "400) nm; only edges along x and y can be followed");
  drop_gates(&r);
  eda_layout_free(r.layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_test_host();
  g_test_add_func("/match/cells", test_cells);
  g_test_add_func("/match/no-labels", test_no_labels);
  g_test_add_func("/match/roles", test_roles);
  g_test_add_func("/match/fingers", test_fingers);
  g_test_add_func("/match/units", test_units);
  g_test_add_func("/match/empty", test_empty);
  g_test_add_func("/match/mismatch", test_mismatch);
  g_test_add_func("/match/syntax", test_syntax);
  g_test_add_func("/match/garbage", test_garbage);
  g_test_add_func("/match/contacts", test_contacts);
  g_test_add_func("/match/same-label", test_same_label);
  g_test_add_func("/match/hints", test_hints);
  g_test_add_func("/match/warnings", test_warnings);
  g_test_add_func("/match/orientations", test_orientations);
  g_test_add_func("/match/numbers", test_numbers);
  g_test_add_func("/match/slanted", test_slanted);
  return g_test_run();
}
