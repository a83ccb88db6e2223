/* SPDX-License-Identifier: BSD-3-Clause */
/* Names, a netlist read and flattened, and invalid circuits. Syntax and its
   faults are tested with netlist.match. */
#include <eda/netlist.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>

/* ---- names ---- */

static void test_names(void) {
  enum { MANY = 3000 };
  eda_pool pool = {0};
  eda_names names = {.pool = &pool};
  g_assert_null(eda_names_find(&names, "a"));
  for (uint32_t i = 0; i < MANY; i++) {
    g_autofree char *text = g_strdup_printf("Net%u", i);
    const char *own = eda_pool_text(&pool, text, strlen(text));
    *eda_names_add(&names, own) = i;
  }
  for (uint32_t i = 0; i < MANY; i++) {
    g_autofree char *text = g_strdup_printf("nET%u", i);
    g_autofree char *more = g_strconcat(text, "/more", NULL);
    g_assert_cmpuint(*eda_names_find(&names, text), ==, i);
    g_assert_null(eda_names_find(&names, more));
  }
  g_assert_cmpuint(*eda_names_add(&names, "new"), ==, UINT32_MAX);
  g_assert_true(eda_in_list("VDD vcc,Vss", "VSS"));
  g_assert_true(eda_in_list("VDD vcc,Vss", "VCC"));
  g_assert_false(eda_in_list("VDD vcc,Vss", "vs"));
  g_assert_false(eda_in_list(NULL, "vs"));
  g_assert_cmpstr(eda_pool_path(&pool, "", "b"), ==, "b");
  g_assert_cmpstr(eda_pool_path(&pool, "a", "b"), ==, "a/b");
  eda_pool_clear(&pool);
}

static void test_grow(void) {
  eda_pool pool = {0};
  size_t capacity = 0;
  double *list = NULL;
  for (size_t i = 0; i < 40000; i++) {
    eda_pool_grow(&pool, &list, &capacity, i + 1, sizeof *list);
    g_assert_cmpfloat(list[i], ==, 0);
    list[i] = (double)i;
  }
  for (size_t i = 0; i < 40000; i++) g_assert_cmpfloat(list[i], ==, (double)i);
  eda_pool_clear(&pool);
}

/* ---- flat ---- */

static const char deck[] =
    "* title\n.param wide='2*small' small=100n\n.global gnd!\n"
    ".subckt inv a y vdd params: w=1u m=1\n"
    "Mn y a gnd! gnd! nch w='w' l=60n $ x=250.5 y=400 nm\n"
    "Mp y a vdd vdd pch w={2*w}\n+ l=60n nf=2\n.ends\n"
    ".subckt buf A Y vdd\nXone A n vdd inv w=wide\nC1 n 0 1f\n"
    "Xtwo n Y vdd / inv m=3\n.ends buf\n";

