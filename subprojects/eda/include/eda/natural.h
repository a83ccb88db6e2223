/* SPDX-License-Identifier: BSD-3-Clause */
/* Lengths that follow from the scanner. Equal images of two scanners scale with
   wavelength / NA (k1 of B. J. Lin, "Where is the lost resolution?", SPIE 633,
   1986), and their depth of focus with wavelength / NA^2. A length that a flow
   does not give is therefore a multiple of these. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Wavelength in vacuum, nm, and numerical aperture; 0, 0: unknown. */
typedef struct eda_scanner {
  double wavelength, na;
} eda_scanner;

/* Return the scanner of a litho model, whose functions are an eda_litho; zeros
   for NULL and for models that do not know their scanner. [any] */
OPC_EXPORT eda_scanner eda_scanner_of(const opc_module *litho);

/* Return wavelength / NA, nm; for an unknown scanner that of 193 nm and NA
   0.75, for which the defaults were determined. [any] */
OPC_EXPORT double eda_natural_unit(eda_scanner scanner);

/* Return the value of a default: "0.155 lambda/NA" and "0.29 lambda/NA^2" in
   nm, "0.0038 (lambda/NA)^2" in nm^2, rounded to integers, at least 1. Return
   NAN for any other text. `scanner` is an eda_scanner (for opc_follow,
   EDA_FOLLOW). [any] */
OPC_EXPORT double eda_natural(const void *scanner, const char *text);

/* Write the introduction of messages about such lengths, "from wavelength / NA
   = 354.3 nm", into `out` of `size` bytes. [any] */
OPC_EXPORT void eda_natural_text(eda_scanner scanner, char *out, size_t size);

/* Set the parameters in the array `parameters` (opcflow/follow.h) of an
   instance `self` that the flow does not give, and log their values. */
#define EDA_FOLLOW(host, id, self, parameters, scanner)                    \
  do {                                                                     \
    const eda_scanner known = (scanner);                                   \
    char whence[128];                                                      \
    eda_natural_text(known, whence, sizeof whence);                        \
    opc_follow(host, id, self, OPC_ARRAY(parameters), eda_natural, &known, \
               whence);                                                    \
  } while (0)

OPC_C_END
