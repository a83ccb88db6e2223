/* SPDX-License-Identifier: BSD-3-Clause */
/* How good a print has to be: its error, and the clear field around it. */
#ifndef CORRECT_FINE_H
#define CORRECT_FINE_H

#include <opcflow/plugin.h>

/* The error of fine prints, clear field 1, from the parameter `text`: a number,
   "off" (0), or NULL, which is what figures within `limit` (%, of Ion) need. */
int fine_error(const char *text, double limit, double *fine, opc_error *error);

/* The clear field around a layout, nm: what the parameter says, or if it is NAN
   what prints with that error need. */
double fine_margin(double margin, double fine);

#define FINE_PARAMETER(state)                                         \
  OPC_PARAMETER_NAMED("fine", state, fine_text, .type = OPC_TEXT,     \
                      .summary =                                      \
                          "error of the prints that the figures are " \
                          "of, clear field 1, if the model of the "   \
                          "optics can print finer than it does by "   \
                          "itself; off: it cannot")
#endif
