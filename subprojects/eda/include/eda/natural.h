/* SPDX-License-Identifier: BSD-3-Clause */
/* Lengths that follow from the scanner. What prints alike through two scanners
   is as large as wavelength / NA (k1 of B. J. Lin, "Where is the lost
   resolution?", SPIE 633, 1986), and loses its focus over wavelength / NA^2; so
   a length that a flow leaves open is a number of these. */
#ifndef EDA_NATURAL_H
#define EDA_NATURAL_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Wavelength in vacuum, nm, and numerical aperture; 0, 0: not known. */
typedef struct eda_scanner {
  double wavelength, na;
} eda_scanner;

/* As a litho model tells, whose functions are an eda_litho; zeros for NULL and
   for one that does not know. [any] */
OPC_EXPORT eda_scanner eda_scanner_of(const opc_module *litho);

/* wavelength / NA, nm; where it is not known that of 193 nm and NA 0.75, at
   which the defaults were found. [any] */
OPC_EXPORT double eda_natural_unit(eda_scanner scanner);

/* What a default like "0.155 lambda/NA" is, in nm; "0.29 lambda/NA^2" in nm,
   "0.0038 (lambda/NA)^2" in nm^2. Rounded to whole ones, at least 1. NAN if it
   is written otherwise. `scanner` is an eda_scanner (of opc_follow,
   EDA_FOLLOW). [any] */
OPC_EXPORT double eda_natural(const void *scanner, const char *text);

/* How a message begins that tells such lengths: "from wavelength / NA = 354.3
   nm". Into `out` of `size` bytes. [any] */
OPC_EXPORT void eda_natural_text(eda_scanner scanner, char *out, size_t size);

/* Give an instance `self` what it was not given of the array `parameters`
   (opcflow/follow.h), and tell it. */
#define EDA_FOLLOW(host, id, self, parameters, scanner)                    \
  do {                                                                     \
    const eda_scanner known = (scanner);                                   \
    char whence[128];                                                      \
    eda_natural_text(known, whence, sizeof whence);                        \
    opc_follow(host, id, self, OPC_ARRAY(parameters), eda_natural, &known, \
               whence);                                                    \
  } while (0)

#ifdef __cplusplus
}
#endif
#endif
