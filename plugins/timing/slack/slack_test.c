/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests circuits of inverters whose delays, currents and best lengths are known
   in closed form or from exhaustive search. */
#include <eda/gates.h>
#include <eda/memory.h>

#include "../paths/library_test.h"

static void close_to(double a, double b, double within) {
  if (!(fabs(a - b) <= within)) g_error("%.12g is not %.12g", a, b);
}

static void assert_good(int code, const opc_error *error) {
  if (code) g_error("%s", error->message);
}

/* ---- devices: currents that fall exponentially with length ---- */

static const double drop[2] = {0.02, 0.3}; /* d ln I / dL of Ion and Ioff,
                                              1/nm */
static const double most_ion = 0.9;
enum { STEPS = 10 };

/* Return the length increase (nm) that costs 10 % of Ion. */
static double longest(void) { return log(most_ion) / -drop[0]; }
static double length_at(int step) {
  return 60 * (exp(log1p(longest() / 60) * step / STEPS) - 1);
}

static const char *devices(void) {
  static char *path;
  g_autoptr(GString) s = g_string_new(
      "opcflow-devices: 1\nname: t\nsource: t\nsupply: 1 V\n"
      "temperature: 27 C\nwidth: 1 um\nion: a\nioff: b\nlength: {unit: nm, "
      "values: [");
  for (int l = 40; l <= 80; l++) g_string_append_printf(s, "%d, ", l);
  g_string_append(s, "81]}\n");
  for (int type = 0; type < 2; type++) {
    g_string_append(s, type ? "pmos:\n" : "nmos:\n");
    for (int which = 0; which < 2; which++) {
      g_string_append(s, which ? "  ioff: {unit: A, values: ["
                               : "  ion: {unit: A, values: [");
      for (int l = 40; l <= 81; l++)
        g_string_append_printf(s, "%s%.12e", l > 40 ? ", " : "",
                               (which ? 1e-7 : 1e-3) * (type ? 0.5 : 1) *
                                   exp(-drop[which] * (l - 60)));
      g_string_append(s, "]}\n");
    }
  }
  g_free(path);
  path = g_build_filename(opc_test_folder(), "devices.yaml", NULL);
  g_assert_true(g_file_set_contents(path, s->str, -1, NULL));
  return path;
}

/* ---- circuit: instances XU1 ... of one inverter each ---- */

enum { MOST = 40 };

typedef struct placed {
  eda_gates gates;
  eda_circuit circuit;
  eda_box box[2 * MOST];
  uint8_t type[2 * MOST], axis[2 * MOST];
  double length[2 * MOST], width[2 * MOST], space[4 * MOST],
      extension[4 * MOST];
  char *instance[2 * MOST], *cell[2 * MOST];
  eda_goal goal[2 * MOST];
  uint32_t number[2 * MOST], finger[2 * MOST];
  eda_device device[2 * MOST];
  char name[2 * MOST][16], path[MOST][8];
} placed;

/* Return a circuit of inverters with n- and p-transistors of 200 and 300 nm
   width. */
