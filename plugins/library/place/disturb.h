/* SPDX-License-Identifier: BSD-3-Clause */
/* Disturbance of the transistors of placed masks: |Ion deviation| in the
   circuit minus |Ion deviation| in the cell alone (thesis eq. 4.1, figures 4.4
   to 4.6). */
#pragma once

#include <eda/gates.h>
#include <opcflow/plugin.h>

/* Write the table "disturbance" and its metrics. Transistors with known[i] = 0
   have no cell in the library and no disturbance. Returns OPC_OK or an error
   code. */
int disturb_report(const opc_host *host, const eda_mask *mask,
                   const uint8_t *known, opc_error *error);

/* Draw the chip with each transistor in the colour of its disturbance, and a
   scale. Returns OPC_OK or an error code. */
int disturb_draw(const opc_host *host, const eda_mask *mask,
                 const uint8_t *known, const char *file, double width,
                 opc_error *error);

#define DISTURB_METRICS                                                    \
  {"disturbance_mean", "%", OPC_LOWER, 0.01,                               \
   "mean of |Ion deviation| in the circuit minus that in the cell alone"}, \
      {"disturbance_max", "%", OPC_LOWER, 0.01, "largest disturbance"}, {  \
    "disturbed", "%", OPC_LOWER, 0.1,                                      \
        "fraction of transistors with a disturbance of 0.05 % or more"     \
  }
