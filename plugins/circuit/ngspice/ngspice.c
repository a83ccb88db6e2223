/* SPDX-License-Identifier: BSD-3-Clause */
/* circuit.ngspice: what a circuit does with transistors as drawn and as
   printed: delays and slopes (thesis 2.3.2, 3.3.2), leakage, static noise
   margins of memory cells (thesis 2.3.4). */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../draw/mask/paper.h"
#include "bench.h"

/* ---- state ---- */

enum {
  CIRCUIT,
  MASK,
  CARDS,
  PMOS_CARDS,
  NMOS,
  PMOS,
  DLC,
  SIZES,
  DEVICES,
  SUPPLY,
  TEMPERATURE,
  LOAD,
  SLEW,
  EDGES,
  MEASURE,
  INPUTS,
  TRANSITIONS,
  MOST,
  SEED,
  CELL,
  ACCESS,
  PICTURE,
  LIMIT,
  PARAMETERS
};

/* As the choices of 'sizes', 'measure' and 'access'. */
enum { BOTH, LENGTH };
enum { AUTO, DELAYS, LEAKAGE, SNM };
enum { HOLD, READ };

typedef struct circuit_step {
  const opc_host *host;
  const opc_value *values;
  char *path[2];
  int format; /* PAPER_PNG and so on */
} circuit_step;

/* ---- work: what there is ---- */

/* The cards' whole paths: the simulator stands elsewhere. */
static int find_cards(circuit_step *s, bench *b, opc_error *error) {
  const opc_host *host = s->host;
  for (int i = 0; i < 2; i++) {
    const opc_value *v = &s->values[CARDS + i];
    const char *name = i ? "pmos_models" : "models";
    free(s->path[i]);
    s->path[i] = NULL;
    if (v->type == OPC_ABSENT) continue;
    s->path[i] = realpath(v->text, NULL);
    if (!s->path[i])
      return host->fail(host, error, OPC_IO, name, "cannot read '%s': %s",
                        v->text, strerror(errno));
    if (strpbrk(s->path[i], "\"\n"))
      return host->fail(host, error, OPC_INVALID, name,
                        "'%s': the simulator takes no such name of a file",
                        v->text);
    b->cards[i] = s->path[i];
  }
  for (int type = 0; type < 2 && b->dlc; type++)
    if (netlist_model_read(host, &b->pool,
                           s->path[type == OPC_PMOS && s->path[1]],
                           b->model[type], type, &b->card[type], error))
      return error->code;
  return OPC_OK;
}

/* Names that a simulator can take, in place of the netlist's. */
static int make_plain(bench *b, opc_error *error) {
  const opc_circuit *c = b->circuit;
  b->plain = *c;
  b->plain.net = bench_alloc(b, c->nets, sizeof *b->plain.net, error);
  if (!b->plain.net) return error->code;
  for (size_t i = 0; i < c->nets; i++) {
    char name[24];
    int n = snprintf(name, sizeof name, "n%zu", i);
    b->plain.net[i] = pool_text(&b->pool, name, (size_t)n);
    if (!b->plain.net[i]) return no_memory(b->host, error);
  }
  return OPC_OK;
}

/* Which sizes there are: a mask that prints badly as drawn is no fault, the
   corrected one is. */
static int find_states(const circuit_step *s, bench *b, opc_error *error) {
  static const int kinds[] = {SIZE_TIMED, SIZE_OFF};
  if (b->mask && b->mask->gates != b->circuit->gates)
    return b->host->fail(b->host, error, OPC_INVALID, "mask",
                         "the mask is of other gates than the circuit");
  if (s->values[SIZES].integer == LENGTH &&
      sizes_by_length(b, s->values[DEVICES].text, error))
    return error->code;
  for (int state = 0; state < STATES; state++) {
    b->has[state] = state == NETLIST_DRAWN || b->mask;
    for (int k = 0; k < 2 && b->has[state]; k++) {
      char *text = bench_netlist(b, &b->plain, state, kinds[k], error);
      int code = text ? OPC_OK : error->code;
      b->host->free(b->host, text);
      if (bench_forgive(b, state, code, error)) return code;
    }
  }
  return OPC_OK;
}