static placed *place_all(size_t instances) {
  static const char *net[] = {"a", "z", "VDD", "VSS"};
  static uint32_t port[] = {0, 1, 2, 3};
  static uint8_t role[] = {EDA_PIN_INPUT, EDA_PIN_OUTPUT, EDA_PIN_SUPPLY,
                           EDA_PIN_GROUND};
  placed *p = eda_alloc(1, sizeof *p);
  p->gates = *eda_gates_sample();
  p->gates.count = 2 * instances;
  for (size_t i = 0; i < 2 * instances; i++) {
    int is_p = i % 2 == 1;
    g_snprintf(p->path[i / 2], sizeof p->path[0], "XU%zu", i / 2 + 1);
    g_snprintf(p->name[i], sizeof p->name[0], "%s/%s", p->path[i / 2],
               is_p ? "MP" : "MN");
    p->box[i] = (eda_box){0, 0, 60, is_p ? 300 : 200};
    p->type[i] = is_p ? EDA_PMOS : EDA_NMOS;
    p->length[i] = 60;
    p->width[i] = is_p ? 300 : 200;
    p->instance[i] = p->path[i / 2];
    p->cell[i] = (char *)"INV";
    p->number[i] = 1 + (uint32_t)is_p;
    p->finger[i] = (uint32_t)i;
    p->device[i] = (eda_device){
        p->name[i],    0,   0, 0, 0, 60, p->width[i], p->type[i], 1,
        &p->finger[i], NULL};
  }
  p->gates.box = p->box;
  p->gates.type = p->type;
  p->gates.axis = p->axis;
  p->gates.length = p->length;
  p->gates.width = p->width;
  p->gates.space = p->space;
  p->gates.extension = p->extension;
  p->gates.instance = p->instance;
  p->gates.cell = p->cell;
  p->gates.number = p->number;
  p->gates.goal = p->goal;
  for (size_t i = 0; i < 2 * MOST; i++) p->goal[i] = eda_goal_none;
  p->circuit = (eda_circuit){.name = "top",
                             .gates = &p->gates,
                             .nets = 4,
                             .net = net,
                             .ports = 4,
                             .port = port,
                             .role = role,
                             .count = 2 * instances,
                             .device = p->device};
  return p;
}

/* ---- delay of an inverter, ps, equal for all edges and slews ---- */

static const double base = 10, by_own = 8,
                    by_load = 2000;   /* delay, ps; its derivatives by ln L, ps,
                                         and by load, ps/pF */
static const double by_gate = 1.5e-3; /* pF/ln */

/* Return a library whose delays depend on the length of the cell's n-transistor
   and on the load, which depends on the n-transistors of the driven cells. The
   p-transistors have no effect. */
static eda_timing *made_up(void) {
  enum { A, Y, VDD, VSS, NETS };
  static const uint32_t port[] = {A, Y};
  static const int8_t rail[NETS] = {[VDD] = 1, [VSS] = -1};
  eda_timing *t = library();
  eda_timing_cell *c = &t->cell[0];
  c->nets = NETS;
  c->port = (uint32_t *)port;
  c->rail = (int8_t *)rail;
  for (int p = 0; p < 2; p++) {
    c->device[p].gate = A;
    c->device[p].drain = Y;
    c->device[p].source = p ? VDD : VSS;
  }
  for (size_t a = 0; a < c->arcs; a++) {
    for (int g = 0; g < SLEWS * LOADS; g++) {
      c->arc[a].delay[g] = 1e-12 * base + by_load * c->at_load[g % LOADS];
      c->arc[a].slew[g] = 10e-12;
    }
    for (int point = 0; point < 3; point++)
      c->arc[a].delay_by[point * 2 * EDA_SIZES + EDA_SIZE_L] = 1e-12 * by_own;
  }
  for (size_t k = 0; k < c->inputs * 2 * EDA_CAPS; k++)
    c->capacitance_by[k * 2 * EDA_SIZES + EDA_SIZE_C] = 1e-12 * by_gate;
  return t;
}

static int slack_run(eda_timing *t, placed *p, const char *ports,
                     const char *instances, const char *more, eda_goal *wishes,
                     opc_error *error) {
  g_autofree char *path = write_circuit(ports, instances);
  g_autofree char *text = g_strdup_printf(
      "{ file: %s, top: top, devices: %s%s%s }", path, devices(),
      strstr(more, "load:") ? "" : ", load: 0 fF", more);
  void *made[2] = {NULL, NULL};
  opc_test_forget();
  opc_module *m = opc_test_module("timing.slack", text, error);
  if (!m) return error->code;
  opc_test_input(m, "timing", t);
  opc_test_input(m, "circuit", &p->circuit);
  int code = opc_test_run(m, made, error);
  if (!code && wishes) {
    /* Only the goals differ. */
    const eda_gates *g = made[0];
    const eda_circuit *c = made[1];
    g_assert_true(c->gates == g && g->box == p->box && c->device == p->device);
    memcpy(wishes, g->goal, g->count * sizeof *wishes);
  }
  if (!code) opc_test_release(m, made);
  opc_test_module_free(m);
  return code;
}

