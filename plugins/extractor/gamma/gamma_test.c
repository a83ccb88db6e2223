/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of weights of slices against closed forms, and against extractor.plain
   for weights of 1. */
#include "../gates_test.h"

static char *devices(void) {
  const char *source = g_getenv("OPCFLOW_SOURCE");
  return g_build_filename(source ? source : ".", "data", "devices",
                          "ptm65.yaml", NULL);
}

static opc_module *module_make(const char *id, const char *more) {
  g_autofree char *file = devices();
  g_autofree char *text = g_strdup_printf("{ devices: '%s'%s }", file, more);
  opc_error error = {0};
  opc_module *m = opc_test_module(id, text, &error);
  if (!m) g_error("%s", error.message);
  const eda_extractor *e = m->functions;
  if (e->prepare(m->self, &error)) g_error("%s", error.message);
  return m;
}

static char *write_text(const char *name, const char *text) {
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  return path;
}

static double straight(double t) { return t < 2 ? 66 : 0; }
static double rounded(double t) {
  return sqrt(38 * 38 + (90 * 90 - 38 * 38) * t);
}

static const char ones[] =
    "type,current,width (nm),edge (nm),gamma\n"
    "n,ion,200,0,1\nn,ion,200,30,1\nn,ion,900,0,1\nn,ion,900,30,1\n"
    "p,ioff,500,10,1\n";

static int figures_same(const figures *a, const figures *b) {
  return a->ion == b->ion && a->ioff == b->ioff && a->leq_ion == b->leq_ion &&
         a->leq_ioff == b->leq_ioff && a->weq == b->weq && a->area == b->area;
}

static void test_one(void) {
  static shape *const shapes[] = {straight, rounded};
  static const char *const rules[] = {"contour", "gauss", "equal"};
  g_autofree char *path = write_text("ones.csv", ones);
  for (size_t r = 0; r < G_N_ELEMENTS(rules); r++) {
    g_autofree char *rule = g_strdup_printf(", rule: %s", rules[r]);
    g_autofree char *both =
        g_strdup_printf(", rule: %s, table: '%s'", rules[r], path);
    g_autoptr(opc_module) plain = module_make("extractor.plain", rule);
    g_autoptr(opc_module) terms = module_make("extractor.gamma", rule);
    g_autoptr(opc_module) table = module_make("extractor.gamma", both);
    for (size_t k = 0; k < 2; k++)
      for (uint8_t type = 0; type < 2; type++) {
        figures a = of_gate(plain, type, 400, shapes[k], 20);
        figures b = of_gate(terms, type, 400, shapes[k], 20);
        figures c = of_gate(table, type, 400, shapes[k], 20);
        if (!figures_same(&a, &b) || !figures_same(&a, &c))
          g_error("%s shape %zu type %d: %.17g %.17g %.17g, %.17g %.17g %.17g",
                  rules[r], k, type, a.ion, b.ion, c.ion, a.leq_ion, b.leq_ion,
                  c.leq_ion);
      }
  }
}

/* Return the mean of 1 + a exp(-d / decay) over a width: 1 + 2 a decay / W (1 -
   exp(-W / 2 decay)). */
static double mean_weight(double a, double decay, double w) {
  return 1 + 2 * a * decay / w * (1 - exp(-w / 2 / decay));
}

static const char terms[] =
    ", nmos: { ion_edge: 0.3, ion_decay: 25 nm, ioff_edge: -0.5, "
    "ioff_decay: 8 nm }, pmos: { ion_edge: -0.2, ion_decay: 15 nm, "
    "ioff_edge: 2, ioff_decay: 40 nm }";

static void test_edge(void) {
  static const double a[2][2] = {{0.3, -0.5}, {-0.2, 2}};
  static const double decay[2][2] = {{25, 8}, {15, 40}};
  g_autoptr(opc_module) plain = module_make("extractor.plain", "");
  g_autoptr(opc_module) gamma = module_make("extractor.gamma", terms);
  for (uint8_t type = 0; type < 2; type++)
    for (double w = 120; w < 1000; w *= 1.7) {
      figures p = of_gate(plain, type, w, straight, 100);
      figures g = of_gate(gamma, type, w, straight, 100);
      assert_near(g.ion / p.ion, mean_weight(a[type][0], decay[type][0], w),
                  1e-4);
      assert_near(g.ioff / p.ioff, mean_weight(a[type][1], decay[type][1], w),
                  1e-4);
      /* The equivalent length of a rectangle is its length. */
      assert_near(g.leq_ion, 66, 1e-9);
      assert_near(g.leq_ioff, 66, 1e-9);
      assert_near(g.area, p.area, 1e-12);
    }
}

/* Test gamma of 1.6 and 1.2 at 0 and 20 nm for narrow transistors, and 1 for
   wide ones. */
