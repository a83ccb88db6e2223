/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements devices.ngspice: computes a device table from a model card or a
   foundry's model library. The table has the on and off currents of transistors
   over length and width (thesis 2.2.1), and the capacitance of their gates. */
#include "ngspice.h"

#include <eda/drawing.h>
#include <eda/memory.h>
#include <eda/simulator.h>
#include <errno.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

/* ---- state: ngspice.h ---- */

enum { MOST_LENGTHS = 2000, LEAST_LENGTHS = 3 };

/* ---- work: reports ---- */

static const char *const types[TYPES] = {[EDA_NMOS] = "n", [EDA_PMOS] = "p"};

typedef struct point {
  double width, length, current[TYPES][QUANTITIES];
} point;

static int table_report(const plan *p, const currents *c, opc_error *error) {
  size_t count = p->count - c->first, n = p->widths * count;
  point *rows = eda_alloc(n, sizeof *rows);
  for (size_t i = 0; i < n; i++) {
    size_t w = i / count, l = c->first + i % count;
    rows[i].width = p->each_width[w];
    rows[i].length = p->length[l];
    for (int k = 0; k < TYPES * QUANTITIES; k++)
      rows[i].current[k / QUANTITIES][k % QUANTITIES] =
          c->at[k / QUANTITIES][k % QUANTITIES][w * p->count + l];
  }
  const opc_column columns[] = {
      {"length", "nm", OPC_REAL, -1, &rows->length},
      {"ion_n", "A", OPC_REAL, -1, &rows->current[EDA_NMOS][EDA_ION]},
      {"ioff_n", "A", OPC_REAL, -1, &rows->current[EDA_NMOS][EDA_IOFF]},
      {"ion_p", "A", OPC_REAL, -1, &rows->current[EDA_PMOS][EDA_ION]},
      {"ioff_p", "A", OPC_REAL, -1, &rows->current[EDA_PMOS][EDA_IOFF]},
      {"width", "nm", OPC_REAL, -1, &rows->width},
      {"cgate_n", "F", OPC_REAL, -1, &rows->current[EDA_NMOS][CGATE]},
      {"cgate_p", "F", OPC_REAL, -1, &rows->current[EDA_PMOS][CGATE]},
  };
  size_t n_columns = sizeof columns / sizeof *columns - (p->with_cgate ? 0 : 2);
  int code = opc_put_rows(p->host, "devices", 0, n, sizeof *rows, columns,
                          n_columns, error);
  free(rows);
  return code;
}

/* Report the extrapolated part of the table. */
static void extended_report(const plan *p, const currents *c) {
  char text[512];
  if (table_extended(p, c, text, sizeof text))
    p->host->log(p->host, OPC_LOG_WARNING, "of the table, %s", text);
}

/* Report the reference transistors and the change of their currents with
   length. */