/* Compute the step of each transistor from its target area. */
static void find_steps(const placed *p, int *step) {
  memset(step, 0, p->circuit.count * sizeof *step);
  for (size_t r = 0; r < opc_test_rows("wishes"); r++) {
    double area = opc_test_number("wishes", "area", r);
    size_t i = 0;
    while (i < p->circuit.count) {
      g_autofree char *name =
          g_strdup_printf("%s:%u", p->instance[i], p->number[i]);
      if (!strcmp(name, opc_test_text("wishes", "transistor", r))) break;
      i++;
    }
    g_assert_cmpuint(i, <, p->circuit.count);
    step[i] = (int)lround(STEPS * log(area) / log1p(longest() / 60));
    double nm = length_at(step[i]);
    close_to(area, 1 + nm / 60, 1e-6);
    close_to(opc_test_number("wishes", "ion", r), exp(-drop[0] * nm), 1e-5);
    close_to(opc_test_number("wishes", "ioff", r), exp(-drop[1] * nm), 1e-5);
  }
}

/* ---- small circuits, all combinations ---- */

/* Instances driven by each instance, at most two; -1: output. */
typedef struct shape {
  const char *ports, *instances;
  size_t count;
  int next[5][2];
} shape;

/* Return the delay of an instance, and of the longest path from the
   instance. */
static double delay_alone(const shape *s, int i, const int *step) {
  double load = 0;
  for (int k = 0; k < 2; k++)
    if (s->next[i][k] >= 0)
      load += by_gate * log1p(length_at(step[s->next[i][k]]) / 60) +
              pin_load * 1e12;
  return base + by_own * log1p(length_at(step[i]) / 60) + by_load * load;
}

static double path_from(const shape *s, int i, const int *step) {
  double most = 0;
  for (int k = 0; k < 2; k++)
    if (s->next[i][k] >= 0)
      most = fmax(most, path_from(s, s->next[i][k], step));
  return delay_alone(s, i, step) + most;
}

static double longest_path(const shape *s, const int *step) {
  double most = 0;
  for (size_t i = 0; i < s->count; i++)
    most = fmax(most, path_from(s, (int)i, step));
  return most;
}

/* Return the longest path through an instance. Each instance has one driver,
   with a smaller number. */
static double path_through(const shape *s, int i, const int *step) {
  double sum = path_from(s, i, step);
  for (int from = i - 1; from >= 0; from--)
    if (s->next[from][0] == i || s->next[from][1] == i) {
      sum += delay_alone(s, from, step);
      i = from;
    }
  return sum;
}

/* Return the leakage. Each input level occurs half of the time, so each
   transistor leaks half of the time. */
static double leak_of(const shape *s, const int *step) {
  double sum = 0;
  for (size_t i = 0; i < s->count; i++)
    sum += 200 * 1e-10 * exp(-drop[1] * length_at(step[i])) +
           300 * 0.5e-10 * exp(-drop[1] * longest());
  return 1e9 * sum / 2;
}

/* Return the least leakage of all combinations of steps that meet the limit. */
static double least_leak(const shape *s, double limit) {
  int step[5] = {0};
  double least = INFINITY;
  for (;;) {
    if (longest_path(s, step) <= limit) least = fmin(least, leak_of(s, step));
    size_t i = 0;
    while (i < s->count && ++step[i] > STEPS) step[i++] = 0;
    if (i == s->count) return least;
  }
}

