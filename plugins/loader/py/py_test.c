/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests plugins in Python: parameters and data as the plugin receives them,
   results, reports of exceptions, ended processes and endless loops, and
   synthesizer.pydpb, whose moves equal those of synthesizer.dpb. Each test
   writes its plugins into the folder of the test. */
#include <eda/eda.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/devel/testing.h"

static int has_numpy;

/* ---- plugins ---- */

static void write_plugin(const char *id, const char *text) {
  g_autofree char *file = g_strconcat(id, ".py", NULL);
  g_autofree char *path = g_build_filename(opc_test_folder(), file, NULL);
  g_autofree char *whole = g_strconcat(
      "import os, signal, sys\nimport numpy as np\nfrom opcflow import *\n",
      text, NULL);
  g_assert_true(g_file_set_contents(path, whole, -1, NULL));
}

static opc_module *make(const char *id, const char *parameters) {
  opc_error error = {0};
  opc_module *m = opc_test_module(id, parameters, &error);
  if (!m) g_assert_cmpstr(error.message, ==, "");
  return m;
}

/* Skip a test without NumPy. Returns whether NumPy is missing. */
static int is_skipped(void) {
  if (!has_numpy) g_test_skip("python3 has no NumPy");
  return !has_numpy;
}

/* ---- a step ---- */

static const char everything[] =
    "class Everything(Step):\n"
    "    \"\"\"Values of all parameters.\n\n    More text.\n    \"\"\"\n"
    "    version = '1.2.3'\n"
    "    length = real('a length', unit='nm', preset='2 um', above=0)\n"
    "    line = real('a length', unit='nm', name='anchor.line')\n"
    "    count = integer('a number', preset=3)\n"
    "    fast = boolean('a flag', preset=True)\n"
    "    slow = boolean('a flag')\n"
    "    word = choice('a word', ('one', 'two'), preset='two')\n"
    "    label = text('a text', preset='x y')\n"
    "    steps = reals('lengths', unit='nm', preset='[1 nm, 2 nm]')\n"
    "    layers = mapping('layers')\n"
    "    table_file = output('a file', preset='out.txt')\n"
    "    gates = gates_input('transistors')\n"
    "    worst = metric('largest', unit='nm', better='lower')\n"
    "    def run(self):\n"
    "        g = self.gates\n"
    "        self.table('values', {'value': [str(v) for v in (self.length,\n"
    "            self.line, self.count, self.fast, self.slow, self.word,\n"
    "            self.label, self.steps, self.layers)]})\n"
    "        self.table('gates', {'length': g.length, 'width': g.width,\n"
    "            'type': g.type, 'x0': g.box[:, 0], 'cell': g.cell},\n"
    "            units={'length': 'nm'})\n"
    "        self.table('poly', {'x': g.drawn[POLY][0][:, 0]})\n"
    "        Step.metric(self, 'worst', 1 / 3)\n"
    "        with open(self.output_path(self.table_file), 'w') as f:\n"
    "            f.write('done')\n"
    "        print('printed')\n";

/* Each type of parameter, the transistors, and each kind of result. */
static void test_step(void) {
  if (is_skipped()) return;
  write_plugin("all.everything", everything);
  g_autoptr(opc_module) m =
      make("all.everything",
           "{ anchor: { line: 65 nm }, layers: { poly: 9/0 }, count: 4 }");
  const eda_gates *g = eda_gates_sample();
  opc_error error = {0};
  opc_test_input(m, "gates", (void *)g);
  if (opc_test_run(m, NULL, &error)) g_assert_cmpstr(error.message, ==, "");
  static const char *const want[] = {"2000.0", "65.0",       "4",
                                     "True",   "None",       "two",
                                     "x y",    "[1.0, 2.0]", "{'poly': '9/0'}"};
  g_assert_cmpint(opc_test_rows("values"), ==, G_N_ELEMENTS(want));
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++)
    g_assert_cmpstr(opc_test_text("values", "value", i), ==, want[i]);
  g_assert_cmpint(opc_test_rows("gates"), ==, g->count);
  for (size_t i = 0; i < g->count; i++) {
    g_assert_true(opc_test_number("gates", "length", i) == g->length[i]);
    g_assert_true(opc_test_number("gates", "width", i) == g->width[i]);
    g_assert_true(opc_test_number("gates", "type", i) == g->type[i]);
    g_assert_true(opc_test_number("gates", "x0", i) == g->box[i].x0);
    g_assert_cmpstr(opc_test_text("gates", "cell", i), ==, g->cell[i]);
  }
  const eda_shapes *poly = &g->drawn[EDA_POLY];
  g_assert_cmpint(opc_test_rows("poly"), ==, poly->start[1]);
  for (uint32_t i = 0; i < poly->start[1]; i++)
    g_assert_true(opc_test_number("poly", "x", i) == poly->points[i].x);
  g_assert_true(opc_test_metric("worst") == 1 / 3.0);
  g_assert_nonnull(strstr(opc_test_log(), "printed\n"));
  g_autofree char *path = g_build_filename(opc_test_folder(), "out.txt", NULL);
  g_assert_true(g_file_test(path, G_FILE_TEST_EXISTS));
}

