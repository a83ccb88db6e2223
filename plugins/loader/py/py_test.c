/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests plugins in Python: parameters and data as the plugin receives them,
   results, reports of exceptions, ended processes and endless loops, and
   synthesizer.pydpb, whose moves equal those of synthesizer.dpb. */
#include "py_test.h"

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
    {"step.option",
     "class Odd(Step):\n    'A step'\n"
     "    size = real('a size', units='nm')\n",
     "TypeError: unknown options of a parameter: units (step.option.py:6)"},
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

int main(int argc, char **argv) {
  set_up(argc, argv);
  g_test_add_func("/loader.py/step", test_step);
  g_test_add_func("/loader.py/faults", test_faults);
  g_test_add_func("/loader.py/cancel", test_cancel);
  g_test_add_func("/loader.py/refused", test_refused);
  g_test_add_func("/loader.py/interpreter", test_interpreter);
  g_test_add_func("/loader.py/dpb", test_dpb);
  g_test_add_func("/loader.py/kept", test_kept);
  return g_test_run();
}