static const shape shapes[] = {
    /* Chain. */
    {"a z",
     "XU1 a m VDD VSS INV\nXU2 m n VDD VSS INV\nXU3 n z VDD VSS INV\n",
     3,
     {{1, -1}, {2, -1}, {-1, -1}}},
    /* Chain with a short branch from its first net. */
    {"a z y",
     "XU1 a m VDD VSS INV\nXU2 m n VDD VSS INV\nXU3 n z VDD VSS INV\n"
     "XU4 m y VDD VSS INV\n",
     4,
     {{1, 3}, {2, -1}, {-1, -1}, {-1, -1}}},
    /* Two chains from one input, the second one forks. */
    {"a z y x",
     "XU1 a m VDD VSS INV\nXU2 m z VDD VSS INV\nXU3 a n VDD VSS INV\n"
     "XU4 n y VDD VSS INV\nXU5 n x VDD VSS INV\n",
     5,
     {{1, -1}, {-1, -1}, {3, 4}, {-1, -1}, {-1, -1}}},
};

/* The leakage exceeds the minimum by at most 4 %, the delay meets the limit,
   and no instance can be raised by another step. */
static void test_all_combinations(void) {
  static const double limits[] = {0, 0.3, 0.8, 1.5, 2.5, 20}; /* % */
  opc_error error;
  double worst = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(shapes); k++)
    for (size_t l = 0; l < G_N_ELEMENTS(limits); l++) {
      const shape *s = &shapes[k];
      const int drawn[5] = {0};
      int both[2 * MOST], step[5];
      placed *p = place_all(s->count);
      eda_timing *t = made_up();
      double limit = longest_path(s, drawn) * (1 + limits[l] / 100);
      g_autofree char *more =
          g_strdup_printf(", delay_limit: %g %%", limits[l]);
      assert_good(slack_run(t, p, s->ports, s->instances, more, NULL, &error),
                  &error);
      find_steps(p, both);
      for (size_t i = 0; i < s->count; i++) {
        step[i] = both[2 * i];
        g_assert_cmpint(both[2 * i + 1], ==, STEPS); /* no effect on delays */
      }
      double found = leak_of(s, step);
      close_to(opc_test_metric("leakage"), found, 1e-4);
      close_to(opc_test_metric("drawn"), longest_path(s, drawn), 1e-6);
      close_to(opc_test_metric("latest"), longest_path(s, step), 1e-6);
      g_assert_cmpfloat(longest_path(s, step), <=, limit + 1e-9);
      for (size_t i = 0; i < s->count; i++) {
        close_to(opc_test_number("slack", "slack_drawn", i),
                 limit - path_through(s, (int)i, drawn), 6e-4);
        close_to(opc_test_number("slack", "slack", i),
                 limit - path_through(s, (int)i, step), 6e-4);
      }
      worst = fmax(worst, found / least_leak(s, limit));
      for (size_t i = 0; i < s->count; i++) {
        if (step[i]++ < STEPS)
          g_assert_cmpfloat(longest_path(s, step), >, limit);
        step[i]--;
      }
      eda_timing_free(t);
      free(p);
    }
  g_test_message("the worst is %.4f of the best", worst);
  g_assert_cmpfloat(worst, <, 1.04);
}

/* ---- comparison with timing.paths ---- */

/* Random inverter circuits with random delays, slews and sensitivities.
   timing.paths with the assigned lengths as printed lengths yields a latest
   path at or before the limit, as predicted. */
