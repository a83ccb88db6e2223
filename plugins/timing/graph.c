/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds the graph of a netlist of cell instances, nodes in topological
   order. */
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "graph.h"

typedef struct builder {
  graph *g;
  eda_pool *pool;
  const eda_timing *timing;
  eda_netlist *n;
  const eda_subcircuit *top;
  const eda_timing_cell **cell; /* cell of each instance */
  const uint32_t **port;        /* nets of the ports of each instance */
  int64_t *driver;              /* node that drives each net, or -1 */
  opc_error *error;
} builder;

static int instance_refuse(builder *b, const eda_element *e, const char *what) {
  char where[300];
  return opc_fail(b->error, OPC_INVALID, "file", "%s: instance '%.100s' %s",
                  eda_netlist_where(b->n, e, where, sizeof where), e->name,
                  what);
}

static char *own_text(eda_pool *pool, const char *text) {
  return eda_pool_text(pool, text, strlen(text));
}

/* ---- instances ---- */

/* Return the net connected to the port named `pin`, or -1 without such a
   port. */
static int64_t net_of(const eda_subcircuit *child, const eda_element *e,
                      const char *pin) {
  for (size_t i = 0; i < child->ports && i < e->nodes; i++)
    if (eda_same_name(child->port[i], pin)) return e->local[i];
  return -1;
}

static int add_instance(builder *b, const eda_element *e) {
  graph *g = b->g;
  if (e->is_transistor)
    return instance_refuse(b, e,
                           "is a transistor, expected an instance of a cell");
  const eda_subcircuit *child = &b->n->subcircuit[e->child];
  const eda_timing_cell *c = eda_timing_find(b->timing, child->name);
  if (!c)
    return instance_refuse(
        b, e, "is an instance of a cell that was not characterised");
  if (c->trouble)
    return instance_refuse(b, e, "is an instance of a cell without arcs");
  uint32_t *net = eda_pool_alloc(b->pool, c->inputs + c->outputs, sizeof *net);
  for (size_t i = 0; i < c->inputs + c->outputs; i++) {
    int64_t found = net_of(child, e, c->pin[i]);
    if (found < 0) return instance_refuse(b, e, "lacks a pin of the cell");
    net[i] = (uint32_t)found;
    if (i < c->inputs) g->fanout[found]++;
  }
  for (size_t o = 0; o < c->outputs; o++) {
    uint32_t to = net[c->inputs + o];
    if (b->driver[to] >= 0)
      return instance_refuse(b, e, "drives a net that has another driver");
    b->driver[to] = (int64_t)g->nodes;
    g->node[g->nodes++] = (node){.cell = c,
                                 .instance = (uint32_t)g->instances,
                                 .output = (uint32_t)o,
                                 .net = to,
                                 .in = net};
  }
  g->instance[g->instances++] = own_text(b->pool, e->name);
  return OPC_OK;
}

/* ---- the order ---- */

/* Sort the nodes topologically by depth-first search with an explicit stack.
   Marks: 1 on the stack, 2 finished. Fails if the circuit has a loop. */
static int sort_nodes(builder *b) {
  graph *g = b->g;
  node *sorted = eda_pool_alloc(b->pool, g->nodes, sizeof *sorted);
  uint8_t *mark = eda_alloc(g->nodes, 1), *next = eda_alloc(g->nodes, 1);
  size_t *stack = eda_alloc(g->nodes, sizeof *stack), done = 0;
  int64_t loop = -1;
  for (size_t i = 0; i < g->nodes && loop < 0; i++) {
    size_t depth = 0;
    if (!mark[i]) stack[depth++] = i;
    while (depth && loop < 0) {
      size_t k = stack[depth - 1];
      const node *n = &g->node[k];
      mark[k] = 1;
      if (next[k] == n->cell->inputs) {
        mark[k] = 2;
        sorted[done++] = *n;
        depth--;
        continue;
      }
      int64_t d = b->driver[n->in[next[k]++]];
      if (d >= 0 && mark[d] == 1) loop = (int64_t)n->net;
      if (d >= 0 && !mark[d]) stack[depth++] = (size_t)d;
    }
  }
  free(mark);
  free(next);
  free(stack);
  g->node = sorted;
  for (size_t i = 1; i < done; i++)
    sorted[i].table = sorted[i - 1].table + sorted[i - 1].cell->arcs *
                                                arc_doubles(sorted[i - 1].cell);
  if (loop < 0) return OPC_OK;
  return opc_fail(b->error, OPC_INVALID, "file",
                  "'%.100s' is sequential: net '%.100s' is on a loop", g->name,
                  g->net[loop]);
}

/* ---- pins ---- */

static void list_pins(builder *b) {
  graph *g = b->g;
  g->first_pin = eda_pool_alloc(b->pool, g->nets + 1, sizeof *g->first_pin);
  for (size_t i = 0; i < g->nets; i++)
    g->first_pin[i + 1] = g->first_pin[i] + g->fanout[i];
  g->pin = eda_pool_alloc(b->pool, g->first_pin[g->nets], sizeof *g->pin);
  uint32_t *next = eda_alloc(g->nets, sizeof *next);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    for (uint32_t k = 0; k < n->cell->inputs && !n->output; k++) {
      uint32_t net = n->in[k];
      g->pin[g->first_pin[net] + next[net]++] = (plug){(uint32_t)i, k};
    }
  }
  free(next);
}

/* ---- ports ---- */

/* List the inputs and outputs among the ports. Rails are ports that connect to
   no pin of a cell. */
