/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/correct/loop.h"

int opc_printer_print(opc_printer *p, int layer, const opc_shapes *mask,
                      opc_error *error) {
  const opc_litho *litho = p->litho->plugin->operations;
  const opc_resist *resist = p->resist->plugin->operations;
  const opc_imaging_service *imaging = p->host->imaging;
  imaging->release_field(p->host, &p->print[layer]);
  opc_spectrum spectrum;
  int code = imaging->mask_spectrum(p->host, mask, p->grid, p->frame,
                                    litho->band(p->litho->self), &spectrum,
                                    error);
  if (code) return code;
  p->simulations++;
  code = litho->image(p->litho->self, layer, &spectrum, &p->print[layer], error);
  imaging->release_spectrum(p->host, &spectrum);
  if (!code)
    code = resist->print(p->resist->self, layer, &p->print[layer], error);
  return code;
}

void opc_printer_clear(opc_printer *p) {
  for (int layer = 0; layer < OPC_MASKS; layer++)
    p->host->imaging->release_field(p->host, &p->print[layer]);
}
