/* SPDX-License-Identifier: BSD-3-Clause */
/* Conversion of lengths given in multiples of wavelength / NA, such as "0.3
   lambda/NA", to nm. */
#include <eda/litho.h>
#include <eda/natural.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Scanner of the thesis (section 3.3): wavelength in nm, NA. Default values of
   parameters were determined for this scanner. */
static const eda_scanner usual = {193, 0.75};

static int is_known(eda_scanner s) { return s.wavelength > 0 && s.na > 0; }

eda_scanner eda_scanner_of(const opc_module *litho) {
  const eda_litho *l = litho ? litho->functions : NULL;
  eda_scanner s = l && l->scanner ? l->scanner(litho->self) : (eda_scanner){0};
  return is_known(s) ? s : (eda_scanner){0};
}

double eda_natural_unit(eda_scanner s) {
  if (!is_known(s)) s = usual;
  return s.wavelength / s.na;
}

double eda_natural(const void *scanner, const char *text) {
  eda_scanner s = *(const eda_scanner *)scanner;
  char *end;
  double number = strtod(text, &end), unit = eda_natural_unit(s);
  if (!is_known(s)) s = usual;
  if (!strcmp(end, " lambda/NA^2"))
    unit /= s.na;
  else if (!strcmp(end, " (lambda/NA)^2"))
    unit *= unit;
  else if (strcmp(end, " lambda/NA") != 0)
    return NAN;
  return fmax(round(number * unit), 1);
}

void eda_natural_text(eda_scanner s, char *out, size_t size) {
  if (is_known(s))
    (void)snprintf(out, size, "from wavelength / NA = %.4g nm",
                   eda_natural_unit(s));
  else
    (void)snprintf(out, size,
                   "assuming %g nm and NA %g, because the model of the optics "
                   "does not report wavelength and NA",
                   usual.wavelength, usual.na);
}
