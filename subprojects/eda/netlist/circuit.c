/* SPDX-License-Identifier: BSD-3-Clause */
/* Creation, check and release of circuits (data kind "circuit"). */
#include <eda/circuit.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

eda_circuit *eda_circuit_new(const eda_gates *gates, const char *name,
                             size_t nets, size_t ports, size_t count) {
  eda_circuit *c = eda_alloc(1, sizeof *c);
  c->gates = gates;
  c->name = eda_pool_text(&c->memory, name, strlen(name));
  c->nets = nets;
  c->net = eda_pool_alloc(&c->memory, nets, sizeof *c->net);
  c->ports = ports;
  c->port = eda_pool_alloc(&c->memory, ports, sizeof *c->port);
  c->role = eda_pool_alloc(&c->memory, ports, sizeof *c->role);
  c->count = count;
  c->device = eda_pool_alloc(&c->memory, count, sizeof *c->device);
  return c;
}

void eda_circuit_free(void *circuit) {
  eda_circuit *c = circuit;
  if (c) eda_pool_clear(&c->memory);
  free(c);
}

int eda_circuit_role(const eda_circuit *circuit, uint32_t net) {
  for (size_t i = 0; i < circuit->ports; i++)
    if (circuit->port[i] == net) return circuit->role[i];
  return -1;
}

/* Return a description of the fault of a device, or NULL. Count the use of each
   gate in `taken`. */
static const char *fault_of(const eda_circuit *c, const eda_device *d,
                            uint8_t *taken) {
  if (d->drain >= c->nets || d->gate >= c->nets || d->source >= c->nets ||
      d->bulk >= c->nets)
    return "is connected to a net that does not exist";
  if (d->type > EDA_PMOS) return "has no valid type";
  if (!(d->length > 0 && d->width > 0) || isinf(d->length) || isinf(d->width))
    return "has no size";
  if (!d->fingers || !d->finger) return "has no gate";
  for (uint32_t i = 0; i < d->fingers; i++) {
    if (d->finger[i] >= c->gates->count)
      return "has a gate that does not exist";
    if (taken[d->finger[i]]++) return "has the gate of another device";
  }
  return NULL;
}

static int check_devices(const eda_circuit *c, opc_error *error) {
  uint8_t *taken = eda_alloc(c->gates->count, 1);
  int code = OPC_OK;
  for (size_t i = 0; i < c->count && !code; i++) {
    const eda_device *d = &c->device[i];
    const char *fault = d->name ? fault_of(c, d, taken) : "has no name";
    if (fault)
      code = opc_fail(error, OPC_FAILED, NULL, "device %zu, '%.100s', %s", i,
                      d->name ? d->name : "", fault);
  }
  free(taken);
  return code;
}

int eda_circuit_check(const void *circuit, opc_error *error) {
  const eda_circuit *c = circuit;
  if (!c || !c->name || !c->gates || (c->nets && !c->net) ||
      (c->ports && (!c->port || !c->role)) || (c->count && !c->device))
    return opc_fail(error, OPC_FAILED, NULL, "the circuit is incomplete");
  for (size_t i = 0; i < c->nets; i++)
    if (!c->net[i])
      return opc_fail(error, OPC_FAILED, NULL, "net %zu has no name", i);
  for (size_t i = 0; i < c->ports; i++)
    if (c->port[i] >= c->nets || c->role[i] > EDA_PIN_GROUND)
      return opc_fail(error, OPC_FAILED, NULL,
                      "port %zu has no valid net or role", i);
  return check_devices(c, error);
}
