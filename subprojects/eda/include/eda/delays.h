/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind (opcflow/step.h) "delays": delays of a circuit of cells at given
   sizes of its transistors, with the first derivatives with respect to the
   sizes. [any]: opcflow/plugin.h. */
#pragma once

#include <eda/gates.h>
#include <eda/pool.h>
#include <eda/timing.h>

OPC_C_BEGIN

/* Derivatives of a delay with respect to the logarithms of the printed sizes of
   one gate, ps. The sizes are the length for the current, the width, and the
   length for the capacitance (area divided by width). */
typedef struct eda_delay_term {
  uint32_t gate;
  float by[EDA_SIZES];
} eda_delay_term;

/* A delay at the sizes of eda_delays.size. */
typedef struct eda_delay {
  double time; /* ps */
  size_t terms;
  eda_delay_term *term; /* ordered by gate */
} eda_delay;

/* A path from an input of the circuit to an output. */
typedef struct eda_delay_path {
  eda_delay delay;
  const char *from, *to; /* nets */
  uint8_t rises;         /* 1: the output rises, 0: falls */
} eda_delay_path;

/* An arc from an input of a cell instance to an output: the mean delay over the
   levels of the other inputs. */
typedef struct eda_delay_arc {
  eda_delay delay;
  const char *cell, *instance, *input, *output;
  uint8_t rises; /* 1: the output rises, 0: falls */
} eda_delay_arc;

/* Delays of the paths and of the arcs of a circuit. The struct owns all arrays
   and texts (`memory` and `size`), but not the gates. */
typedef struct eda_delays {
  const char *name;           /* of the circuit */
  const eda_gates *gates;     /* must outlive the delays; NULL: the sizes of no
                                 gate are known, so there are no delays */
  double *size[EDA_SIZES];    /* sizes of the gates: L, W, nm; area, nm^2 */
  double supply, temperature; /* V, C */
  double drawn;               /* latest arrival with drawn sizes, ps */
  size_t paths;
  eda_delay_path *path; /* the longest path first */
  size_t arcs;
  eda_delay_arc *arc; /* arcs to one output of an instance are adjacent */
  eda_pool memory;
} eda_delays;

/* Return delays without paths and arcs, and allocate the arrays `size` for all
   gates unless `gates` is NULL. Release with eda_delays_free. [any] */
OPC_EXPORT eda_delays *eda_delays_new(const eda_gates *gates);
/* Free delays (NULL: do nothing), but not the gates. [any] */
OPC_EXPORT void eda_delays_free(void *delays);
/* Check that there is a path, that all figures are finite, and that all gates
   exist. Return OPC_OK, or OPC_FAILED and *error. [any] */
OPC_EXPORT int eda_delays_check(const void *delays, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_DELAYS(port)                                  \
  {                                                            \
    .name = port, .kind = "delays", .check = eda_delays_check, \
    .release = eda_delays_free                                 \
  }

OPC_C_END
