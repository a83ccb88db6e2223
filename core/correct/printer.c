/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/correct/check.h"
#include "core/correct/loop.h"
#include "core/plugin/guard.h"

/* An error of the resist, unless it is what the litho model told it. */
static int blame_resist(const opc_printer *p, int code, opc_error *error) {
  if (!code || !p->litho.failed) return opc_blame(error, code, "resist");
  *error = p->litho.fault;
  return error->code;
}

int opc_printer_prepare(opc_printer *p, opc_error *error) {
  const opc_resist *resist = p->resist->plugin->operations;
  int code = p->litho.operations.prepare(&p->litho, error);
  if (code) return code;
  const char *before = opc_call(p->resist, error);
  code = resist->prepare(p->resist->self, &p->litho.module, error);
  opc_leave(before);
  return blame_resist(p, code, error);
}

int opc_printer_print(opc_printer *p, int layer, const opc_shapes *mask,
                      opc_error *error) {
  const opc_litho *litho = &p->litho.operations;
  const opc_resist *resist = p->resist->plugin->operations;
  const opc_imaging_service *imaging = p->host->imaging;
  opc_field *print = &p->print[layer];
  imaging->release_field(p->host, print);
  opc_spectrum spectrum;
  int code = imaging->mask_spectrum(p->host, mask, p->grid, p->frame,
                                    litho->band(&p->litho), &spectrum, error);
  if (code) return code;
  p->simulations++;
  code = litho->image(&p->litho, layer, &spectrum, print, error);
  imaging->release_spectrum(p->host, &spectrum);
  if (code) return code;
  const char *before = opc_call(p->resist, error);
  code = resist->print(p->resist->self, layer, print, error);
  opc_leave(before);
  if (!code) code = opc_check_field(print, &p->frame, "level set", error);
  return blame_resist(p, code, error);
}

void opc_printer_clear(opc_printer *p) {
  for (int layer = 0; layer < OPC_MASKS; layer++)
    p->host->imaging->release_field(p->host, &p->print[layer]);
}
