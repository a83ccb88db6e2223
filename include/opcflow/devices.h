/* SPDX-License-Identifier: BSD-3-Clause */
/* Device tables: the currents of wide transistors against their length
   (thesis 2.2.1). */
#ifndef OPCFLOW_DEVICES_H
#define OPCFLOW_DEVICES_H

#include <opcflow/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { OPC_NMOS = 0, OPC_PMOS = 1 };

/* Currents per width, A/nm, against L in nm, increasing. [type][i] */
typedef struct opc_devices {
  size_t size;
  size_t count;
  const double *length;
  const double *ion[2];
  const double *ioff[2];
  double supply;             /* V */
  double width;              /* nm, of the transistors that were simulated */
  const char *name;
} opc_devices;

struct opc_device_service {
  size_t size;

  /* Read a table (docs/devices.md tells the format). Errors carry
     file:line:column. [main] */
  opc_devices *(*load)(const opc_host *host, const char *path,
                       opc_error *error);
  void (*release)(opc_devices *devices);
};

#ifdef __cplusplus
}
#endif
#endif
