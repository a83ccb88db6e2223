/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "compat": a factor. */
#ifndef COMPAT_MODEL_H
#define COMPAT_MODEL_H

#include <opcflow/kind.h>

typedef struct compat_model {
  double (*factor)(const void *self);
  double (*other)(const void *self); /* optional */
  OPC_MAY_GROW
} compat_model;

#endif