/* ---- faults ---- */

static const char faulty[] =
    "class Faulty(Synthesizer):\n"
    "    \"\"\"A fault\"\"\"\n"
    "    fault = text('a fault', preset='none')\n"
    "    def check(self):\n"
    "        if self.fault == 'check':\n"
    "            raise Invalid('fault', 'no such fault')\n"
    "    def begin(self, f):\n"
    "        if self.fault == 'begin':\n"
    "            1 / 0\n"
    "    def update(self, f, moves):\n"
    "        fault = self.fault\n"
    "        if fault == 'raise': self.helper({})\n"
    "        if fault == 'exit': sys.exit(3)\n"
    "        if fault == 'leave': os._exit(0)\n"
    "        if fault == 'kill': os.kill(os.getpid(), signal.SIGKILL)\n"
    "        if fault == 'crash':\n"
    "            import ctypes; ctypes.string_at(0)\n"
    "        while fault == 'loop': pass\n"
    "        return None if fault == 'none' else True\n"
    "    def helper(self, empty):\n"
    "        return empty['missing']\n";

static const struct {
  const char *fault, *message, *log;
} faults[] = {
    {"begin", "ZeroDivisionError: division by zero (synthesizer.faulty.py:12)",
     "line 12, in begin"},
    {"raise", "KeyError: 'missing' (synthesizer.faulty.py:24)",
     "line 15, in update"},
    {"none", "TypeError: update must return True or False, found None", ""},
    {"exit", "the Python process exited with status 3 in update", ""},
    {"leave", "the Python process exited with status 0 in update", ""},
    {"kill",
     "the Python process ended by signal 9 (Killed) in "
     "update",
     ""},
    {"crash",
     "the Python process ended by signal 11 "
     "(Segmentation fault) in update",
     "line 20 in update"},
    {"loop", "update did not end within call_limit, 0.5 s",
     "line 21 in update"},
};

/* Call begin and update of a synthesizer on the sample. */
static int call_update(const opc_module *m, opc_error *error) {
  const eda_synthesizer *s = m->functions;
  const eda_gates *g = eda_gates_sample();
  double ones[2] = {1, 1};
  int32_t l[2] = {0}, w[2] = {0};
  int done;
  eda_performance p = {.count = 2, .ion = ones};
  eda_feedback f = {.gates = g, .design = &p};
  eda_moves moves = {.l = l, .w = w};
  int code = s->begin(m->self, &f, error);
  f.printed = &p;
  return code ? code : s->update(m->self, &f, &moves, &done, error);
}

static void test_faults(void) {
  if (is_skipped()) return;
  write_plugin("synthesizer.faulty", faulty);
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++) {
    g_autofree char *given =
        g_strdup_printf("{ fault: %s, call_limit: %s }", faults[i].fault,
                        strcmp(faults[i].fault, "loop") ? "100 s" : "0.5 s");
    g_autoptr(opc_module) m = make("synthesizer.faulty", given);
    opc_error error = {0};
    opc_test_forget();
    g_assert_cmpint(call_update(m, &error), ==, OPC_FAILED);
    if (!g_str_has_prefix(error.message, faults[i].message))
      g_assert_cmpstr(error.message, ==, faults[i].message);
    if (!strstr(opc_test_log(), faults[i].log))
      g_assert_cmpstr(opc_test_log(), ==, faults[i].log);
    /* After an exception the process still answers; a dead one is reported. */
    int again = call_update(m, &error);
    g_assert_cmpint(again, ==, OPC_FAILED);
  }
  opc_error error = {0};
  g_assert_null(
      opc_test_module("synthesizer.faulty", "{ fault: check }", &error));
  g_assert_nonnull(strstr(error.message, "no such fault"));
}

/* A request to stop ends a call, and logs the place. */
static void test_cancel(void) {
  if (is_skipped()) return;
  write_plugin("synthesizer.faulty", faulty);
  g_autoptr(opc_module) m = make("synthesizer.faulty", "{ fault: loop }");
  opc_error error = {0};
  opc_test_forget();
  opc_test_cancel(1);
  int code = call_update(m, &error);
  opc_test_cancel(0);
  g_assert_cmpint(code, ==, OPC_CANCELLED);
}

