/* SPDX-License-Identifier: BSD-3-Clause */
/* devices.ngspice: from a BSIM4 card to a device table, the on and off currents
   of wide transistors against their length (thesis 2.2.1). */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <opcflow/step.h>

#include "../../draw/mask/paper.h"
#include "ngspice.h"

/* ---- state ---- */

enum {
  CARD,
  PMOS_CARD,
  NMOS,
  PMOS,
  OVERRIDES,
  SUPPLY,
  TEMPERATURE,
  WIDTH,
  FROM,
  TO,
  STEP,
  LIST,
  ION_VGS,
  ION_VDS,
  IOFF_VGS,
  IOFF_VDS,
  REFERENCE_LENGTH,
  REFERENCE_WIDTH,
  NAME,
  FILE_NAME,
  PICTURE,
  LIMIT,
  PARAMETERS
};

enum { MOST_LENGTHS = 2000, LEAST_LENGTHS = 3 };

typedef struct device_step {
  const opc_host *host;
  const opc_value *values;
  plan plan;
  char *path[TYPES];
  int format; /* PAPER_PNG and so on */
} device_step;

/* ---- work: what is told ---- */

static const char *const types[TYPES] = {[OPC_NMOS] = "n", [OPC_PMOS] = "p"};

static int tell_table(const device_step *d, const currents *c,
                      opc_error *error) {
  const plan *p = &d->plan;
  const double *length = p->length + c->first;
  const opc_column columns[] = {
      {"length", "nm", OPC_REAL, -1, length},
      {"ion_n", "A", OPC_REAL, -1, c->at[OPC_NMOS][ION] + c->first},
      {"ioff_n", "A", OPC_REAL, -1, c->at[OPC_NMOS][IOFF] + c->first},
      {"ion_p", "A", OPC_REAL, -1, c->at[OPC_PMOS][ION] + c->first},
      {"ioff_p", "A", OPC_REAL, -1, c->at[OPC_PMOS][IOFF] + c->first},
  };
  return d->host->table(d->host, "devices", 0, p->count - c->first, columns,
                        sizeof columns / sizeof *columns, error);
}

/* The reference transistors, and how fast their currents change with length. */
static int tell_reference(const device_step *d, const currents *c,
                          opc_error *error) {
  static const char *const metrics[CURRENTS][TYPES] = {
      [ION] = {"ion_n", "ion_p"}, [IOFF] = {"ioff_n", "ioff_p"}};
  const plan *p = &d->plan;
  double length[TYPES], width[TYPES], ion[TYPES], ioff[TYPES], on_slope[TYPES],
      off_slope[TYPES];
  if (!(p->reference_length > 0)) return OPC_OK;
  for (int t = 0; t < TYPES; t++) {
    length[t] = p->reference_length;
    width[t] = p->reference_width;
    ion[t] = 1e6 * c->reference[t][ION];
    ioff[t] = 1e9 * c->reference[t][IOFF];
    on_slope[t] = table_slope(p, c, t, ION, length[t]);
    off_slope[t] = table_slope(p, c, t, IOFF, length[t]);
    for (int i = 0; i < CURRENTS; i++)
      if (d->host->metric(d->host, metrics[i][t], c->reference[t][i], error))
        return error->code;
  }
  const opc_column columns[] = {
      {"type", NULL, OPC_TEXT, 0, types},
      {"L", "nm", OPC_REAL, 1, length},
      {"W", "nm", OPC_REAL, 0, width},
      {"Ion", "uA", OPC_REAL, 2, ion},
      {"dIon/dL", "%/nm", OPC_REAL, 2, on_slope},
      {"Ioff", "nA", OPC_REAL, 3, ioff},
      {"dIoff/dL", "%/nm", OPC_REAL, 1, off_slope},
  };
  return d->host->table(d->host, "reference", OPC_TABLE_PRINT, TYPES, columns,
                        sizeof columns / sizeof *columns, error);
}

/* ---- work ---- */

static const char *name_of(const device_step *d) {
  const opc_value *name = &d->values[NAME];
  const char *slash = strrchr(d->plan.card[OPC_NMOS], '/');
  if (name->type != OPC_ABSENT) return name->text;
  return slash ? slash + 1 : d->plan.card[OPC_NMOS];
}

