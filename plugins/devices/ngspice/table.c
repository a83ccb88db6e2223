/* SPDX-License-Identifier: BSD-3-Clause */
/* The device table as a file (docs/devices.md). */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ngspice.h"

enum { ROW = 8 }; /* values in a line */

/* A text in quotes. */
static void put_text(FILE *out, const char *text) {
  fputc('"', out);
  for (const char *c = text; *c; c++) {
    if (*c == '"' || *c == '\\') fputc('\\', out);
    fputc(*c, out);
  }
  fputc('"', out);
}

static void put_list(FILE *out, const double *value, size_t n, int exponent,
                     int indent) {
  fputc('[', out);
  for (size_t i = 0; i < n; i++) {
    if (i) fputs(i % ROW ? ", " : ",\n", out);
    if (i && i % ROW == 0) fprintf(out, "%*s", indent, "");
    fprintf(out, exponent ? "%.6e" : "%.10g", value[i]);
  }
  fputs("]}\n", out);
}

static const char *file_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

static void put_source(FILE *out, const plan *p, const currents *c) {
  char text[1024];
  int n = snprintf(text, sizeof text, "%s", file_name(p->path[EDA_NMOS]));
  if (strcmp(p->path[EDA_NMOS], p->path[EDA_PMOS]))
    n += snprintf(text + n, sizeof text - (size_t)n, " and %s",
                  file_name(p->path[EDA_PMOS]));
  for (size_t i = 0; i < p->overrides.count && n < 900; i++)
    n += snprintf(text + n, sizeof text - (size_t)n, "%s%.32s = %.32s",
                  i ? ", " : " with ", p->overrides.pairs[i].key,
                  p->overrides.pairs[i].value);
  snprintf(text + n, sizeof text - (size_t)n, ", simulated with %s",
           c->simulator);
  fputs("source: ", out);
  put_text(out, text);
  fputc('\n', out);
}

static void put_bias(FILE *out, const char *key, const bias *b, double supply) {
  fprintf(out, "%s: \"", key);
  if (b->gate == supply && b->drain == supply)
    fputs("Vgs = Vds = supply", out);
  else if (b->drain == supply)
    fprintf(out, "Vgs = %g%s, Vds = supply", b->gate, b->gate != 0 ? " V" : "");
  else
    fprintf(out, "Vgs = %g V, Vds = %g V", b->gate, b->drain);
  fputs("\"\n", out);
}

static void put_table(FILE *out, const plan *p, const currents *c,
                      const char *name) {
  static const char *const types[TYPES] = {
      [EDA_NMOS] = "nmos", [EDA_PMOS] = "pmos"};
  static const char *const names[EDA_CURRENTS] = {
      [EDA_ION] = "ion", [EDA_IOFF] = "ioff"};
  size_t n = p->count - c->first;
  fputs(
      "# On and off current against drawn channel length, by the plugin "
      "devices.ngspice.\nopcflow-devices: 1\nname: ",
      out);
  put_text(out, name);
  fputc('\n', out);
  put_source(out, p, c);
  fprintf(out, "supply: %.10g V\ntemperature: %.10g C\nwidth: %.10g um\n",
          p->supply, p->temperature, p->width / 1000);
  for (int i = 0; i < EDA_CURRENTS; i++)
    put_bias(out, names[i], &p->bias[i], p->supply);
  fputs("length: {unit: nm, values: ", out);
  put_list(out, p->length + c->first, n, 0, 28);
  for (int type = 0; type < TYPES; type++) {
    fprintf(out, "%s:\n", types[type]);
    for (int i = 0; i < EDA_CURRENTS; i++) {
      fprintf(out, "  %s: {unit: A, values:\n%11s", names[i], "");
      put_list(out, c->at[type][i] + c->first, n, 1, 12);
    }
  }
}

int table_write(const plan *p, const currents *c, const char *name,
                opc_error *error) {
  const char *path = p->host->output_path(p->host, p->file, error);
  if (!path) return error->code;
  FILE *out = fopen(path, "w");
  if (out) put_table(out, p, c, name);
  int bad = !out || ferror(out), reason = errno;
  if (out && fclose(out)) bad = 1, reason = errno;
  if (!bad) return OPC_OK;
  if (out) (void)remove(path);
  return opc_fail(error, OPC_IO, "file", "cannot write '%s': %s", path,
                  strerror(reason));
}

double table_slope(const plan *p, const currents *c, int type, int current,
                   double length) {
  const double *x = p->length, *y = c->at[type][current];
  size_t low = c->first, high;
  if (!(length > x[low] && length < x[p->count - 1])) return NAN;
  while (low + 1 < p->count && x[low + 1] < length) low++;
  high = x[low + 1] > length ? low + 1 : low + 2;
  return 100 * log(y[high] / y[low]) / (x[high] - x[low]);
}