static const struct {
  const char *id, *text, *message;
} refused[] = {
    {"step.syntax", "class Broken(Step:\n",
     "SyntaxError: invalid syntax (step.syntax.py, line 4)"},
    {"step.empty", "", "TypeError: expected one plugin class, found 0"},
    {"step.raise", "raise OSError('no licence')\n",
     "OSError: no licence (step.raise.py:4)"},
    {"step.exit", "sys.exit(2)\n",
     "the Python process exited with status 2 in describe"},
    {"step.kind", "class Odd(Step):\n    kind = 'command'\n",
     "plugins of the kind 'command' cannot be written in Python"},
    {"step.summary", "class Odd(Step):\n    pass\n",
     "the descriptor has no summary"},
    {"step.preset",
     "class Odd(Step):\n    'A step'\n"
     "    size = real('a size', unit='nm', preset='2 V')\n",
     "default of parameter 'size'"},
};

static void test_refused(void) {
  if (is_skipped()) return;
  for (size_t i = 0; i < G_N_ELEMENTS(refused); i++) {
    opc_error error = {0};
    write_plugin(refused[i].id, refused[i].text);
    g_assert_null(opc_test_module(refused[i].id, "{}", &error));
    if (!strstr(error.message, refused[i].message))
      g_assert_cmpstr(error.message, ==, refused[i].message);
  }
}

/* An interpreter that does not exist. */
static void test_interpreter(void) {
  if (is_skipped()) return;
  write_plugin("step.missing", "");
  opc_error error = {0};
  g_setenv("OPCFLOW_PYTHON", "/nowhere/python3", TRUE);
  g_assert_null(opc_test_module("step.missing", "{}", &error));
  g_unsetenv("OPCFLOW_PYTHON");
  g_assert_nonnull(
      strstr(error.message,
             "cannot start the Python interpreter '/nowhere/python3': "
             "No such file or directory"));
}

/* ---- synthesizers ---- */

enum { GATES = 300 };

/* Transistors whose Ion is a linear function of l and w, with vetoes and
   transistors that do not print below a length. */
typedef struct model {
  opc_module *module;
  double offset[GATES], by_l[GATES], by_w[GATES];
  int32_t veto_from[GATES], open_until[GATES];
  double design[GATES], length[GATES], width[GATES], ion[GATES];
  uint32_t flags[GATES], vetoes[GATES];
  int32_t l[GATES], w[GATES];
  int done;
} model;

/* Return a random number in from .. to. */
static double between(GRand *random, double from, double to) {
  return g_rand_double_range(random, from, to);
}

static void model_fill(model *t, guint32 seed) {
  GRand *random = g_rand_new_with_seed(seed);
  for (int i = 0; i < GATES; i++) {
    t->offset[i] = between(random, -30, 30);
    t->by_l[i] = between(random, -4, -1);
    t->width[i] = between(random, 60, 900);
    t->by_w[i] = between(random, 50, 150) / t->width[i];
    t->veto_from[i] = g_rand_int_range(random, 0, 4) ? 1000 : 3;
    t->open_until[i] = g_rand_int_range(random, 0, 10) ? -1000 : 1;
    t->design[i] = between(random, 1e-5, 1e-3);
    t->length[i] = 65;
  }
  g_rand_free(random);
}

static void model_print(model *t, uint32_t iteration) {
  for (int i = 0; i < GATES; i++) {
    /* Neighbours disturb some transistors in later iterations. */
    double off = i % 7 || iteration < 5 || iteration > 9 ? 0 : 0.8;
    double pde =
        t->offset[i] + off + t->by_l[i] * t->l[i] + t->by_w[i] * t->w[i];
    int is_open = t->l[i] < t->open_until[i];
    t->ion[i] = is_open ? 0 : t->design[i] * (1 + pde / 100);
    t->flags[i] = is_open ? EDA_PRINT_OPEN : 0;
    t->vetoes[i] = (t->l[i] >= t->veto_from[i] ? EDA_VETO_LONGER : 0) |
                   (t->w[i] >= 3 * t->veto_from[i] ? EDA_VETO_WIDER : 0);
  }
}

