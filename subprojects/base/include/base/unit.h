/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers with units: "65 nm", "0.065 um", "0.5 %". */
#pragma once

#include <glib.h>

/* A unit of measure. */
typedef struct opc_unit opc_unit;

/* Return a unit by name, NULL if unknown. Units are constant; do not free
   them. */
const opc_unit *opc_unit_find(const char *name);

/* Return the name of a unit's quantity, such as "a length"; the same pointer
   for all units of a dimension. */
const char *opc_unit_noun(const opc_unit *unit);

/* Return whether 0 is the same quantity in all units of the dimension. FALSE
   for temperatures. */
int opc_unit_shares_zero(const opc_unit *unit);

/* Return the names of all units, for suggestions (const char *, not owned by
   the array; the caller frees the array). */
GPtrArray *opc_unit_names(void);

/* Return the length of the number at the start of `text` ("12", "-.5", "1e-9"),
   0 without a number. */
size_t opc_number_length(const char *text);

/* Return the number written in `length` bytes at `text` in the unit `from`,
   converted to the unit `to` of the same dimension. If one of the units is
   NULL, the number is not converted. For a factor that is a power of ten, the
   result is rounded only once, because the exponent in the text is changed
   before the text is converted. Return +-HUGE_VAL on overflow. */
double opc_number_in(const char *text, size_t length, const opc_unit *from,
                     const opc_unit *to);

/* Return the shortest text that reads back as the same number (g_free). */
char *opc_number_text(double number);

/* Return the number with `decimals` decimals, at most 20, or with all digits if
   `decimals` is negative; "" for NAN, "inf" or "-inf" for infinity (g_free). */
char *opc_number_fixed(double number, int decimals);

/* Return the number with six significant digits; an integer with all digits
   (g_free). */
char *opc_number_short(double number);

/* Return a size as "12 MB", "1.5 GB" or "less than 1 MB" (g_free). */
char *opc_bytes_text(double bytes);