static int make_bench(circuit_step *s, bench *b, opc_error *error) {
  const opc_value *v = s->values;
  *b = (bench){
      .host = s->host,
      .circuit = v[CIRCUIT].object,
      .mask = v[MASK].type == OPC_ABSENT ? NULL : v[MASK].object,
      .model = {[OPC_NMOS] = v[NMOS].text, [OPC_PMOS] = v[PMOS].text},
      .dlc = (int)v[DLC].integer,
      .supply = v[SUPPLY].real,
      .temperature = v[TEMPERATURE].real,
      .load = v[LOAD].real,
      .slew = v[SLEW].real,
      .low = v[EDGES].reals[0] / 100,
      .high = v[EDGES].reals[1] / 100,
      .limit = v[LIMIT].real,
  };
  const char *inputs = v[INPUTS].type == OPC_ABSENT ? NULL : v[INPUTS].text;
  if (find_cards(s, b, error) || make_plain(b, error) ||
      bench_ports(b, inputs, error))
    return error->code;
  return find_states(s, b, error);
}

static const char *picture_path(const circuit_step *s, opc_error *error) {
  return s->host->output_path(s->host, s->values[PICTURE].text, error);
}

/* ---- work: logic ---- */

static int run_logic(circuit_step *s, bench *b, int measure, opc_error *error) {
  const opc_value *v = s->values;
  patterns p;
  logic l;
  delays d;
  int64_t loop;
  if (feedback_find(b, &loop, error)) return error->code;
  if (loop >= 0)
    return s->host->fail(s->host, error, OPC_INVALID, "circuit",
                         "'%s' keeps a state: its net '%s' is on a loop; "
                         "delays and leakage are of circuits without",
                         b->circuit->name, b->circuit->net[loop]);
  if (patterns_make(b, v[TRANSITIONS].integer != 0, (size_t)v[MOST].integer,
                    (uint64_t)v[SEED].integer, &p, error))
    return error->code;
  if (p.sampled)
    s->host->log(s->host, OPC_LOG_INFO,
                 "%zu transitions of the inputs, drawn at random: there are "
                 "more",
                 p.transitions);
  if (logic_find(b, &p, &l, error)) return error->code;
  if (measure != DELAYS && tell_leakage(b, &p, &l, error)) return error->code;
  if (measure == LEAKAGE) return OPC_OK;
  if (delays_find(b, &p, &l, &d, error) || tell_delays(b, &p, &d, error))
    return error->code;
  const char *path = picture_path(s, error);
  return path ? draw_delays(b, &p, &d, s->format, path, error) : error->code;
}

/* ---- work: memory ---- */

/* Keep the cell with a storage node of that name. */
static int pick_cell(const circuit_step *s, const bench *b, cell *cells,
                     size_t *count, opc_error *error) {
  const opc_value *v = &s->values[CELL];
  if (v->type == OPC_ABSENT) return OPC_OK;
  for (size_t i = 0; i < *count; i++)
    if (same_name(b->circuit->net[cells[i].q], v->text) ||
        same_name(b->circuit->net[cells[i].qb], v->text)) {
      cells[0] = cells[i];
      *count = 1;
      return OPC_OK;
    }
  return s->host->fail(s->host, error, OPC_INVALID, "cell",
                       "'%s' is no storage node of '%s'", v->text,
                       b->circuit->name);
}

static int run_margins(circuit_step *s, bench *b, cell *cells, size_t count,
                       opc_error *error) {
  margins m;
  if (!count)
    return s->host->fail(s->host, error, OPC_INVALID, "circuit",
                         "'%s' has no inverters that drive each other",
                         b->circuit->name);
  if (pick_cell(s, b, cells, &count, error) ||
      margins_find(b, cells, count, s->values[ACCESS].integer == READ, &m,
                   error) ||
      tell_margins(b, cells, count, &m, error))
    return error->code;
  const char *path = picture_path(s, error);
  return path ? draw_margins(b, cells, count, &m, s->format, path, error)
              : error->code;
}

/* ---- work ---- */

/* A memory is what has cells whose bit lines are ports. */
static int is_memory(const cell *cells, size_t count) {
  size_t n = 0;
  for (size_t i = 0; i < count; i++)
    n += cells[i].accesses > 0 && cells[i].on_ports;
  return count && n == count;
}

static int run_bench(circuit_step *s, bench *b, opc_error *error) {
  cell *cells;
  size_t count;
  int64_t measure = s->values[MEASURE].integer;
  if (make_bench(s, b, error) || cells_find(b, &cells, &count, error))
    return error->code;
  if (measure == SNM || (measure == AUTO && is_memory(cells, count)))
    return run_margins(s, b, cells, count, error);
  return run_logic(s, b, (int)measure, error);
}

