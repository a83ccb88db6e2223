/* SPDX-License-Identifier: BSD-3-Clause */
/* What the kept plugins share. */
#ifndef COMPAT_H
#define COMPAT_H

#include <eda/extractor.h>
#include <eda/imaging.h>
#include <eda/litho.h>
#include <eda/regulator.h>
#include <eda/resist.h>
#include <eda/synthesizer.h>
#include <math.h>
#include <opcflow/choices.h>
#include <opcflow/opcflow.h>
#include <opcflow/pieces.h>
#include <opcflow/results.h>
#include <string.h>

typedef struct plain {
  const opc_host *host;
} plain;

/* A plugin without parameters. */
#define COMPAT_PLAIN(ID, KIND)                                         \
  OPC_PLUGIN(plain, .id = ID, .kind = KIND, .version = "1.0.0",        \
             .licence = "BSD-3-Clause", .summary = "Kept as a binary", \
             .flags = OPC_DETERMINISTIC | OPC_REENTRANT,               \
             OPC_FUNCTIONS(functions))

#endif
