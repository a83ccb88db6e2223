/* SPDX-License-Identifier: BSD-3-Clause */
/* netlist.match: which gate of a layout is which transistor of a netlist. */
#include "match.h"

#include <stdio.h>
#include <string.h>

#include "output.h"

/* ---- state ---- */

typedef struct matcher {
  const opc_host *host;
  const opc_value *values;
} matcher;

enum {
  GATES,
  LAYOUT_IN,
  FILE_NAME,
  TOP,
  LAYER_MAP,
  LABEL_MAP,
  SCALE,
  FLAT,
  TOLERANCE,
  SUPPLY,
  GROUND,
  N_MODELS,
  P_MODELS,
  PARAMETERS
};

/* ---- work ---- */

int match_no_memory(job *j) {
  return j->host->fail(j->host, j->error, OPC_FAILED, NULL, "out of memory");
}

const char *match_gate_name(const job *j, size_t gate, char *buffer,
                            size_t room) {
  const opc_gates *g = j->gates;
  snprintf(buffer, room, "%.200s:%u",
           *g->instance[gate] ? g->instance[gate] : g->cell[gate],
           g->number[gate]);
  return buffer;
}

/* The name of a layer in the map of the flow, and those that it usually has:
   those of data/cells65 and those of FreePDK45. */
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

static const char *in_map(const opc_value *map, const char *key) {
  for (size_t i = 0; map->type != OPC_ABSENT && i < map->count; i++)
    if (!strcmp(map->pairs[i].key, key)) return map->pairs[i].value;
  return NULL;
}

static int find_layer(job *j, const opc_value *map, const char *parameter,
                      const char *key, int32_t *layer) {
  const char *name = in_map(map, key);
  if (!name) return OPC_OK;
  *layer = j->host->layout->find_layer(j->layout, name);
  if (*layer >= 0) return OPC_OK;
  return j->host->fail(j->host, j->error, OPC_INVALID, parameter,
                       "the layout has no layer '%.200s' for '%s'", name, key);
}

static int find_layers(job *j, const opc_value *v) {
  char used[400] = "";
  size_t n = 0;
  for (int k = 0; k < LAYERS; k++) {
    char name[3][16];
    layer_names(k, name);
    j->layer[k] = -1;
    for (int i = 0; i < 3 && j->layer[k] < 0; i++)
      j->layer[k] = j->host->layout->find_layer(j->layout, name[i]);
    if (find_layer(j, &v[LAYER_MAP], "layers", name[0], &j->layer[k]))
      return j->error->code;
    j->text_layer[k] = j->layer[k];
    if (find_layer(j, &v[LABEL_MAP], "labels", name[0], &j->text_layer[k]))
      return j->error->code;
    if (j->layer[k] >= 0)
      n += (size_t)snprintf(
          used + n, sizeof used - n, "%s%s '%.40s'", n ? ", " : "", name[0],
          j->host->layout->layer_name(j->layout, j->layer[k]));
    if (n >= sizeof used) n = sizeof used - 1;
  }
  j->host->log(j->host, OPC_LOG_INFO, "netlist.match: layers: %s", used);
  return OPC_OK;
}

static int find_top(job *j) {
  j->top = j->host->layout->find_cell(j->layout, j->gates->name);
  if (j->top >= 0) return OPC_OK;
  return j->host->fail(j->host, j->error, OPC_INVALID, "layout",
                       "the layout has no cell '%.200s', which the gates are "
                       "of",
                       j->gates->name);
}

static int match(job *j, const opc_value *v, opc_circuit **out) {
  netlist *n = &j->netlist;
  if (find_top(j) || find_layers(j, v)) return j->error->code;
  if (netlist_read(n, v[FILE_NAME].text)) return j->error->code;
  const char *name = v[TOP].type == OPC_ABSENT ? j->gates->name : v[TOP].text;
  int64_t number = netlist_find(n, name);
  if (number < 0 || netlist_prepare(n, (uint32_t)number)) return j->error->code;
  scope top = {NULL, &n->subcircuit[number], NULL};
  j->flat.pool = &j->pool;
  if (netlist_flatten(n, &top, &j->flat)) return j->error->code;
  if (match_pair(j, &top) || match_extract(j) || match_solve(j))
    return j->error->code;
  if (j->loose)
    j->host->log(j->host, OPC_LOG_WARNING,
                 "netlist.match: labels that lie on no shape of their layer: "
                 "%zu",
                 j->loose);
  if (n->left_out)
    j->host->log(j->host, OPC_LOG_WARNING,
                 "netlist.match: capacitors and diodes of '%s' that are left "
                 "out: %zu",
                 n->file[0], n->left_out);
  *out = output_circuit(j, top.of->name, v[SUPPLY].text, v[GROUND].text);
  return *out ? output_publish(j, *out) : j->error->code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const matcher *m = self;
  const opc_value *v = m->values;
  job j = {.host = m->host,
           .error = error,
           .layout = v[LAYOUT_IN].object,
           .gates = v[GATES].object,
           .ignore_hierarchy = (int)v[FLAT].integer,
           .tolerance = v[TOLERANCE].real / 100};
  j.netlist = (netlist){.host = m->host,
                        .error = error,
                        .scale = v[SCALE].real,
                        .n_models = v[N_MODELS].text,
                        .p_models = v[P_MODELS].text};
  opc_circuit *circuit = NULL;
  int code = match(&j, v, &circuit);
  outputs[0] = circuit;
  pool_clear(&j.netlist.pool);
  pool_clear(&j.pool);
  return code;
}

