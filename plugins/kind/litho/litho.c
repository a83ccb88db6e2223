/* SPDX-License-Identifier: BSD-3-Clause */
/* kind.litho: what a litho model must have, how it is tried out, and what a new
   one looks like. */
#include <eda/litho.h>
#include <math.h>

#include "../try.h"
#include "templates.h"

/* ---- work ---- */

static void try_image(opc_inspector *in, const opc_module *m, int layer,
                      const eda_spectrum *mask, double defocus) {
  const eda_litho *o = m->functions;
  eda_field field = {0};
  opc_error error = {0};
  int code = defocus == 0
                 ? o->image(m->self, layer, mask, &field, &error)
                 : o->image_at(m->self, layer, mask, defocus, &field, &error);
  if (try_went_well(in, defocus == 0 ? "image" : "image_at", code, &error))
    try_field(in, "image", "intensity", &field, &mask->frame);
  eda_field_clear(&field);
}

/* Layers past poly and active are there too, as a flow may name any number. */
static void exercise(const opc_module *m, opc_inspector *in) {
  enum { LAYERS = 3 };
  const eda_litho *o = m->functions;
  opc_error error = {0};
  if (!try_went_well(in, "prepare", o->prepare(m->self, &error), &error))
    return;
  double band = o->band(m->self);
  if (!(band > 0) || !isfinite(band)) {
    in->find(in, "its band is %g 1/nm", band);
    return;
  }
  for (int layer = 0; layer < LAYERS; layer++) {
    eda_spectrum mask;
    if (!try_mask(in, layer, band, &mask)) return;
    try_image(in, m, layer, &mask, 0);
    if (o->image_at) try_image(in, m, layer, &mask, 50);
    eda_spectrum_clear(&mask);
  }
}

/* ---- entry ---- */

static const opc_function required[] = {OPC_FUNCTION(eda_litho, prepare),
                                        OPC_FUNCTION(eda_litho, band),
                                        OPC_FUNCTION(eda_litho, image)};
OPC_KIND("litho", eda_litho,
         "litho models: from a mask to the intensity it gives");
