/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements netlist.match: assigns the gates of a layout to the transistors of
   a netlist. */
#include "match.h"

#include <stdio.h>
#include <string.h>

/* ---- state ---- */

typedef struct matcher {
  const opc_host *host;
  const eda_gates *gates;
  const eda_mask *mask;
  const eda_layout *layout;
  const char *file, *top;
  opc_map layers, labels;
  double scale;
  int flat, by_place;
  double tolerance; /* % */
  const char *supply, *ground, *n_models, *p_models;
} matcher;

/* ---- work ---- */

uint32_t *match_unknown(match_task *j, size_t n) {
  uint32_t *list = eda_pool_alloc(&j->pool, n, sizeof *list);
  for (size_t i = 0; i < n; i++) list[i] = UINT32_MAX;
  return list;
}

const char *match_gate_name(const match_task *j, size_t gate, char *buffer,
                            size_t capacity) {
  const eda_gates *g = j->gates;
  snprintf(buffer, capacity, "%.200s:%u",
           *g->instance[gate] ? g->instance[gate] : g->cell[gate],
           g->number[gate]);
  return buffer;
}

/* Set the possible names of a layer: the key in the map of the flow, and the
   names in data/cells65 and FreePDK45. */
static void layer_names(int k, char name[3][16]) {
  static const char *const first[] = {"poly", "active", "contact"};
  static const char *const cif[] = {"CP", "CA", "CC"};
  static const int gds[] = {9, 1, 10};
  if (k <= CONTACT) {
    snprintf(name[0], 16, "%s", first[k]);
    snprintf(name[1], 16, "%s", cif[k]);
    snprintf(name[2], 16, "%d/0", gds[k]);
    return;
  }
  int via = k % 2 == 0, number = (k - CONTACT + 1 - via) / 2;
  snprintf(name[0], 16, "%s%d", via ? "via" : "metal", number);
  if (!via && number == 1)
    snprintf(name[1], 16, "CM");
  else
    snprintf(name[1], 16, "%s%d", via ? "CV" : "CM", number);
  snprintf(name[2], 16, "%d/0", k - METAL1 + 11);
}

static int find_layer(match_task *j, const opc_map *map, const char *parameter,
                      const char *key, int32_t *layer) {
  const char *name = NULL;
  for (size_t i = 0; i < map->count; i++)
    if (!strcmp(map->pairs[i].key, key)) name = map->pairs[i].value;
  if (!name) return OPC_OK;
  opc_error missing;
  *layer = eda_layout_select(j->layout, name, &missing);
  if (*layer >= 0) return OPC_OK;
  return opc_fail(j->error, OPC_INVALID, parameter, "'%s': %.800s", key,
                  missing.message);
}

/* Return 1 if the flow or the layout names a wire or via layer. The numbers of
   unnamed layers then do not follow FreePDK45, because another process may use
   these numbers for implants. */
static int wires_are_named(const match_task *j, const matcher *m) {
  for (int k = METAL1; k < LAYERS; k++) {
    char name[3][16];
    layer_names(k, name);
    if (eda_layout_find_layer(j->layout, name[0]) >= 0) return 1;
    for (size_t i = 0; i < m->layers.count; i++)
      if (!strcmp(m->layers.pairs[i].key, name[0])) return 1;
  }
  return 0;
}

static int find_layers(match_task *j, const matcher *m) {
  char used[400] = "";
  size_t n = 0;
  int ways = wires_are_named(j, m) ? 2 : 3;
  for (int k = 0; k < LAYERS; k++) {
    char name[3][16];
    layer_names(k, name);
    j->layer[k] = -1;
    for (int i = 0; i < ways && j->layer[k] < 0; i++)
      j->layer[k] = eda_layout_find_layer(j->layout, name[i]);
    if (find_layer(j, &m->layers, "layers", name[0], &j->layer[k]))
      return j->error->code;
    j->text_layer[k] = j->layer[k];
    if (find_layer(j, &m->labels, "labels", name[0], &j->text_layer[k]))
      return j->error->code;
    if (j->layer[k] >= 0)
      n += (size_t)snprintf(used + n, sizeof used - n, "%s%s '%.40s'",
                            n ? ", " : "", name[0],
                            eda_layout_layer_name(j->layout, j->layer[k]));
    if (n >= sizeof used) n = sizeof used - 1;
  }
  j->host->log(j->host, OPC_LOG_INFO, "netlist.match: layers: %s", used);
  return OPC_OK;
}

