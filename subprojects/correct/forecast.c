/* SPDX-License-Identifier: BSD-3-Clause */
/* What the prints of a loop or of a verification will take. */
#include <correct/forecast.h>

void forecast_prints(const opc_context *context, const eda_gates *g,
                     const opc_module *litho, const opc_module *resist,
                     double margin, double fine, const char *prints,
                     const char *fine_prints, opc_forecast *out) {
  eda_printer printer;
  size_t layers = 0;
  for (size_t k = 0; k < g->layers; k++) layers += g->corrected[k] != 0;
  eda_printer_init(&printer, context, g, litho, resist, margin);
  printer.fine = fine;
  int finely = fine > 0 && printer.litho.functions.image_fine;
  eda_image_size size = eda_printer_forecast(&printer, layers);
  eda_printer_clear(&printer);
  out->memory = size.bytes;
  (void)snprintf(out->work, sizeof out->work,
                 "%s of %zu layer%s, about %.0f x %.0f points each",
                 finely ? fine_prints : prints, layers, layers == 1 ? "" : "s",
                 size.columns, size.rows);
  (void)snprintf(out->help, sizeof out->help,
                 "a smaller 'margin' or part of the layout");
}