static int run(void *self, void **outputs, opc_error *error) {
  bench b = {0};
  (void)outputs;
  int code = run_bench(self, &b, error);
  pool_clear(&b.pool);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [CIRCUIT] = {.name = "circuit",
                 .type = OPC_INPUT,
                 .flags = OPC_REQUIRED,
                 .choices = "circuit",
                 .summary = "the netlist and its gates"},
    [MASK] = {.name = "mask",
              .type = OPC_INPUT,
              .choices = "mask",
              .summary = "the corrected mask, with what it prints"},
    [CARDS] = {.name = "models",
               .type = OPC_FILE,
               .flags = OPC_REQUIRED,
               .summary = "file with the model cards"},
    [PMOS_CARDS] = {.name = "pmos_models",
                    .type = OPC_FILE,
                    .summary = "that of the p-transistor, if it is another"},
    [NMOS] = {.name = "nmos",
              .type = OPC_TEXT,
              .preset = "nmos",
              .summary = "name of the n-transistor's model"},
    [PMOS] = {.name = "pmos",
              .type = OPC_TEXT,
              .preset = "pmos",
              .summary = "name of the p-transistor's model"},
    [DLC] = {.name = "dlc",
             .type = OPC_BOOL,
             .preset = "true",
             .summary = "gate capacitances are those of the printed area"},
    [SIZES] = {.name = "sizes",
               .type = OPC_CHOICE,
               .choices = "both|length",
               .preset = "both",
               .summary = "L and W as they print; or W as drawn and L alone, "
                          "so that Ion is the printed one (thesis 2.3.3)"},
    [DEVICES] = {.name = "devices",
                 .type = OPC_FILE,
                 .summary = "the table of devices that the mask was made with, "
                            "for 'sizes: length'"},
    [SUPPLY] = {.name = "supply",
                .type = OPC_REAL,
                .unit = "V",
                .flags = OPC_REQUIRED | OPC_ABOVE | OPC_AT_MOST,
                .min = 0,
                .max = 20,
                .summary = "supply voltage"},
    [TEMPERATURE] = {.name = "temperature",
                     .type = OPC_REAL,
                     .unit = "C",
                     .flags = OPC_AT_LEAST | OPC_AT_MOST,
                     .preset = "27 C",
                     .min = -200,
                     .max = 300,
                     .summary = "temperature of the transistors"},
    [LOAD] = {.name = "load",
              .type = OPC_REAL,
              .unit = "F",
              .flags = OPC_AT_LEAST | OPC_AT_MOST,
              .preset = "4 fF",
              .min = 0,
              .max = 1e-6,
              .summary = "capacitance at each output"},
    [SLEW] = {.name = "slew",
              .type = OPC_REAL,
              .unit = "s",
              .flags = OPC_AT_LEAST | OPC_AT_MOST,
              .preset = "20 ps",
              .min = 1e-14,
              .max = 1e-3,
              .summary = "time of an input from 0 to 100 %"},
    [EDGES] = {.name = "edges",
               .type = OPC_REALS,
               .unit = "%",
               .preset = "[10 %, 90 %]",
               .summary = "where rise and fall times begin and end"},
    [MEASURE] = {.name = "measure",
                 .type = OPC_CHOICE,
                 .choices = "auto|delays|leakage|snm",
                 .preset = "auto",
                 .summary = "auto: noise margins of memories, else delays and "
                            "leakage"},
    [INPUTS] = {.name = "inputs",
                .type = OPC_TEXT,
                .summary = "names of the input ports, with blanks between "
                           "(default: those that are on gates alone)"},
    [TRANSITIONS] = {.name = "transitions",
                     .type = OPC_CHOICE,
                     .choices = "single|several",
                     .preset = "single",
                     .summary = "of one input at a time, or of several at "
                                "once, too"},
    [MOST] = {.name = "most",
              .type = OPC_INT,
              .flags = OPC_AT_LEAST | OPC_AT_MOST,
              .preset = "1024",
              .min = 1,
              .max = 100000,
              .summary = "transitions to be tried; of more, so many are drawn "
                         "at random"},
    [SEED] = {.name = "seed",
              .type = OPC_INT,
              .flags = OPC_AT_LEAST,
              .preset = "1",
              .min = 0,
              .summary = "of what is drawn at random"},
    [CELL] = {.name = "cell",
              .type = OPC_TEXT,
              .summary = "a storage node of the memory cell (default: all "
                         "cells)"},
    [ACCESS] = {.name = "access",
                .type = OPC_CHOICE,
                .choices = "hold|read",
                .preset = "hold",
                .summary = "access transistors of memory cells are off, or "
                           "conduct; bit lines are at the supply"},
    [PICTURE] = {.name = "picture",
                 .type = OPC_OUTPUT,
                 .preset = "circuit.png",
                 .summary = "waveforms or butterfly, .png, .svg or .pdf"},
    [LIMIT] = {.name = "limit",
               .type = OPC_REAL,
               .unit = "s",
               .flags = OPC_ABOVE | OPC_AT_MOST | OPC_NO_EFFECT,
               .preset = "300 s",
               .min = 0,
               .max = 86400,
               .summary = "time that one process of the simulator may take"},
};