static int reference_report(const plan *p, const currents *c,
                            opc_error *error) {
  const double *n = c->reference[EDA_NMOS], *pm = c->reference[EDA_PMOS];
  struct {
    double length, width, ion, ioff, on_slope, off_slope, cgate;
    const char *type;
  } row[TYPES];
  if (!(p->reference_length > 0)) return OPC_OK;
  for (int t = 0; t < TYPES; t++) {
    row[t].type = types[t];
    row[t].length = p->reference_length;
    row[t].width = p->reference_width;
    row[t].ion = 1e6 * c->reference[t][EDA_ION];
    row[t].ioff = 1e9 * c->reference[t][EDA_IOFF];
    row[t].cgate = 1e15 * c->reference[t][CGATE];
    row[t].on_slope = table_slope(p, c, t, EDA_ION, p->reference_length);
    row[t].off_slope = table_slope(p, c, t, EDA_IOFF, p->reference_length);
  }
  const opc_metric_value values[] = {
      {"ion_n", n[EDA_ION]},  {"ioff_n", n[EDA_IOFF]},
      {"ion_p", pm[EDA_ION]}, {"ioff_p", pm[EDA_IOFF]},
      {"cgate_n", n[CGATE]},  {"cgate_p", pm[CGATE]}};
  const opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, &row->type},
      {"L", "nm", OPC_REAL, 1, &row->length},
      {"W", "nm", OPC_REAL, 0, &row->width},
      {"Ion", "uA", OPC_REAL, 2, &row->ion},
      {"dIon/dL", "%/nm", OPC_REAL, 2, &row->on_slope},
      {"Ioff", "nA", OPC_REAL, -1, &row->ioff},
      {"dIoff/dL", "%/nm", OPC_REAL, 1, &row->off_slope},
      {"Cgate", "fF", OPC_REAL, 3, &row->cgate},
  };
  size_t n_columns = sizeof columns / sizeof *columns - (p->with_cgate ? 0 : 1);
  int code = opc_put_metrics(p->host, values, p->with_cgate ? 6 : 4, error);
  return code ? code
              : opc_put_rows(p->host, "reference", OPC_TABLE_PRINT, TYPES,
                             sizeof *row, columns, n_columns, error);
}

/* ---- work: a run ---- */

static int write_all(const plan *p, const currents *c, opc_error *error) {
  const char *slash = strrchr(p->path[EDA_NMOS], '/');
  const char *name = p->name ? p->name : slash + 1;
  int code = table_write(p, c, name, error);
  if (!code) code = picture_draw(p, c, name, error);
  if (!code)
    code = p->host->metric(p->host, "shortest", p->length[c->first], error);
  if (!code) code = reference_report(p, c, error);
  extended_report(p, c);
  return code ? code : table_report(p, c, error);
}

/* Find the absolute paths of the files: the simulator runs in another
   folder. */
static int find_files(plan *p, opc_error *error) {
  const char *parameter = p->library ? "library" : "card";
  /* Checked at run time, because flows may leave these parameters to the
     caller. */
  if (!p->library && !p->card[EDA_NMOS])
    return opc_fail(error, OPC_INVALID, NULL,
                    "set 'card' or 'library', a file of models");
  for (int t = 0; t < TYPES; t++) {
    const char *file = p->library   ? p->library
                       : p->card[t] ? p->card[t]
                                    : p->card[EDA_NMOS];
    p->path[t] = realpath(file, NULL);
    if (!p->path[t])
      return opc_fail(error, OPC_IO, parameter, "cannot read '%s': %s", file,
                      strerror(errno));
    if (strpbrk(p->path[t], "\"\n"))
      return opc_fail(error, OPC_INVALID, parameter,
                      "'%s': the simulator cannot open a file name with a "
                      "quote or line break",
                      file);
  }
  return OPC_OK;
}

static int read_library(plan *p, opc_error *error) {
  static const char *const parameter[TYPES] = {"nmos", "pmos"};
  p->models = eda_models_read(p->library, p->corner, p->osdi, error);
  if (!p->models) return error->code;
  for (int t = 0; t < TYPES; t++)
    if (!eda_models_kind(p->models, p->model[t]))
      return opc_fail(error, OPC_INVALID, parameter[t],
                      "'%s'%s%s has neither a subcircuit nor a model '%s'",
                      p->library, p->corner ? ", corner " : "",
                      p->corner ? p->corner : "", p->model[t]);
  return OPC_OK;
}

static int devices_run(void *self, void **outputs, opc_error *error) {
  plan *p = self;
  currents c = {0};
  (void)outputs;
  for (int k = 0; k < TYPES * QUANTITIES; k++)
    c.at[k / QUANTITIES][k % QUANTITIES] =
        eda_alloc(p->widths * p->count, sizeof(double));
  int code = find_files(p, error);
  if (!code && p->library) code = read_library(p, error);
  if (!code) code = simulate(p, &c, error);
  if (!code) code = write_all(p, &c, error);
  for (int k = 0; k < TYPES * QUANTITIES; k++)
    free(c.at[k / QUANTITIES][k % QUANTITIES]);
  return code;
}

