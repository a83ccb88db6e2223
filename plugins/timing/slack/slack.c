/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements timing.slack: on paths with slack, sets the targets of transistors
   to longer gates, which leak less. The latest arrival stays within its limit.
   Source: Gupta et al., "Selective gate-length biasing for cost-effective
   runtime leakage control", DAC 2004. */
#include <eda/circuit.h>
#include <eda/curves.h>
#include <glib.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include "../parameters.h"
#include "budget.h"

/* ---- state ---- */

typedef struct slack {
  const opc_host *host;
  const eda_timing *timing;
  const eda_circuit *circuit;
  const char *file, *top, *devices;
  conditions at;
  double ion, limit, clock, weight; /* ion and limit, %; clock, s; weight,
                                       relative */
  eda_curves curves;
} slack;

static const size_t NO_CHOICE = SIZE_MAX;
static const double NEVER = -1; /* largest ln(length / drawn length) of a gate
                                   whose length is fixed by a goal */

/* State of a run. */
typedef struct slack_task {
  const slack *s;
  eda_pool pool;
  graph graph;
  budget budget;
  size_t *of;             /* choice of each gate, or NO_CHOICE */
  double *drawn;          /* slack of each net at drawn sizes, ps */
  double worst, at_first; /* at drawn sizes: latest arrival, ps; leakage, A */
} slack_task;

/* ---- work: effect of a length ---- */

/* Return the current of a gate whose length is multiplied by exp(by), A.
   `which` is EDA_ION or EDA_IOFF. */
static double gate_current(const slack *s, size_t gate, int which, double by) {
  const eda_gates *g = s->circuit->gates;
  eda_curves_width w = eda_curves_among(&s->curves, g->width[gate]);
  return g->width[gate] *
         exp(eda_curves_narrow_at(&s->curves, g->type[gate], which,
                                  g->length[gate] * exp(by), &w));
}

/* Return ln(largest allowed length / drawn length) of a gate: the length with
   the Ion that the parameter `ion` allows, at most the longest of the table. */
static double gate_longest(const slack *s, size_t gate) {
  const eda_gates *g = s->circuit->gates;
  eda_curves_width w = eda_curves_among(&s->curves, g->width[gate]);
  double wanted = log(gate_current(s, gate, EDA_ION, 0) / g->width[gate] *
                      (1 - s->ion / 100));
  double l = eda_curves_narrow_length(&s->curves, g->type[gate], EDA_ION,
                                      wanted, &w, g->length[gate]);
  l = fmin(l, eda_curves_longest(&s->curves));
  return fmax(0, log(l / g->length[gate]));
}

/* ---- work: choices ---- */

static void number_choices(slack_task *j) {
  const graph *g = &j->graph;
  budget *b = &j->budget;
  size_t most = 0;
  b->g = g;
  b->first = eda_pool_alloc(&j->pool, g->instances, sizeof *b->first);
  for (size_t i = 0; i < g->nodes; i++) most += g->node[i].cell->bundles;
  b->choice = eda_pool_alloc(&j->pool, most, sizeof *b->choice);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    if (n->output) continue; /* only the first node of each instance */
    b->first[n->instance] = b->count;
    for (uint32_t k = 0; k < n->cell->bundles; k++)
      b->choice[b->count++] = (choice){.instance = n->instance, .bundle = k};
  }
  j->of = eda_pool_alloc(&j->pool, j->s->circuit->gates->count, sizeof *j->of);
}

/* Set lengths and leakage of all choices (budget.h). The largest length is the
   smallest limit of the gates of a choice. Levels are equidistant in ln L. */