#define FIGURE(id, of, text) \
  { .name = (id), .unit = (of), .better = OPC_NEUTRAL, .summary = (text) }
#define CHANGE(id, text)                                              \
  {.name = (id "_worst"),                                             \
   .unit = "%",                                                       \
   .better = OPC_LOWER,                                               \
   .summary = ("largest deviation of " text)},                        \
  {                                                                   \
    .name = (id "_worst_before"), .unit = "%", .better = OPC_NEUTRAL, \
    .summary = ("before correction, that of " text)                   \
  }

static const opc_metric metrics[] = {
    FIGURE("transitions", NULL, "input transitions that an output follows"),
    {.name = "unmeasured",
     .better = OPC_LOWER,
     .summary = "outputs that did not get there"},
    FIGURE("tr", "ps", "mean rise time as drawn"),
    FIGURE("tf", "ps", "mean fall time as drawn"),
    FIGURE("tplh", "ps", "mean delay of rising outputs as drawn"),
    FIGURE("tphl", "ps", "mean delay of falling outputs as drawn"),
    FIGURE("tp", "ps", "mean delay as drawn"),
    CHANGE("tr", "rise times (thesis eq. 3.9)"),
    CHANGE("tf", "fall times (thesis eq. 3.10)"),
    CHANGE("tplh", "delays of rising outputs"),
    CHANGE("tphl", "delays of falling outputs"),
    CHANGE("tp", "delays (thesis eq. 3.8)"),
    FIGURE("leakage", "A", "mean supply current at rest as drawn"),
    FIGURE("leakage_most", "A", "largest supply current at rest as drawn"),
    FIGURE("power", "W", "mean static power as drawn"),
    FIGURE("leakage_mean", "%", "mean deviation of the leakage"),
    FIGURE("leakage_mean_before", "%", "that before correction"),
    CHANGE("leakage", "the leakage"),
    FIGURE("cells", NULL, "memory cells"),
    FIGURE("snm_left", "mV", "smallest left noise margin as drawn"),
    FIGURE("snm_right", "mV", "smallest right noise margin as drawn"),
    CHANGE("snm_left", "left noise margins"),
    CHANGE("snm_right", "right noise margins"),
};

/* ---- checks ---- */

static int refuse(const opc_host *host, const char *parameter, const char *what,
                  const char *why, opc_error *error) {
  return host->fail(host, error, OPC_INVALID, parameter, "'%s' %s", what, why);
}

/* What may stand in a deck as a name. */
static int is_name(const char *text) {
  return *text && strspn(text,
                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                         "0123456789_.-") == strlen(text);
}

static int check(circuit_step *s, opc_error *error) {
  const opc_host *host = s->host;
  const opc_value *v = s->values;
  for (int i = NMOS; i <= PMOS; i++)
    if (!is_name(v[i].text))
      return refuse(host, parameters[i].name, v[i].text,
                    "is not the name of a model", error);
  if (v[SIZES].integer == LENGTH && v[DEVICES].type == OPC_ABSENT)
    return host->fail(host, error, OPC_INVALID, "devices",
                      "missing: 'sizes: length' needs a table of devices");
  const double *edge = v[EDGES].reals;
  if (v[EDGES].count != 2 || !(edge[0] > 0) || !(edge[0] < 50) ||
      !(edge[1] > 50) || !(edge[1] < 100))
    return refuse(host, "edges", "edges",
                  "are one place above 0 and one below 100 %, with the middle "
                  "between them",
                  error);
  s->format = paper_format(v[PICTURE].text);
  if (s->format < 0)
    return refuse(host, "picture", v[PICTURE].text,
                  "is not the name of a .png, .svg or .pdf file", error);
  return OPC_OK;
}

/* ---- entry ---- */

static void destroy(void *self) {
  circuit_step *s = self;
  for (int i = 0; i < 2; i++) free(s->path[i]);
  s->host->free(s->host, s);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  circuit_step *s = host->alloc(host, 1, sizeof *s);
  if (!s) {
    no_memory(host, error);
    return NULL;
  }
  s->host = host;
  s->values = values;
  if (!check(s, error)) return s;
  destroy(s);
  return NULL;
}

static const opc_step operations = {.size = sizeof operations, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "circuit.ngspice",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "delays, leakage and noise margins of a circuit as printed",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
