/* SPDX-License-Identifier: BSD-3-Clause */
/* Accuracy of simulations: error of the image and the clear field around the
   layout. */
#pragma once

#include <eda/print.h>
#include <opcflow/plugin.h>

/* Set *fine to the error of accurate simulations, clear field 1, from the
   parameter `text`: a number, "off" (0), or NULL for the error that `limit` (%
   of Ion) requires. Returns OPC_INVALID if the text is not one of these. */
OPC_EXPORT int correct_fine_error(const char *text, double limit, double *fine,
                                  opc_error *error);

/* Return the standard deviation of Ion, %, that accurate simulations may cause
   (see correct_fine_by_layer); 0 if `text` is given, so that one error holds
   for all layers. */
OPC_EXPORT double correct_fine_change(const char *text, double limit);

/* Set the error of accurate simulations of poly and active so that each causes
   a standard deviation of Ion of about `change` %.

   The sensitivity of Ion to an error is computed from the fast simulation of
   the drawn mask, whose images the printer still holds. The same images at a
   slightly higher intensity determine the derivative. All simulations of these
   gates by these models therefore use equal errors. Sets nothing if `change` is
   0 or no transistor prints. */
OPC_EXPORT int correct_fine_by_layer(eda_printer *printer, const opc_host *host,
                                     const eda_gates *gates,
                                     const opc_module *extractor, double change,
                                     opc_error *error);

/* Compute the same with a printer that has not simulated anything yet; its
   state is restored. */
OPC_EXPORT int correct_fine_by_drawn(eda_printer *printer, const opc_host *host,
                                     const eda_gates *gates,
                                     const opc_module *extractor, double change,
                                     opc_error *error);

/* Return the clear field around a layout in nm: `margin` unless NAN, else the
   distance that simulations with the error `fine` require. That distance is
   computed for the scanner of the model (NULL: see eda_natural) and logged. */
OPC_EXPORT double correct_fine_margin(const opc_host *host,
                                      const opc_module *litho, double margin,
                                      double fine);

/* Default of `margin` with accurate simulations. */
#define FINE_MARGIN "11.658 lambda/NA"
