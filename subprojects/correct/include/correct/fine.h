/* SPDX-License-Identifier: BSD-3-Clause */
/* How good a print has to be: its error, and the clear field around it. */
#ifndef CORRECT_FINE_H
#define CORRECT_FINE_H

#include <eda/print.h>
#include <opcflow/plugin.h>

/* The error of fine prints, clear field 1, from the parameter `text`: a number,
   "off" (0), or NULL, which is what figures within `limit` (%, of Ion) need. */
OPC_EXPORT int correct_fine_error(const char *text, double limit, double *fine,
                                  opc_error *error);

/* What fine prints may be off by in Ion, %, sd: what layers are to be printed
   for (correct_fine_by_layer). 0 if `text` has an error for all of them, or
   none. */
OPC_EXPORT double correct_fine_change(const char *text, double limit);

/* Set the error of fine prints of poly and active: so much that Ion is off by
   about `change` (%, sd) for each. How much of Ion an error is worth is seen
   from the print that is there, a cheap one of the drawn mask whose images the
   printer has kept, and what becomes of it with a little more light; so that
   whoever prints a mask of these gates by these models does it with the same
   errors. Nothing is set if `change` is 0, or where no transistor prints. */
OPC_EXPORT int correct_fine_by_layer(eda_printer *printer, const opc_host *host,
                                     const eda_gates *gates,
                                     const opc_module *extractor, double change,
                                     opc_error *error);

/* The same by a printer that has printed nothing yet, and does not know of that
   print afterwards. */
OPC_EXPORT int correct_fine_by_drawn(eda_printer *printer, const opc_host *host,
                                     const eda_gates *gates,
                                     const opc_module *extractor, double change,
                                     opc_error *error);

/* The clear field around a layout, nm: what the parameter says, or if it is NAN
   what prints with that error need through the scanner of that model (NULL: as
   eda_natural has it), which is told. */
OPC_EXPORT double correct_fine_margin(const opc_host *host,
                                      const opc_module *litho, double margin,
                                      double fine);

/* Of `margin`, with fine prints. */
#define FINE_MARGIN "11.658 lambda/NA"

#endif