/* ---- parameters ---- */

#define TEXT(label, type_of, field, what) \
  .name = (label), .type = (type_of), .summary = (what), OPC_FIELD(plan, field)
#define LENGTH(label, field, what)                                           \
  .name = (label), .type = OPC_REAL, .unit = "nm",                           \
  .flags = OPC_ABOVE | OPC_AT_MOST, .min = 0, .max = 1e6, .summary = (what), \
  OPC_FIELD(plan, field)
#define VOLTAGE(label, field, what)                           \
  .name = (label), .type = OPC_REAL, .unit = "V",             \
  .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = -20, .max = 20, \
  .summary = (what), OPC_FIELD(plan, field)

static const opc_parameter parameters[] = {
    {TEXT("card", OPC_FILE, card[EDA_NMOS],
          "file with the model cards; required without `library`")},
    {TEXT("pmos_card", OPC_FILE, card[EDA_PMOS],
          "file with the model card of the p-transistor, if different")},
    {TEXT("library", OPC_FILE, library,
          "model library of a foundry: subcircuits or cards, in sections and "
          "bins")},
    {TEXT("corner", OPC_TEXT, corner,
          "section of the library (default: the models outside of sections)")},
    {TEXT("osdi", OPC_FILE, osdi,
          "shared object of the compiled models that the library uses (OSDI)")},
    {TEXT("ends", OPC_CHOICE, ends,
          "treatment of lengths shorter than the model permits. cut: omit "
          "them; refuse: error; extend: use the outermost bins; slope: "
          "extrapolate the currents by their slope"),
     .choices = "cut|refuse|extend|slope", .preset = "cut"},
    {TEXT("nmos", OPC_TEXT, model[EDA_NMOS],
          "name of the n-transistor's model, or subcircuit"),
     .preset = "nmos"},
    {TEXT("pmos", OPC_TEXT, model[EDA_PMOS],
          "name of the p-transistor's model, or subcircuit"),
     .preset = "pmos"},
    {TEXT("overrides", OPC_MAP, overrides,
          "model parameters to change in both cards, { igbmod: 0 }")},
    EDA_CONDITIONS(plan),
    {LENGTH("width", width, "drawn width of the transistors of the table"),
     .preset = "10 um"},
    {TEXT("widths", OPC_REALS, width_list,
          "increasing widths, for a table of length and width; replaces "
          "`width`; slices use the current of the largest width"),
     .unit = "nm"},
    {LENGTH("length.from", from, "shortest drawn length")},
    {LENGTH("length.to", to, "longest drawn length")},
    {LENGTH("length.step", step, "step between two lengths"), .preset = "1 nm"},
    {TEXT("length.list", OPC_REALS, list,
          "increasing lengths; replaces the range `from` to `to`"),
     .unit = "nm"},
    {VOLTAGE("ion.vgs", bias[EDA_ION].gate,
             "gate voltage of Ion (default: the supply)")},
    {VOLTAGE("ion.vds", bias[EDA_ION].drain,
             "drain voltage of Ion (default: the supply)")},
    {VOLTAGE("ioff.vgs", bias[EDA_IOFF].gate, "gate voltage of Ioff"),
     .preset = "0 V"},
    {VOLTAGE("ioff.vds", bias[EDA_IOFF].drain,
             "drain voltage of Ioff (default: the supply)")},
    {TEXT("capacitance", OPC_BOOL, with_cgate,
          "measure the gate capacitance as well: charge of the gate over a "
          "swing from 0 to the supply, divided by the supply, with the drain "
          "at the supply"),
     .preset = "false"},
    {LENGTH("reference.length", reference_length,
            "length of the transistors whose currents are metrics")},
    {LENGTH("reference.width", reference_width,
            "width of the transistors whose currents are metrics"),
     .preset = "1 um"},
    {TEXT("name", OPC_TEXT, name,
          "name of the table (default: name of the card)")},
    {TEXT("flavour", OPC_TEXT, flavour,
          "flavour of the transistors, such as lvt; required for all tables of "
          "a file except the first")},
    {TEXT("file", OPC_OUTPUT, file, "device table"), .preset = "devices.yaml"},
    {TEXT("picture", OPC_OUTPUT, picture,
          "picture of the curves, .png, .svg or .pdf"),
     .preset = "devices.png"},
    OPC_PARAMETER_NAMED("time_limit", plan, limit, .type = OPC_REAL,
                        .unit = "s", .former = "limit",
                        .flags = OPC_ABOVE | OPC_AT_MOST | OPC_NO_EFFECT,
                        .preset = "60 s", .min = 0, .max = 86400,
                        .summary = "Longest time of the simulator"),
};