static int fill_choices(slack_task *j, opc_error *error) {
  const slack *s = j->s;
  const eda_circuit *c = s->circuit;
  budget *b = &j->budget;
  place *places = graph_places(&j->graph, c, error);
  if (!places) return error->code;
  for (size_t i = 0; i < c->gates->count; i++) j->of[i] = NO_CHOICE;
  for (size_t i = 0; i < c->count; i++) {
    size_t k = b->first[places[i].instance] + places[i].device->bundle;
    for (uint32_t f = 0; f < c->device[i].fingers; f++)
      j->of[c->device[i].finger[f]] = k;
  }
  free(places);
  for (size_t i = 0; i < c->gates->count; i++) {
    if (j->of[i] == NO_CHOICE) continue;
    double *most = &b->choice[j->of[i]].length[LEVELS];
    double here =
        eda_gates_goal(c->gates, i).given ? NEVER : gate_longest(s, i);
    *most = *most == 0 ? here : fmin(*most, here);
  }
  for (size_t i = 0; i < b->count; i++) {
    choice *k = &b->choice[i];
    k->most = k->length[LEVELS] > 0 ? LEVELS : 0;
    for (int level = 0; level <= LEVELS; level++)
      k->length[level] = k->most ? k->length[LEVELS] * level / LEVELS : 0;
  }
  double *share = static_leakage_shares(b);
  for (size_t i = 0; i < c->gates->count; i++)
    for (int level = 0; level <= LEVELS && j->of[i] != NO_CHOICE; level++) {
      choice *k = &b->choice[j->of[i]];
      k->leak[level] +=
          share[j->of[i]] * gate_current(s, i, EDA_IOFF, k->length[level]);
    }
  free(share);
  return OPC_OK;
}

/* ---- work: gates with new targets ---- */

static void free_gates(void *object) {
  eda_gates *g = object;
  if (g) free(g->goal);
  free(g);
}

static void free_circuit(void *object) { free(object); }

/* Return the length increase of a gate, ln(length / drawn length). */
static double gate_increase(const slack_task *j, size_t gate) {
  if (j->of[gate] == NO_CHOICE) return 0;
  const choice *c = &j->budget.choice[j->of[gate]];
  return c->length[c->level];
}

/* Round a factor to the digits of wishes.csv, so that the mask does not depend
   on whether a synthesizer reads the gates or the file. */
static double factor_round(double factor) { return round(factor * 1e6) / 1e6; }

static eda_goal goal_of(const slack_task *j, size_t gate) {
  const slack *s = j->s;
  double by = gate_increase(j, gate);
  return (eda_goal){
      .weight = s->weight,
      .target = {[EDA_GOAL_ION] =
                     factor_round(gate_current(s, gate, EDA_ION, by) /
                                  gate_current(s, gate, EDA_ION, 0)),
                 [EDA_GOAL_IOFF] =
                     factor_round(gate_current(s, gate, EDA_IOFF, by) /
                                  gate_current(s, gate, EDA_IOFF, 0)),
                 [EDA_GOAL_AREA] = factor_round(exp(by))},
      .given = 1};
}

/* Return a copy of the gates with the new goals (caller frees). All other
   arrays belong to the gates of the circuit. */
static eda_gates *with_wishes(const slack_task *j) {
  const eda_gates *from = j->s->circuit->gates;
  eda_gates *g = eda_alloc(1, sizeof *g);
  *g = *from;
  g->serial = 0;
  g->goal = eda_alloc(g->count, sizeof *g->goal);
  for (size_t i = 0; i < g->count; i++)
    g->goal[i] =
        gate_increase(j, i) > 0 ? goal_of(j, i) : eda_gates_goal(from, i);
  return g;
}

/* ---- work: reports ---- */

typedef struct wished {
  char *name;
  double weight, ion, ioff, area;
} wished;

static int requests_report(const slack_task *j, opc_error *error) {
  const eda_gates *g = j->s->circuit->gates;
  wished *row = eda_alloc(g->count, sizeof *row);
  size_t n = 0;
  for (size_t i = 0; i < g->count; i++) {
    if (!(gate_increase(j, i) > 0)) continue;
    eda_goal w = goal_of(j, i);
    row[n++] = (wished){
        .name = g_strdup_printf("%s:%u", eda_gates_owner(g, i), g->number[i]),
        .weight = w.weight,
        .ion = w.target[EDA_GOAL_ION],
        .ioff = w.target[EDA_GOAL_IOFF],
        .area = w.target[EDA_GOAL_AREA]};
  }
  const opc_column columns[] = {{"transistor", NULL, OPC_TEXT, 0, &row->name},
                                {"weight", NULL, OPC_REAL, 4, &row->weight},
                                {"ion", NULL, OPC_REAL, 6, &row->ion},
                                {"ioff", NULL, OPC_REAL, 6, &row->ioff},
                                {"area", NULL, OPC_REAL, 6, &row->area}};
  int code = opc_put_rows(j->s->host, "wishes", 0, n, sizeof *row,
                          OPC_ARRAY(columns), error);
  for (size_t i = 0; i < n; i++) g_free(row[i].name);
  free(row);
  return code;
}

