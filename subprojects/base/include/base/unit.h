/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers with units: "65 nm", "0.065 um", "0.5 %". */
#ifndef OPC_BASE_UNIT_H
#define OPC_BASE_UNIT_H

#include <glib.h>

typedef struct opc_unit opc_unit;

/* NULL if there is no such unit. */
const opc_unit *opc_unit_find(const char *name);

/* What it measures: "a length" ... ; units of the same dimension have the same
   pointer. */
const char *opc_unit_noun(const opc_unit *unit);

/* Whether 0 is the same in all units of that dimension: not of temperatures. */
int opc_unit_shares_zero(const opc_unit *unit);

/* All names, const char *, for suggestions. */
GPtrArray *opc_unit_names(void);

/* The length of the number that `text` begins with ("12", "-.5", "1e-9"), 0 if
   it begins with none. */
size_t opc_number_length(const char *text);

/* The number of `length` bytes at `text`, written in the unit `from`, in the
   unit `to` of the same dimension (both NULL: as it is). Rounded once: units
   that differ by powers of ten move the exponent of the text. +-HUGE_VAL if it
   is too large. */
double opc_number_in(const char *text, size_t length, const opc_unit *from,
                     const opc_unit *to);

/* Return the shortest text that reads back as the same number (g_free). */
char *opc_number_text(double number);

/* Return the number with so many decimals, at most 20, or with all digits if
   `decimals` is negative; "" for NAN (g_free). */
char *opc_number_fixed(double number, int decimals);

/* Return the number with six digits, a whole number with all (g_free). */
char *opc_number_short(double number);

#endif
