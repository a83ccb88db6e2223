/* SPDX-License-Identifier: BSD-3-Clause */
/* SPICE and CDL netlists: read, and made flat from each subcircuit. */
#include <glib.h>

#include "core/plugin/host.h"
#include "fuzz/fuzz.h"
#include "plugins/netlist/netlist.h"

/* What one file may become here; more is allowed, and takes its time. */
static const uint64_t most_devices = 10000;

/* Names of transistors and nets are there to be read. */
static void look_at(const flat_netlist *flat) {
  for (size_t i = 0; i < flat->devices; i++)
    if (!*flat->device[i].name) g_error("a transistor without a name");
  for (size_t i = 0; i < flat->ports; i++)
    if (!flat->net[flat->port[i]]) g_error("a port without a net");
}

static void flatten(netlist *n, uint32_t top) {
  pool p = {0};
  flat_netlist flat = {.pool = &p};
  const scope in = {NULL, &n->subcircuit[top], NULL};
  if (!netlist_prepare(n, top) && in.of->devices <= most_devices &&
      !netlist_flatten(n, &in, &flat))
    look_at(&flat);
  pool_clear(&p);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static opc_host *host;
  if (!host) host = opc_host_new(NULL);
  opc_error error = {0};
  netlist n = {.host = host, .error = &error, .scale = 1};
  if (!netlist_read(&n, fuzz_file(data, size)))
    for (size_t i = 0; i < n.subcircuits; i++) flatten(&n, (uint32_t)i);
  pool_clear(&n.pool);
  return 0;
}
