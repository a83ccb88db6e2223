/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "resist": from the intensity to the shapes that print. */
#ifndef EDA_RESIST_H
#define EDA_RESIST_H

#include <eda/gates.h>
#include <eda/litho.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct eda_resist {
  /* Once, before any print: calibrate each layer against the litho model it
     will be used with, whose functions are an eda_litho. [main] */
  int (*prepare)(void *self, const opc_module *litho, opc_error *error);

  /* Turn the intensity of a layer into its level set, in place: positive where
     the feature prints. The field may get another grid. [any] */
  int (*print)(const void *self, int layer, eda_field *field, opc_error *error);

  /* Before `prepare`: the transistors that will be printed, from which what is
     not given may follow. They stay until `prepare` returns. NULL: nothing
     follows from them. Since 0.7. [main] */
  void (*drawn)(void *self, const eda_gates *gates);
} eda_resist;

#ifdef __cplusplus
}
#endif
#endif
