/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind "library": corrected cells, made from a sheet (cut.h). */
#pragma once

#include <glib.h>
#include <opcflow/results.h>
#include <opcflow/step.h>

#include <correct/entry.h>

enum { LIBRARY_LITHO, LIBRARY_RESIST, LIBRARY_EXTRACTOR, LIBRARY_MODELS };

/* Names of the slots that hold the models of a process. */
OPC_EXPORT extern const char *const correct_library_models[LIBRARY_MODELS];

typedef struct library_cell {
  char *name, *geometry; /* name; checksum of the shapes (correct_units_sum) */
  entry *entry;          /* the correction */
} library_cell;

typedef struct library {
  char *model[LIBRARY_MODELS]; /* opc_host.identity of each model */
  double grid;                 /* mask grid, nm */
  GArray *cells;               /* library_cell, of cells with transistors */
} library;

OPC_EXPORT library *correct_library_new(double grid);
OPC_EXPORT void correct_library_free(void *library);
OPC_EXPORT int correct_library_check(const void *library, opc_error *error);

/* Set `model` to the identities of the models in the slots of a step. Return
   OPC_OK or the code of opc_results.identity. */
OPC_EXPORT int correct_library_take_models(const opc_host *host,
                                           char *model[LIBRARY_MODELS],
                                           opc_error *error);

#define LIBRARY_PORT(port)                                           \
  {                                                                  \
    .name = port, .kind = "library", .check = correct_library_check, \
    .release = correct_library_free                                  \
  }
