/* SPDX-License-Identifier: BSD-3-Clause */
/* What the prints of a loop or of a verification will take. */
#include "forecast.h"

void forecast_prints(const opc_context *context, const eda_gates *g,
                     const opc_module *litho, const opc_module *resist,
                     double margin, const char *prints, opc_forecast *out) {
  eda_printer printer;
  size_t layers = 0;
  for (size_t k = 0; k < g->layers; k++) layers += g->corrected[k] != 0;
  eda_printer_init(&printer, context, g, litho, resist, margin);
  eda_image_size size = eda_printer_forecast(&printer, layers);
  eda_printer_clear(&printer);
  out->memory = size.bytes;
  (void)snprintf(out->work, sizeof out->work,
                 "%s of %zu layer%s, about %.0f x %.0f points each", prints,
                 layers, layers == 1 ? "" : "s", size.columns, size.rows);
  (void)snprintf(out->help, sizeof out->help,
                 "a smaller 'margin' or part of the layout");
}