static int find_top(match_task *j) {
  j->top = eda_layout_find_cell(j->layout, j->gates->name);
  if (j->top >= 0) return OPC_OK;
  return opc_fail(j->error, OPC_INVALID, "layout",
                  "the layout has no cell '%.200s', to which the gates belong",
                  j->gates->name);
}

static int match_netlist(match_task *j, const matcher *m, eda_circuit **out) {
  eda_netlist *n = &j->netlist;
  if ((!m->by_place && (find_top(j) || find_layers(j, m))) ||
      eda_netlist_read(n, m->file))
    return j->error->code;
  int64_t number = eda_netlist_find(n, m->top ? m->top : j->gates->name);
  if (number < 0 || eda_netlist_prepare(n, (uint32_t)number))
    return j->error->code;
  eda_scope top = {NULL, &n->subcircuit[number], NULL};
  j->flat.pool = &j->pool;
  if (eda_netlist_flatten(n, &top, &j->flat) ||
      (m->by_place ? match_places(j)
                   : match_pair(j, &top) || match_extract(j) || match_solve(j)))
    return j->error->code;
  if (j->loose)
    j->host->log(j->host, OPC_LOG_WARNING,
                 "netlist.match: %zu labels are on no shape of their layer",
                 j->loose);
  if (n->left_out)
    j->host->log(j->host, OPC_LOG_WARNING,
                 "netlist.match: capacitors and diodes of '%s' ignored: %zu",
                 m->file, n->left_out);
  *out = match_circuit(j, top.of->name, m->supply, m->ground);
  return match_publish(j, *out);
}

/* Return whether two segmentations have the same transistors. */
static int same_gates(const eda_gates *a, const eda_gates *b) {
  return a == b || (a->count == b->count && a->grid == b->grid &&
                    !memcmp(a->box, b->box, a->count * sizeof *a->box));
}

static int match_check(const matcher *m, opc_error *error) {
  if (!m->mask && !m->gates)
    return opc_fail(error, OPC_INVALID, "gates",
                    "set either 'gates' or 'mask'");
  if (m->mask && m->gates && !same_gates(m->mask->gates, m->gates))
    return opc_fail(error, OPC_INVALID, "gates",
                    "the mask belongs to other gates");
  return OPC_OK;
}

static int match_forecast(void *self, opc_forecast *out, opc_error *error) {
  const matcher *m = self;
  if (m->mask) out->memory = eda_mask_flat_bytes(m->mask);
  return match_check(self, error);
}

static int match_run(void *self, void **outputs, opc_error *error) {
  matcher *m = self;
  if (m->mask && eda_mask_flat(m->mask, &m->mask, error)) return error->code;
  eda_circuit *circuit = NULL;
  match_task j = {.host = m->host,
                  .error = error,
                  .layout = m->layout,
                  .gates = m->mask ? m->mask->gates : m->gates,
                  .ignore_hierarchy = m->flat,
                  .tolerance = m->tolerance / 100,
                  .netlist = {.error = error,
                              .scale = m->scale,
                              .n_models = m->n_models,
                              .p_models = m->p_models}};
  int code = match_check(m, error);
  if (!code) code = match_netlist(&j, m, &circuit);
  outputs[0] = circuit;
  eda_netlist_clear(&j.netlist);
  eda_pool_clear(&j.pool);
  return code;
}