/* Sizes, multiples, inner nets and globals, computed by hand. */
static void test_flat(void) {
  static const struct {
    const char *name, *net[3];
    double width;
    uint32_t fingers;
  } want[] = {{"Xone/Mn", {"n", "A", "gnd!"}, 200, 0},
              {"Xone/Mp", {"n", "A", "vdd"}, 400, 2},
              {"Xtwo/Mn", {"Y", "n", "gnd!"}, 3000, 3},
              {"Xtwo/Mp", {"Y", "n", "vdd"}, 6000, 6}};
  g_autofree char *folder = g_dir_make_tmp("netlist-test-XXXXXX", NULL);
  g_autofree char *path = g_build_filename(folder, "buf.sp", NULL);
  g_assert_true(g_file_set_contents(path, deck, -1, NULL));
  opc_error error;
  eda_netlist n = {.error = &error, .scale = 1};
  if (eda_netlist_read(&n, path)) g_error("%s", error.message);
  int64_t top = eda_netlist_find(&n, "BUF");
  g_assert_cmpint(top, >=, 0);
  if (eda_netlist_prepare(&n, (uint32_t)top)) g_error("%s", error.message);
  const eda_scope scope = {NULL, &n.subcircuit[top], NULL};
  eda_flat_netlist f = {.pool = &n.pool};
  if (eda_netlist_flatten(&n, &scope, &f)) g_error("%s", error.message);
  g_assert_cmpuint(n.left_out, ==, 1);
  g_assert_cmpuint(f.nets, ==, 5);
  g_assert_cmpuint(f.ports, ==, 4);
  g_assert_cmpstr(f.net[f.port[3]], ==, "gnd!");
  g_assert_cmpuint(f.devices, ==, G_N_ELEMENTS(want));
  for (size_t i = 0; i < f.devices; i++) {
    const eda_transistor *d = &f.device[i];
    g_assert_cmpstr(d->name, ==, want[i].name);
    g_assert_cmpstr(f.net[d->drain], ==, want[i].net[0]);
    g_assert_cmpstr(f.net[d->gate], ==, want[i].net[1]);
    g_assert_cmpstr(f.net[d->source], ==, want[i].net[2]);
    g_assert_cmpfloat(fabs(d->width - want[i].width), <, 1e-9);
    g_assert_cmpfloat(fabs(d->length - 60), <, 1e-9);
    g_assert_cmpuint(d->fingers, ==, want[i].fingers);
  }
  g_assert_cmpfloat(f.device[0].from->x, ==, 250.5);
  char where[256];
  g_assert_true(g_str_has_suffix(
      eda_netlist_where(&n, f.device[1].from, where, sizeof where), ":6"));
  eda_netlist_clear(&n);
  g_unlink(path);
  g_rmdir(folder);
}

/* ---- expressions ---- */

/* A random expression of numbers with suffixes and parameters, and its
   value. */
typedef struct expression {
  char *text;
  double value;
} expression;

static const expression parameters[] = {{"p1", 3}, {"P_2", -0.25}, {"p3", 7e3}};

static expression number(GRand *rand) {
  static const struct {
    const char *text;
    double factor;
  } suffixes[] = {{"", 1},       {"k", 1e3},   {"MEG", 1e6}, {"g", 1e9},
                  {"T", 1e12},   {"m", 1e-3},  {"u", 1e-6},  {"nF", 1e-9},
                  {"P", 1e-12},  {"f", 1e-15}, {"a", 1e-18}, {"mil", 25.4e-6},
                  {"e-3", 1e-3}, {"e2k", 1e5}};
  int i = g_rand_int_range(rand, 0, G_N_ELEMENTS(suffixes)),
      digits = g_rand_int_range(rand, 1, 1000);
  const char *form = i % 2 ? "%d.5%s" : "%d%s";
  return (expression){g_strdup_printf(form, digits, suffixes[i].text),
                      (digits + (i % 2 ? 0.5 : 0)) * suffixes[i].factor};
}

static expression expression_grow(GRand *rand, int depth) {
  int kind = g_rand_int_range(rand, 0, depth > 0 ? 7 : 2);
  if (kind == 0) return number(rand);
  if (kind == 1) {
    const expression *p =
        &parameters[g_rand_int_range(rand, 0, G_N_ELEMENTS(parameters))];
    return (expression){g_strdup(p->text), p->value};
  }
  expression a = expression_grow(rand, depth - 1),
             b = expression_grow(rand, depth - 1), all;
  const char *gap = g_rand_boolean(rand) ? " " : "";
  if (kind == 2)
    all = (expression){g_strdup_printf("(-(%s))", a.text), -a.value};
  else if (kind == 3)
    all = (expression){g_strdup_printf("(%s%s+ %s)", a.text, gap, b.text),
                       a.value + b.value};
  else if (kind == 4)
    all = (expression){g_strdup_printf("(%s-%s%s)", a.text, gap, b.text),
                       a.value - b.value};
  else if (kind == 5)
    all = (expression){g_strdup_printf("%s *%s%s", a.text, gap, b.text),
                       a.value * b.value};
  else
    all = (expression){g_strdup_printf("%s%s/ (%s)", a.text, gap, b.text),
                       a.value / b.value};
  g_free(a.text);
  g_free(b.text);
  return all;
}

