/* SPDX-License-Identifier: BSD-3-Clause */
/* Default lengths derived from the scanner. Images of two scanners are equal if
   lengths scale with wavelength / NA (k1 of B. J. Lin, "Where is the lost
   resolution?", SPIE 633, 1986) and defocus with wavelength / NA^2. Defaults
   are therefore multiples of these lengths. [any]: see opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Wavelength in vacuum, nm, and numerical aperture; both are 0 if unknown. */
typedef struct eda_scanner {
  double wavelength, na;
} eda_scanner;

/* Return the scanner of a litho model (functions: eda_litho). Return zeros if
   `litho` is NULL or the model has no function `scanner`. [any] */
OPC_EXPORT eda_scanner eda_scanner_of(const opc_module *litho);

/* Return wavelength / NA, nm; for an unknown scanner 193 / 0.75, the values for
   which the defaults were determined. [any] */
OPC_EXPORT double eda_natural_unit(eda_scanner scanner);

/* Evaluate an expression such as "0.155 lambda/NA" or "0.29 lambda/NA^2" in nm,
   or "0.0038 (lambda/NA)^2" in nm^2, rounded to an integer >= 1; NAN for other
   texts. `scanner` points to an eda_scanner (opc_follow_value). [any] */
OPC_EXPORT double eda_natural(const void *scanner, const char *text);

/* Write the source of derived defaults for messages, such as "from wavelength /
   NA = 354.3 nm", to `out` of `size` bytes. [any] */
OPC_EXPORT void eda_natural_text(eda_scanner scanner, char *out, size_t size);

/* Set the parameters (array `parameters`) of the instance `self` that have no
   value to defaults derived from the scanner, and log them
   (opcflow/follow.h). */
#define EDA_FOLLOW(host, id, self, parameters, scanner)                    \
  do {                                                                     \
    const eda_scanner known = (scanner);                                   \
    char whence[128];                                                      \
    eda_natural_text(known, whence, sizeof whence);                        \
    opc_follow(host, id, self, OPC_ARRAY(parameters), eda_natural, &known, \
               whence);                                                    \
  } while (0)

OPC_C_END
