/* SPDX-License-Identifier: BSD-3-Clause */
/* Locates mismatches between netlist and layout. A bundle is all transistors of
   one type with the same nets. The colour of a bundle describes its
   neighbourhood; bundles of equal colour are counterparts. The comparison
   starts with wide neighbourhoods, and reports bundles without a
   counterpart. */
#include <glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "graph.h"

enum {
  ROUNDS = 6, /* colour r of a node describes the nodes within r links */
  NAMES = 3   /* largest number of transistors that a message names */
};

typedef struct finder {
  graph *g;
  uint64_t *colour[ROUNDS]; /* colour of each node after each round */
  uint32_t *left, n;        /* bundles without a counterpart */
} finder;

static void colour_nodes(finder *f) {
  const graph *g = f->g;
  for (uint32_t i = g->bundle0[NETLIST]; i < g->nodes; i++)
    f->colour[0][i] = graph_bundle(g, i)->type;
  for (int s = 0; s < SIDES; s++)
    for (uint32_t i = 0; i < g->side[s].nets; i++) {
      const side *of = &g->side[s];
      f->colour[0][g->net0[s] + i] =
          graph_hash(of->seed[i] ? of->seed[i] : of->name[i]);
    }
  for (int r = 1; r < ROUNDS; r++)
    for (uint32_t i = 0; i < g->nodes; i++) {
      uint64_t sum = 0;
      for (uint32_t k = g->start[i]; k < g->start[i + 1]; k++)
        sum += graph_mix(f->colour[r - 1][g->links[k].node], g->links[k].role);
      f->colour[r][i] = graph_mix(f->colour[r - 1][i], sum);
    }
}

/* Remove counterparts, bundles of both sides with equal colour, from `left`. */
static void pair_up(finder *f, int round) {
  const uint64_t *colour = f->colour[round];
  uint32_t *left = f->left, kept = 0;
  graph_sort(left, f->n, colour);
  for (uint32_t i = 0, k; i < f->n; i = k) {
    uint32_t of[SIDES] = {0, 0}, seen[SIDES] = {0, 0};
    for (k = i; k < f->n && colour[left[k]] == colour[left[i]]; k++)
      of[graph_side(f->g, left[k])]++;
    for (uint32_t m = i; m < k; m++)
      if (seen[graph_side(f->g, left[m])]++ >= MIN(of[NETLIST], of[LAYOUT]))
        left[kept++] = left[m];
  }
  f->n = kept;
}

/* Find the bundles without a counterpart. Bundles of equal colour are paired,
   first by the colours of the last round, then of each round before, down to
   round `last`. */
static void faults_find(finder *f, int last) {
  uint32_t first = f->g->bundle0[NETLIST];
  f->n = f->g->nodes - first;
  for (uint32_t i = 0; i < f->n; i++) f->left[i] = first + i;
  for (int r = ROUNDS - 1; r >= last; r--) pair_up(f, r);
}

/* ---- words ---- */

/* Return the transistors of a side's bundles without a counterpart, in
   order. */
static uint32_t *side_members(finder *f, int s, uint32_t *n) {
  const graph *g = f->g;
  size_t most = g->flat.devices + g->j->gates->count;
  uint32_t *list = eda_pool_alloc(&g->j->pool, most, sizeof *list);
  *n = 0;
  for (uint32_t i = 0; i < f->n; i++) {
    const bundle *b = graph_bundle(g, f->left[i]);
    if (graph_side(g, f->left[i]) != s) continue;
    for (uint32_t k = 0; k < b->count; k++)
      list[(*n)++] = g->side[s].member[b->first + k];
  }
  qsort(list, *n, sizeof *list, eda_uint32s_rise);
  return list;
}

static void devices_report(finder *f, FILE *out) {
  const graph *g = f->g;
  uint32_t n, *list = side_members(f, NETLIST, &n);
  for (uint32_t i = 0; i < n && i < NAMES; i++) {
    const eda_transistor *d = &g->flat.device[list[i]];
    char where[256];
    fprintf(out, "%s'%.60s%s%.60s' (%.90s)", i ? ", " : "netlist device ",
            g->group->path, *g->group->path ? "/" : "", d->name,
            eda_netlist_where(&g->j->netlist, d->from, where, sizeof where));
  }
  if (n > NAMES) fprintf(out, " and %u more", n - NAMES);
  if (n) fprintf(out, " ha%s no gate in the layout", n > 1 ? "ve" : "s");
}

static void gates_text(finder *f, FILE *out) {
  uint32_t n, *list = side_members(f, LAYOUT, &n);
  if (n && ftell(out)) fputs("; ", out);
  for (uint32_t i = 0; i < n && i < NAMES; i++) {
    char name[256];
    fprintf(out, "%s'%.80s'", i ? ", " : "transistor ",
            match_gate_name(f->g->j, list[i], name, sizeof name));
  }
  if (n > NAMES) fprintf(out, " and %u more", n - NAMES);
  if (n) fprintf(out, " %s not in the netlist", n > 1 ? "are" : "is");
}

int graph_report(graph *g) {
  finder f = {.g = g};
  match_task *j = g->j;
  for (int r = 0; r < ROUNDS; r++)
    f.colour[r] = eda_pool_alloc(&j->pool, g->nodes, sizeof(uint64_t));
  f.left = eda_pool_alloc(&j->pool, g->nodes, sizeof *f.left);
  colour_nodes(&f);
  for (int last = 1; last < ROUNDS && !f.n; last++) faults_find(&f, last);
  if (!f.n)
    return opc_fail(j->error, OPC_INVALID, "file",
                    "'%.100s': the nets of its transistors differ from those "
                    "of the layout",
                    g->group->scope->of->name);
  char text[840] = "";
  FILE *out = fmemopen(text, sizeof text, "w");
  devices_report(&f, out);
  gates_text(&f, out);
  fclose(out);
  return opc_fail(j->error, OPC_INVALID, "file", "%s", text);
}