static int find_ports(builder *b) {
  graph *g = b->g;
  for (size_t i = 0; i < b->top->ports; i++) {
    uint32_t net = (uint32_t)i; /* ports have the first net numbers */
    if (b->driver[net] >= 0)
      g->output[g->outputs++] = net;
    else if (g->fanout[net])
      g->input[g->inputs++] = net;
  }
  for (size_t i = 0; i < g->nets; i++)
    if (i >= b->top->ports && g->fanout[i] && b->driver[i] < 0)
      return opc_fail(b->error, OPC_INVALID, "file",
                      "nothing drives net '%.100s' of '%.100s'", g->net[i],
                      g->name);
  if (g->inputs && g->outputs) return OPC_OK;
  return opc_fail(b->error, OPC_INVALID, "file",
                  "'%.100s' has no %s among its ports", g->name,
                  g->inputs ? "output" : "input");
}

static int graph_build(builder *b) {
  graph *g = b->g;
  size_t most = 0;
  g->name = own_text(b->pool, b->top->name);
  g->nets = b->top->nodes;
  g->net = eda_pool_alloc(b->pool, g->nets, sizeof *g->net);
  for (size_t i = 0; i < g->nets; i++)
    g->net[i] = own_text(b->pool, b->top->node[i]);
  for (size_t i = 0; i < b->top->elements; i++) {
    const eda_element *e = &b->top->element[i];
    most += e->is_transistor ? 0 : b->n->subcircuit[e->child].ports;
  }
  g->node = eda_pool_alloc(b->pool, most, sizeof *g->node);
  g->instance = eda_pool_alloc(b->pool, b->top->elements, sizeof *g->instance);
  g->fanout = eda_pool_alloc(b->pool, g->nets, sizeof *g->fanout);
  g->input = eda_pool_alloc(b->pool, b->top->ports, sizeof *g->input);
  g->output = eda_pool_alloc(b->pool, b->top->ports, sizeof *g->output);
  b->driver = eda_alloc(g->nets, sizeof *b->driver);
  for (size_t i = 0; i < g->nets; i++) b->driver[i] = -1;
  int code = OPC_OK;
  for (size_t i = 0; i < b->top->elements && !code; i++)
    code = add_instance(b, &b->top->element[i]);
  if (!code) code = find_ports(b);
  if (!code) code = sort_nodes(b);
  if (!code) list_pins(b);
  free(b->driver);
  return code;
}

int graph_read(graph *g, eda_pool *pool, const eda_timing *timing,
               const char *file, const char *top, opc_error *error) {
  eda_netlist n = {.error = error, .scale = 1};
  builder b = {.g = g, .pool = pool, .timing = timing, .n = &n, .error = error};
  *g = (graph){0};
  int code = eda_netlist_read(&n, file);
  int64_t at = code ? -1 : eda_netlist_find(&n, top);
  if (at < 0 || eda_netlist_prepare(&n, (uint32_t)at))
    code = error->code;
  else
    b.top = &n.subcircuit[at];
  if (!code) code = graph_build(&b);
  eda_netlist_clear(&n);
  return code;
}

/* ---- from devices of the circuit to devices of cells ---- */

/* Return a hash table from instance name to the number of the first node +
   1. */
static GHashTable *index_instances(const graph *g) {
  GHashTable *at = g_hash_table_new(g_str_hash, g_str_equal);
  for (size_t i = 0; i < g->nodes; i++)
    g_hash_table_insert(at, (gpointer)g->instance[g->node[i].instance],
                        GSIZE_TO_POINTER(i + 1));
  return at;
}

/* Return the instance and cell device of a device of the placed circuit, by its
   name: "XU1/M_i_0" is device M_i_0 of instance XU1. */
static place find_device(const graph *g, const char *name,
                         GHashTable *instances) {
  const char *slash = strchr(name, '/');
  if (!slash) return (place){0};
  g_autofree char *head = g_strndup(name, (gsize)(slash - name));
  gpointer at = g_hash_table_lookup(instances, head);
  if (!at) return (place){0};
  const node *n = &g->node[GPOINTER_TO_SIZE(at) - 1];
  for (size_t i = 0; i < n->cell->devices; i++)
    if (!strcmp(n->cell->device[i].name, slash + 1))
      return (place){n->instance, &n->cell->device[i]};
  return (place){0};
}

/* Largest allowed relative difference between the drawn lengths and widths of a
   device in the circuit and in its cell. The limit accepts rounding to a grid
   and rejects a different scale. */
static const double same_size = 0.02;

place *graph_places(const graph *g, const eda_circuit *circuit,
                    opc_error *error) {
  g_autoptr(GHashTable) instances = index_instances(g);
  place *all = eda_alloc(circuit->count, sizeof *all);
  for (size_t i = 0; i < circuit->count; i++) {
    const eda_device *d = &circuit->device[i];
    all[i] = find_device(g, d->name, instances);
    const eda_timing_device *t = all[i].device;
    if (!t)
      opc_fail(error, OPC_INVALID, "circuit",
               "device '%.200s' is in no characterised cell of '%.100s'",
               d->name, g->name);
    else if (fabs(d->length / t->length - 1) > same_size ||
             fabs(d->width / t->width - 1) > same_size)
      opc_fail(error, OPC_INVALID, "circuit",
               "device '%.200s' is %g x %g nm, but the cell was characterised "
               "with %g x %g nm: check the scale",
               d->name, d->length, d->width, t->length, t->width);
    else
      continue;
    free(all);
    return NULL;
  }
  return all;
}
