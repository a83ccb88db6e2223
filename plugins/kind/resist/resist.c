/* SPDX-License-Identifier: BSD-3-Clause */
/* kind.resist: what a resist must have, how it is tried out, and what a new one
   looks like. */
#include <eda/resist.h>

#include "../try.h"
#include "templates.h"

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
OPC_KIND("resist", eda_resist,
         "resists: from the intensity to the shapes that print");
