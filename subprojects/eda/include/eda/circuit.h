/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind "circuit": a flat transistor netlist whose devices are known in the
   layout. */
#ifndef EDA_CIRCUIT_H
#define EDA_CIRCUIT_H

#include <eda/gates.h>
#include <eda/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a port of the circuit is for. */
enum {
  EDA_PIN_INPUT = 0,
  EDA_PIN_OUTPUT = 1, /* also inner nets that are brought out */
  EDA_PIN_SUPPLY = 2,
  EDA_PIN_GROUND = 3
};

/* A transistor: nets by number, drawn size in nm as the netlist has it, and the
   gates it is drawn as (several fingers share their nets). */
typedef struct eda_device {
  const char *name; /* whole path: "XU1/MN2" */
  uint32_t drain, gate, source, bulk;
  double length, width;
  uint8_t type; /* EDA_NMOS, EDA_PMOS */
  uint32_t fingers;
  const uint32_t *finger; /* numbers of eda_gates */
  const char *model;      /* as the netlist calls it. Since 0.6. */
} eda_device;

/* The gates it was matched to outlive it. */
typedef struct eda_circuit {
  const char *name; /* of the subcircuit */
  const eda_gates *gates;
  size_t nets;
  const char **net; /* names */
  size_t ports;
  uint32_t *port; /* their nets, in the order of the netlist */
  uint8_t *role;  /* EDA_PIN_* of each */
  size_t count;
  eda_device *device;
  eda_pool memory; /* what all of the above is of, but the gates */
} eda_circuit;

/* A circuit with zeroed arrays of so many; texts and fingers are to be put into
   its memory. An object of the data kind "circuit". */
OPC_EXPORT eda_circuit *eda_circuit_new(const eda_gates *gates,
                                        const char *name, size_t nets,
                                        size_t ports, size_t count);
OPC_EXPORT void eda_circuit_free(void *circuit);

/* Whether a circuit is sound: names, numbers of nets, sizes, and that no gate
   is of two devices. The code, and *error. */
OPC_EXPORT int eda_circuit_check(const void *circuit, opc_error *error);

/* What a net is as a port, EDA_PIN_*; -1 for inner nets. */
OPC_EXPORT int eda_circuit_role(const eda_circuit *circuit, uint32_t net);

/* For the initialiser of an opc_port (opcflow/step.h). */
#define EDA_PORT_CIRCUIT(port)                                   \
  {                                                              \
    .name = port, .kind = "circuit", .check = eda_circuit_check, \
    .release = eda_circuit_free                                  \
  }

#ifdef __cplusplus
}
#endif
#endif