/* Read a deck and flatten the subcircuit "s"; the caller clears the pool. */
static int deck_flatten(eda_netlist *n, const char *text, eda_flat_netlist *f) {
  g_autofree char *folder = g_dir_make_tmp("netlist-test-XXXXXX", NULL);
  g_autofree char *path = g_build_filename(folder, "s.sp", NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  int code = eda_netlist_read(n, path);
  int64_t top = code ? -1 : eda_netlist_find(n, "s");
  if (!code) code = eda_netlist_prepare(n, (uint32_t)top);
  *f = (eda_flat_netlist){.pool = &n->pool};
  if (!code)
    code = eda_netlist_flatten(n, &(eda_scope){NULL, &n->subcircuit[top], NULL},
                               f);
  g_unlink(path);
  g_rmdir(folder);
  return code;
}

/* Each expression is the width of a transistor, scaled to about 100 nm. */
static void test_expressions(void) {
  enum { MANY = 400 };
  GRand *rand = g_rand_new_with_seed(8);
  g_autoptr(GString) text = g_string_new("* title\n.param");
  for (size_t i = 0; i < G_N_ELEMENTS(parameters); i++)
    g_string_append_printf(text, " %s=%.17g", parameters[i].text,
                           parameters[i].value);
  g_string_append(text, "\n.subckt s a\n");
  for (int i = 0; i < MANY;) {
    expression e = expression_grow(rand, 5);
    if (isfinite(e.value) && fabs(e.value) > 1e-200 && fabs(e.value) < 1e200)
      g_string_append_printf(text, "M%d a a a a n l=1u w='(%s) * %.17g'\n", i,
                             e.text, (100 + i) * 1e-9 / e.value),
          i++;
    g_free(e.text);
  }
  g_string_append(text, ".ends\n");
  opc_error error;
  eda_netlist n = {.error = &error, .scale = 1};
  eda_flat_netlist f;
  if (deck_flatten(&n, text->str, &f)) g_error("%s", error.message);
  g_assert_cmpuint(f.devices, ==, MANY);
  for (int i = 0; i < MANY; i++)
    if (fabs(f.device[i].width / (100 + i) - 1) > 1e-6)
      g_error("M%d: %g\n%s", i, f.device[i].width, text->str);
  eda_netlist_clear(&n);
  g_rand_free(rand);
}

/* Invalid expressions, with their places. */
static void test_bad_expressions(void) {
  static const char *const cases[][2] = {
      {"w='2*'", ".sp:4:25: a number is missing in '2*'"},
      {"w='2*#'", ".sp:4:25: a number is missing in '2*#'"},
      {"w='(2*3'", ".sp:4:25: a bracket is not closed in '(2*3'"},
      {"w='2 3'", ".sp:4:25: not an expression in '2 3'"},
      {"w='q'", ".sp:4:25: unknown parameter 'q'"},
      {"w='a'",
       ".sp:2:10: parameters are nested too deep or depend on each other in a "
       "cycle in 'b'"},
      {"w='1/0'", ".sp:4:25: a number is not finite in '1/0'"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error;
    eda_netlist n = {.error = &error, .scale = 1};
    eda_flat_netlist f;
    g_autofree char *text = g_strdup_printf(
        "* t\n.param a='b' b='a'\n.subckt s n1 n2\nM1 n1 n1 n1 n1 n l=1u "
        "%s\n.ends\n",
        cases[i][0]);
    g_assert_cmpint(deck_flatten(&n, text, &f), ==, OPC_INVALID);
    g_assert_true(g_str_has_suffix(error.message, cases[i][1]));
    eda_netlist_clear(&n);
  }
}

/* An X element is a transistor of a foundry kit if it has four nodes, W and L,
   and no subcircuit has its name. */
static void test_wrapped(void) {
  static const struct {
    const char *call;
    int good;
  } cases[] = {
      {"X1 a a a a nch w=2u l=1u", 1},    {"X1 a a a a nch w=2u", 0},
      {"X1 a a a a nch m=2 w=2u", 0},     {"X1 a a a a nch l=1u m=2", 0},
      {"X1 a a a nch w=2u l=1u", 0},      {"X1 a a a a zzz w=2u l=1u", 0},
      {"X1 a a a a nch L=1u m=2 W=2u", 1}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text =
        g_strdup_printf("* t\n.subckt s a\n%s\n.ends\n", cases[i].call);
    opc_error error;
    eda_netlist n = {.error = &error, .scale = 1};
    eda_flat_netlist f;
    int code = deck_flatten(&n, text, &f);
    g_assert_cmpint(code, ==, cases[i].good ? OPC_OK : OPC_INVALID);
    if (code) g_assert_nonnull(strstr(error.message, "no subcircuit"));
    if (!code) g_assert_cmpuint(f.devices, ==, 1);
    eda_netlist_clear(&n);
  }
}

/* ---- circuits ---- */

static eda_circuit *sound(void) {
  static const uint32_t gate[2] = {0, 1};
  eda_circuit *c = eda_circuit_new(eda_gates_sample(), "pair", 3, 1, 2);
  for (int i = 0; i < 3; i++) c->net[i] = "net";
  for (uint32_t i = 0; i < 2; i++)
    c->device[i] = (eda_device){.name = "M",
                                .gate = 1,
                                .source = 2,
                                .length = 60,
                                .width = 200,
                                .fingers = 1,
                                .finger = &gate[i]};
  return c;
}

static void assert_refused(eda_circuit *c, const char *words) {
  opc_error error;
  g_assert_cmpint(eda_circuit_check(c, &error), ==, OPC_FAILED);
  if (!strstr(error.message, words))
    g_error("'%s' is not '%s'", error.message, words);
  eda_circuit_free(c);
}

static void test_check(void) {
  static const uint32_t far = 2, both[2] = {0, 1};
  opc_error error;
  eda_circuit *c = sound();
  if (eda_circuit_check(c, &error)) g_error("%s", error.message);
  g_assert_cmpint(eda_circuit_role(c, 0), ==, EDA_PIN_INPUT);
  g_assert_cmpint(eda_circuit_role(c, 1), ==, -1);
  eda_circuit_free(c);
  eda_circuit_free(NULL);
  assert_refused(NULL, "incomplete");
#define SPOILED(change, words) \
  c = sound();                 \
  change;                      \
  assert_refused(c, words)
  SPOILED(c->net[2] = NULL, "net 2 has no name");
  SPOILED(c->port[0] = 3, "port 0");
  SPOILED(c->role[0] = 4, "port 0");
  SPOILED(c->device[1].name = NULL, "device 1, '', has no name");
  SPOILED(c->device[1].bulk = 3, "device 1, 'M', is connected to a net");
  SPOILED(c->device[0].type = 2, "has no valid type");
  SPOILED(c->device[0].width = NAN, "has no size");
  SPOILED(c->device[0].length = 0, "has no size");
  SPOILED(c->device[0].fingers = 0, "has no gate");
  SPOILED(c->device[0].finger = &far, "has a gate that does not exist");
  SPOILED((c->device[0].fingers = 2, c->device[0].finger = both),
          "device 1, 'M', has the gate of another device");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/netlist/names", test_names);
  g_test_add_func("/netlist/grow", test_grow);
  g_test_add_func("/netlist/flat", test_flat);
  g_test_add_func("/netlist/expressions", test_expressions);
  g_test_add_func("/netlist/bad-expressions", test_bad_expressions);
  g_test_add_func("/netlist/wrapped", test_wrapped);
  g_test_add_func("/netlist/check", test_check);
  return g_test_run();
}