/* ---- parameters ---- */

#define LAYER_KEYS                                                       \
  "poly|active|contact|metal1|via1|metal2|via2|metal3|via3|metal4|via4|" \
  "metal5|via5|metal6|via6|metal7|via7|metal8|via8|metal9|via9|metal10"

static const opc_parameter parameters[] = {
    OPC_PARAMETER(matcher, gates, .type = OPC_INPUT, .choices = "gates",
                  .summary = "gates of the layout"),
    OPC_PARAMETER(matcher, mask, .type = OPC_INPUT, .choices = "mask",
                  .summary = "mask of the gates, instead of `gates`"),
    OPC_PARAMETER(matcher, layout, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "layout", .summary = "layout with these gates"),
    OPC_PARAMETER(matcher, file, .type = OPC_FILE, .flags = OPC_REQUIRED,
                  .summary = "netlist file, SPICE or CDL"),
    OPC_PARAMETER(
        matcher, top, .type = OPC_TEXT,
        .summary = "subcircuit to match; default: the name of the gates' cell"),
    OPC_PARAMETER(matcher, layers, .type = OPC_MAP, .choices = LAYER_KEYS,
                  .summary = "conducting layers: layer names in the layout"),
    OPC_PARAMETER(matcher, labels, .type = OPC_MAP, .choices = LAYER_KEYS,
                  .summary = "separate layers with the texts that name nets"),
    OPC_PARAMETER(
        matcher, scale, .type = OPC_REAL, .flags = OPC_ABOVE, .preset = "1",
        .summary = "factor by which the sizes in the netlist are multiplied"),
    OPC_PARAMETER(matcher, flat, .type = OPC_BOOL, .preset = "false",
                  .summary = "match the flattened netlist, even if the layout "
                             "has the netlist's instances"),
    OPC_PARAMETER_NAMED(
        "assign", matcher, by_place, .type = OPC_CHOICE,
        .choices = "connections|places", .preset = "connections",
        .summary = "assign gates by the nets of the layout, or by the places "
                   "in the netlist: nets are not checked, and other gates do "
                   "not belong to the circuit"),
    OPC_PARAMETER(matcher, tolerance, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "%",
                  .preset = "1 %", .max = 50,
                  .summary = "largest deviation of L and W from the netlist; "
                             "at least a grid step is allowed"),
    OPC_PARAMETER(matcher, supply, .type = OPC_TEXT, .preset = "VDD VDD! VCC",
                  .summary = "names of supply ports, separated by blanks"),
    OPC_PARAMETER(matcher, ground, .type = OPC_TEXT,
                  .preset = "VSS VSS! GND GND! 0",
                  .summary = "names of ground ports, separated by blanks"),
    OPC_PARAMETER_NAMED(
        "nmos", matcher, n_models, .type = OPC_TEXT,
        .summary =
            "model names of n-transistors that do not indicate the type"),
    OPC_PARAMETER_NAMED(
        "pmos", matcher, p_models, .type = OPC_TEXT,
        .summary =
            "model names of p-transistors that do not indicate the type"),
};

static const opc_metric metrics[] = {
    {"devices", NULL, OPC_NEUTRAL, 0, "transistors of the netlist"},
    {"gates", NULL, OPC_NEUTRAL, 0, "number of gates of the layout"},
    {"nets", NULL, OPC_NEUTRAL, 0, "nets of the netlist"},
    {"by_order", NULL, OPC_LOWER, 0,
     "number of choices among equivalent transistors decided by their order"},
};

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_CIRCUIT("circuit")};
/* Results of the step are not reused, because the netlist may include other
   files. */
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = match_run,
                                   .forecast = match_forecast,
                                   .flags = OPC_STEP_OUTSIDE};
OPC_PLUGIN(matcher, .id = "netlist.match", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "find the transistors of a netlist in a layout",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           OPC_FUNCTIONS(functions));
