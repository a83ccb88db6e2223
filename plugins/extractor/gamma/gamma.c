/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements extractor.gamma: gate slicing in which each slice has a weight,
   gamma, for effects near the active edges (thesis eq. 3.2). */
#include <math.h>

#include "../slicer.h"
#include "../weights.h"

/* ---- state ---- */

/* gamma = 1 + amplitude exp(-edge / decay); edge and decay in nm. */
typedef struct edge_term {
  double amplitude, decay;
  int amplitude_given, decay_given;
} edge_term;

typedef struct state {
  slicer slicer;          /* first member, passed to the slicer's functions */
  const char *table_path; /* NULL: edge terms */
  int loaded;
  weights table;
  edge_term term[2][EDA_CURRENTS];
} state;

/* ---- work ---- */

static double table_weight(const void *self, int type, int current, double edge,
                           double width) {
  const state *s = self;
  return grid_at(&s->table.grid[type][current], edge, width);
}

static double term_weight(const void *self, int type, int current, double edge,
                          double width) {
  const edge_term *t = &((const state *)self)->term[type][current];
  (void)width;
  return 1 + t->amplitude * exp(-edge / t->decay);
}

static int gamma_prepare(void *self, opc_error *error) {
  state *s = self;
  int code = slicer_prepare(self, error);
  if (code || !s->table_path || s->loaded) return code;
  s->loaded = 1;
  return weights_read(s->table_path, "table", &s->table, error);
}

/* ---- parameters ---- */

/* Parameters of the edge term for one transistor type and one current. */
/* clang-format off */
#define TERM(group, what, t, c, text)                                         \
  {.name = group "." what "_edge", .type = OPC_REAL, .flags = OPC_ABOVE,      \
   .preset = "0", .min = -1,                                                  \
   .summary = "a in gamma = 1 + a exp(-d / decay), d the distance from "      \
              "the active edge: " text,                                       \
   OPC_FIELD(state, term[t][c].amplitude),                                    \
   .given = offsetof(state, term[t][c].amplitude_given)},                     \
  {.name = group "." what "_decay", .type = OPC_REAL, .flags = OPC_ABOVE,     \
   .unit = "nm", .preset = "10 nm", .min = 0,                                 \
   .summary = "decay in gamma: " text,                                        \
   OPC_FIELD(state, term[t][c].decay),                                        \
   .given = offsetof(state, term[t][c].decay_given)}
/* clang-format on */

static const opc_parameter parameters[] = {
    SLICER_PARAMETERS,
    OPC_PARAMETER_NAMED("table", state, table_path, .type = OPC_FILE,
                        .summary = "table of gamma against width and distance "
                                   "from the edge; replaces the edge terms"),
    TERM("nmos", "ion", EDA_NMOS, EDA_ION, "Ion of n-transistors"),
    TERM("nmos", "ioff", EDA_NMOS, EDA_IOFF, "Ioff of n-transistors"),
    TERM("pmos", "ion", EDA_PMOS, EDA_ION, "Ion of p-transistors"),
    TERM("pmos", "ioff", EDA_PMOS, EDA_IOFF, "Ioff of p-transistors"),
};

static int gamma_check(void *self, opc_error *error) {
  static const char *const names[2][EDA_CURRENTS] = {{"nmos.ion", "nmos.ioff"},
                                                     {"pmos.ion", "pmos.ioff"}};
  state *s = self;
  s->slicer.weight = s->table_path ? table_weight : term_weight;
  for (int k = 0; k < 2 * EDA_CURRENTS && s->table_path; k++) {
    const edge_term *t = &s->term[k / EDA_CURRENTS][k % EDA_CURRENTS];
    if (!t->amplitude_given && !t->decay_given) continue;
    char name[24];
    snprintf(name, sizeof name, "%s_%s",
             names[k / EDA_CURRENTS][k % EDA_CURRENTS],
             t->amplitude_given ? "edge" : "decay");
    return opc_fail(error, OPC_INVALID, name,
                    "a table replaces all edge terms; remove them");
  }
  return slicer_check(self, error);
}

static void gamma_clear(void *self) {
  state *s = self;
  slicer_clear(&s->slicer);
  weights_clear(&s->table);
}

/* ---- entry ---- */

static const eda_extractor functions = {.prepare = gamma_prepare,
                                        .slicing = slicer_slicing,
                                        .extract = slicer_extract,
                                        .slice = slicer_slice,
                                        .range = slicer_range,
                                        .modelled = slicer_modelled};
OPC_PLUGIN(state, .id = "extractor.gamma", .kind = "extractor",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "gate slicing with weights near the active edges",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = gamma_check,
           .clear = gamma_clear, OPC_FUNCTIONS(functions));
