/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind "circuit": a flat transistor netlist whose devices are matched to
   gates (transistors) of the layout. Data kinds: opcflow/step.h. */
#pragma once

#include <eda/gates.h>
#include <eda/pool.h>

OPC_C_BEGIN

/* Role of a port of the circuit. */
enum {
  EDA_PIN_INPUT = 0,
  EDA_PIN_OUTPUT = 1, /* or an internal net that has a port */
  EDA_PIN_SUPPLY = 2,
  EDA_PIN_GROUND = 3
};

/* A transistor: its nets (indices in eda_circuit.net), its size in the netlist,
   nm, and the gates of the layout that form it (several if it has fingers). */
typedef struct eda_device {
  const char *name; /* full path: "XU1/MN2" */
  uint32_t drain, gate, source, bulk;
  double length, width;
  uint8_t type; /* EDA_NMOS, EDA_PMOS */
  uint32_t fingers;
  const uint32_t *finger; /* indices in eda_gates */
  const char *model;      /* name of the model in the netlist. Since 0.6. */
} eda_device;

/* A matched circuit. The gates must outlive the circuit. */
typedef struct eda_circuit {
  const char *name; /* name of the subcircuit */
  const eda_gates *gates;
  size_t nets;      /* number of nets */
  const char **net; /* names */
  size_t ports;     /* number of ports */
  uint32_t *port;   /* net of each port, in the order of the netlist */
  uint8_t *role;    /* EDA_PIN_* of each port */
  size_t count;     /* number of devices */
  eda_device *device;
  eda_pool memory; /* owns all arrays and texts, but not `gates` */
} eda_circuit;

/* Return a circuit with zeroed arrays for `nets`, `ports` and `count` devices.
   The caller allocates texts and fingers from circuit->memory. */
OPC_EXPORT eda_circuit *eda_circuit_new(const eda_gates *gates,
                                        const char *name, size_t nets,
                                        size_t ports, size_t count);
/* Free a circuit with all its memory (NULL: do nothing). */
OPC_EXPORT void eda_circuit_free(void *circuit);

/* Check names, net numbers and sizes, and that no gate belongs to two devices.
   Return OPC_OK, or OPC_FAILED and *error. */
OPC_EXPORT int eda_circuit_check(const void *circuit, opc_error *error);

/* Return the role (EDA_PIN_*) of the port of a net; -1: the net has no port. */
OPC_EXPORT int eda_circuit_role(const eda_circuit *circuit, uint32_t net);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_CIRCUIT(port)                                   \
  {                                                              \
    .name = port, .kind = "circuit", .check = eda_circuit_check, \
    .release = eda_circuit_free                                  \
  }

OPC_C_END