static int write_all(const device_step *d, const currents *c,
                     opc_error *error) {
  const opc_host *host = d->host;
  const plan *p = &d->plan;
  const char *path = host->output_path(host, d->values[FILE_NAME].text, error);
  if (!path || table_write(host, p, c, name_of(d), path, error))
    return error->code;
  path = host->output_path(host, d->values[PICTURE].text, error);
  if (!path || curves_draw(host, p, c, name_of(d), d->format, path, error))
    return error->code;
  if (host->metric(host, "shortest", p->length[c->first], error))
    return error->code;
  int code = tell_reference(d, c, error);
  return code ? code : tell_table(d, c, error);
}

/* The cards' whole paths: the simulator stands elsewhere. */
static int find_cards(device_step *d, opc_error *error) {
  static const int place[TYPES] = {[OPC_NMOS] = CARD, [OPC_PMOS] = PMOS_CARD};
  for (int t = 0; t < TYPES; t++) {
    const opc_value *v = &d->values[place[t]];
    if (v->type == OPC_ABSENT) v = &d->values[CARD];
    free(d->path[t]);
    d->path[t] = realpath(v->text, NULL);
    if (!d->path[t])
      return d->host->fail(d->host, error, OPC_IO, "card",
                           "cannot read '%s': %s", v->text, strerror(errno));
    if (strpbrk(d->path[t], "\"\n"))
      return d->host->fail(d->host, error, OPC_INVALID, "card",
                           "'%s': the simulator takes no such name of a file",
                           v->text);
    d->plan.card[t] = d->path[t];
  }
  return OPC_OK;
}

static int run(void *self, void **outputs, opc_error *error) {
  device_step *d = self;
  const opc_host *host = d->host;
  currents c = {0};
  (void)outputs;
  int code = find_cards(d, error);
  for (int t = 0; t < TYPES; t++)
    for (int i = 0; i < CURRENTS; i++) {
      c.at[t][i] = host->alloc(host, d->plan.count, sizeof(double));
      if (!c.at[t][i] && !code)
        code = host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    }
  if (!code) code = simulate(host, &d->plan, &c, error);
  if (!code) code = write_all(d, &c, error);
  for (int t = 0; t < TYPES; t++)
    for (int i = 0; i < CURRENTS; i++) host->free(host, c.at[t][i]);
  return code;
}

/* ---- parameters ---- */

#define LENGTH(lower, text)                                         \
  .type = OPC_REAL, .unit = "nm", .flags = OPC_ABOVE | OPC_AT_MOST, \
  .min = (lower), .max = 1e6, .summary = (text)
#define VOLTAGE(text)                                                 \
  .type = OPC_REAL, .unit = "V", .flags = OPC_AT_LEAST | OPC_AT_MOST, \
  .min = -20, .max = 20, .summary = (text)

