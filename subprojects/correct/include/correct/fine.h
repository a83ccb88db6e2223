/* SPDX-License-Identifier: BSD-3-Clause */
/* Accuracy of simulations: largest image error (difference of the intensity
   from that of the model with all kernels), and width of the clear field around
   the layout. */
#pragma once

#include <eda/print.h>
#include <opcflow/plugin.h>

/* Set *fine to the image error of accurate simulations, relative to the clear
   field. `text`: a number; "off": *fine is 0; NULL: *fine is the error that
   `limit`, in % of Ion, permits, from 5e-5 to 5e-4. Return OPC_INVALID for any
   other text. */
OPC_EXPORT int correct_fine_error(const char *text, double limit, double *fine,
                                  opc_error *error);

/* Return the standard deviation of Ion, %, that image errors of accurate
   simulations may cause, the argument `change` of correct_fine_by_layer. Return
   0 if `text` sets one error for all layers. */
OPC_EXPORT double correct_fine_change(const char *text, double limit);

/* Set the image errors of accurate simulations of poly and active so that each
   error causes a standard deviation of Ion of about `change` %.

   The printer must hold the images of a fast simulation of the drawn mask. The
   sensitivity of Ion to an image error is computed from these images and the
   same images at a slightly higher intensity. Set nothing if `change` or the
   printer's `fine` is 0, or if no transistor prints. */
OPC_EXPORT int correct_fine_by_layer(eda_printer *printer, const opc_host *host,
                                     const eda_gates *gates,
                                     const opc_module *extractor, double change,
                                     opc_error *error);

/* Simulate the drawn mask by a printer without images, call
   correct_fine_by_layer, clear the images, and set the printer's number of
   simulations to 0. */
OPC_EXPORT int correct_fine_by_drawn(eda_printer *printer, const opc_host *host,
                                     const eda_gates *gates,
                                     const opc_module *extractor, double change,
                                     opc_error *error);

/* If *margin, the width of the clear field around a layout, nm, is NAN, set it
   to the width that simulations with the error `fine` require, and log the
   result. The required width is proportional to lambda/NA of the model (`litho`
   NULL: see eda_natural_unit) and to 1 / sqrt(fine), and at least 3.886
   lambda/NA. Otherwise check the given width: log a finding if the error of the
   given width exceeds `fine`, and return OPC_INVALID if the width is below
   1.166 lambda/NA. */
OPC_EXPORT int correct_fine_margin(const opc_host *host,
                                   const opc_module *litho, double fine,
                                   double *margin, opc_error *error);

/* Default of `margin` for accurate simulations with an error of 5e-5. */
#define FINE_MARGIN "11.658 lambda/NA"
