/* SPDX-License-Identifier: BSD-3-Clause */
/* The slots that steps of this family have alike: fields of the same names in
   `state`. */
#ifndef CORRECT_SLOTS_H
#define CORRECT_SLOTS_H

#include <opcflow/plugin.h>

#define SLOT(state, NAME, FLAGS, SUMMARY)                        \
  OPC_PARAMETER(state, NAME, .type = OPC_SLOT, .flags = (FLAGS), \
                .choices = #NAME, .summary = (SUMMARY))

/* What prints and measures. */
#define PRINT_SLOTS(state)                                      \
  SLOT(state, litho, OPC_REQUIRED, "model of the optics"),      \
      SLOT(state, resist, OPC_REQUIRED, "model of the resist"), \
      SLOT(state, extractor, OPC_REQUIRED,                      \
           "performance of a printed transistor")

/* What moves, and what keeps to rules. */
#define MOVE_SLOTS(state)                                                \
  SLOT(state, synthesizer, OPC_REQUIRED, "what moves the mask's edges"), \
      SLOT(state, regulator, 0, "what keeps the print free of failures")

#endif