static const opc_parameter parameters[PARAMETERS] = {
    [CARD] = {.name = "card",
              .type = OPC_FILE,
              .flags = OPC_REQUIRED,
              .summary = "file with the model cards"},
    [PMOS_CARD] = {.name = "pmos_card",
                   .type = OPC_FILE,
                   .summary = "that of the p-transistor, if it is another"},
    [NMOS] = {.name = "nmos",
              .type = OPC_TEXT,
              .preset = "nmos",
              .summary = "name of the n-transistor's model"},
    [PMOS] = {.name = "pmos",
              .type = OPC_TEXT,
              .preset = "pmos",
              .summary = "name of the p-transistor's model"},
    [OVERRIDES] = {.name = "overrides",
                   .type = OPC_MAP,
                   .summary = "model parameters to be changed in both cards, "
                              "{ igbmod: 0 }"},
    [SUPPLY] = {.name = "supply",
                .type = OPC_REAL,
                .unit = "V",
                .flags = OPC_REQUIRED | OPC_ABOVE | OPC_AT_MOST,
                .min = 0,
                .max = 20,
                .summary = "supply voltage"},
    [TEMPERATURE] = {.name = "temperature",
                     .type = OPC_REAL,
                     .unit = "C",
                     .flags = OPC_AT_LEAST | OPC_AT_MOST,
                     .preset = "27 C",
                     .min = -200,
                     .max = 300,
                     .summary = "temperature of the transistors"},
    [WIDTH] = {.name = "width",
               LENGTH(0, "drawn width of the transistors of the table"),
               .preset = "10 um"},
    [FROM] = {.name = "length.from",
              LENGTH(0, "shortest drawn length to be tried")},
    [TO] = {.name = "length.to", LENGTH(0, "longest drawn length")},
    [STEP] = {.name = "length.step",
              LENGTH(0, "between two lengths"),
              .preset = "1 nm"},
    [LIST] = {.name = "length.list",
              .type = OPC_REALS,
              .unit = "nm",
              .summary = "in place of these: the lengths, increasing"},
    [ION_VGS] = {.name = "ion.vgs",
                 VOLTAGE("gate voltage of Ion (default: the supply)")},
    [ION_VDS] = {.name = "ion.vds",
                 VOLTAGE("drain voltage of Ion (default: the supply)")},
    [IOFF_VGS] = {.name = "ioff.vgs",
                  VOLTAGE("gate voltage of Ioff"),
                  .preset = "0 V"},
    [IOFF_VDS] = {.name = "ioff.vds",
                  VOLTAGE("drain voltage of Ioff (default: the supply)")},
    [REFERENCE_LENGTH] = {.name = "reference.length",
                          LENGTH(0,
                                 "length of the transistors whose currents "
                                 "are metrics")},
    [REFERENCE_WIDTH] = {.name = "reference.width",
                         LENGTH(0, "their width"),
                         .preset = "1 um"},
    [NAME] = {.name = "name",
              .type = OPC_TEXT,
              .summary = "of the table (default: what the card is called)"},
    [FILE_NAME] = {.name = "file",
                   .type = OPC_OUTPUT,
                   .preset = "devices.yaml",
                   .summary = "the table"},
    [PICTURE] = {.name = "picture",
                 .type = OPC_OUTPUT,
                 .preset = "devices.png",
                 .summary = "the curves, .png, .svg or .pdf"},
    [LIMIT] = {.name = "limit",
               .type = OPC_REAL,
               .unit = "s",
               .flags = OPC_ABOVE | OPC_AT_MOST | OPC_NO_EFFECT,
               .preset = "60 s",
               .min = 0,
               .max = 86400,
               .summary = "time that the simulator may take"},
};

#define CURRENT(id, direction, text) \
  { .name = (id), .unit = "A", .better = (direction), .summary = (text) }

static const opc_metric metrics[] = {
    CURRENT("ion_n", OPC_NEUTRAL, "Ion of the reference n-transistor"),
    CURRENT("ion_p", OPC_NEUTRAL, "Ion of the reference p-transistor"),
    CURRENT("ioff_n", OPC_NEUTRAL, "Ioff of the reference n-transistor"),
    CURRENT("ioff_p", OPC_NEUTRAL, "Ioff of the reference p-transistor"),
    {.name = "shortest",
     .unit = "nm",
     .better = OPC_LOWER,
     .summary = "length that the table begins with"},
};

/* ---- checks ---- */

static int refuse(const opc_host *host, const char *parameter, const char *what,
                  const char *why, opc_error *error) {
  return host->fail(host, error, OPC_INVALID, parameter, "'%s' %s", what, why);
}

/* What may stand in a deck as a name. */
static int is_name(const char *text) {
  return *text && strspn(text,
                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                         "0123456789_.-") == strlen(text);
}

static int check_texts(const device_step *d, opc_error *error) {
  const opc_host *host = d->host;
  const opc_value *v = d->values;
  for (int i = NMOS; i <= PMOS; i++)
    if (!is_name(v[i].text))
      return refuse(host, parameters[i].name, v[i].text,
                    "is not the name of a model", error);
  for (size_t i = 0; i < v[OVERRIDES].count; i++) {
    const opc_pair *pair = &v[OVERRIDES].pairs[i];
    char *end;
    if (!is_name(pair->key))
      return refuse(host, "overrides", pair->key,
                    "is not the name of a model parameter", error);
    if (!isfinite(strtod(pair->value, &end)) || end == pair->value || *end)
      return refuse(host, "overrides", pair->value, "is not a plain number",
                    error);
  }
  for (const char *c = v[NAME].type == OPC_ABSENT ? "" : v[NAME].text; *c; c++)
    if ((unsigned char)*c < 32)
      return refuse(host, "name", v[NAME].text, "has a control character",
                    error);
  return OPC_OK;
}