static void model_iterate(model *t, uint32_t iteration) {
  const eda_synthesizer *s = t->module->functions;
  const double limit = 0.7;
  opc_error error = {0};
  eda_gates gates = *eda_gates_sample();
  char *texts[GATES] = {0};
  eda_box box[GATES] = {{0}};
  uint8_t bytes[GATES] = {0};
  double sides[2 * GATES] = {0};
  for (int i = 0; i < GATES; i++) texts[i] = gates.cell[0];
  gates.count = GATES;
  gates.length = t->length, gates.width = t->width, gates.box = box;
  gates.type = gates.axis = bytes, gates.space = gates.extension = sides;
  gates.instance = gates.cell = texts;
  gates.number = t->flags;
  eda_performance design = {.count = GATES, .ion = t->design};
  eda_performance printed = {.count = GATES, .ion = t->ion};
  eda_feedback f = {.iteration = iteration,
                    .gates = &gates,
                    .design = &design,
                    .flags = t->flags,
                    .vetoes = t->vetoes,
                    .scanner = {193, 0.75},
                    .ion_limit = &limit};
  eda_moves moves = {.l = t->l, .w = t->w};
  if (!iteration && s->begin(t->module->self, &f, &error))
    g_assert_cmpstr(error.message, ==, "");
  f.printed = &printed;
  model_print(t, iteration);
  if (s->update(t->module->self, &f, &moves, &t->done, &error))
    g_assert_cmpstr(error.message, ==, "");
}

/* Run both plugins on the same transistors; all moves must be equal. */
static void compare_dpb(const char *parameters, guint32 seed) {
  model *c = g_new0(model, 1), *py = g_new0(model, 1);
  model_fill(c, seed);
  model_fill(py, seed);
  c->module = make("synthesizer.dpb", parameters);
  py->module = make("synthesizer.pydpb", parameters);
  uint32_t i = 0;
  for (; !c->done && i < 150; i++) {
    model_iterate(c, i);
    model_iterate(py, i);
    g_assert_cmpmem(c->l, sizeof c->l, py->l, sizeof py->l);
    g_assert_cmpmem(c->w, sizeof c->w, py->w, sizeof py->w);
    g_assert_cmpint(c->done, ==, py->done);
  }
  g_assert_cmpint(i, >, 9);
  const eda_synthesizer *s = c->module->functions;
  const eda_synthesizer *own = py->module->functions;
  for (size_t k = 0; k < GATES; k++)
    g_assert_cmpstr(s->verdict(c->module->self, k), ==,
                    own->verdict(py->module->self, k));
  opc_test_module_free(c->module);
  opc_test_module_free(py->module);
  g_free(c);
  g_free(py);
}

static void test_dpb(void) {
  if (is_skipped()) return;
  compare_dpb("{}", 1);
  compare_dpb("{ w_step: unit, ion_limit: 0.2 % }", 2);
  compare_dpb("{ max_bias: 4 nm, ion_limit: 0.5 % }", 3);
}

static const char keeping[] =
    "class Keeping(Synthesizer):\n"
    "    \"\"\"Keeps the arrays of earlier iterations\"\"\"\n"
    "    def begin(self, f): self.all, self.copies = [], []\n"
    "    def update(self, f, moves):\n"
    "        self.all.append(f.printed.ion)\n"
    "        self.copies.append(f.printed.ion.copy())\n"
    "        moves.l += 1\n"
    "        return False\n"
    "    def verdict(self, gate):\n"
    "        return str(all((a == b).all() for a, b in\n"
    "                       zip(self.all, self.copies))) + str(len(self.all))\n"
    "    def targets(self): return self.all[0] * 2\n";

/* Arrays that the plugin keeps do not change in later calls, although the
   memory is shared. */
static void test_kept(void) {
  if (is_skipped()) return;
  write_plugin("synthesizer.keeping", keeping);
  model *t = g_new0(model, 1);
  model_fill(t, 5);
  t->module = make("synthesizer.keeping", "{}");
  for (uint32_t i = 0; i < 6; i++) model_iterate(t, i);
  const eda_synthesizer *s = t->module->functions;
  g_assert_cmpstr(s->verdict(t->module->self, 0), ==, "True6");
  g_assert_cmpint(t->l[GATES - 1], ==, 6);
  memset(t->l, 0, sizeof t->l);
  model_print(t, 0);
  for (size_t i = 0; i < GATES; i++)
    g_assert_true(s->target(t->module->self, i) == 2 * t->ion[i]);
  opc_test_module_free(t->module);
  g_free(t);
}

/* ---- models ---- */

