/* SPDX-License-Identifier: BSD-3-Clause */
/* extract.gamma: gate slicing in which each slice has a weight, gamma, for what
   happens near the edges of the active (thesis eq. 3.2). */
#include "../slicer.h"
#include "../weights.h"

#include <math.h>
#include <stdlib.h>

/* ---- state ---- */

/* 1 + amplitude exp(-edge / decay) */
typedef struct edge_term {
  double amplitude, decay;
} edge_term;

typedef struct state {
  slicer slicer;             /* first: what its functions get */
  const char *table_path;    /* NULL: edge terms */
  int loaded;
  weights table;
  edge_term term[2][CURRENTS];
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

static int prepare(void *self, opc_error *error) {
  state *s = self;
  int code = slicer_prepare(self, error);
  if (code || !s->table_path || s->loaded) return code;
  s->loaded = 1;
  return weights_read(s->slicer.host, s->table_path, "table", &s->table, error);
}

/* ---- parameters ---- */

enum {
  TABLE = SLICER_PARAMETERS, TERMS, PARAMETERS = TERMS + 4 * CURRENTS
};

#define AMPLITUDE(group, what, text)                                      \
  {.name = group "." what "_edge", .type = OPC_REAL, .flags = OPC_ABOVE,  \
   .preset = "0", .min = -1,                                              \
   .summary = "a of gamma = 1 + a exp(-d / decay), d from the nearer "    \
              "active edge: " text}
#define DECAY(group, what, text)                                           \
  {.name = group "." what "_decay", .type = OPC_REAL, .flags = OPC_ABOVE,  \
   .unit = "nm", .preset = "10 nm", .min = 0, .summary = "its decay: " text}

static const opc_parameter parameters[PARAMETERS] = {
    SLICER_DECLARATIONS,
    [TABLE] = {.name = "table", .type = OPC_FILE,
               .summary = "gamma against width and distance from the edge, "
                          "instead of the edge terms"},
    [TERMS] = AMPLITUDE("nmos", "ion", "Ion of n-transistors"),
    [TERMS + 1] = DECAY("nmos", "ion", "Ion of n-transistors"),
    [TERMS + 2] = AMPLITUDE("nmos", "ioff", "Ioff of n-transistors"),
    [TERMS + 3] = DECAY("nmos", "ioff", "Ioff of n-transistors"),
    [TERMS + 4] = AMPLITUDE("pmos", "ion", "Ion of p-transistors"),
    [TERMS + 5] = DECAY("pmos", "ion", "Ion of p-transistors"),
    [TERMS + 6] = AMPLITUDE("pmos", "ioff", "Ioff of p-transistors"),
    [TERMS + 7] = DECAY("pmos", "ioff", "Ioff of p-transistors"),
};

static void destroy(void *self) {
  state *s = self;
  slicer_clear(&s->slicer);
  weights_clear(&s->table);
  free(s);
}

static int take_weights(state *s, const opc_value *values, opc_error *error) {
  const opc_host *host = s->slicer.host;
  s->table_path = values[TABLE].text;
  s->slicer.weight = s->table_path ? table_weight : term_weight;
  for (int k = 0; k < 2 * CURRENTS; k++) {
    const opc_value *v = values + TERMS + 2 * k;
    s->term[k / CURRENTS][k % CURRENTS] = (edge_term){v[0].real, v[1].real};
    if (!s->table_path || !(v[0].given || v[1].given)) continue;
    host->fail(host, error, OPC_INVALID,
               parameters[TERMS + 2 * k + !v[0].given].name,
               "a table takes the place of all edge terms");
    return 0;
  }
  return 1;
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  state *s = calloc(1, sizeof *s);
  if (s && slicer_make(&s->slicer, host, values, error) &&
      take_weights(s, values, error))
    return s;
  if (s) destroy(s);
  else host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  return NULL;
}

/* ---- entry ---- */

static const opc_extract operations = {.size = sizeof operations,
                                       .prepare = prepare,
                                       .slicing = slicer_slicing,
                                       .extract = slicer_extract,
                                       .slice = slicer_slice};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "extract.gamma",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "gate slicing with weights for the edges of the active",
      .kind = OPC_KIND_EXTRACT,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