static double or_supply(const device_step *d, int i) {
  return d->values[i].type == OPC_ABSENT ? d->plan.supply : d->values[i].real;
}

static int check_lengths(const device_step *d, size_t count,
                         const char *parameter, opc_error *error) {
  const double *x = d->plan.length;
  if (count < LEAST_LENGTHS || count > MOST_LENGTHS)
    return d->host->fail(d->host, error, OPC_INVALID, parameter,
                         "a table needs %d to %d lengths, not %zu",
                         LEAST_LENGTHS, MOST_LENGTHS, count);
  for (size_t i = 0; x && i < count; i++)
    if (!(x[i] > (i ? x[i - 1] : 0) && x[i] <= 1e6))
      return d->host->fail(d->host, error, OPC_INVALID, parameter,
                           "lengths must increase, above 0: '%g nm'", x[i]);
  return OPC_OK;
}

static int make_lengths(device_step *d, opc_error *error) {
  const opc_host *host = d->host;
  const opc_value *v = d->values;
  int list = v[LIST].type != OPC_ABSENT;
  const char *parameter = list ? "length.list" : "length.to";
  if (list && (v[FROM].type != OPC_ABSENT || v[TO].type != OPC_ABSENT))
    return refuse(host, "length.list", "length.list",
                  "is given, 'length.from' and 'length.to' are too", error);
  if (!list && (v[FROM].type == OPC_ABSENT || v[TO].type == OPC_ABSENT))
    return refuse(host, NULL, "length", "needs 'from' and 'to', or a 'list'",
                  error);
  double steps = list ? 0 : (v[TO].real - v[FROM].real) / v[STEP].real;
  /* The last step reaches `to`, though not to the last bit. */
  double n = list ? (double)v[LIST].count : floor(steps + 1e-6) + 1;
  size_t count = n > 0 ? (size_t)fmin(n, MOST_LENGTHS + 1) : 0;
  if (check_lengths(d, count, parameter, error)) return error->code;
  d->plan.length = calloc(MOST_LENGTHS, sizeof(double));
  if (!d->plan.length)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  d->plan.count = count;
  for (size_t i = 0; i < count; i++)
    d->plan.length[i] =
        list ? v[LIST].reals[i] : v[FROM].real + (double)i * v[STEP].real;
  return check_lengths(d, count, parameter, error);
}

static int make_plan(device_step *d, opc_error *error) {
  const opc_value *v = d->values;
  plan *p = &d->plan;
  p->model[OPC_NMOS] = v[NMOS].text;
  p->model[OPC_PMOS] = v[PMOS].text;
  p->overrides = v[OVERRIDES].pairs;
  p->n_overrides = v[OVERRIDES].count;
  p->supply = v[SUPPLY].real;
  p->temperature = v[TEMPERATURE].real;
  p->width = v[WIDTH].real;
  p->bias[ION] = (bias){or_supply(d, ION_VGS), or_supply(d, ION_VDS)};
  p->bias[IOFF] = (bias){v[IOFF_VGS].real, or_supply(d, IOFF_VDS)};
  p->limit = v[LIMIT].real;
  p->reference_length =
      v[REFERENCE_LENGTH].type == OPC_ABSENT ? 0 : v[REFERENCE_LENGTH].real;
  p->reference_width = v[REFERENCE_WIDTH].real;
  if (check_texts(d, error)) return error->code;
  return make_lengths(d, error);
}

static void destroy(void *self) {
  device_step *d = self;
  for (int t = 0; t < TYPES; t++) free(d->path[t]);
  free(d->plan.length);
  free(d);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  const char *picture = values[PICTURE].text;
  device_step *d = calloc(1, sizeof *d);
  if (!d) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  d->host = host;
  d->values = values;
  d->format = paper_format(picture);
  if (d->format < 0)
    refuse(host, "picture", picture,
           "is not the name of a .png, .svg or .pdf file", error);
  else if (!make_plan(d, error))
    return d;
  destroy(d);
  return NULL;
}

/* ---- entry ---- */

static const opc_step operations = {
    .size = sizeof operations, .port_size = sizeof(opc_port), .run = run};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "devices.ngspice",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "device table from a BSIM4 model card",
      .kind = OPC_KIND_STEP,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      OPC_METRICS(metrics),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