static void test_paths(void) {
  static double leq[2 * MOST], weq[2 * MOST], area[2 * MOST];
  static uint32_t flags[2 * MOST];
  static const double limits[] = {0, 1, 4};
  opc_error error;
  g_autoptr(GRand) r = g_rand_new_with_seed(7);
  for (int turn = 0; turn < 6; turn++) {
    double limit = limits[turn % 3];
    eda_timing *t = made_up();
    eda_timing_cell *c = &t->cell[0];
    c->arcs = 0;
    cell_fill(t, 0);
    for (size_t a = 0; a < c->arcs; a++)
      for (size_t k = 0; k < 3 * 2 * EDA_SIZES; k++) {
        c->arc[a].delay_by[k] = 1e-12 * g_rand_double_range(r, 0, 12);
        c->arc[a].slew_by[k] = 1e-12 * g_rand_double_range(r, 0, 6);
      }
    for (size_t k = 0; k < c->inputs * 2 * EDA_CAPS * 2 * EDA_SIZES; k++)
      c->capacitance_by[k] = 1e-15 * g_rand_double_range(r, 0, 1);
    g_autoptr(GString) ports = g_string_new("n0");
    g_autoptr(GString) text = g_string_new(NULL);
    int leaf[MOST + 1];
    for (int i = 0; i <= MOST; i++) leaf[i] = i > 0;
    for (int i = 1; i <= MOST; i++) {
      int from = g_rand_int_range(r, i > 6 ? i - 6 : 0, i);
      leaf[from] = 0;
      g_string_append_printf(text, "XU%d n%d n%d VDD VSS INV\n", i, from, i);
    }
    for (int i = 1; i <= MOST; i++)
      if (leaf[i] || i % 5 == 0) g_string_append_printf(ports, " n%d", i);
    placed *p = place_all(MOST);
    g_autofree char *more = g_strdup_printf(
        ", delay_limit: %g %%, load: 3 fF, wire: 0.2 fF", limit);
    int step[2 * MOST];
    assert_good(slack_run(t, p, ports->str, text->str, more, NULL, &error),
                &error);
    double by =
        100 * (opc_test_metric("latest") / opc_test_metric("drawn") - 1);
    find_steps(p, step);
    for (size_t i = 0; i < 2 * MOST; i++) {
      leq[i] = 60 + length_at(step[i]);
      weq[i] = p->width[i];
      area[i] = leq[i] * weq[i];
    }
    eda_mask mask = {
        .gates = &p->gates,
        .flags = flags,
        .after = {.count = 2 * MOST, .leq_ion = leq, .weq = weq, .area = area}};
    assert_good(run_paths(t, ports->str, text->str,
                          ", load: 3 fF, wire: 0.2 fF, transitions: 1",
                          &p->circuit, &mask, &error),
                &error);
    double judged = opc_test_metric("static_deviation");
    close_to(judged, by, 1e-9);
    g_assert_cmpfloat(judged, <=, limit + 1e-9);
    g_assert_cmpfloat(judged, >, limit - 0.1);
    eda_timing_free(t);
    free(p);
  }
}

/* ---- a NAND of four transistors ---- */

static eda_timing *with_nand(void) {
  enum { A, B, Y, M, VDD, VSS, NETS };
  static uint32_t port[] = {A, B, Y};
  static int8_t rail[NETS] = {[VDD] = 1, [VSS] = -1};
  static eda_timing_device devices[] = {
      {"MN", EDA_NMOS, Y, A, M, VSS, 60, 200, 0, 1},
      {"MP", EDA_PMOS, Y, A, VDD, VDD, 60, 300, 1, 0.5},
      {"MN2", EDA_NMOS, M, B, VSS, VSS, 60, 200, 2, 1},
      {"MP2", EDA_PMOS, Y, B, VDD, VDD, 60, 300, 1, 0.5}};
  eda_timing *t = made_up();
  eda_timing_cell *c = &t->cell[1];
  c->nets = NETS;
  c->port = port;
  c->rail = rail;
  c->devices = 4;
  c->device = devices;
  c->arcs = 0;
  cell_fill(t, 1);
  return t;
}

/* Test a NAND with one inverter before the first input and two before the
   second. The slack of the single inverter is that of its later transition. */
