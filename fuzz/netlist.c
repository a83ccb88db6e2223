/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes SPICE and CDL netlists: reading, and flattening from each
   subcircuit. */
#include <eda/netlist.h>
#include <glib.h>

#include "fuzz/fuzz.h"

/* Largest number of devices of a netlist that is flattened. Larger netlists are
   valid, but take too long. */
static const uint64_t most_devices = 10000;

/* Read the names of transistors and nets, so that sanitizers detect invalid
   pointers. */
static void look_at(const eda_flat_netlist *flat) {
  for (size_t i = 0; i < flat->devices; i++)
    if (!*flat->device[i].name) g_error("a transistor without a name");
  for (size_t i = 0; i < flat->ports; i++)
    if (!flat->net[flat->port[i]]) g_error("a port without a net");
}

static void netlist_flatten(eda_netlist *n, uint32_t top) {
  eda_pool pool = {0};
  eda_flat_netlist flat = {.pool = &pool};
  const eda_scope in = {NULL, &n->subcircuit[top], NULL};
  if (!eda_netlist_prepare(n, top) && in.of->devices <= most_devices &&
      !eda_netlist_flatten(n, &in, &flat))
    look_at(&flat);
  eda_pool_clear(&pool);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  opc_error error = {0};
  eda_netlist n = {.error = &error, .scale = 1};
  if (!eda_netlist_read(&n, fuzz_file(data, size)))
    for (size_t i = 0; i < n.subcircuits; i++) netlist_flatten(&n, (uint32_t)i);
  eda_netlist_clear(&n);
  return 0;
}