static const opc_metric metrics[] = {
    {"ion_n", "A", OPC_NEUTRAL, 0, "Ion of the reference n-transistor"},
    {"ion_p", "A", OPC_NEUTRAL, 0, "Ion of the reference p-transistor"},
    {"ioff_n", "A", OPC_NEUTRAL, 0, "Ioff of the reference n-transistor"},
    {"ioff_p", "A", OPC_NEUTRAL, 0, "Ioff of the reference p-transistor"},
    {"cgate_n", "F", OPC_NEUTRAL, 0, "Cgate of the reference n-transistor"},
    {"cgate_p", "F", OPC_NEUTRAL, 0, "Cgate of the reference p-transistor"},
    {"shortest", "nm", OPC_LOWER, 0, "smallest length of the table"},
};

static int parameter_refuse(const char *parameter, const char *what,
                            const char *why, opc_error *error) {
  return opc_fail(error, OPC_INVALID, parameter, "'%s' %s", what, why);
}

static int check_texts(const plan *p, opc_error *error) {
  static const char *const models[TYPES] = {"nmos", "pmos"};
  for (int t = 0; t < TYPES; t++)
    if (!eda_spice_is_name(p->model[t]))
      return parameter_refuse(models[t], p->model[t],
                              "is not the name of a model", error);
  for (size_t i = 0; i < p->overrides.count; i++) {
    const opc_pair *pair = &p->overrides.pairs[i];
    char *end;
    if (!eda_spice_is_name(pair->key))
      return parameter_refuse("overrides", pair->key,
                              "is not the name of a model parameter", error);
    if (!isfinite(strtod(pair->value, &end)) || end == pair->value || *end)
      return parameter_refuse("overrides", pair->value, "is not a plain number",
                              error);
  }
  if (p->flavour && !eda_spice_is_name(p->flavour))
    return parameter_refuse("flavour", p->flavour, "is not a name", error);
  for (const char *c = p->name ? p->name : ""; *c; c++)
    if ((unsigned char)*c < 32)
      return parameter_refuse("name", p->name, "has a control character",
                              error);
  return OPC_OK;
}

/* Check that the given parameters are consistent. */
static int check_source(const plan *p, opc_error *error) {
  if (p->card[EDA_NMOS] && p->library)
    return parameter_refuse("library", p->library,
                            "and 'card' exclude each other", error);
  if (p->library && p->card[EDA_PMOS])
    return parameter_refuse("pmos_card", p->card[EDA_PMOS], "requires 'card'",
                            error);
  if (p->library && p->overrides.count)
    return parameter_refuse("overrides", "overrides", "require 'card'", error);
  if (p->card[EDA_NMOS] && p->corner)
    return parameter_refuse("corner", p->corner, "requires 'library'", error);
  if (p->osdi && !p->library)
    return parameter_refuse("osdi", p->osdi, "requires 'library'", error);
  if (p->card[EDA_NMOS] && p->ends == EXTEND)
    return parameter_refuse("ends", "extend", "requires 'library'", error);
  if (p->corner && !eda_spice_is_name(p->corner))
    return parameter_refuse("corner", p->corner, "is not the name of a section",
                            error);
  return OPC_OK;
}

