/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind (opcflow/step.h) "samples": sizes of the transistors of sampled
   chips. [any]: opcflow/plugin.h. */
#pragma once

#include <eda/gates.h>

OPC_C_BEGIN

/* Chips with the figures Ion, L for the current, W and area of each
   transistor; the other figures of eda_performance are 0. The struct owns the
   figures, but not the gates. */
typedef struct eda_samples {
  const eda_gates *gates; /* must outlive the chips */
  size_t count;
  eda_performance *of; /* [count] */
} eda_samples;

/* Return `count` chips with zeroed figures. Release with eda_samples_free.
   [any] */
OPC_EXPORT eda_samples *eda_samples_new(const eda_gates *gates, size_t count);
/* Free chips (NULL: do nothing), but not the gates. [any] */
OPC_EXPORT void eda_samples_free(void *chips);
/* Check that all sizes are positive and finite. Return OPC_OK, or OPC_FAILED
   and *error. [any] */
OPC_EXPORT int eda_samples_check(const void *chips, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_SAMPLES(port)                                   \
  {                                                              \
    .name = port, .kind = "samples", .check = eda_samples_check, \
    .release = eda_samples_free                                  \
  }

OPC_C_END