static void test_spare(void) {
  opc_error error;
  eda_timing *t = with_nand();
  const eda_timing_cell *c = &t->cell[1];
  placed *p = place_all(5);
  strcpy(p->name[8], "XU2/MN2");
  strcpy(p->name[9], "XU2/MP2");
  assert_good(slack_run(t, p, "a b z",
                        "XU1 a p VDD VSS INV\nXU2 p r z VDD VSS NAND2\n"
                        "XU3 b q VDD VSS INV\nXU4 q r VDD VSS INV\n",
                        "", NULL, &error),
              &error);
  const double one = base + by_load * pin_load * 1e12;
  double last[2] = {0, 0}; /* through each input; the other input is 1 */
  for (uint32_t k = 0; k < c->arcs; k++)
    last[c->arc[k].input] = fmax(last[c->arc[k].input],
                                 one * (1 + c->arc[k].input) +
                                     1e12 * delay_of(1, &c->arc[k], 10e-12, 0));
  close_to(opc_test_metric("drawn"), last[1], 1e-6);
  close_to(opc_test_number("slack", "slack_drawn", 0), last[1] - last[0], 6e-4);
  close_to(opc_test_number("slack", "slack_drawn", 3), 0, 6e-4);
  eda_timing_free(t);
  free(p);
}

/* Test that the limit is met if lengths change only slews. The search then
   finds no gain on the latest path and lowers all choices. */
static void test_slews(void) {
  opc_error error;
  eda_timing *t = made_up();
  eda_timing_cell *c = &t->cell[0];
  c->arcs = 0;
  cell_fill(t, 0);
  for (size_t k = 0; k < 2 * 3 * 2 * EDA_SIZES; k++) {
    eda_timing_arc *a = &c->arc[k / (3 * 2 * EDA_SIZES)];
    a->delay_by[k % (3 * 2 * EDA_SIZES)] = 0;
    a->slew_by[k % (3 * 2 * EDA_SIZES)] = 20e-12;
  }
  for (size_t k = 0; k < c->inputs * 2 * EDA_CAPS * 2 * EDA_SIZES; k++)
    c->capacitance_by[k] = 0;
  placed *p = place_all(3);
  assert_good(
      slack_run(
          t, p, "a z",
          "XU1 a m VDD VSS INV\nXU2 m n VDD VSS INV\nXU3 n z VDD VSS INV\n",
          ", delay_limit: 0.5 %", NULL, &error),
      &error);
  double by = opc_test_metric("latest") / opc_test_metric("drawn") - 1;
  g_assert_cmpfloat(by, <=, 0.005);
  g_assert_cmpfloat(by, >, 0.002); /* a step is 0.0026 */
  eda_timing_free(t);
  free(p);
}

/* ---- static leakage ---- */

/* Test the leakage shares. z is the NAND of a and the inverted a, always 1. The
   two n-transistors in series leak alternately. The lower transistor leaks
   less, because the upper transistor passes a degraded high level. In a NAND of
   two independent inputs, each n-transistor leaks alone in a quarter of the
   patterns; both in series are neglected. Both p-transistors leak in a quarter
   of the patterns. The two transistors of the inverter leak alternately. */
static void test_rest(void) {
  static const double n = 200 * 1e-10, p = 300 * 0.5e-10;
  opc_error error;
  for (int two = 0; two < 2; two++) {
    eda_timing *t = with_nand();
    placed *all = place_all(3);
    strcpy(all->name[4], "XU2/MN2");
    strcpy(all->name[5], "XU2/MP2");
    all->goal[3] = (eda_goal){2, {1, 1, 1}, 1}; /* one of two parallel
                                                   transistors */
    assert_good(
        slack_run(t, all, two ? "a n m z" : "a z",
                  two ? "XU1 a m VDD VSS INV\nXU2 a n z VDD VSS NAND2\n"
                      : "XU1 a n VDD VSS INV\nXU2 a n z VDD VSS NAND2\n",
                  "", NULL, &error),
        &error);
    double nand = two ? (1.4 * n + 2 * p) / 4 : 1.4 * n / 2;
    for (size_t r = 0; r < opc_test_rows("wishes"); r++)
      g_assert_cmpstr(opc_test_text("wishes", "transistor", r), !=, "XU3:2");
    close_to(opc_test_metric("leakage_drawn"), 1e9 * (nand + (n + p) / 2),
             1e-6);
    eda_timing_free(t);
    free(all);
  }
}