static int make_widths(plan *p, opc_error *error) {
  enum { MOST_WIDTHS = 200 };
  const opc_reals *list = &p->width_list;
  if (list->count == 1 || list->count > MOST_WIDTHS)
    return opc_fail(error, OPC_INVALID, "widths",
                    "a table has 2 to %d widths, found %zu", MOST_WIDTHS,
                    list->count);
  p->widths = list->count ? list->count : 1;
  p->each_width = eda_alloc(p->widths, sizeof *p->each_width);
  p->each_width[0] = p->width;
  for (size_t i = 0; i < list->count; i++) {
    double w = p->each_width[i] = list->values[i];
    if (!(w > (i ? list->values[i - 1] : 0) && w <= 1e6))
      return opc_fail(error, OPC_INVALID, "widths",
                      "widths must increase, above 0: '%g nm'", w);
  }
  p->width = p->each_width[p->widths - 1];
  return OPC_OK;
}

static int make_lengths(plan *p, opc_error *error) {
  int list = p->list.count > 0;
  const char *parameter = list ? "length.list" : "length.to";
  if (list && (!isnan(p->from) || !isnan(p->to)))
    return parameter_refuse("length.list", "length.list",
                            "excludes 'length.from' and 'length.to'", error);
  if (!list && (isnan(p->from) || isnan(p->to)))
    return parameter_refuse(NULL, "length",
                            "requires 'from' and 'to', or a 'list'", error);
  /* The last step reaches `to` except for rounding. */
  double n = list ? (double)p->list.count
                  : floor((p->to - p->from) / p->step + 1e-6) + 1;
  p->count = (size_t)fmin(fmax(n, 0), MOST_LENGTHS + 1);
  if (p->count < LEAST_LENGTHS || p->count > MOST_LENGTHS)
    return opc_fail(error, OPC_INVALID, parameter,
                    "a table has %d to %d lengths, found %zu", LEAST_LENGTHS,
                    MOST_LENGTHS, p->count);
  double *x = p->length = eda_alloc(p->count, sizeof *x);
  for (size_t i = 0; i < p->count; i++) {
    x[i] = list ? p->list.values[i] : p->from + (double)i * p->step;
    if (!(x[i] > (i ? x[i - 1] : 0) && x[i] <= 1e6))
      return opc_fail(error, OPC_INVALID, parameter,
                      "lengths must increase, above 0: '%g nm'", x[i]);
  }
  return OPC_OK;
}

static int devices_check(void *self, opc_error *error) {
  plan *p = self;
  double *voltages[] = {&p->bias[EDA_ION].gate, &p->bias[EDA_ION].drain,
                        &p->bias[EDA_IOFF].drain};
  for (size_t i = 0; i < sizeof voltages / sizeof *voltages; i++)
    if (isnan(*voltages[i])) *voltages[i] = p->supply;
  p->bias[CGATE] = (bias){p->supply, p->supply};
  int code = eda_paper_check(p->picture, "picture", error);
  if (!code) code = check_source(p, error);
  if (!code) code = check_texts(p, error);
  if (!code) code = make_widths(p, error);
  return code ? code : make_lengths(p, error);
}

static void devices_clear(void *self) {
  plan *p = self;
  for (int t = 0; t < TYPES; t++) free(p->path[t]);
  free(p->length);
  free(p->each_width);
  eda_models_free(p->models);
}

/* ---- entry ---- */

/* Cards and libraries may include other files, and the simulator is another
   program. */
static const opc_step functions = {.run = devices_run,
                                   .flags = OPC_STEP_OUTSIDE};

OPC_PLUGIN(plan, .id = "devices.ngspice", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "device table from a model card or a foundry's library",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = devices_check, .clear = devices_clear,
           OPC_FUNCTIONS(functions));