/* ---- parameters ---- */

#define LAYER_KEYS                                                       \
  "poly|active|contact|metal1|via1|metal2|via2|metal3|via3|metal4|via4|" \
  "metal5|via5|metal6|via6|metal7|via7|metal8|via8|metal9|via9|metal10"

static const opc_parameter parameters[PARAMETERS] = {
    [GATES] = {.name = "gates",
               .type = OPC_INPUT,
               .flags = OPC_REQUIRED,
               .choices = "gates",
               .summary = "the gates to find"},
    [LAYOUT_IN] = {.name = "layout",
                   .type = OPC_INPUT,
                   .flags = OPC_REQUIRED,
                   .choices = "layout",
                   .summary = "the layout that the gates are of"},
    [FILE_NAME] = {.name = "file",
                   .type = OPC_FILE,
                   .flags = OPC_REQUIRED,
                   .summary = "the netlist: SPICE or CDL"},
    [TOP] = {.name = "top",
             .type = OPC_TEXT,
             .summary = "the subcircuit; if not given, that with the name of "
                        "the gates' cell"},
    [LAYER_MAP] = {.name = "layers",
                   .type = OPC_MAP,
                   .choices = LAYER_KEYS,
                   .summary = "names of the layout for layers that conduct"},
    [LABEL_MAP] = {.name = "labels",
                   .type = OPC_MAP,
                   .choices = LAYER_KEYS,
                   .summary = "layers with the texts that name nets, where "
                              "they are layers of their own"},
    [SCALE] = {.name = "scale",
               .type = OPC_REAL,
               .flags = OPC_ABOVE,
               .preset = "1",
               .summary = "a factor on the sizes of the netlist"},
    [FLAT] = {.name = "flat",
              .type = OPC_BOOL,
              .preset = "false",
              .summary = "match all at once, even where the layout has the "
                         "netlist's instances"},
    [TOLERANCE] = {.name = "tolerance",
                   .type = OPC_REAL,
                   .flags = OPC_AT_LEAST | OPC_AT_MOST,
                   .unit = "%",
                   .preset = "1 %",
                   .max = 50,
                   .summary = "how far L and W may be from the netlist's; one "
                              "step of the grid at least"},
    [SUPPLY] = {.name = "supply",
                .type = OPC_TEXT,
                .preset = "VDD VDD! VCC",
                .summary = "names of supply ports, with blanks between"},
    [GROUND] = {.name = "ground",
                .type = OPC_TEXT,
                .preset = "VSS VSS! GND GND! 0",
                .summary = "names of ground ports, with blanks between"},
    [N_MODELS] = {.name = "nmos",
                  .type = OPC_TEXT,
                  .summary = "names of n models, where it does not show"},
    [P_MODELS] = {.name = "pmos",
                  .type = OPC_TEXT,
                  .summary = "names of p models, where it does not show"},
};

static const opc_metric metrics[] = {
    {.name = "devices", .summary = "transistors of the netlist"},
    {.name = "gates", .summary = "gates that they are drawn as"},
    {.name = "nets", .summary = "nets of the netlist"},
    {.name = "by_order",
     .better = OPC_LOWER,
     .summary = "choices among like transistors that only their order settled"},
};

/* ---- entry ---- */

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  matcher *m = host->alloc(host, 1, sizeof *m);
  if (!m) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  m->host = host;
  m->values = values;
  return m;
}

static void destroy(void *self) {
  matcher *m = self;
  m->host->free(m->host, m);
}

static const opc_port outputs_of[] = {
    {.name = "circuit", .kind = "circuit", .release = output_release}};

static const opc_step operations = {
    .size = sizeof operations,
    .n_outputs = 1,
    .port_size = sizeof(opc_port),
    .outputs = outputs_of,
    .run = run,
};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "netlist.match",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "find the transistors of a netlist in a layout",
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
