/* SPDX-License-Identifier: BSD-3-Clause */
/* kind.resist: what a resist must have, how it is tried out, and what a new one
   looks like. */
#include <eda/resist.h>

#include "../try.h"
#include "templates.h"

typedef struct kind {
  const opc_host *host;
} kind;

/* ---- work ---- */

/* Layers past poly and active are there too, as a flow may name any number. */
static void exercise(const opc_module *m, opc_inspector *in) {
  enum { LAYERS = 3 };
  const eda_resist *o = m->functions;
  const opc_module litho = try_litho(in);
  opc_error error = {0};
  if (!try_went_well(in, "prepare", o->prepare(m->self, &litho, &error),
                     &error))
    return;
  for (int layer = 0; layer < LAYERS; layer++) {
    eda_field field;
    if (!try_print(in, layer, &field)) return;
    int code = o->print(m->self, layer, &field, &error);
    if (try_went_well(in, "print", code, &error))
      try_field(in, "print", "level set", &field, &try_frame);
    eda_field_clear(&field);
  }
}

/* ---- entry ---- */

static const opc_function required[] = {OPC_FUNCTION(eda_resist, prepare),
                                        OPC_FUNCTION(eda_resist, print)};
static const opc_kind functions = {
    .functions_size = sizeof(eda_resist),
    .n_functions = sizeof required / sizeof *required,
    .functions = required,
    .exercise = exercise,
    .n_templates = sizeof templates / sizeof *templates,
    .templates = templates};
OPC_PLUGIN(kind, .id = "kind.resist", .kind = "kind", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "resists: from the intensity to the shapes that print",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_FUNCTIONS(functions));