/* ---- goals of the designer, errors ---- */

static const char chain[] =
    "XU1 a m VDD VSS INV\nXU2 m n VDD VSS INV\nXU3 n z VDD VSS INV\n";

static void check_goal(const eda_goal *w, eda_goal want) {
  g_assert_cmpint(w->given, ==, want.given);
  g_assert_cmpfloat(w->weight, ==, want.weight);
  for (int k = 0; k < EDA_GOAL_TARGETS; k++) /* six decimals */
    g_assert_cmpfloat_with_epsilon(w->target[k], want.target[k], 0.5001e-6);
}

/* A goal of the designer is kept, and its transistor has the drawn length. */
static void test_designer(void) {
  opc_error error;
  placed *p = place_all(3);
  eda_timing *t = made_up();
  const eda_goal designer = {3, {1, 1, 1}, 1},
                 longer = {
                     0.5,
                     {most_ion, exp(-drop[1] * longest()), 1 + longest() / 60},
                     1};
  p->goal[2] = designer;
  eda_goal goal[6];
  assert_good(slack_run(t, p, "a z", chain, ", delay_limit: 50 %, weight: 0.5",
                        goal, &error),
              &error);
  for (int i = 0; i < 6; i++) check_goal(&goal[i], i == 2 ? designer : longer);
  close_to(opc_test_metric("longer"), 5, 0);
  close_to(opc_test_metric("longer_most"), longest(), 1e-6);
  /* No choice has a gain: all lengths as drawn. */
  assert_good(slack_run(t, p, "a z", chain, ", ion: 0 %", NULL, &error),
              &error);
  close_to(opc_test_metric("longer"), 0, 0);
  close_to(opc_test_metric("leakage_change"), 0, 1e-12);
  eda_timing_free(t);
  free(p);
}

static void test_refused(void) {
  opc_error error;
  placed *p = place_all(3);
  eda_timing *t = made_up();
  double drawn;
  assert_good(slack_run(t, p, "a z", chain, "", NULL, &error), &error);
  drawn = opc_test_metric("drawn");
  g_autofree char *clock = g_strdup_printf(", clock: %.6f ps", drawn - 0.01),
                  *late = g_strdup_printf(", clock: %.6f ps", drawn + 1);
  g_assert_cmpint(slack_run(t, p, "a z", chain, clock, NULL, &error), ==,
                  OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "clock");
  g_assert_nonnull(strstr(error.message, "as drawn"));
  g_assert_cmpint(
      slack_run(t, p, "a z", chain, ", delay_limit: -0.1 %", NULL, &error), ==,
      OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "delay_limit");
  assert_good(slack_run(t, p, "a z", chain, late, NULL, &error), &error);
  close_to(opc_test_metric("allowed"), drawn + 1, 1e-6);
  g_strlcpy(p->name[5], "XU9/MP", sizeof p->name[5]);
  g_assert_cmpint(slack_run(t, p, "a z", chain, "", NULL, &error), ==,
                  OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "'XU9/MP' is in no characterised"));
  eda_timing_free(t);
  free(p);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/slack/all-combinations", test_all_combinations);
  g_test_add_func("/slack/paths", test_paths);
  g_test_add_func("/slack/spare", test_spare);
  g_test_add_func("/slack/slews", test_slews);
  g_test_add_func("/slack/rest", test_rest);
  g_test_add_func("/slack/designer", test_designer);
  g_test_add_func("/slack/refused", test_refused);
  return g_test_run();
}
