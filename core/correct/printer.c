/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/correct/check.h"
#include "core/correct/loop.h"
#include "core/plugin/guard.h"

void opc_printer_make(opc_printer *p, const opc_host *host,
                      const opc_gates *gates, const opc_module *litho,
                      const opc_module *resist, double margin) {
  opc_box b = gates->extent;
  double grid = gates->grid;
  *p = (opc_printer){.host = host, .resist = resist, .grid = grid};
  p->frame = (opc_frame){b.x0 * grid - margin, b.y0 * grid - margin,
                         ((double)b.x1 - b.x0) * grid + 2 * margin,
                         ((double)b.y1 - b.y0) * grid + 2 * margin};
  opc_model_make(&p->litho, litho);
}

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

static int print_layer(opc_printer *p, int layer, const opc_shapes *mask,
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
  code = litho->image(&p->litho, layer, &spectrum, print, error);
  imaging->release_spectrum(p->host, &spectrum);
  if (code) return code;
  const char *before = opc_call(p->resist, error);
  code = resist->print(p->resist->self, layer, print, error);
  opc_leave(before);
  if (!code) code = opc_check_field(print, &p->frame, "level set", error);
  return blame_resist(p, code, error);
}

/* The layers to print, side by side: what of a print is not for several
   threads is then done for both at once. */
typedef struct prints {
  opc_printer *printer;
  const opc_shapes *mask;
  size_t n;
  int layer[OPC_MASKS];
  opc_error error[OPC_MASKS];
} prints;

static void print_one(void *data, size_t i) {
  prints *all = data;
  int layer = all->layer[i];
  print_layer(all->printer, layer, &all->mask[layer], &all->error[i]);
}

int opc_printer_print(opc_printer *p, const int layers[OPC_MASKS],
                      const opc_shapes mask[OPC_MASKS], opc_error *error) {
  prints all = {.printer = p, .mask = mask};
  for (int layer = 0; layer < OPC_MASKS; layer++)
    if (layers[layer]) all.layer[all.n++] = layer;
  p->simulations += (uint32_t)all.n;
  p->host->parallel(p->host, all.n, print_one, &all);
  for (size_t i = 0; i < all.n; i++)
    if (all.error[i].code) {
      *error = all.error[i];
      return error->code;
    }
  return OPC_OK;
}

void opc_printer_clear(opc_printer *p) {
  for (int layer = 0; layer < OPC_MASKS; layer++)
    p->host->imaging->release_field(p->host, &p->print[layer]);
}
