/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind "circuit": a flat transistor netlist whose devices are matched to
   gates of the layout. */
#pragma once

#include <eda/gates.h>
#include <eda/pool.h>

OPC_C_BEGIN

/* Role of a port of the circuit. */
enum {
  EDA_PIN_INPUT = 0,
  EDA_PIN_OUTPUT = 1, /* includes inner nets that are brought out */
  EDA_PIN_SUPPLY = 2,
  EDA_PIN_GROUND = 3
};

/* A transistor: net numbers, drawn size in nm from the netlist, and the gates
   of the layout that form the transistor (fingers share their nets). */
typedef struct eda_device {
  const char *name; /* full path: "XU1/MN2" */
  uint32_t drain, gate, source, bulk;
  double length, width;
  uint8_t type; /* EDA_NMOS, EDA_PMOS */
  uint32_t fingers;
  const uint32_t *finger; /* indices in eda_gates */
  const char *model;      /* name of the model in the netlist. Since 0.6. */
} eda_device;

/* A matched circuit. The gates outlive the circuit. */
typedef struct eda_circuit {
  const char *name; /* name of the subcircuit */
  const eda_gates *gates;
  size_t nets;
  const char **net; /* names */
  size_t ports;
  uint32_t *port; /* net numbers, in the order of the netlist */
  uint8_t *role;  /* EDA_PIN_* of each port */
  size_t count;
  eda_device *device;
  eda_pool memory; /* owns everything above except the gates */
} eda_circuit;

/* Return a circuit with zeroed arrays of the given sizes. The caller allocates
   texts and fingers in the circuit's memory. An object of the data kind
   "circuit". */
OPC_EXPORT eda_circuit *eda_circuit_new(const eda_gates *gates,
                                        const char *name, size_t nets,
                                        size_t ports, size_t count);
OPC_EXPORT void eda_circuit_free(void *circuit);

/* Check a circuit: names, net numbers, sizes, and that no gate belongs to two
   devices. Return the code and fill *error. */
OPC_EXPORT int eda_circuit_check(const void *circuit, opc_error *error);

/* Return the role of a net as a port, EDA_PIN_*; -1 for an inner net. */
OPC_EXPORT int eda_circuit_role(const eda_circuit *circuit, uint32_t net);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_CIRCUIT(port)                                   \
  {                                                              \
    .name = port, .kind = "circuit", .check = eda_circuit_check, \
    .release = eda_circuit_free                                  \
  }

OPC_C_END