static const char extractor[] =
    "class Formula(Extractor):\n"
    "    \"\"\"Current in proportion to W / L\"\"\"\n"
    "    slices = integer('slices', preset=3)\n"
    "    def slicing(self):\n"
    "        n = self.slices\n"
    "        return (np.arange(n) + 0.5) / n, np.full(n, 1 / n)\n"
    "    def extract(self, s, out):\n"
    "        out.ion[:] = (s.width / s.length).sum(axis=1) * (1 + s.type)\n"
    "        out.ioff[:] = s.edge[:, 1]\n"
    "        out.leq_ion[:], out.leq_ioff[:] = s.length[:, 0], s.length[:, 2]\n"
    "        out.weq[:] = s.width.sum(axis=1)\n"
    "        out.area[:] = 7\n"
    "        out.outside[:] = 1\n";

static void test_extractor(void) {
  if (is_skipped()) return;
  write_plugin("extractor.formula", extractor);
  g_autoptr(opc_module) m = make("extractor.formula", "{}");
  const eda_extractor *e = m->functions;
  opc_error error = {0};
  const double *place, *share;
  g_assert_cmpint(e->prepare(m->self, &error), ==, OPC_OK);
  g_assert_cmpint(e->slicing(m->self, &place, &share), ==, 3);
  g_assert_true(place[1] == 0.5 && share[2] == 1 / 3.0);
  const uint8_t type[] = {EDA_NMOS, EDA_PMOS};
  const double width[] = {100, 100, 100, 200, 200, 250};
  const double length[] = {50, 64, 80, 32, 40, 100};
  const double edge[] = {1, 2, 3, 4, 5, 6};
  const eda_slices in = {.count = 2,
                         .slices = 3,
                         .type = type,
                         .width = width,
                         .length = length,
                         .edge = edge};
  eda_performance out;
  eda_performance_init(&out, 2);
  g_assert_cmpint(e->extract(m->self, &in, &out, &error), ==, OPC_OK);
  g_assert_true(out.ion[0] == 100 / 50.0 + 100 / 64.0 + 100 / 80.0);
  g_assert_true(out.ion[1] == 2 * (200 / 32.0 + 200 / 40.0 + 250 / 100.0));
  g_assert_true(out.ioff[0] == 2 && out.ioff[1] == 5);
  g_assert_true(out.leq_ion[1] == 32 && out.leq_ioff[1] == 100);
  g_assert_true(out.weq[1] == 650 && out.area[0] == 7 && out.outside[1] == 1);
  eda_performance_clear(&out);
}

static const char resist[] =
    "class Level(Resist):\n"
    "    \"\"\"A threshold that depends on the layer\"\"\"\n"
    "    threshold = real('threshold', preset='0.25')\n"
    "    def prepare(self, scanner): self.na = scanner.na\n"
    "    def level(self, layer, image):\n"
    "        assert image.values.shape == (6, 8) and image.frame[2] == 800\n"
    "        return self.threshold * (1 + layer) - image.values\n";

/* A linear resist acts on values as on coefficients. */
static void test_resist(void) {
  if (is_skipped()) return;
  write_plugin("resist.level", resist);
  g_autoptr(opc_module) m = make("resist.level", "{}");
  const eda_resist *r = m->functions;
  opc_error error = {0};
  eda_field field = {{0, 0, 800, 600}, 8, 6, eda_alloc(48, sizeof(float))};
  for (int i = 0; i < 48; i++)
    field.coefficients[i] = (float)(i * 37 % 48) / 48;
  g_assert_cmpint(r->prepare(m->self, NULL, &error), ==, OPC_OK);
  g_assert_cmpint(r->print(m->self, 1, &field, &error), ==, OPC_OK);
  for (int i = 0; i < 48; i++)
    g_assert_cmpfloat_with_epsilon(field.coefficients[i],
                                   0.5 - (i * 37 % 48) / 48.0, 2e-6);
  eda_field_clear(&field);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_autofree char *path =
      g_strjoin(":", opc_test_folder(), g_getenv("OPCFLOW_PLUGIN_PATH"),
                g_getenv("OPCFLOW_SOURCE"), NULL);
  g_autofree char *all =
      g_strconcat(path, "/subprojects/python/examples", NULL);
  g_setenv("OPCFLOW_PLUGIN_PATH", all, TRUE);
  has_numpy = !system("python3 -c 'import numpy' 2>/dev/null");
  g_test_add_func("/loader.py/step", test_step);
  g_test_add_func("/loader.py/faults", test_faults);
  g_test_add_func("/loader.py/cancel", test_cancel);
  g_test_add_func("/loader.py/refused", test_refused);
  g_test_add_func("/loader.py/interpreter", test_interpreter);
  g_test_add_func("/loader.py/dpb", test_dpb);
  g_test_add_func("/loader.py/kept", test_kept);
  g_test_add_func("/loader.py/extractor", test_extractor);
  g_test_add_func("/loader.py/resist", test_resist);
  return g_test_run();
}