/* Row of slack.csv: smallest slack (ps) of the nets that the instance drives,
   and leakage of the instance (nA), as drawn and with the longer gates. */
typedef struct row {
  const char *instance, *cell;
  double before, after, drawn, leak;
} row;

static int instances_report(const slack_task *j, const double *after,
                            opc_error *error) {
  const graph *g = &j->graph;
  const budget *b = &j->budget;
  row *rows = eda_alloc(g->instances, sizeof *rows);
  for (size_t i = 0; i < g->instances; i++)
    rows[i].before = rows[i].after = INFINITY;
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    row *r = &rows[n->instance];
    r->instance = g->instance[n->instance];
    r->cell = n->cell->name;
    for (size_t k = 2 * n->net; k < 2 * n->net + 2; k++) {
      r->before = fmin(r->before, j->drawn[k]);
      r->after = fmin(r->after, after[k]);
    }
  }
  for (size_t i = 0; i < b->count; i++) {
    const choice *c = &b->choice[i];
    rows[c->instance].drawn += 1e9 * c->leak[0];
    rows[c->instance].leak += 1e9 * c->leak[c->level];
  }
  const opc_column columns[] = {
      {"instance", NULL, OPC_TEXT, 0, &rows->instance},
      {"cell", NULL, OPC_TEXT, 0, &rows->cell},
      {"slack_drawn", "ps", OPC_REAL, 3, &rows->before},
      {"slack", "ps", OPC_REAL, 3, &rows->after},
      {"leakage_drawn", "nA", OPC_REAL, 4, &rows->drawn},
      {"leakage", "nA", OPC_REAL, 4, &rows->leak}};
  int code = opc_put_rows(j->s->host, "slack", 0, g->instances, sizeof *rows,
                          OPC_ARRAY(columns), error);
  free(rows);
  return code;
}

static int slack_report(const slack_task *j, opc_error *error) {
  const budget *b = &j->budget;
  const eda_gates *g = j->s->circuit->gates;
  double slower = 0, most = 0, leak = budget_leak(b), worst = budget_worst(b);
  for (size_t i = 0; i < g->count; i++) {
    double by = gate_increase(j, i);
    slower += by > 0;
    most = fmax(most, g->length[i] * (exp(by) - 1));
  }
  const opc_metric_value values[] = {
      {"drawn", j->worst},
      {"allowed", b->limit},
      {"latest", worst},
      {"longer", slower},
      {"longer_most", most},
      {"leakage_drawn", 1e9 * j->at_first},
      {"leakage", 1e9 * leak},
      {"leakage_change", 100 * (leak / j->at_first - 1)}};
  return opc_put_metrics(j->s->host, OPC_ARRAY(values), error);
}

/* ---- work: all ---- */

static int slack_spend(slack_task *j, opc_error *error) {
  const slack *s = j->s;
  budget *b = &j->budget;
  b->at = s->at;
  budget_init(b);
  log_extrapolated(j->s->host, b->g, &b->sizes, b->at.slew);
  j->worst = budget_worst(b);
  b->limit = s->clock > 0 ? s->clock * 1e12 : j->worst * (1 + s->limit / 100);
  j->at_first = budget_leak(b);
  j->drawn = budget_slack(b);
  if (!budget_spend(b))
    return opc_fail(error, OPC_INVALID, s->clock > 0 ? "clock" : "delay_limit",
                    "the latest path of '%.100s' takes %.3f ps as drawn, "
                    "expected at most %.3f ps",
                    j->graph.name, j->worst, b->limit);
  double *after = budget_slack(b);
  int code = slack_report(j, error);
  if (!code) code = requests_report(j, error);
  if (!code) code = instances_report(j, after, error);
  free(after);
  return code;
}