static void test_table(void) {
  g_autofree char *path =
      write_text("table.csv",
                 "# width and edge in nm\n\ngamma, edge, width, current, type\n"
                 "1.2,20,100,ion,n\n1.6,0,100,ion,n\n1,0,300,ion,n\n"
                 "1,20,300,ion,n\n");
  g_autofree char *more = g_strdup_printf(", table: '%s'", path);
  g_autofree char *many =
      g_strdup_printf("%s, rule: equal, slices: 10000", more);
  g_autoptr(opc_module) plain = module_make("extractor.plain", "");
  g_autoptr(opc_module) gamma = module_make("extractor.gamma", many);
  static const struct {
    double width, mean;
  } cases[] = {{100, 1.2 + 0.2 * 40 / 100},
               {50, 1.2 + 0.2 * 40 / 50},
               {200, 1 + (0.2 + 0.2 * 40 / 200) / 2},
               {300, 1},
               {800, 1}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    double w = cases[i].width;
    figures p = of_gate(plain, EDA_NMOS, w, straight, 100);
    figures g = of_gate(gamma, EDA_NMOS, w, straight, 100);
    assert_near(g.ion / p.ion, cases[i].mean, 1e-6);
    assert_near(g.ioff, p.ioff, 1e-12);
  }
}

/* Test 12 slices of the contour rule against many equal slices. */
static void test_contour(void) {
  g_autofree char *more =
      g_strdup_printf("%s, rule: equal, slices: 10000", terms);
  g_autoptr(opc_module) many = module_make("extractor.gamma", more);
  g_autoptr(opc_module) gamma = module_make("extractor.gamma", terms);
  for (uint8_t type = 0; type < 2; type++) {
    figures want = of_gate(many, type, 500, rounded, 15);
    figures got = of_gate(gamma, type, 500, rounded, 15);
    g_test_message("Ion %.5f %%, Ioff %.5f %%", 100 * (got.ion / want.ion - 1),
                   100 * (got.ioff / want.ioff - 1));
    assert_near(got.ion, want.ion, 1e-4);
    assert_near(got.ioff, want.ioff, 2e-3);
  }
}

static void assert_refused(const char *text, const char *message) {
  g_autofree char *path = write_text("bad.csv", text);
  g_autofree char *file = devices();
  g_autofree char *map =
      g_strdup_printf("{ devices: '%s', table: '%s' }", file, path);
  opc_error error = {0};
  g_autoptr(opc_module) m = opc_test_module("extractor.gamma", map, &error);
  g_assert_nonnull(m);
  const eda_extractor *e = m->functions;
  g_assert_cmpint(e->prepare(m->self, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "table");
  if (!strstr(error.message, message))
    g_error("'%s' is not '%s'", error.message, message);
}

static void test_refused(void) {
  static const char head[] = "type,current,width,edge,gamma\n";
  static const struct {
    const char *rows, *message;
  } cases[] = {
      {"", "has no rows"},
      {"x,ion,1,0,1\n", "bad.csv:2:1: neither 'n' nor 'p': 'x'"},
      {"n,ioN,1,0,1\n", "bad.csv:2:3: expected 'ion' or 'ioff': 'ioN'"},
      {"n,ion,0,0,1\n", "bad.csv:2:7: not above 0: '0'"},
      {"n,ion,1,-1,1\n", "bad.csv:2:9: not above"},
      {"n,ion,1,0,nan\n", "bad.csv:2:11: not a number: 'nan'"},
      {"n,ion,1,0\n", "bad.csv:2:10: not a number: ''"},
      {"n , ion ,1\t,  0 , z \n", "bad.csv:2:19: not a number: 'z'"},
      {"n,ion,1,0,0\n", "bad.csv:2:11: not above 0: '0'"},
      {"n,ion,1,0,1\nn,ion,1,0,2\n", "bad.csv:3:9: a second row"},
      {"n,ion,1,0,1\nn,ion,1,5,1\nn,ion,2,0,1\n",
       "bad.csv:4:9: all widths must have the same edges"},
      {"n,ion,1,0,1\nn,ion,2,5,1\n",
       "bad.csv:3:9: all widths must have the same edges"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = g_strconcat(head, cases[i].rows, NULL);
    assert_refused(text, cases[i].message);
  }
  assert_refused("type,current,width,edge\n",
                 "bad.csv:1:1: missing column 'gamma'");
  assert_refused("type,typ\n", "bad.csv:1:6: unknown column 'typ'");
  assert_refused("type , typ\n", "bad.csv:1:8: unknown column 'typ'");
  assert_refused("type,width (um)\n", "bad.csv:1:6: wrong unit: 'width (um)'");
  assert_refused("type,type\n", "bad.csv:1:6: duplicate column: 'type'");
  g_autofree char *path = write_text("both.csv", ones);
  g_autofree char *file = devices();
  g_autofree char *map = g_strdup_printf(
      "{ devices: '%s', table: '%s', nmos: { ion_edge: 0.1 } }", file, path);
  opc_error error;
  g_assert_null(opc_test_module("extractor.gamma", map, &error));
  g_assert_nonnull(strstr(error.message, "replaces all edge terms"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/gamma/one", test_one);
  g_test_add_func("/gamma/edge", test_edge);
  g_test_add_func("/gamma/table", test_table);
  g_test_add_func("/gamma/contour", test_contour);
  g_test_add_func("/gamma/refused", test_refused);
  return g_test_run();
}
