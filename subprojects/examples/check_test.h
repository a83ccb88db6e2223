/* SPDX-License-Identifier: BSD-3-Clause */
/* Helpers of the unit tests of this project. */
#pragma once

#include <math.h>
#include <opcflow/testing.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Abort the test with the source location unless the condition holds. */
#define CHECK(condition)                                              \
  do {                                                                \
    if (!(condition)) {                                               \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
      exit(1);                                                        \
    }                                                                 \
  } while (0)

/* Create a plugin; abort the test with the error message on failure. */
static inline opc_module *module_make(const char *id, const char *parameters) {
  opc_error error = {0};
  opc_module *module = opc_test_module(id, parameters, &error);
  if (!module) fprintf(stderr, "%s\n", error.message);
  CHECK(module);
  return module;
}
