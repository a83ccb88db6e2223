/* SPDX-License-Identifier: BSD-3-Clause */
/* A plugin of another plugin's kind. */
#include "compat.h"
#include "compat.model.h"

static double factor(const void *self) {
  (void)self;
  return 2;
}

/* Without the optional function, as if it was built before there was one. */
typedef struct older_model {
  double (*factor)(const void *self);
} older_model;

static const older_model functions = {factor};

COMPAT_PLAIN("compat.model", "compat");
