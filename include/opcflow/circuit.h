/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind "circuit": a flat transistor netlist whose devices are known in the
   layout. Since 1.1. */
#ifndef OPCFLOW_CIRCUIT_H
#define OPCFLOW_CIRCUIT_H

#include <opcflow/gates.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a port of the circuit is for. */
enum {
  OPC_PORT_INPUT = 0,
  OPC_PORT_OUTPUT = 1,       /* also inner nets that are brought out */
  OPC_PORT_SUPPLY = 2,
  OPC_PORT_GROUND = 3
};

/* A transistor: nets by number, drawn size in nm as the netlist has it, and the
   gates it is drawn as (several fingers share their nets). */
typedef struct opc_device {
  const char *name;          /* whole path: "XU1/MN2" */
  uint32_t drain, gate, source, bulk;
  double length, width;
  uint8_t type;              /* OPC_NMOS, OPC_PMOS */
  uint8_t reserved[3];
  uint32_t fingers;
  const uint32_t *finger;    /* numbers of opc_gates */
} opc_device;

/* The gates it was matched to outlive it. All arrays come from host->alloc. */
typedef struct opc_circuit {
  size_t size;               /* sizeof(opc_circuit) */
  const char *name;          /* of the subcircuit */
  const opc_gates *gates;
  size_t nets;
  const char **net;          /* names */
  size_t ports;
  uint32_t *port;            /* their nets, in the order of the netlist */
  uint8_t *role;             /* OPC_PORT_* of each */
  size_t count;
  opc_device *device;
} opc_circuit;

#ifdef __cplusplus
}
#endif
#endif
