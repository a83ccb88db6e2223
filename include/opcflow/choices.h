/* SPDX-License-Identifier: BSD-3-Clause */
/* Values that a parameter may have, listed by its plugin: the cells of a file.
   An extension of plugins with a parameter that is OPC_LISTED. */
#ifndef OPCFLOW_CHOICES_H
#define OPCFLOW_CHOICES_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

#define OPC_CHOICES "opcflow.choices/1"

typedef struct opc_choices {
  /* Call `take` with each value that `parameter` may have where the others are
     as they are, in any order. `take` copies the text. Inputs may be missing.
     [main] */
  int (*list)(void *self, const char *parameter,
              void (*take)(void *data, const char *value), void *data,
              opc_error *error);
} opc_choices;

OPC_C_END
#endif