static int slack_run(void *self, void **outputs, opc_error *error) {
  slack *s = self;
  slack_task j = {.s = s};
  int code = eda_curves_read(&s->curves, s->devices, error);
  const char *top = s->top ? s->top : s->circuit->name;
  if (!code)
    code = graph_read(&j.graph, &j.pool, s->timing, s->file, top, error);
  if (!code) {
    number_choices(&j);
    code = fill_choices(&j, error);
  }
  if (!code) {
    code = slack_spend(&j, error);
    budget_clear(&j.budget);
    free(j.drawn);
  }
  if (!code) {
    eda_gates *gates = with_wishes(&j);
    eda_circuit *circuit = eda_alloc(1, sizeof *circuit);
    *circuit = *s->circuit;
    circuit->gates = gates;
    outputs[0] = gates;
    outputs[1] = circuit;
  }
  eda_pool_clear(&j.pool);
  return code;
}

static void slack_clear(void *self) {
  eda_curves_clear(&((slack *)self)->curves);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(slack, timing, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "timing",
                  .summary = "timing tables of the circuit's cells"),
    OPC_PARAMETER(slack, circuit, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "circuit",
                  .summary = "matched gates of the transistors"),
    OPC_PARAMETER(slack, file, .type = OPC_FILE, .flags = OPC_REQUIRED,
                  .summary = "SPICE or CDL netlist of cell instances"),
    OPC_PARAMETER(
        slack, top, .type = OPC_TEXT,
        .summary = "subcircuit to analyse (default: the name of `circuit`)"),
    OPC_PARAMETER(slack, devices, .type = OPC_FILE, .flags = OPC_REQUIRED,
                  .summary = "device table with Ion and Ioff over L"),
    OPC_PARAMETER(slack, ion, .type = OPC_REAL, .unit = "%",
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "10 %",
                  .min = 0, .max = 50,
                  .summary = "largest reduction of Ion allowed in exchange for "
                             "leakage"),
    OPC_PARAMETER_NAMED(
        "delay_limit", slack, limit, .type = OPC_REAL, .unit = "%",
        .former = "limit", .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0 %",
        .min = -50, .max = 1000,
        .summary = "Largest allowed increase of the latest path's delay over "
                   "that of the drawn circuit"),
    OPC_PARAMETER(
        slack, clock, .type = OPC_REAL, .unit = "s",
        .flags = OPC_ABOVE | OPC_AT_MOST, .min = 0, .max = 1,
        .summary = "allowed latest arrival, in place of 'delay_limit'"),
    OPC_PARAMETER(slack, weight, .type = OPC_REAL,
                  .flags = OPC_ABOVE | OPC_AT_MOST, .preset = "1", .min = 0,
                  .max = 1,
                  .summary = "weight of lengthened transistors, which divides "
                             "their tolerance in the correction"),
    TIMING_CONDITIONS(slack),
};

static const opc_metric metrics[] = {
    FIGURE("drawn", "ps", "latest arrival of static analysis as drawn"),
    FIGURE("allowed", "ps", "allowed latest arrival"),
    FIGURE("latest", "ps", "latest arrival with the longer gates"),
    FIGURE("longer", NULL, "number of transistors to lengthen"),
    FIGURE("longer_most", "nm", "largest increase of a length"),
    FIGURE("leakage_drawn", "nA", "leakage as drawn, mean over input patterns"),
    COST("leakage", "nA",
         "leakage with the longer gates, mean over input patterns"),
    COST("leakage_change", "%", "change of the leakage by the longer gates"),
};

/* ---- entry ---- */

/* Both outputs refer to the input circuit. */
static const opc_port outputs[] = {{.name = "gates",
                                    .kind = "gates",
                                    .check = eda_gates_check,
                                    .release = free_gates},
                                   {.name = "circuit",
                                    .kind = "circuit",
                                    .check = eda_circuit_check,
                                    .release = free_circuit}};

/* Results of the step are not stored, because the netlist may include other
   files. */
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = slack_run,
                                   .flags = OPC_STEP_OUTSIDE};
OPC_PLUGIN(
    slack, .id = "timing.slack", .kind = "step", .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary =
        "longer gates for transistors with timing slack, for less leakage",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), .clear = slack_clear, OPC_FUNCTIONS(functions));
