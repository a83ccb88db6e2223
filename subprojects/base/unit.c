/* SPDX-License-Identifier: BSD-3-Clause */
/* Units by dimension, and conversion of numbers. */
#include <base/unit.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct opc_unit {
  const char *name;
  const char *noun;
  int exponent;  /* value of the unit: factor * 10^exponent of the base unit */
  double factor; /* 0 if the unit is a power of ten of the base unit */
  double offset; /* zero of this unit, in the base unit */
};

static const char length[] = "a length", area[] = "an area",
                  percent[] = "a percentage", voltage[] = "a voltage",
                  current[] = "a current", temperature[] = "a temperature",
                  angle[] = "an angle", duration[] = "a time",
                  frequency[] = "a spatial frequency",
                  capacitance[] = "a capacitance";

static const opc_unit units[] = {
    {"nm", length, 0, 0, 0},           {"um", length, 3, 0, 0},
    {"\xC2\xB5m", length, 3, 0, 0}, /* micro sign */
    {"\xCE\xBCm", length, 3, 0, 0}, /* Greek mu */
    {"pm", length, -3, 0, 0},          {"angstrom", length, -1, 0, 0},
    {"mm", length, 6, 0, 0},           {"m", length, 9, 0, 0},
    {"nm^2", area, 0, 0, 0},           {"um^2", area, 6, 0, 0},
    {"mm^2", area, 12, 0, 0},          {"1/nm", frequency, 0, 0, 0},
    {"1/um", frequency, -3, 0, 0},     {"%", percent, 0, 0, 0},
    {"V", voltage, 0, 0, 0},           {"mV", voltage, -3, 0, 0},
    {"A", current, 0, 0, 0},           {"mA", current, -3, 0, 0},
    {"uA", current, -6, 0, 0},         {"nA", current, -9, 0, 0},
    {"pA", current, -12, 0, 0},        {"F", capacitance, 0, 0, 0},
    {"pF", capacitance, -12, 0, 0},    {"fF", capacitance, -15, 0, 0},
    {"aF", capacitance, -18, 0, 0},    {"C", temperature, 0, 0, 0},
    {"K", temperature, 0, 1, -273.15}, {"deg", angle, 0, 0, 0},
    {"rad", angle, 0, 180 / G_PI, 0},  {"s", duration, 0, 0, 0},
    {"ms", duration, -3, 0, 0},        {"us", duration, -6, 0, 0},
    {"ns", duration, -9, 0, 0},        {"ps", duration, -12, 0, 0},
    {"min", duration, 0, 60, 0},       {"h", duration, 0, 3600, 0},
};

const opc_unit *opc_unit_find(const char *name) {
  for (size_t i = 0; i < G_N_ELEMENTS(units); i++)
    if (!strcmp(units[i].name, name)) return &units[i];
  return NULL;
}

const char *opc_unit_noun(const opc_unit *unit) { return unit->noun; }

int opc_unit_shares_zero(const opc_unit *unit) {
  for (size_t i = 0; i < G_N_ELEMENTS(units); i++)
    if (units[i].noun == unit->noun && units[i].offset != 0) return 0;
  return 1;
}

GPtrArray *opc_unit_names(void) {
  GPtrArray *names = g_ptr_array_new();
  for (size_t i = 0; i < G_N_ELEMENTS(units); i++)
    g_ptr_array_add(names, (char *)units[i].name);
  return names;
}

size_t opc_number_length(const char *text) {
  const char *c = text;
  if (*c == '+' || *c == '-') c++;
  const char *digits = c;
  while (g_ascii_isdigit(*c)) c++;
  size_t n = (size_t)(c - digits);
  if (*c == '.') {
    const char *point = c++;
    while (g_ascii_isdigit(*c)) c++;
    n += (size_t)(c - point - 1);
  }
  if (!n) return 0;
  if (*c == 'e' || *c == 'E') {
    const char *e = c + 1;
    if (*e == '+' || *e == '-') e++;
    if (g_ascii_isdigit(*e)) {
      while (g_ascii_isdigit(*e)) e++;
      c = e;
    }
  }
  return (size_t)(c - text);
}

/* Return the number times ten to the power of `shift`, rounded once. */
static double number_shifted(const char *text, size_t n, int shift) {
  g_autofree char *number = g_strndup(text, n);
  char *e = strpbrk(number, "eE");
  long exponent = shift;
  if (e) {
    /* An exponent of any size is accepted: strtol returns a limit, and 10^6
       exceeds the range of every number. */
    exponent += CLAMP(strtol(e + 1, NULL, 10), -1000000, 1000000);
    *e = 0;
  }
  g_autofree char *whole = g_strdup_printf("%se%ld", number, exponent);
  return g_ascii_strtod(whole, NULL);
}

double opc_number_in(const char *text, size_t n, const opc_unit *from,
                     const opc_unit *to) {
  if (from == to || !from || !to) return number_shifted(text, n, 0);
  if (from->factor == 0 && to->factor == 0)
    return number_shifted(text, n, from->exponent - to->exponent);
  double base = number_shifted(text, n, from->exponent) *
                    (from->factor != 0 ? from->factor : 1) +
                from->offset;
  return (base - to->offset) / (to->factor != 0 ? to->factor : 1) /
         pow(10, to->exponent);
}

char *opc_number_text(double number) {
  char buffer[40];
  for (int digits = 15; digits <= 17; digits++) {
    char format[8];
    g_snprintf(format, sizeof format, "%%.%dg", digits);
    g_ascii_formatd(buffer, sizeof buffer, format, number);
    if (g_ascii_strtod(buffer, NULL) == number) break;
  }
  return g_strdup(buffer);
}

enum { MOST_DECIMALS = 20 };

char *opc_number_fixed(double number, int decimals) {
  if (isnan(number)) return g_strdup("");
  if (isinf(number)) return g_strdup(number < 0 ? "-inf" : "inf");
  if (decimals < 0) return opc_number_text(number);
  char format[16], buffer[400];
  g_snprintf(format, sizeof format, "%%.%df", MIN(decimals, MOST_DECIMALS));
  g_ascii_formatd(buffer, sizeof buffer, format, number);
  /* Zero has no sign. */
  gboolean zero = *buffer == '-' && strspn(buffer, "-0.") == strlen(buffer);
  return g_strdup(buffer + zero);
}

char *opc_number_short(double number) {
  if (!isfinite(number) || (number == rint(number) && fabs(number) < 1e15))
    return opc_number_fixed(number, -1);
  char digits[40];
  g_ascii_formatd(digits, sizeof digits, "%.6g", number);
  return opc_number_text(g_ascii_strtod(digits, NULL));
}

char *opc_bytes_text(double bytes) {
  if (bytes < 1e6) return g_strdup("less than 1 MB");
  return g_strdup_printf(bytes < 1e9 ? "%.0f MB" : "%.1f GB",
                         bytes < 1e9 ? bytes * 1e-6 : bytes * 1e-9);
}
