/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the device table (docs/reference/devices.md). */
#include <eda/file.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ngspice.h"

enum { ROW = 8 }; /* values per line */

/* Write a text in quotes. */
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
  fputc(']', out);
}

static void put_source(FILE *out, const plan *p, const currents *c) {
  char text[1024];
  int n = snprintf(text, sizeof text, "%.200s", basename(p->path[EDA_NMOS]));
  if (p->models)
    n +=
        snprintf(text + n, sizeof text - (size_t)n, " %.60s%s%.100s and %.100s",
                 p->corner ? p->corner : "", p->corner ? ", " : "",
                 p->model[EDA_NMOS], p->model[EDA_PMOS]);
  else if (strcmp(p->path[EDA_NMOS], p->path[EDA_PMOS]))
    n += snprintf(text + n, sizeof text - (size_t)n, " and %.200s",
                  basename(p->path[EDA_PMOS]));
  for (size_t i = 0; i < p->overrides.count && n < 900; i++)
    n += snprintf(text + n, sizeof text - (size_t)n, "%s%.32s = %.32s",
                  i ? ", " : " with ", p->overrides.pairs[i].key,
                  p->overrides.pairs[i].value);
  snprintf(text + n, sizeof text - (size_t)n, ", simulated with %s%s%.100s",
           c->simulator, p->osdi ? " and " : "",
           p->osdi ? basename(p->osdi) : "");
  fputs("source: ", out);
  put_text(out, text);
  fputc('\n', out);
}

/* Add an extrapolated item to the text. */
static void extrapolation_add(char *text, size_t capacity, const char *type,
                              const char *what, double bound, const char *how) {
  size_t n = strlen(text);
  (void)snprintf(text + n, capacity - n, "%s%s %s than %.10g nm by %s",
                 n ? "; " : "", type, what, bound, how);
}

int table_extended(const plan *p, const currents *c, char *text,
                   size_t capacity) {
  static const char *const names[TYPES] = {"n", "p"};
  *text = 0;
  for (int t = 0; t < TYPES; t++) {
    eda_sizes bins = {{0}, {0}};
    if (p->ends == EXTEND) (void)eda_models_bins(p->models, p->model[t], &bins);
    if (c->simulated[t])
      extrapolation_add(text, capacity, names[t], "shorter",
                        p->length[c->simulated[t]], "the slope there");
    if (c->narrowest[t] > 0)
      extrapolation_add(text, capacity, names[t], "narrower", c->narrowest[t],
                        "the slope over 1/W there");
    if (p->length[c->first] < bins.length[0] - 1)
      extrapolation_add(text, capacity, names[t], "shorter", bins.length[0],
                        "the last bin");
    if (p->each_width[0] < bins.width[0] - 1)
      extrapolation_add(text, capacity, names[t], "narrower", bins.width[0],
                        "the last bin");
  }
  return *text != 0;
}

/* Return the shortest length, nm, at which a type was simulated within the bins
   of its model; 0: all lengths of the table. */
static double table_modelled(const plan *p, const currents *c, int type) {
  eda_sizes bins = {{0}, {0}};
  if (p->ends == EXTEND)
    (void)eda_models_bins(p->models, p->model[type], &bins);
  if (c->simulated[type]) return p->length[c->simulated[type]];
  return p->length[c->first] < bins.length[0] - 1 ? bins.length[0] : 0;
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

static void put_widths(FILE *out, const plan *p) {
  if (p->widths == 1) {
    fprintf(out, "width: %.10g um\n", p->width / 1000);
    return;
  }
  fputs("width: {unit: nm, values: ", out);
  put_list(out, p->each_width, p->widths, 0, 27);
  fputs("}\n", out);
}

/* Write a current at all lengths; with several widths, a list for each. */
static void put_currents(FILE *out, const plan *p, const currents *c,
                         const double *at) {
  size_t n = p->count - c->first;
  fprintf(out, "%11s%s", "", p->widths > 1 ? "[" : "");
  for (size_t w = 0; w < p->widths; w++) {
    if (w) fprintf(out, ",\n%12s", "");
    put_list(out, at + w * p->count + c->first, n, 1, p->widths > 1 ? 13 : 12);
  }
  fputs(p->widths > 1 ? "]}\n" : "}\n", out);
}

static void put_table(FILE *out, const plan *p, const currents *c,
                      const char *name) {
  static const char *const types[TYPES] = {
      [EDA_NMOS] = "nmos", [EDA_PMOS] = "pmos"};
  static const char *const names[QUANTITIES] = {
      [EDA_ION] = "ion", [EDA_IOFF] = "ioff", [CGATE] = "cgate"};
  char extended[512];
  if (p->flavour) fprintf(out, "---\nflavour: %s\n", p->flavour);
  fputs(
      "# On and off current against drawn channel length, by the plugin "
      "devices.ngspice.\nopcflow-devices: 1\nname: ",
      out);
  put_text(out, name);
  fputc('\n', out);
  put_source(out, p, c);
  if (table_extended(p, c, extended, sizeof extended))
    fprintf(out, "extended: \"%s\"\n", extended);
  fprintf(out, "supply: %.10g V\ntemperature: %.10g C\n", p->supply,
          p->temperature);
  put_widths(out, p);
  for (int i = 0; i < EDA_CURRENTS; i++)
    put_bias(out, names[i], &p->bias[i], p->supply);
  if (p->with_cgate)
    fputs(
        "cgate: \"charge of the gate over Vgs = 0 to supply, by the supply, at "
        "Vds = supply\"\n",
        out);
  for (int t = 0; t < TYPES; t++) {
    double shortest = table_modelled(p, c, t);
    if (shortest > 0)
      fprintf(out, "%s_modelled: %.10g nm\n", types[t], shortest);
  }
  fputs("length: {unit: nm, values: ", out);
  put_list(out, p->length + c->first, p->count - c->first, 0, 28);
  fputs("}\n", out);
  for (int type = 0; type < TYPES; type++) {
    fprintf(out, "%s:\n", types[type]);
    for (int i = 0; i < plan_quantities(p); i++) {
      fprintf(out, "  %s: {unit: %s, values:\n", names[i],
              i == CGATE ? "F" : "A");
      put_currents(out, p, c, c->at[type][i]);
    }
  }
}

int table_write(const plan *p, const currents *c, const char *name,
                opc_error *error) {
  const char *path = p->host->output_path(p->host, p->file, error);
  if (!path) return error->code;
  FILE *out = fopen(path, "w");
  if (out) put_table(out, p, c, name);
  int opened = out != NULL, code = eda_file_close(out, path, "file", error);
  if (code && opened) (void)remove(path);
  return code;
}

double table_slope(const plan *p, const currents *c, int type, int current,
                   double length) {
  const double *x = p->length, *y = currents_widest(p, c, type, current);
  size_t low = c->first, high;
  if (!(length > x[low] && length < x[p->count - 1])) return NAN;
  while (low + 1 < p->count && x[low + 1] < length) low++;
  high = x[low + 1] > length ? low + 1 : low + 2;
  return 100 * log(y[high] / y[low]) / (x[high] - x[low]);
}
